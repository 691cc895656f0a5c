"""The lines of the panel Devices: each shows what is held of one device, and operates it.

A line calls `change(value)` when the referee wants another value; `show_value` brings what is to be shown.
"""

from typing import Callable, List, Sequence

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QHBoxLayout, QLabel, QSlider, QSpinBox, QWidget

from roah_rsbb.rqt.widgets import basic

# Of the referee's own value, until it is answered.
WAITING = " …"
PERCENT = 100
PAGE = 10
# A name's width, in units of the desktop's font: all lines begin alike.
NAME_EMS = 6
COMMAND_EMS = 5


class DeviceRow(QWidget):
    """A name, what there is, and what changes it."""

    def __init__(self, name: str, change: Callable[[int], None]) -> None:
        super().__init__()
        self.name = name
        self.change = change
        self.commands: List[basic.CommandButton] = []
        self.line = QHBoxLayout(self)
        self.line.setContentsMargins(0, 0, 0, 0)
        title = basic.enlarged(QLabel(name), 1.3, bold=True)
        title.setMinimumWidth(round(NAME_EMS * basic.em()))
        self.line.addWidget(title)

    def add_command(self, text: str, explanation: str, value: int) -> basic.CommandButton:
        """Add a button that asks for `value`."""
        button = basic.CommandButton(text, explanation, 1.2)
        button.setMinimumWidth(round(COMMAND_EMS * basic.em()))
        button.clicked.connect(lambda: self.change(value))
        self.commands.append(button)
        self.line.addWidget(button)
        return button

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        """Show `value`; `waiting`: it is not answered yet; `off`: why nothing can be operated, every reason."""
        raise NotImplementedError

    def _allow(self, off: Sequence[str]) -> None:
        for button in self.commands:
            button.allow(not off, off)


class TwoStateRow(DeviceRow):
    """Something that is one of two, such as a switch. Each has its button: a second press changes nothing."""

    def __init__(self, name: str, change: Callable[[int], None], words: Sequence[str]) -> None:
        """`words`: what 0 and 1 are called."""
        super().__init__(name, change)
        self._words = words
        self.state = basic.Badge(1.3)
        self.state.setMinimumWidth(round(6 * basic.em()))
        self.line.addWidget(self.state, 1)
        for value in (1, 0):
            self.add_command(words[value].capitalize(), f"{name}: {words[value].lower()}", value)

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        mark = "●" if value else "○"
        tone = basic.OFF if off else basic.RUNNING if value else basic.IDLE
        self.state.show_text(f"{mark} {self._words[bool(value)]}{WAITING if waiting else ''}", tone)
        self.state.setEnabled(not off)
        self._allow(off)


class _Slider(QSlider):
    """A slider that the wheel does not move: a referee who only scrolls operates nothing."""

    def wheelEvent(self, event) -> None:
        event.ignore()


class _Number(QSpinBox):
    """A number likewise."""

    def wheelEvent(self, event) -> None:
        event.ignore()


class PercentageRow(DeviceRow):
    """A percentage: a slider, the exact number, and its two ends.

    A slider that is dragged asks for its value when it is let go, a number when Enter is pressed or another
    widget is chosen; what is published meanwhile does not take it out of the referee's hand.
    """

    def __init__(self, name: str, change: Callable[[int], None]) -> None:
        super().__init__(name, change)
        self.slider = _Slider(Qt.Horizontal)
        self.slider.setRange(0, PERCENT)
        self.slider.setPageStep(PAGE)
        self.slider.setTracking(False)
        self.slider.setMinimumWidth(round(8 * basic.em()))
        self.slider.setFocusPolicy(Qt.TabFocus)
        self.number = basic.enlarged(_Number(), 1.4, bold=True)
        self.number.setRange(0, PERCENT)
        self.number.setSuffix(" %")
        self.number.setAlignment(Qt.AlignRight)
        self.number.setKeyboardTracking(False)
        self.number.setFocusPolicy(Qt.StrongFocus)
        self.state = QLabel()
        self.state.setMinimumWidth(round(1.2 * basic.em()))
        self.add_command("0 %", f"{name}: 0 %", 0)
        self.line.addWidget(self.slider, 1)
        self.add_command("100 %", f"{name}: 100 %", PERCENT)
        self.line.addWidget(self.number)
        self.line.addWidget(self.state)
        self.slider.sliderMoved.connect(self._on_dragged)
        self.slider.valueChanged.connect(self._on_chosen)
        self.number.valueChanged.connect(self._on_chosen)
        self.number.editingFinished.connect(lambda: self.number.lineEdit().setModified(False))

    def is_edited(self) -> bool:
        """Whether the referee has it in hand."""
        return self.slider.isSliderDown() or (self.number.hasFocus() and self.number.lineEdit().isModified())

    def show_value(self, value: int, waiting: bool, off: Sequence[str]) -> None:
        self.state.setText(WAITING.strip() if waiting else "")
        if not self.is_edited():
            self._put(value)
        for widget in (self.slider, self.number):
            widget.setEnabled(not off)
            widget.setToolTip(basic.tip("\n".join(off)))
        self._allow(off)

    def _put(self, value: int) -> None:
        """Show it without asking for it."""
        for widget in (self.slider, self.number):
            if widget.value() != value:
                widget.blockSignals(True)
                widget.setValue(value)
                widget.blockSignals(False)

    def _on_dragged(self, value: int) -> None:
        """The number goes with the hand."""
        self.number.blockSignals(True)
        self.number.setValue(value)
        self.number.blockSignals(False)

    def _on_chosen(self, value: int) -> None:
        self.number.lineEdit().setModified(False)
        self.change(value)
