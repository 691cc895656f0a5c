"""Scoring: the referee's score sheet, and the benchmarking module's scores (docs/referee.md, "Scoring")."""

import enum
import html
from functools import partial
from typing import Callable, Dict, List, Optional, Sequence, Tuple, Type, Union

from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.records import ScoreValue, SheetPoints
from roah_rsbb.model.results import HistoryEntry
from roah_rsbb.model.scoring import INCIDENTS, Entered
from roah_rsbb.model.zone import IDLE, SheetItem
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.calls import CallOutcome, Edits, RefereeName
from roah_rsbb.rqt.model import Sheets
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel
from roah_rsbb.rqt.panels.score_sheet import (
    PLACES,
    UNDO,
    WHOLE_WORDS,
    ChoiceField,
    NumberField,
    RatingFields,
    ScoreDialog,
    SheetView,
    UndoRow,
    least_of,
    most_of,
)
from roah_rsbb.rqt.qt import (
    QFrame,
    QHBoxLayout,
    QKeySequence,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QShortcut,
    QStackedLayout,
    Qt,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording import language, sheets
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.sheets import scores_by_group
from roah_rsbb.wording.times import NOTHING

IN_TIME = ENTRIES["in_time"]
NO_RUN = tr_later("Scoring begins when a robot is connected.")
NO_ITEMS = tr_later("This benchmark has nothing for the referee to score.")
SILENT = tr_later("The box is silent: nothing can be scored now")


class NoValue(enum.Enum):
    """The value of an item that the robot did not attempt."""

    NOT_ATTEMPTED = enum.auto()


NOT_ATTEMPTED = NoValue.NOT_ATTEMPTED

ItemName = Tuple[str, str]  # group and description, which name an item on the ROS interface
EditName = Tuple[str, str, str]  # and the judge
# A whole number, the text of another value, or `NOT_ATTEMPTED`.
Value = Union[int, str, NoValue]


_YES = tr_later("✔ Yes")
_BOOL_TEXTS = {0: tr_later("No"), NOT_ATTEMPTED: tr_later("Not attempted")}
# The items with these numbers have keys.
LAST_KEY = 9
# Of an item without judges.
NO_JUDGE = ""
# Widths of points and of a judge's field, in units of the font.
POINTS_EMS, RATING_EMS = 3.0, 3.2


# Sizes of a row, in units of the font: height and width of all controls but the menu, and a gap.
HIGH_EMS, WIDE_EMS, GAP_EMS = 1.8, 6.4, 0.15
_MOST_WIDE = 1.6  # of a choice, whose texts may be long


class ItemRow(QWidget):
    """One item: its text, its controls, its points, and a menu."""

    def __init__(
        self, number: int, item: SheetItem, change: Callable[..., None], count: Callable[[int], None],
        ask: Callable[[], None],
    ) -> None:
        """`number` in the sheet; `change(value, judge)`: the referee set this value; `count(added)`: they counted;
        `ask()`: with a note."""
        super().__init__()
        self._change = change
        self._count = count
        self._value: Value = 0
        self._buttons: List[QWidget] = []  # what is off while the core is silent
        self.key = str(number) if number <= LAST_KEY else ""
        self.text = QLabel(f"{self.key}  {item.desc}".strip(), wordWrap=True, textFormat=Qt.PlainText)
        if item.needs:
            self.text.setToolTip(basic.tip(tr("Counts only with: {items}", items=", ".join(item.needs))))
        self.line = basic.flat(QHBoxLayout(self))
        self.line.addWidget(self.text, 1)
        self.add_controls(item)
        self.points = QLabel("", alignment=Qt.AlignRight | Qt.AlignVCenter)
        self.points.setVisible(bool(item.points))
        self.line.addWidget(self.points)
        self._add_menu(ask)
        self._set_sizes()

    def add_controls(self, item: SheetItem) -> None:
        """Add the controls of the item's type."""
        raise NotImplementedError

    def _add_menu(self, ask: Callable[[], None]) -> None:
        self.menu_button = basic.MenuButton("⋯")
        self.not_attempted = self.menu_button.entries.addAction(tr("Not attempted"))
        self.not_attempted.setCheckable(True)
        self.not_attempted.triggered.connect(lambda on: self._change(NOT_ATTEMPTED if on else self.nothing))
        self.with_note = self.menu_button.entries.addAction(tr("With a note …"), ask)
        self.line.addWidget(self.menu_button)
        self._buttons.append(self.menu_button)

    def _set_sizes(self) -> None:
        self.points.setFixedWidth(round(POINTS_EMS * basic.em()))
        for button in self._buttons:
            basic.enlarged(button, basic.TEXT, bold=True)
            button.setFixedHeight(round(HIGH_EMS * basic.em()))
        self.line.setSpacing(round(GAP_EMS * basic.em()))
        self.set_widths(round(WIDE_EMS * basic.em()))

    def set_widths(self, wide: int) -> None:
        """Set the widths of the controls, which may have so many pixels."""
        raise NotImplementedError

    nothing: Value = 0  # the value at the beginning
    is_count = False  # the referee adds to it

    def score(self) -> None:
        """The key of the item was pressed."""
        raise NotImplementedError

    def take_back(self) -> None:
        """The key was pressed together with Shift."""

    @property
    def value(self) -> Value:
        """The shown value."""
        return self._value

    def show_value(self, value: Value, waiting: bool, why_off: str) -> None:
        """Show `value`. `waiting`: the core has not confirmed it yet; `why_off`: why nothing can be scored now."""
        self._value = value
        self.not_attempted.setChecked(value is NOT_ATTEMPTED)
        for button in self._buttons:
            button.setEnabled(not why_off)
            button.setToolTip(basic.tip(why_off))
        if not why_off:
            self.menu_button.setToolTip(tr("Not attempted; add a note"))

    def show_points(self, points: str) -> None:
        """Show the points of the item; empty: it gives none."""
        if points != self.points.text():
            self.points.setText(points)
            self.points.setToolTip(tr("{points} points", points=points))


class BoolRow(ItemRow):
    """A yes-or-no item."""

    def add_controls(self, item: SheetItem) -> None:
        self.toggle = basic.button("", lambda: self._change(0 if self._value == 1 else 1))
        self.toggle.setCheckable(True)
        self._buttons = [self.toggle]
        self.line.addWidget(self.toggle)

    def set_widths(self, wide: int) -> None:
        self.toggle.setFixedWidth(wide)

    def score(self) -> None:
        self._change(1)

    def take_back(self) -> None:
        self._change(0)

    def show_value(self, value: Value, waiting: bool, why_off: str) -> None:
        super().show_value(value, waiting, why_off)
        self.toggle.setChecked(value == 1)
        self.toggle.setText(f"{tr(_BOOL_TEXTS.get(value, _YES))}{' …' if waiting else ''}")
        self.toggle.setAccessibleName(f"{self.text.text()}: {self.toggle.text()}")
        basic.set_style(self.toggle, f"QPushButton {{ {basic.YES.css} }}" if value == 1 and not why_off else "")


class CountRow(ItemRow):
    """A whole number that is counted."""

    is_count = True

    def add_controls(self, item: SheetItem) -> None:
        self._least, self._most = least_of(item), most_of(item)
        self.less = basic.button("−", self.take_back)
        self.number = QLabel("0", alignment=Qt.AlignCenter)
        self.more = basic.button("+", self.score)
        self._buttons = [self.less, self.more]
        for widget in (self.less, self.number, self.more):
            self.line.addWidget(widget)

    def set_widths(self, wide: int) -> None:
        basic.enlarged(self.number, basic.LEAD, bold=True)
        for widget in (self.less, self.number, self.more):
            widget.setFixedWidth((wide - 2 * self.line.spacing()) // 3)

    def score(self) -> None:
        if _whole(self._value) < self._most:
            self._count(1)

    def take_back(self) -> None:
        if _whole(self._value) > self._least:
            self._count(-1)

    def show_value(self, value: Value, waiting: bool, why_off: str) -> None:
        super().show_value(value, waiting, why_off)
        self.number.setText(f"{tr('n/a') if value is NOT_ATTEMPTED else value}{' …' if waiting else ''}")
        self.number.setToolTip(tr("Not attempted") if value is NOT_ATTEMPTED else "")
        self.less.setEnabled(not why_off and _whole(value) > self._least)
        self.more.setEnabled(not why_off and _whole(value) < self._most)


class FieldRow(ItemRow):
    """A decimal number or a choice."""

    nothing = ""

    def add_controls(self, item: SheetItem) -> None:
        if item.type == "choice":
            self.field: Union[ChoiceField, NumberField] = ChoiceField(item, self._entered)
        else:
            self.field = NumberField(item, self._entered)
            self.nothing = "0"
        self.field.setAccessibleName(item.desc)
        self._buttons = [self.field]
        self.line.addWidget(self.field)

    def _entered(self, text: str) -> None:
        if text != self._value:
            self._change(text)

    def set_widths(self, wide: int) -> None:
        most = round(_MOST_WIDE * wide) if isinstance(self.field, ChoiceField) else wide
        self.field.setFixedWidth(max(wide, min(self.field.sizeHint().width(), most)))

    def score(self) -> None:
        """Go to the field."""
        self.field.setFocus(Qt.ShortcutFocusReason)

    def show_value(self, value: Value, waiting: bool, why_off: str) -> None:
        super().show_value(value, waiting, why_off)
        self.field.show_text("" if value is NOT_ATTEMPTED else str(value))
        if value is NOT_ATTEMPTED:
            self.field.setToolTip(tr("Not attempted"))


class RatingRow(ItemRow):
    """Ratings of several judges, below the text of the item, and their result."""

    nothing = ""

    def add_controls(self, item: SheetItem) -> None:
        self.result = QLabel("", alignment=Qt.AlignCenter)
        self.result.setToolTip(tr("Result of the jury"))
        self.ratings = RatingFields(item, lambda judge, text: self._change(text, judge))
        self._buttons = list(self.ratings.fields.values())
        self.line.removeWidget(self.text)
        column = QVBoxLayout()
        column.setSpacing(0)
        column.addWidget(self.text)
        column.addWidget(self.ratings)
        self.line.addLayout(column, 1)
        self.line.addWidget(self.result)

    def set_widths(self, wide: int) -> None:
        basic.enlarged(self.result, basic.TEXT, bold=True)
        for field in self.ratings.fields.values():
            field.setFixedWidth(round(RATING_EMS * basic.em()))

    def score(self) -> None:
        """Go to the first judge."""
        next(iter(self.ratings.fields.values())).setFocus(Qt.ShortcutFocusReason)

    def show_value(self, value: Value, waiting: bool, why_off: str) -> None:
        super().show_value(value, waiting, why_off)
        text = tr("n/a") if value is NOT_ATTEMPTED else str(value) or NOTHING
        self.result.setText(f"{text} …" if waiting else text)


# By the types of items.
ROWS: Dict[str, Type[ItemRow]] = {"bool": BoolRow, "uint": CountRow, "int": CountRow, "decimal": FieldRow,
                                  "choice": FieldRow, "rating": RatingRow}


class ModuleScores(QScrollArea):
    """The benchmarking module's scores so far, read-only; hidden while there are none."""

    def __init__(self) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.NoFrame)
        self.text = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignTop), basic.TEXT)
        self.text.setTextFormat(Qt.RichText)
        self.text.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.setWidget(self.text)
        self.hide()

    def show_scores(self, scores: Sequence[ScoreValue], is_old: bool) -> None:
        """Show these scores; more follow during the run."""
        self.setVisible(bool(scores))
        self.text.setEnabled(not is_old)
        shown = _scores_html(scores)
        if shown != self.text.text():
            self.text.setText(shown)
            self._limit_height()

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._limit_height()

    def _limit_height(self) -> None:
        """Take no more space than the text needs: the rest is the sheet's."""
        self.setMaximumHeight(max(1, self.text.heightForWidth(self.viewport().width())))


# The key in the settings.
REFEREE_KEY = "referee"
MAX_NAME = 60


class RefereeLine(QLineEdit):
    """The field for the referee's name."""

    def __init__(self, shared: RefereeName) -> None:
        super().__init__(shared.name)
        self._shared = shared
        self.setMaxLength(MAX_NAME)
        self.setFocusPolicy(Qt.ClickFocus)  # a stray key press must not change the name
        self.setPlaceholderText(tr("Enter your name"))
        self.setToolTip(tr("The referee's name. It is recorded with everything that you do here."))
        self.textEdited.connect(lambda text: shared.set(text.strip()))
        shared.changed.connect(self._show)
        self._mark()

    def end(self) -> None:
        """Stop following the name."""
        self._shared.changed.disconnect(self._show)

    def save(self, settings) -> None:
        """Save the name; see `Panel.save_settings`."""
        settings.set_value(REFEREE_KEY, self._shared.name)

    def restore(self, settings) -> None:
        """Restore the last name, unless another one was typed meanwhile."""
        name = settings.value(REFEREE_KEY, "")
        if name and not self._shared.name:
            self._shared.set(str(name))

    def _show(self, name: str) -> None:
        if name != self.text().strip():
            self.setText(name)
        self._mark()

    def _mark(self) -> None:
        """A missing name stands out."""
        tone = basic.OLD
        style = "" if self._shared.name else f"QLineEdit {{ {tone.css} }}"
        basic.set_style(self, style)


class ScoringPanel(Panel):
    """All items of the run, in their groups."""

    TITLE = tr_later("Scoring")
    PARTS = ("zone", "results")
    WORKS_BEHIND = True

    def __init__(self, client) -> None:
        super().__init__(client)
        self._sheet: tuple = ()  # identifies the sheet that is shown
        self._edits: Edits[int] = Edits(self.model.is_confirmed)
        self.rows: Dict[ItemName, ItemRow] = {}
        self._nothing = basic.enlarged(QLabel(wordWrap=True, alignment=Qt.AlignCenter), basic.LEAD)
        self.sheet = SheetView()
        self._stack = QStackedLayout()
        self._stack.addWidget(self._nothing)
        self._stack.addWidget(self.sheet)
        self.body.addLayout(self._stack, 1)
        self.module_scores = ModuleScores()
        self.body.addWidget(self.module_scores, 1)
        self._sheets = Sheets(self, client.calls, self.redraw)
        self.points = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), basic.LEAD, bold=True)
        self.points.hide()
        self.body.addWidget(self.points)
        self.late = QWidget()
        self.late.hide()
        self.late_text = basic.enlarged(QLabel(wordWrap=True, textFormat=Qt.PlainText), basic.TEXT)
        self.in_time = QPushButton(tr(IN_TIME.label))
        self.in_time.clicked.connect(self._say_in_time)
        line = basic.flat(QHBoxLayout(self.late))
        line.addWidget(self.late_text, 1)
        line.addWidget(self.in_time)
        self._late_entry = 0
        self.body.addWidget(self.late)
        self.undo = UndoRow(self._undo)
        self.body.addWidget(self.undo)
        self.answer = AnswerLine()
        self.referee = RefereeLine(client.referee)
        last = QHBoxLayout()
        last.addWidget(self.referee, 1)
        last.addWidget(self.answer, 2)
        self.body.addLayout(last)
        for number in range(1, LAST_KEY + 1):
            self._key(str(number), partial(self._press, number, lambda row: row.score()))
            self._key(f"Shift+{number}", partial(self._press, number, lambda row: row.take_back()))

    def shutdown(self) -> None:
        self.referee.end()
        super().shutdown()

    def save_settings(self, settings) -> None:
        self.referee.save(settings)

    def restore_settings(self, settings) -> None:
        self.referee.restore(settings)

    def _key(self, key: str, pressed: Callable[[], None]) -> None:
        # Of this window only: a key that is pressed in a dialog is not meant for the sheet.
        shortcut = QShortcut(QKeySequence(key), self)
        shortcut.setContext(Qt.WindowShortcut)
        shortcut.setAutoRepeat(False)
        shortcut.activated.connect(pressed)

    # -- showing ------------------------------------------------------------------------------------

    def show_model(self) -> None:
        zone = self.model.zone
        items = () if zone is None else zone.items
        sheet = () if zone is None else (zone.zone, zone.identity, zone.event, tuple(map(_shape, items)))
        if sheet != self._sheet:
            self._sheet = sheet
            self._edits.clear()
            self._build(items)
            self.undo.show_entries([], self.model.now().utc, "")  # those of another run are new, though numbers repeat
            self.answer.clear_answer()
        self.module_scores.show_scores(() if zone is None else zone.module_scores, self.model.is_old)
        if zone is None or not items:
            self._nothing.setText(tr(NO_RUN if zone is None or zone.phase == IDLE else NO_ITEMS))
        else:
            self._show_values(items, zone.points)
        self.undo.setVisible(bool(items))  # without a sheet there is nothing to undo, and perhaps no space

    def show_times(self) -> None:
        """Show the last marks of the run, and how long ago they were."""
        run = self.model.run_of(self.model.identity_of(self.model.zone_name))
        sheet = self._sheets.newest(run)
        entries = [] if sheet is None or not self.rows else sheets.to_undo(sheet.history, PLACES)
        self.undo.show_entries(entries, self.model.now().utc, self.model.why_read_only(tr(SILENT)))

    def _show_values(self, items: Sequence[SheetItem], points: Optional[SheetPoints]) -> None:
        why_off = self.model.why_read_only(tr(SILENT))
        for item in items:
            row = self.rows[item.group, item.desc]
            name = (item.group, item.desc, NO_JUDGE)
            published = _value_of(item, item.type)
            judges = [(*name[:2], judge) for judge in item.judges]
            waiting = any(self._edits.is_waiting(each) for each in (name, *judges))
            row.show_value(self._edits.value(name, published), waiting, why_off)
            row.show_points(language.number(item.points))
            if isinstance(row, RatingRow):
                row.ratings.show_ratings([
                    (judge[2], self._edits.value(judge, text)) for judge, text in zip(judges, item.ratings)])
        self._show_points(points)
        self.sheet.show_incidents(sheets.incidents_text(items))
        late = [item for item in items if item.late]
        self.late.setVisible(bool(late))
        if late:
            item = max(late, key=lambda item: item.late[-1])
            self._late_entry = item.late[-1]
            self.late_text.setText(f"⚠ {item.desc}: {tr(sheets.LATE)}")
            self.in_time.setEnabled(not why_off)

    def _show_points(self, points: Optional[SheetPoints]) -> None:
        groups = () if points is None else points.groups
        self.sheet.show_points({name: tr("{points} points", points=given) for name, given in groups})
        self.points.setVisible(points is not None)
        text = sheets.points_text(points)
        if text != self.points.text():
            self.points.setText(text)
        self.points.setToolTip(basic.tip("\n".join(sheets.steps_text(points))))

    def _build(self, items: Sequence[SheetItem]) -> None:
        """Create the rows of another sheet."""
        self.rows = {}
        self.sheet.clear()
        self.points.hide()
        for number, item in enumerate(items, 1):
            name = (item.group, item.desc)
            # A key must not mark what may be hidden.
            number = number if item.group != INCIDENTS else LAST_KEY + 1
            self.rows[name] = ROWS[item.type](number, item, partial(self._change, name), partial(self._count, name),
                                              partial(self._ask, item))
            self.sheet.add(item.group, self.rows[name])
        self.sheet.settle()
        self._stack.setCurrentIndex(1 if items else 0)

    # -- changing -----------------------------------------------------------------------------------

    def _press(self, number: int, act: Callable[[ItemRow], None]) -> None:
        """The key of an item was pressed."""
        row = next((row for row in self.rows.values() if row.key == str(number)), None)
        if row is not None and not self.model.why_read_only(tr(SILENT)):
            act(row)

    def _undo(self, entry: HistoryEntry) -> None:
        """Withdraw one of the last marks."""
        zone = self.model.zone
        if zone is None or not zone.identity:
            return
        what = tr(UNDO, mark=sheets.mark_text(entry))
        self.client.calls.act(self, "withdraw", zone.zone, zone.identity, {"entry": entry.number},
                              self.answer.begin(what))

    def _say_in_time(self) -> None:
        """What the newest late entry marks was seen before the time limit."""
        zone = self.model.zone
        if zone is not None and zone.identity:
            self.client.calls.act(self, IN_TIME.name, zone.zone, zone.identity, {"entry": self._late_entry},
                                  self.answer.begin(tr(IN_TIME.label)))

    def _change(self, item: ItemName, value: Value, judge: str = NO_JUDGE) -> None:
        """Handle another value that the referee set."""
        name = (*item, judge)
        send = self._edits.wish(name, value)
        if send is not None:
            self._send(name, send)
        self.redraw()

    def _count(self, item: ItemName, added: int) -> None:
        """Handle a count of the referee."""
        name, before = (*item, NO_JUDGE), self.rows[item].value
        send = self._edits.wish(name, _whole(before) + added)
        if send is not None:
            self._send_count(name, before, send)
        self.redraw()

    def _send_count(self, name: EditName, before: Value, value: Value, note: str = "") -> None:
        """Send what the referee added to a value. What other referees count at the same time is not lost."""
        if isinstance(value, int) and value != _whole(before):
            self._send(name, value, note, value - _whole(before))
        else:
            self._send(name, value, note)

    def _send(self, name: EditName, value: Value, note: str = "", added: int = 0) -> None:
        """Send a value that the referee set, or counted with `added`."""
        sheet, (group, desc, judge) = self._sheet, name
        change = {"added": str(added)} if added else {
            "not_attempted": value is NOT_ATTEMPTED, "value": _whole(value),
            "text": value if isinstance(value, str) else ""}
        mark = {"group": group, "desc": desc, **change, "judge": judge, "note": note}
        self.client.calls.mark(self, *sheet[:2], mark, lambda outcome: self._answered(sheet, name, value, outcome))

    def _ask(self, item: SheetItem) -> None:
        """Ask for a value and a note."""
        sheet, name = self._sheet, (item.group, item.desc)
        row = self.rows[name]
        before = row.value

        def then(given: Entered) -> None:
            if sheet == self._sheet:
                send = partial(self._send_count, before=before) if row.is_count else self._send
                send((*name, given.judge), value=_value_of(given, item.type), note=given.note)
            else:
                self.answer.warn(tr(
                    "Not saved: {item}. The score sheet of another run is shown now.", item=item.desc))

        basic.show_dialog(ScoreDialog(self, self.where(), item, row.value, row.value is not NOT_ATTEMPTED, then))

    def _answered(self, sheet: tuple, item: EditName, value: Value, outcome: CallOutcome) -> None:
        what = f"{sheet[0]}: {item[1]} = {tr(sheets.NOT_ATTEMPTED) if value is NOT_ATTEMPTED else value}"
        if outcome.error:
            self.answer.show_outcome(what, outcome)
        if sheet != self._sheet:
            return
        if outcome.error:
            self._edits.failed(item)
        else:
            self.answer.clear_answer()
            is_count, answer = self.rows[item[:2]].is_count, outcome.result
            now = NOT_ATTEMPTED if answer["not_attempted"] else answer["value"]
            following = self._edits.carried_out(item, outcome.number, now if is_count else None)
            if following is not None and is_count:
                self._send_count(item, value, following)
            elif following is not None:
                self._send(item, following)
        self.redraw()


def _scores_html(scores: Sequence[ScoreValue]) -> str:
    rows = []
    for group, lines in scores_by_group(scores):
        rows.append(f'<tr><td colspan="2"><b>{html.escape(group)}</b></td></tr>')
        rows += [
            f"<tr><td>{html.escape(line.name)}&nbsp;&nbsp;</td><td><b>{html.escape(line.value)}</b></td></tr>"
            for line in lines
        ]
    title = html.escape(tr("Score of the benchmarking module"))
    return f"<p>{title}</p><table>{''.join(rows)}</table>" if rows else ""


def _value_of(given: Union[SheetItem, Entered], type_: str) -> Value:
    if given.not_attempted:
        return NOT_ATTEMPTED
    return given.value if type_ in WHOLE_WORDS else given.text


def _whole(value: Value) -> int:
    return value if isinstance(value, int) else 0


def _shape(item: SheetItem) -> SheetItem:
    """Return an item without its value."""
    return item._replace(value=0, not_attempted=False, corrected=False, text="", points="", ratings=(), late=())
