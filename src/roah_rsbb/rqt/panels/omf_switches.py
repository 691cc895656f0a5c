"""OMF Switches: the switches that the robot changed and damaged, in HOMF (docs/referee.md, "OMF Switches")."""

from typing import Dict, List, Optional

from roah_rsbb.model.actions import MAX_DAMAGED
from roah_rsbb.model.zone import Switches
from roah_rsbb.rqt.panels.panel import SILENT, AnswerLine, Panel
from roah_rsbb.rqt.qt import QGridLayout, QHBoxLayout, QLabel, Qt
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later

NO_SWITCHES = tr_later("Used in HOMF only, from the robot's first goal.")
EXECUTING = tr_later("The robot has not finished. Confirm when it has.")
# The test bed's panel has ten switches.
COUNT = 10
COLUMNS = 5


class OmfSwitchesPanel(Panel):
    """A button for each switch, the number of damaged switches, and a button to confirm."""

    TITLE = tr_later("OMF Switches")
    TAB = tr_later("Switches")

    def __init__(self, client) -> None:
        super().__init__(client)
        self.hint = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignCenter), 1.2)
        self.body.addWidget(self.hint)
        grid = QGridLayout()
        self.switches: List[basic.CommandButton] = [self._switch(number) for number in range(1, COUNT + 1)]
        for index, button in enumerate(self.switches):
            grid.addWidget(button, *divmod(index, COLUMNS))
        self.body.addLayout(grid)
        self.body.addLayout(self._damaged_line())
        self._answer = AnswerLine()
        self.body.addWidget(self._answer)
        self.complete = basic.CommandButton(
            tr("✔ Confirm switches"), tr("Confirm that the entries are correct"), 1.5)
        self.complete.clicked.connect(self._confirm)
        self.body.addWidget(self.complete)
        self.body.addStretch(1)

    def _switch(self, number: int) -> basic.CommandButton:
        button = basic.CommandButton(str(number), tr("The robot pressed switch {number}", number=number), 1.4)
        button.clicked.connect(lambda: self._press(number))
        return button

    def _damaged_line(self) -> QHBoxLayout:
        line = QHBoxLayout()
        line.addWidget(basic.enlarged(QLabel(tr("Damaged switches")), 1.2), 1)
        self.less = basic.CommandButton("−", tr("One fewer damaged switch"), 1.3)
        self.damaged = basic.enlarged(QLabel("0", alignment=Qt.AlignCenter), 1.6, bold=True)
        self.damaged.setMinimumWidth(round(3 * basic.em()))
        self.more = basic.CommandButton("+", tr("One more damaged switch"), 1.3)
        self.less.clicked.connect(lambda: self._damage(-1))
        self.more.clicked.connect(lambda: self._damage(1))
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
            button.allow(can, off, basic.RUNNING if number in on else None)
        self.damaged.setText(str(damaged))
        self.less.allow(can and damaged > 0, off if not can else [tr("No switch is damaged")])
        self.more.allow(can and damaged < MAX_DAMAGED, off)
        self.complete.allow(can and to_confirm, off if not can else [tr(EXECUTING)], basic.READY)

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
            self._answer.show_outcome(what, outcome)
            button.let_go()

        self.client.calls.act(self, action, self.model.zone_name, "", given, done)
