"""The name of the referee at this client: typed once, in any panel, it stands beside all that is written down."""

from typing import Optional

from python_qt_binding.QtCore import QObject, Qt, Signal
from python_qt_binding.QtWidgets import QLineEdit, QWidget

KEY = "referee"
MAX_LENGTH = 60


class RefereeName(QObject):
    """One for all panels of a process."""

    changed = Signal(str)

    def __init__(self, parent: Optional[QObject] = None) -> None:
        super().__init__(parent)
        self.name = ""

    def set(self, name: str) -> None:
        """Somebody else referees now."""
        if name != self.name:
            self.name = name
            self.changed.emit(name)


class RefereeLine(QLineEdit):
    """Where the name is typed."""

    def __init__(self, shared: RefereeName, parent: Optional[QWidget] = None) -> None:
        super().__init__(shared.name, parent)
        self._shared = shared
        self.setMaxLength(MAX_LENGTH)
        self.setFocusPolicy(Qt.ClickFocus)  # a stray press of a key must not change the name
        self.setPlaceholderText("Referee's name")
        self.setToolTip("It stands beside each score, note and sign-off; without it, only the computer's program does")
        self.textEdited.connect(lambda text: shared.set(text.strip()))
        shared.changed.connect(self._show)

    def end(self) -> None:
        """Follow the name no more."""
        self._shared.changed.disconnect(self._show)

    def save(self, settings) -> None:
        """Keep the name; see `Panel.save_settings`."""
        settings.set_value(KEY, self._shared.name)

    def restore(self, settings) -> None:
        """The name of last time, unless another one was typed since."""
        name = settings.value(KEY, "")
        if name and not self._shared.name:
            self._shared.set(str(name))

    def _show(self, name: str) -> None:
        if name != self.text().strip():
            self.setText(name)
