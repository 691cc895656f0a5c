"""A button that must be held: for what no slip of the hand may do."""

from typing import Optional

from python_qt_binding.QtCore import QTimer, Signal
from python_qt_binding.QtWidgets import QWidget

from roah_rsbb.rqt.widgets import basic

KEEP_MS = 800
KEEP_HOLDING = "… keep holding"


class HoldButton(basic.CommandButton):
    """`kept` comes when it was held for KEEP_MS, `too_short` when it was let go before."""

    kept = Signal()
    too_short = Signal()

    def __init__(self, text: str, explanation: str, factor: float = 1.3, parent: Optional[QWidget] = None) -> None:
        super().__init__(text, explanation, factor, parent)
        self._text = text
        # Its text changes, its size must not.
        self.setText(KEEP_HOLDING)
        self.setMinimumWidth(self.sizeHint().width())
        self.setText(text)
        self._keeping = QTimer(self, singleShot=True)
        self._keeping.timeout.connect(self._on_kept)
        self.pressed.connect(self._on_pressed)
        self.released.connect(self._on_released)

    def _on_pressed(self) -> None:
        self.setText(KEEP_HOLDING)
        self._keeping.start(KEEP_MS)

    def _on_released(self) -> None:
        early = self._keeping.isActive()
        self._keeping.stop()
        self.setText(self._text)
        if early and self.is_on():  # where there is nothing to do any more, Qt lets it go by itself
            self.too_short.emit()

    def _on_kept(self) -> None:
        self.setText(self._text)
        if self.is_on():
            self.kept.emit()
