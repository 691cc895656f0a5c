"""Fields for the values of scoring items that are not counted with buttons: numbers, choices, ratings."""

from typing import Callable, Dict, Sequence, Tuple

from roah_rsbb.model.zone import SheetItem
from roah_rsbb.rqt.qt import (
    QAbstractSpinBox,
    QComboBox,
    QDoubleSpinBox,
    QHBoxLayout,
    QLabel,
    QLocale,
    QSignalBlocker,
    Qt,
    QWidget,
)
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.times import NOTHING

MAX_NUMBER = 1_000_000
DECIMALS = 3
# Of an item without judges.
NO_JUDGE = ""


def number_text(number: float) -> str:
    """Return a number with as many decimals as it has."""
    text = f"{number:.{DECIMALS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class NumberField(basic.NoWheel, basic.AnyRegion, QDoubleSpinBox):
    """A decimal number. With `may_be_empty`, it begins empty and can be emptied. `entered(text)`: the referee did it.
    """

    def __init__(self, item: SheetItem, entered: Callable[[str], None], may_be_empty: bool = False) -> None:
        super().__init__()
        self._may_be_empty = may_be_empty
        self.setLocale(QLocale.c())
        least, most = float(item.min or -MAX_NUMBER), float(item.max or MAX_NUMBER)
        self.setDecimals(DECIMALS)
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

    def __init__(self, item: SheetItem, entered: Callable[[str], None]) -> None:
        super().__init__()
        self.addItem(NOTHING, "")
        for name, points in zip(item.choices, item.choice_points):
            self.addItem(f"{name} ({points})" if points else name, name)
        self.setFocusPolicy(Qt.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
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
