"""What a run asks of the referee: Manual Operation and OMF Switches (docs/referee.md)."""

from functools import partial
from typing import Any, Dict, List, Optional, Sequence, Tuple

from roah_rsbb.model.actions import MAX_DAMAGED
from roah_rsbb.model.fields import Choice, Field, entered, fixed
from roah_rsbb.model.zone import UNKNOWN, Switches
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.panels.actions import FieldEditors
from roah_rsbb.rqt.panels.panel import SILENT, AnswerLine, Panel, scoring_in
from roah_rsbb.rqt.qt import (
    QApplication,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QScrollArea,
    Qt,
    QTimer,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording.language import tr, tr_later

NOTHING = tr_later("No manual operation now.")
TO_CONFIRM = tr_later(
    "The robot has finished. Enter and confirm the switches that it changed in the panel OMF Switches.")
COMPLETE = tr_later("✔ Manual operation complete")
COMPLETE_WITH = tr_later("✔ Complete with this answer")
# How many times a new request flashes, and for how long each time.
FLASHES = 8
FLASH_MS = 350

# Identifies a request: zone, run and number.
OperationKey = Tuple[str, str, int]


def to_front(panel: QWidget) -> None:
    """Bring a panel to the front where panels are stacked."""
    parent = panel.parentWidget()
    if parent is not None and hasattr(parent, "raise_"):
        parent.raise_()


class ManualOperationPanel(Panel):
    """The request in large letters, and its form: of one choice, a button for each answer. A new request flashes and
    beeps."""

    TITLE = tr_later("Manual Operation")
    TAB = tr_later("Manual")
    WORKS_BEHIND = True

    def __init__(self, client) -> None:
        super().__init__(client)
        self._request: Optional[OperationKey] = None
        self._fields: Sequence[Field] = ()
        self._came = False  # to the front, for this request
        self._flashes_left = 0
        self._flash = QTimer(self, interval=FLASH_MS, timeout=self._on_flash)
        self.text = QLabel(wordWrap=True, alignment=Qt.AlignCenter, textFormat=Qt.PlainText)
        self.text.setMargin(round(0.5 * basic.em()))
        # Both scroll where the panel is low: its buttons stay in sight.
        area, asked = QScrollArea(widgetResizable=True), QWidget()
        self._asked = basic.flat(QVBoxLayout(asked))
        self._asked.addWidget(self.text, 1)
        self.form = FieldEditors(())
        self._asked.addWidget(self.form)
        area.setWidget(asked)
        self.body.addWidget(area, 1)
        self.answer = AnswerLine()
        self.body.addWidget(self.answer)
        self._line = QHBoxLayout()
        self.body.addLayout(self._line)
        self.buttons: List[basic.CommandButton] = []
        self._build()

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        zone = self.model.zone
        action = UNKNOWN if zone is None else zone.action("operation")
        request = (zone.zone, zone.identity, zone.operation) if action.shown else None
        if request != self._request:
            self._fields = zone.fields("operation") if request is not None else ()
            self._show_another(request)
        waits_for_switches = zone is not None and zone.switches is not None and zone.switches.to_confirm
        self.text.setText(action.text if request else tr(TO_CONFIRM if waits_for_switches else NOTHING))
        self.text.setEnabled(not self.model.is_old and (request is not None or waits_for_switches))
        self._show_tone()
        why_off = self.model.why_read_only(tr(SILENT)) or ("" if request is not None else tr(NOTHING))
        can_answer = not why_off
        self.form.setEnabled(can_answer)
        for number, button in enumerate(self.buttons):
            button.allow(can_answer, [why_off], basic.ON if number == 0 else None)

    def _show_another(self, request: Optional[OperationKey]) -> None:
        """Show another request, or none."""
        self._request = request
        self.answer.clear_answer()
        self._build()
        self._flashes_left = FLASHES if request is not None else 0
        if request is not None:
            for button in self.buttons:
                button.hold()  # a click meant for the previous request must not answer this one
            QApplication.beep()
            self._flash.start()
            self._came = self._came or self.visibleRegion().isEmpty()
            to_front(self)
        elif self._came and not self.visibleRegion().isEmpty():
            self._came = False
            scoring = scoring_in(self.window())
            if scoring is not None:
                to_front(scoring)

    def _build(self) -> None:
        """Create a button for each answer, or the form and a button that completes the operation."""
        for widget in (self.form, *self.buttons):
            widget.hide()
            widget.deleteLater()
        asked = entered(self._fields)
        only = asked[0] if len(asked) == 1 and isinstance(asked[0], Choice) else None
        form = FieldEditors(() if only else self._fields)
        self._asked.replaceWidget(self.form, form)
        self.form, self.buttons = form, []
        form.setVisible(bool(form.editors))
        # A form must be in sight, too.
        basic.enlarged(self.text, basic.LEAD if form.editors else basic.FIGURE, bold=True)
        for editor in form.editors.values():
            basic.enlarged(editor, basic.LEAD)
            if isinstance(editor, QLineEdit):
                editor.returnPressed.connect(self._on_return)
        answers: List[Tuple[str, Dict[str, str]]] = [(tr(COMPLETE_WITH if asked else COMPLETE), {})]
        if only:
            answers = [(choice, {only.name: choice}) for choice in only.choices]
        for text, chosen in answers:
            button = basic.CommandButton(text, tr("Confirm that it is done. The run continues."), basic.TITLE,
                                         partial(self._complete, chosen))
            self._line.addWidget(button)
            self.buttons.append(button)

    def _on_flash(self) -> None:
        self._flashes_left = max(0, self._flashes_left - 1)
        if not self._flashes_left:
            self._flash.stop()
        self._show_tone()

    def _show_tone(self) -> None:
        """Flash in two colours; afterwards a waiting request stays marked."""
        if self._request is None or self.model.why_read_only(tr(SILENT)):
            basic.set_style(self.text, "")
            return
        tone = basic.Tone(*reversed(basic.ALARM)) if self._flashes_left % 2 else basic.ALARM
        basic.set_style(self.text, tone.css)

    # -- answering ----------------------------------------------------------------------------------

    def _on_return(self) -> None:
        if self.buttons[0].is_on():
            self._complete({})

    def _complete(self, chosen: Dict[str, Any]) -> None:
        """The referee did it. `chosen`: the answer of a button; empty: what is in the form."""
        request, given = self._request, {**fixed(self._fields), **chosen} if chosen else self.form.given()
        if request is None or given is None:
            return
        for button in self.buttons:
            button.hold()
        self.answer.say(tr("Manual operation complete …"))
        zone, run, _ = request
        self.client.calls.act(self, "operation", zone, run, given, lambda outcome: self._answered(request, outcome))

    def _answered(self, request: OperationKey, outcome) -> None:
        if request == self._request or outcome.error:
            self.answer.show_outcome(tr("Manual operation complete"), outcome)
        if outcome.error:
            for button in self.buttons:
                button.let_go()


NO_SWITCHES = tr_later("Used in HOMF only, from the robot's first goal.")
EXECUTING = tr_later("The robot has not finished. Confirm when it has.")
# The test bed's panel has ten switches.
SWITCHES = 10
COLUMNS = 5


class OmfSwitchesPanel(Panel):
    """A button for each switch, the number of damaged switches, and a button to confirm."""

    TITLE = tr_later("OMF Switches")
    TAB = tr_later("Switches")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.hint = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignCenter), basic.LEAD)
        self.body.addWidget(self.hint)
        grid = QGridLayout()
        self.switches: List[basic.CommandButton] = [self._switch(number) for number in range(1, SWITCHES + 1)]
        for index, button in enumerate(self.switches):
            grid.addWidget(button, *divmod(index, COLUMNS))
        self.body.addLayout(grid)
        self.body.addLayout(self._damaged_line())
        self.answer = AnswerLine()
        self.body.addWidget(self.answer)
        self.complete = basic.CommandButton(
            tr("✔ Confirm switches"), tr("Confirm that the entries are correct"), basic.TITLE, self._confirm)
        self.body.addWidget(self.complete)
        self.body.addStretch(1)

    def _switch(self, number: int) -> basic.CommandButton:
        return basic.CommandButton(str(number), tr("The robot pressed switch {number}", number=number), basic.LEAD,
                                   partial(self._press, number))

    def _damaged_line(self) -> QHBoxLayout:
        line = QHBoxLayout()
        line.addWidget(basic.enlarged(QLabel(tr("Damaged switches")), basic.LEAD), 1)
        self.less = basic.CommandButton("−", tr("One fewer damaged switch"), basic.LEAD, partial(self._damage, -1))
        self.damaged = basic.enlarged(QLabel("0", alignment=Qt.AlignCenter), basic.TITLE, bold=True)
        self.damaged.setMinimumWidth(round(3 * basic.em()))
        self.more = basic.CommandButton("+", tr("One more damaged switch"), basic.LEAD, partial(self._damage, 1))
        for widget in (self.less, self.damaged, self.more):
            line.addWidget(widget)
        return line

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        switches = self._entered()
        there = switches is not None
        why_off = self.model.why_read_only(tr(SILENT))
        can = there and not why_off
        off = [why_off or tr(NO_SWITCHES)]
        self.hint.setText("" if there else tr(NO_SWITCHES))
        self.hint.setVisible(not there)
        on, damaged, to_confirm = switches or Switches((), 0, False)
        for number, button in enumerate(self.switches, 1):
            button.setText(f"{number}\n{tr('ON') if number in on else tr('off')}")
            button.allow(can, off, basic.ON if number in on else None)
        self.damaged.setText(str(damaged))
        self.less.allow(can and damaged > 0, off if not can else [tr("No switch is damaged")])
        self.more.allow(can and damaged < MAX_DAMAGED, off)
        self.complete.allow(can and to_confirm, off if not can else [tr(EXECUTING)], basic.ON)

    def _entered(self) -> Optional[Switches]:
        """What was entered; None: there are no switches."""
        return None if self.model.zone is None else self.model.zone.switches

    # -- entering -----------------------------------------------------------------------------------

    def _press(self, number: int) -> None:
        what = tr("Switch {number}", number=number)
        self._call("switch", {"number": number}, what, self.switches[number - 1])

    def _damage(self, by: int) -> None:
        switches = self._entered()
        if switches is not None:
            damaged = min(MAX_DAMAGED, max(0, switches.damaged + by))
            button = self.more if by > 0 else self.less
            self._call("damaged", {"number": damaged}, tr("{n} damaged", n=damaged), button)

    def _confirm(self) -> None:
        self._call("confirm_switches", {}, tr("Switches confirmed"), self.complete)

    def _call(self, action: str, given: Dict[str, int], what: str, button: basic.CommandButton) -> None:
        button.hold()

        def done(outcome) -> None:
            self.answer.show_outcome(what, outcome)
            button.let_go()

        self.client.calls.act(self, action, self.model.zone_name, "", given, done)
