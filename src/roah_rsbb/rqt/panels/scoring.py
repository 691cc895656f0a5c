"""Scoring: the referee's score sheet, and the benchmarking module's scores (docs/referee.md, "Scoring")."""

import html
from functools import partial
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.msg import ModuleScore, ZoneDetails, ZoneScoreGroup, ZoneState
from roah_rsbb.rqt.model.calls import CallOutcome
from roah_rsbb.rqt.model.edits import Edits
from roah_rsbb.rqt.panels.history import HistoryDialog, RunSheets, history_of
from roah_rsbb.rqt.panels.panel import Answer, RefereePanel
from roah_rsbb.rqt.qt import (
    QFrame,
    QHBoxLayout,
    QKeySequence,
    QLabel,
    QMenu,
    QPushButton,
    QScrollArea,
    QShortcut,
    QStackedLayout,
    Qt,
    QToolButton,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.score_dialogs import ScoreDialog
from roah_rsbb.rqt.widgets.sheet_view import SheetView
from roah_rsbb.rqt.widgets.undo import PLACES, UNDO, UndoRow
from roah_rsbb.srv import ScoreMark, ScoreWithdraw
from roah_rsbb.wording import sheets
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.module_scores import by_group
from roah_rsbb.wording.sheets import HistoryEntry

NO_RUN = tr_later("Scoring begins when a robot is connected.")
NO_ITEMS = tr_later("This benchmark has nothing for the referee to score.")
SILENT = tr_later("The core is silent: nothing can be scored now")
# The value of an item that the robot did not attempt.
NOT_ATTEMPTED = -1

ItemName = Tuple[str, str]  # group and description, which name an item on the ROS interface


class ItemShape(NamedTuple):
    """An item without its value."""

    group: str
    desc: str
    kind: int


_YES = tr_later("✔ Yes")
_BOOL_TEXTS = {0: tr_later("No"), NOT_ATTEMPTED: tr_later("Not attempted")}
# The items with these numbers have keys.
LAST_KEY = 9


class _Size(NamedTuple):
    """Sizes of a row: fonts relative to the desktop's, lengths in units of it."""

    text: float
    button: float
    number: float
    high_ems: float
    wide_ems: float  # of all controls but the menu
    gap_ems: float


_LARGE = _Size(1.2, 1.3, 1.6, 2.0, 9.0, 0.35)
_COMPACT = _Size(1.0, 1.1, 1.3, 1.8, 6.4, 0.15)


class ScoreRow(QWidget):
    """One item: its text, its value, which may be `NOT_ATTEMPTED`, and its controls."""

    def __init__(self, number: int, shape: ItemShape, change: Callable[[int], None], ask: Callable[[], None]) -> None:
        """`number` in the sheet; `change(value)`: the referee set this value; `ask()`: with a note."""
        super().__init__()
        self._change = change
        self._value = 0
        self._is_bool = shape.kind == ZoneScoreGroup.SCORING_BOOL
        self.key = str(number) if number <= LAST_KEY else ""
        self.text = QLabel(f"{self.key}  {shape.desc}".strip(), wordWrap=True)
        self.text.setTextFormat(Qt.PlainText)
        line = QHBoxLayout(self)
        line.setContentsMargins(0, 0, 0, 0)
        line.addWidget(self.text, 1)
        if self._is_bool:
            self.toggle = self._button("", lambda: self._change(0 if self._value == 1 else 1))
            self.toggle.setCheckable(True)
            self._buttons = [self.toggle]
        else:
            self.less = self._button("−", self.take_back)
            self.number = QLabel("0", alignment=Qt.AlignCenter)
            self.more = self._button("+", self.score)
            self._buttons = [self.less, self.more]
        for widget in self._buttons if self._is_bool else (self.less, self.number, self.more):
            line.addWidget(widget)
        self.more_menu = QMenu(self)
        self.not_attempted = self.more_menu.addAction(tr("Not attempted"))
        self.not_attempted.setCheckable(True)
        self.not_attempted.triggered.connect(lambda on: self._change(NOT_ATTEMPTED if on else 0))
        self.with_note = self.more_menu.addAction(tr("With a note …"), ask)
        self.menu_button = QToolButton()
        self.menu_button.setText("⋯")
        self.menu_button.setFocusPolicy(Qt.TabFocus)
        self.menu_button.setPopupMode(QToolButton.InstantPopup)
        self.menu_button.setMenu(self.more_menu)
        basic.set_style(self.menu_button, "QToolButton::menu-indicator { image: none; }")
        line.addWidget(self.menu_button)
        self._buttons.append(self.menu_button)
        self.set_compact(False)

    def set_compact(self, is_compact: bool) -> None:
        """Take less width and height, for sheets in two columns."""
        size = _COMPACT if is_compact else _LARGE
        em = basic.em()
        basic.enlarged(self.text, size.text)
        for button in self._buttons:
            basic.enlarged(button, size.button, bold=True)
            button.setFixedHeight(round(size.high_ems * em))
        self.layout().setSpacing(round(size.gap_ems * em))
        if self._is_bool:
            self.toggle.setFixedWidth(round(size.wide_ems * em))
            return
        basic.enlarged(self.number, size.number, bold=True)
        gaps = 2 * self.layout().spacing()
        for widget in (self.less, self.number, self.more):
            widget.setFixedWidth(round((size.wide_ems * em - gaps) / 3))

    def score(self) -> None:
        """Count one more, or yes."""
        self._change(1 if self._is_bool else max(0, self._value) + 1)

    def take_back(self) -> None:
        """Count one less, or no."""
        self._change(0 if self._is_bool else max(0, self._value - 1))

    @property
    def value(self) -> int:
        """The shown value."""
        return self._value

    def show_value(self, value: int, waiting: bool, enabled: bool) -> None:
        """Show `value`. `waiting`: the core has not confirmed it yet."""
        self._value = value
        mark = " …" if waiting else ""
        self.not_attempted.setChecked(value == NOT_ATTEMPTED)
        if self._is_bool:
            self.toggle.setChecked(value == 1)
            self.toggle.setText(f"{tr(_BOOL_TEXTS.get(value, _YES))}{mark}")
            self.toggle.setAccessibleName(f"{self.text.text()}: {self.toggle.text()}")
            tone = basic.RUNNING
            style = f"background: {tone.background}; color: {tone.text};" if value > 0 and enabled else ""
            basic.set_style(self.toggle, f"QPushButton {{ {style} }}" if style else "")
        else:
            self.number.setText(f"{tr('n/a') if value == NOT_ATTEMPTED else value}{mark}")
            self.number.setToolTip(tr("Not attempted") if value == NOT_ATTEMPTED else "")
        for button in self._buttons:
            button.setEnabled(enabled)
            button.setToolTip("" if enabled else tr(SILENT))
        if enabled:
            self.menu_button.setToolTip(tr("Not attempted; add a note"))
        if not self._is_bool:
            self.less.setEnabled(enabled and value > 0)

    @staticmethod
    def _button(text: str, pressed: Callable[[], None]) -> QPushButton:
        button = QPushButton(text)
        button.setFocusPolicy(Qt.TabFocus)
        button.clicked.connect(pressed)
        return button


class ModuleScores(QScrollArea):
    """The benchmarking module's scores so far, read-only; hidden while there are none."""

    def __init__(self) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.NoFrame)
        self.text = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignTop), 1.2)
        self.text.setTextFormat(Qt.RichText)
        self.text.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.setWidget(self.text)
        self.hide()

    def show_scores(self, scores: Sequence[ModuleScore], is_old: bool) -> None:
        """Show these scores; more follow during the run."""
        self.setVisible(bool(scores))
        self.text.setEnabled(not is_old)
        shown = _scores_html(scores)
        if shown != self.text.text():
            self.text.setText(shown)


class ScoringPanel(RefereePanel):
    """All items of the run, in their groups."""

    TITLE = tr_later("Scoring")

    def __init__(self, client, parent=None) -> None:
        super().__init__(client, parent)
        self._sheet: tuple = ()  # identifies the sheet that is shown
        self._edits = Edits()
        self._clock_steps = 0
        self.rows: Dict[ItemName, ScoreRow] = {}
        self._nothing = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignCenter), 1.3)
        self.sheet = SheetView()
        self._stack = QStackedLayout()
        self._stack.addWidget(self._nothing)
        self._stack.addWidget(self.sheet)
        self.body.addLayout(self._stack, 1)
        self.module_scores = ModuleScores()
        self.body.addWidget(self.module_scores, 1)
        self._answer = Answer()
        self.history = QPushButton(tr("History …"))
        self.history.setFocusPolicy(Qt.TabFocus)
        self.history.clicked.connect(self._show_history)
        last = QHBoxLayout()
        last.addWidget(self.referee, 1)
        last.addWidget(self._answer, 2)
        last.addWidget(self.history)
        self._sheets = RunSheets(self, client.calls, self._on_update)
        self.undo = UndoRow(self._undo)
        self.body.addWidget(self.undo)
        self.body.addLayout(last)
        for number in range(1, LAST_KEY + 1):
            self._key(str(number), partial(self._press, number, ScoreRow.score))
            self._key(f"Shift+{number}", partial(self._press, number, ScoreRow.take_back))

    def _key(self, key: str, pressed: Callable[[], None]) -> None:
        # Of this window only: a key that is pressed in a dialog is not meant for the sheet.
        shortcut = QShortcut(QKeySequence(key), self)
        shortcut.setContext(Qt.WindowShortcut)
        shortcut.setAutoRepeat(False)
        shortcut.activated.connect(pressed)

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        zone = self.model.zone
        shapes = [] if zone is None else _shapes(zone)
        sheet = () if zone is None else (zone.zone, zone.code, zone.team, zone.round, zone.run, tuple(shapes))
        if sheet != self._sheet or self._clock_steps != self.model.box_clock.steps_back:
            self._clock_steps = self.model.box_clock.steps_back
            self._edits.clear()
        if sheet != self._sheet:
            self._sheet = sheet
            self._build(shapes)
            self._answer.clear_answer()
        details = self.model.zone_details
        self.module_scores.show_scores(() if details is None else details.module_scores, self.model.is_old)
        if not shapes:
            connected = details is not None and details.robot != ""
            self._nothing.setText(tr(NO_ITEMS if connected else NO_RUN))
        elif zone is not None:
            self._show_values(zone, details)
        self.history.setEnabled(bool(shapes) and details is not None and bool(details.identity))
        self._show_undo("" if details is None else details.identity)

    def _show_undo(self, identity: str) -> None:
        """Show the last marks of the run."""
        summary = next((run for run in self.model.runs_of(self._sheet[0]) if run.identity == identity), None) \
            if self._sheet and identity else None
        sheet = None if summary is None else self._sheets.sheet(summary)
        entries = [] if sheet is None else sheets.to_undo(history_of(sheet), PLACES)
        self.undo.show_entries(entries, self.model.clock_s, tr(SILENT) if self.model.is_old else "")

    def _show_values(self, zone: ZoneState, details: Optional[ZoneDetails]) -> None:
        marks = iter(() if details is None else details.not_attempted)
        # Values and marks come on two topics. The shown state is as old as the older of them.
        clock_s = self.model.clock_s if details is None else min(self.model.clock_s, self.model.details_clock_s)
        for group in zone.scoring:
            for desc, published in zip(group.descriptions, group.current_values):
                item = (group.group_name, desc)
                published = NOT_ATTEMPTED if next(marks, False) else published
                value = self._edits.value(item, published, clock_s)
                if item in self.rows:
                    self.rows[item].show_value(value, self._edits.is_waiting(item), not self.model.is_old)

    def _build(self, shapes: List[ItemShape]) -> None:
        """Create the rows of another sheet."""
        self.rows = {}
        self.sheet.clear()
        for number, shape in enumerate(shapes, 1):
            item = (shape.group, shape.desc)
            self.rows[item] = ScoreRow(number, shape, partial(self._change, item), partial(self._ask, shape))
            self.sheet.add(shape.group, self.rows[item])
        self.sheet.settle()
        self._stack.setCurrentIndex(1 if shapes else 0)

    # -- changing -----------------------------------------------------------------------------------

    def _press(self, number: int, act: Callable[[ScoreRow], None]) -> None:
        """The key of an item was pressed."""
        row = next((row for row in self.rows.values() if row.key == str(number)), None)
        if row is not None and not self.model.is_old:
            act(row)

    def _undo(self, entry: HistoryEntry) -> None:
        """Withdraw one of the last marks."""
        details = self.model.zone_details
        if details is None or not details.identity:
            return
        what = tr(UNDO, mark=sheets.mark_text(entry))
        self._answer.say(f"{what} …")
        self.client.calls.service(
            self, "/core/score/withdraw", ScoreWithdraw,
            (details.zone, details.identity, entry.number, "", self.client.referee.name),
            lambda outcome: self._answer.show_outcome(what, outcome),
        )

    def _change(self, item: ItemName, value: int) -> None:
        """Handle another value that the referee set."""
        send = self._edits.wish(item, value)
        if send is not None:
            self._send(item, send)
        self.show_model()

    def _send(self, item: ItemName, value: int, note: str = "") -> None:
        sheet, (group, desc) = self._sheet, item
        details = self.model.zone_details
        not_attempted = value == NOT_ATTEMPTED
        request = (group, desc, 0 if not_attempted else value, not_attempted, "", "", note, self.client.referee.name)
        self.client.calls.command(
            self, "/core/score", ScoreMark, (sheet[0], "" if details is None else details.identity, *request),
            lambda outcome: self._answered(sheet, item, value, outcome),
        )

    def _ask(self, shape: ItemShape) -> None:
        """Ask for a value and a note."""
        sheet, item = self._sheet, (shape.group, shape.desc)
        shown = self.rows[item].value

        def then(value: int, not_attempted: bool, note: str) -> None:
            if sheet == self._sheet:
                self._send(item, NOT_ATTEMPTED if not_attempted else value, note)
            else:
                self._answer.warn(tr(
                    "Not saved: {item}. The score sheet of another run is shown now.", item=shape.desc))

        basic.show_dialog(ScoreDialog(
            self, self.where(), shape.desc, shape.kind, max(0, shown), shown == NOT_ATTEMPTED, then
        ))

    def _show_history(self) -> None:
        """Open the history of the current run."""
        details = self.model.zone_details
        if details is not None and details.identity:
            HistoryDialog(self, self.client, details.zone, details.identity).show()

    def _answered(self, sheet: tuple, item: ItemName, value: int, outcome: CallOutcome) -> None:
        what = f"{sheet[0]}: {item[1]} = {tr(sheets.NOT_ATTEMPTED) if value == NOT_ATTEMPTED else value}"
        if outcome.error:
            self._answer.show_outcome(what, outcome)
        if sheet != self._sheet:
            return
        if outcome.error:
            self._edits.failed(item)
        else:
            self._answer.clear_answer()
            following = self._edits.carried_out(item, outcome.result)
            if following is not None:
                self._send(item, following)
        self.show_model()


def _scores_html(scores: Sequence[ModuleScore]) -> str:
    rows = []
    for group, lines in by_group(scores):
        rows.append(f'<tr><td colspan="2"><b>{html.escape(group)}</b></td></tr>')
        rows += [
            f"<tr><td>{html.escape(line.name)}&nbsp;&nbsp;</td><td><b>{html.escape(line.value)}</b></td></tr>"
            for line in lines
        ]
    title = html.escape(tr("Score of the benchmarking module"))
    return f"<p>{title}</p><table>{''.join(rows)}</table>" if rows else ""


def _shapes(zone: ZoneState) -> List[ItemShape]:
    return [
        ItemShape(group.group_name, desc, kind)
        for group in zone.scoring
        for desc, kind in zip(group.descriptions, group.types)
    ]
