"""Parts of a run's score sheet: fields for values, the dialog for a note, the items in their groups, and buttons that
withdraw the last marks.
"""

from functools import partial
from typing import Callable, Dict, Hashable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.reason import MAX_NOTE
from roah_rsbb.model.results import HistoryEntry
from roah_rsbb.model.scoring import INCIDENTS, MAX_DECIMALS, MAX_NUMBER, MAX_VALUE, WHOLE, Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.panels.actions import FormDialog
from roah_rsbb.rqt.qt import (
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFontMetricsF,
    QFrame,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QLocale,
    QScrollArea,
    QSignalBlocker,
    QSize,
    QSizePolicy,
    Qt,
    QTimer,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import NOTHING

# Types whose value is a whole number.
WHOLE_WORDS = [kind.word for kind in WHOLE]


def least_of(item: SheetItem) -> int:
    """Return the least value of an item that is a whole number."""
    return 0 if item.type == "uint" else int(item.min or -MAX_VALUE)


def most_of(item: SheetItem) -> int:
    """Return the largest value of an item that is a whole number."""
    return int(item.max or MAX_VALUE)


def number_text(number: float) -> str:
    """Return a number with as many decimals as it has."""
    text = f"{number:.{MAX_DECIMALS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class NumberField(basic.NoWheel, basic.AnyRegion, QDoubleSpinBox):
    """A decimal number. With `may_be_empty`, it begins empty and can be emptied. `entered(text)`: the referee did it.
    """

    def __init__(
        self, item: SheetItem, entered: Callable[[str], None] = lambda text: None, may_be_empty: bool = False,
    ) -> None:
        super().__init__()
        self._may_be_empty = may_be_empty
        self.setLocale(QLocale.c())
        least, most = float(item.min or -MAX_NUMBER), float(item.max or MAX_NUMBER)
        self.setDecimals(MAX_DECIMALS)
        self.setSuffix(f" {item.unit}" if item.unit else "")
        # The value below the least one stands for no value.
        self.setRange(least - 1.0 if may_be_empty else least, most)
        if may_be_empty:
            self.setSpecialValueText(NOTHING)
        self.setSingleStep(0.5 if item.type == "rating" else 0.1)
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignRight)
        self.setFocusPolicy(Qt.StrongFocus)
        self.setCorrectionMode(QAbstractSpinBox.CorrectToNearestValue)
        self._entered = entered
        self._least = least
        self.valueChanged.connect(self._changed)

    def textFromValue(self, value: float) -> str:
        return number_text(value)

    def stepBy(self, steps: int) -> None:
        # The first step of an empty field goes to the least value.
        if self._may_be_empty and self.value() < self._least and steps > 0:
            self.setValue(self._least)
        else:
            super().stepBy(steps)

    def text_value(self) -> str:
        """The number as text; empty: no value."""
        return "" if self._may_be_empty and self.value() < self._least else number_text(self.value())

    def show_text(self, text: str) -> None:
        """Show a value of the core, unless the referee is typing another one."""
        value = float(text) if text else self.minimum() if self._may_be_empty else 0.0
        if self.lineEdit().isModified() and self.hasFocus():
            return
        with QSignalBlocker(self):
            self.setValue(value)

    def _changed(self, _value: float) -> None:
        self.lineEdit().setModified(False)
        self._entered(self.text_value())


class ChoiceField(basic.NoWheel, QComboBox):
    """One of several choices, or none. `entered(text)`: the referee chose it."""

    def __init__(self, item: SheetItem, entered: Callable[[str], None] = lambda text: None) -> None:
        super().__init__()
        self.addItem(NOTHING, "")
        for name, points in zip(item.choices, item.choice_points):
            self.addItem(f"{name} ({points})" if points else name, name)
        self.setFocusPolicy(Qt.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.AdjustToContents)
        self.activated.connect(lambda _index: entered(self.text_value()))

    def text_value(self) -> str:
        """The choice; empty: none."""
        return self.currentData()

    def show_text(self, text: str) -> None:
        """Show a value of the core."""
        self.setCurrentIndex(max(0, self.findData(text)))


class RatingFields(QWidget):
    """A number for each judge. `entered(judge, text)`: the referee entered it."""

    def __init__(self, item: SheetItem, entered: Callable[[str, str], None]) -> None:
        super().__init__()
        line = basic.flat(QHBoxLayout(self))
        self.fields: Dict[str, NumberField] = {}
        for judge in item.judges:
            field = NumberField(item, lambda text, judge=judge: entered(judge, text), may_be_empty=True)
            label = QLabel(judge, textFormat=Qt.PlainText)
            label.setBuddy(field)
            field.setAccessibleName(f"{item.desc}: {judge}")
            line.addWidget(label)
            line.addWidget(field)
            self.fields[judge] = field
        line.addStretch(1)

    def show_ratings(self, ratings: Sequence[Tuple[str, str]]) -> None:
        """Show the ratings of the core, by judge."""
        for judge, text in ratings:
            if judge in self.fields:
                self.fields[judge].show_text(text)


class ScoreDialog(FormDialog):
    """Asks for the value of an item; calls `then(given)`."""

    def __init__(
        self, parent: QWidget, title: str, item: SheetItem, value: Hashable, was_attempted: bool,
        then: Callable[[Entered], None],
    ) -> None:
        """`value`: a number or a text; ignored if the item was not attempted."""
        super().__init__(parent, title, item.desc, tr("Save"))
        self._then = then
        self.judge: Optional[QComboBox] = None
        self.field = self._field(item, value if was_attempted else 0)
        self.field.setEnabled(was_attempted)
        self.not_attempted = QCheckBox(tr("Not attempted"), checked=not was_attempted)
        self.not_attempted.toggled.connect(lambda on: self.field.setEnabled(not on))
        self.note = QLineEdit(maxLength=MAX_NOTE)
        if item.judges:
            self.judge = QComboBox()
            self.judge.addItems(item.judges)
            self.judge.currentIndexChanged.connect(lambda index: self.field.show_text(item.ratings[index]))
            self.form.addRow(tr("Judge"), self.judge)
        self.form.addRow(tr("Value"), self.field)
        self.form.addRow("", self.not_attempted)
        self.form.addRow(tr("Note"), self.note)
        self.note.setFocus()

    @staticmethod
    def _field(item: SheetItem, value: Hashable) -> QWidget:
        """Return a field of the item's type."""
        if item.type == "bool":
            return QCheckBox(tr("Yes"), checked=bool(value))
        if item.type in WHOLE_WORDS:
            return basic.WholeField(minimum=least_of(item), maximum=most_of(item), value=value)
        field = ChoiceField(item) if item.type == "choice" else NumberField(item, may_be_empty=item.type == "rating")
        field.show_text(item.ratings[0] if item.judges else str(value))
        return field

    def confirm(self) -> None:
        self.accept()
        note, judge = self.note.text().strip(), "" if self.judge is None else self.judge.currentText()
        if self.not_attempted.isChecked():
            given = Entered(not_attempted=True, note=note)
        elif isinstance(self.field, QCheckBox):
            given = Entered(int(self.field.isChecked()), note=note)
        elif isinstance(self.field, basic.WholeField):
            given = Entered(self.field.value(), note=note)
        else:
            given = Entered(text=self.field.text_value(), judge=judge, note=note)
        self._then(given)


# Groups whose names begin with this are never hidden.
PINNED = "disqualif"
# A narrower sheet stays in one column, in units of the desktop's font.
TWO_COLUMNS_EMS = 34
# The smallest width and height.
LEAST_EMS = (20, 9)
_REVEAL_MS = 50


class _Group(NamedTuple):
    box: QGroupBox
    grid: QGridLayout
    rows: List[QWidget]


class SheetView(QWidget):
    """The items of a score sheet in their groups, in one or two columns, so that all of them are visible. Disqualifying
    items stay visible even if the others must scroll. Incidents are in a drawer, which is closed at first: they are
    seldom needed."""

    def __init__(self) -> None:
        super().__init__()
        self._groups: Dict[str, _Group] = {}
        self.columns = 0
        self._area = QScrollArea(widgetResizable=True)
        self._area.setFrameShape(QFrame.NoFrame)
        self._area.setFocusPolicy(Qt.NoFocus)  # its items have it
        self._area.setMinimumHeight(round(2 * basic.em()))
        self._pinned = QWidget()
        self.drawer = basic.button("", self._turn_drawer)
        self.drawer.setCheckable(True)
        self._title = ""  # of the drawer
        column = basic.flat(QVBoxLayout(self))
        column.setSpacing(round(0.2 * basic.em()))
        column.addWidget(self._area, 1)
        column.addWidget(self._pinned)
        column.addWidget(self.drawer)
        self._inside: Optional[QVBoxLayout] = None
        self._below = basic.flat(QVBoxLayout(self._pinned))
        self._soon = QTimer(self, singleShot=True, interval=0, timeout=self._settle)
        # Once the layout is up to date.
        self._reveal = QTimer(self, singleShot=True, interval=_REVEAL_MS, timeout=self._reveal_drawer)

    def clear(self) -> None:
        """Remove all rows."""
        for group in self._groups.values():
            group.box.hide()
            group.box.deleteLater()
        self._groups = {}
        self.drawer.setChecked(False)
        self.drawer.hide()
        inside = QWidget()
        self._inside = basic.flat(QVBoxLayout(inside))
        self._inside.addStretch(1)
        self._area.setWidget(inside)
        self.columns = 0

    def add(self, group: str, row: QWidget) -> None:
        """Add a row to a group. Call `settle` after the last one."""
        if group not in self._groups:
            box = basic.enlarged(QGroupBox(group), basic.TEXT, bold=True)
            grid = QGridLayout(box)
            edge = round(0.3 * basic.em())
            grid.setContentsMargins(edge, edge, edge, edge)
            grid.setHorizontalSpacing(round(0.8 * basic.em()))
            grid.setVerticalSpacing(round(0.15 * basic.em()))
            self._groups[group] = _Group(box, grid, [])
            if group.lower().startswith(PINNED):
                self._below.addWidget(box)
            else:
                self._inside.insertWidget(self._inside.count() - 1, box)
        self._groups[group].rows.append(row)

    def show_points(self, points: Mapping[str, str]) -> None:
        """Show the points of groups, by their names, in their titles."""
        for name, group in self._groups.items():
            title = "" if name == INCIDENTS else f"{name}: {points[name]}" if name in points else name
            if title != group.box.title():
                group.box.setTitle(title)

    def show_incidents(self, title: str) -> None:
        """Show the title of the drawer; without incidents there is none."""
        self._title = title
        self.drawer.setVisible(INCIDENTS in self._groups)
        text = f"{'▾' if self.drawer.isChecked() else '▸'} {title}".replace("&", "&&")
        if text != self.drawer.text():
            self.drawer.setText(text)

    def _turn_drawer(self) -> None:
        self.show_incidents(self._title)
        self.settle()
        self._reveal.start()

    def _reveal_drawer(self) -> None:
        if self.drawer.isChecked() and INCIDENTS in self._groups:
            self._area.ensureWidgetVisible(self._groups[INCIDENTS].box)

    def settle(self) -> None:
        """Choose the number of columns, once the layout is up to date."""
        self.columns = 0
        self._arrange(1)
        self._soon.start()

    def minimumSizeHint(self) -> QSize:
        """Does not depend on the sheet: another one must not push other panels away, under the mouse."""
        return QSize(round(LEAST_EMS[0] * basic.em()), round(LEAST_EMS[1] * basic.em()))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def resizeEvent(self, event) -> None:
        super().resizeEvent(event)
        self._soon.start()

    def _settle(self) -> None:
        if not self._groups:
            return
        self._arrange(1)
        if self._needed() > self.height() and self.width() >= TWO_COLUMNS_EMS * basic.em():
            self._arrange(2)

    def _needed(self) -> int:
        """The height of all groups, at the present width."""
        width = self.width()
        # Layouts keep the sizes of their widgets until Qt has handled the events of the last arrangement.
        for group in self._groups.values():
            for row in group.rows:
                for widget in row.findChildren(QWidget):
                    widget.updateGeometry()
                row.updateGeometry()
            group.box.updateGeometry()
        layouts = [self._below] + ([self._inside] if self._inside is not None else [])
        for layout in layouts:
            layout.invalidate()
        heights = [max(layout.totalHeightForWidth(width), layout.totalSizeHint().height()) if layout.hasHeightForWidth()
                   else layout.totalSizeHint().height() for layout in layouts]
        return sum(heights) + self.layout().spacing()

    def _arrange(self, columns: int) -> None:
        if columns == self.columns:
            return
        self.columns = columns
        for name, group in self._groups.items():
            # A layout shows what is added to it only when Qt handles its next events; until then it has no height.
            group.box.setVisible(name != INCIDENTS or self.drawer.isChecked())
            for index, row in enumerate(group.rows):
                group.grid.addWidget(row, *divmod(index, columns))
                row.show()
            for column in range(2):
                group.grid.setColumnStretch(column, 1 if column < columns else 0)


PLACES = 5
UNDO = tr_later("Undo: {mark}")


def placed(before: Sequence[Optional[HistoryEntry]], entries: Sequence[HistoryEntry]) -> List[Optional[HistoryEntry]]:
    """Return which entry is in which place. `entries`: the newest first; those that were shown keep their places."""
    by_number = {entry.number: entry for entry in entries}
    places = [by_number.pop(entry.number, None) if entry is not None else None for entry in before]
    for entry in sorted(by_number.values(), key=lambda entry: entry.number):
        places[places.index(None)] = entry
    return places


class UndoRow(QWidget):
    """The last marks, as buttons that call `withdraw(entry)`.

    A button keeps its place, and a new mark replaces the oldest one. A click therefore never withdraws another mark
    than the one that the referee saw.
    """

    def __init__(self, withdraw: Callable[[HistoryEntry], None]) -> None:
        super().__init__()
        self._withdraw = withdraw
        self._entries: List[Optional[HistoryEntry]] = [None] * PLACES
        line = basic.flat(QHBoxLayout(self))
        line.setSpacing(round(0.2 * basic.em()))
        self._places = [basic.CommandButton("", "", basic.TEXT, partial(self._press, number))
                        for number in range(PLACES)]
        for button in self._places:
            policy = QSizePolicy(QSizePolicy.Ignored, QSizePolicy.Expanding)
            policy.setRetainSizeWhenHidden(True)
            button.setSizePolicy(policy)
            line.addWidget(button)
        self.setFixedHeight(round(2.7 * basic.em()))

    @property
    def buttons(self) -> List[basic.CommandButton]:
        """The buttons of all marks that can be undone."""
        return [button for button, entry in zip(self._places, self._entries) if entry is not None]

    def show_entries(self, entries: Sequence[HistoryEntry], now_utc_s: float, off: str) -> None:
        """Show these entries, the newest first. `off`: why nothing can be undone; empty: it can."""
        before, self._entries = self._entries, placed(self._entries, entries[:PLACES])
        newest = entries[0].number if entries else 0
        for button, old, entry in zip(self._places, before, self._entries):
            button.setVisible(entry is not None)
            if entry is None:
                continue
            if old is None or old.number != entry.number:
                button.hold()  # a click may be meant for the mark that was here
            self._show(button, entry, now_utc_s, newest)
            button.allow(not off, [off])

    @staticmethod
    def _show(button: basic.CommandButton, entry: HistoryEntry, now_utc_s: float, newest: int) -> None:
        ago = times.ago(now_utc_s - entry.utc_s)
        font = button.font()
        font.setBold(entry.number == newest)
        button.setFont(font)
        metrics, room = QFontMetricsF(font), button.width() - 1.5 * basic.em()
        lines = (entry.item, f"↶ {sheets.change_text(entry)} ({ago})")  # in words it is too wide in some languages
        button.setText("\n".join(metrics.elidedText(line, Qt.ElideRight, room) for line in lines).replace("&", "&&"))
        more = tr("{group}, by {name}, entry {number} of the history",
                  group=entry.group, name=sheets.person(entry.who), number=entry.number)
        button.explanation = f"{tr(UNDO, mark=sheets.mark_text(entry))} ({ago})\n{more}"

    def _press(self, number: int) -> None:
        entry = self._entries[number]
        if entry is not None:
            self._places[number].hold()
            self._withdraw(entry)
