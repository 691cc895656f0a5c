"""What every panel is: a widget under a line that says which zone it shows and whether that is current."""

from typing import Callable, Optional

from python_qt_binding.QtCore import Qt, QTimer
from python_qt_binding.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QMessageBox, QSizePolicy, QVBoxLayout, QWidget

from roah_rsbb.msg import ZoneDetails
from roah_rsbb.rqt.model.calls import Outcome
from roah_rsbb.rqt.model.client import Client, RefereeName
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.srv import StopRun
from roah_rsbb.wording import times


class Panel(QWidget):
    """Base of all panels. A subclass fills `self.body` and implements `show_model`.

    `show_model` is called whenever something changed and the panel can be seen.
    """

    TITLE = ""
    WHERE_FACTOR = 1.0

    def __init__(self, client: Client, parent: Optional[QWidget] = None) -> None:
        super().__init__(parent)
        self.client = client
        self.model = client.model
        self.setObjectName(type(self).__name__)
        self.setWindowTitle(self.TITLE)
        self._where = basic.enlarged(QLabel(), self.WHERE_FACTOR, bold=True)
        self._where.setTextFormat(Qt.PlainText)
        self._where.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Preferred)
        self._news = basic.Badge()
        line = QHBoxLayout()
        line.addWidget(self._where, 1)
        line.addWidget(self._news)
        self.body = QVBoxLayout()
        outer = QVBoxLayout(self)
        outer.addLayout(line)
        outer.addLayout(self.body, 1)
        self.model.updated.connect(self._on_update)

    def show_model(self) -> None:
        """Show what the model holds now."""
        raise NotImplementedError

    def where(self) -> str:
        """What the line above says: which zone the panel is about, and what is on there."""
        zone = self.model.zone
        if zone is None:
            return self.model.zone_name
        return f"{zone.zone}  ·  {zone.code}  ·  {zone.team}  ·  round {zone.round}, run {zone.run}"

    def stop_run(self, zone: str, details: Optional[ZoneDetails], done: Callable[[Outcome], None]) -> None:
        """Stop the run that the referee sees.

        A run that ends at the moment of the click is not left, as /core/stop would do with a run that is over.
        """
        identity = "" if details is None else details.identity
        self.client.calls.service(self, "/core/stop_run", StopRun, (zone, identity), done)

    def shutdown(self) -> None:
        """End: nothing is delivered to this panel any more."""
        self.model.updated.disconnect(self._on_update)
        self.client.calls.forget(self)

    def save_settings(self, settings) -> None:
        """Keep what the referee set up in this panel; `settings` has `set_value(key, value)`."""

    def restore_settings(self, settings) -> None:
        """The reverse of `save_settings`; `settings` has `value(key, default)`."""

    def showEvent(self, event) -> None:
        super().showEvent(event)
        self._on_update()

    def _on_update(self) -> None:
        if not self.isVisible():
            return
        self._where.setText(self.where())
        if self.model.is_old:
            self._news.show_text(f"⚠ {times.silence(self.model.silence_s)}", basic.OLD)
        else:
            self._news.show_text("● live", basic.OFF)
        self.show_model()


def ask(parent: QWidget, question: str, details: str, yes: str, then) -> QMessageBox:
    """Ask before something that cannot be undone; `then()` is called on yes. Does not block."""
    box = QMessageBox(QMessageBox.Warning, question, question, parent=parent)
    box.setInformativeText(details)
    accept = box.addButton(yes, QMessageBox.AcceptRole)
    cancel = box.addButton("Cancel", QMessageBox.RejectRole)
    box.setDefaultButton(cancel)
    box.setEscapeButton(cancel)
    box.setAttribute(Qt.WA_DeleteOnClose)
    box.buttonClicked.connect(lambda button: then() if button is accept else None)
    box.open()
    return box


# Place for an answer that keeps it while it is empty, lines.
LINES = 2
# What went well is no news after this long; what failed stays.
DONE_MS = 4000


class Answer(QLabel):
    """The line where a panel shows what became of the last command."""

    def __init__(self, reserved: bool = True, parent: Optional[QWidget] = None) -> None:
        """`reserved`: it keeps its place while it is empty, so that nothing jumps when it is not."""
        super().__init__(parent)
        self._reserved = reserved
        self._done = QTimer(self, singleShot=True)
        self._done.timeout.connect(self.clear_answer)
        if reserved:
            self.setFixedHeight(round(LINES * self.fontMetrics().lineSpacing() + basic.em()))
        self.setWordWrap(True)
        self.setTextFormat(Qt.PlainText)
        self.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.clear_answer()

    def say(self, text: str) -> None:
        """Show what is going on."""
        self._show(text, "")

    def warn(self, text: str) -> None:
        """Ask for attention."""
        self._show(text, f"background: {basic.OLD.background}; color: {basic.OLD.text}; font-weight: bold;")

    def show_outcome(self, what: str, outcome: Outcome) -> None:
        """Show how the command `what` ended."""
        if outcome.error:
            tone = basic.ALARM
            self._show(f"✘ {what} failed: {outcome.error}", f"background: {tone.background}; color: {tone.text};")
        else:
            self._show(f"✔ {what}: done", "")
            self._done.start(DONE_MS)

    def clear_answer(self) -> None:
        """Show nothing."""
        self._show(" ", "")

    def _show(self, text: str, style: str) -> None:
        self._done.stop()
        self.setText(text)
        self.setToolTip(basic.tip(text.strip()))  # all of it, also where it is too long for its place
        if not self._reserved:
            self.setVisible(text != " ")
        basic.set_style(self, f"QLabel {{ padding: 0.2em; {style} }}")


# The key in the settings.
REFEREE_KEY = "referee"
MAX_NAME = 60


class RefereeLine(QLineEdit):
    """Where the name is typed."""

    def __init__(self, shared: RefereeName, parent: Optional[QWidget] = None) -> None:
        super().__init__(shared.name, parent)
        self._shared = shared
        self.setMaxLength(MAX_NAME)
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
        settings.set_value(REFEREE_KEY, self._shared.name)

    def restore(self, settings) -> None:
        """The name of last time, unless another one was typed since."""
        name = settings.value(REFEREE_KEY, "")
        if name and not self._shared.name:
            self._shared.set(str(name))

    def _show(self, name: str) -> None:
        if name != self.text().strip():
            self.setText(name)


class RefereePanel(Panel):
    """Base of such panels. A subclass puts `self.referee` where it belongs."""

    def __init__(self, client: Client, parent: Optional[QWidget] = None) -> None:
        super().__init__(client, parent)
        self.referee = RefereeLine(client.referee)

    def shutdown(self) -> None:
        self.referee.end()
        super().shutdown()

    def save_settings(self, settings) -> None:
        self.referee.save(settings)

    def restore_settings(self, settings) -> None:
        self.referee.restore(settings)
