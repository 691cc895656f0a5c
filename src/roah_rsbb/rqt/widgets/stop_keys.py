"""The keys that stop runs: Esc twice for the run that STOP names, Shift+Esc twice for all zones.

They work wherever the focus is: in panels, dialogs, menus and floating docks. They stop runs and never leave them. The
first press also does what Esc usually does, such as closing a dialog. The prompt says what the second press will do.

Not while another program is in front: a global grab (XGrabKey) fails for the second window on a screen (BadAccess),
gets nothing while another program's menu is open, nor in Wayland, and would make each Esc in an editor half a STOP.
"""

from typing import List

from roah_rsbb.rqt.model import presses
from roah_rsbb.rqt.model.model import Model
from roah_rsbb.rqt.model.presses import DoublePress
from roah_rsbb.rqt.model.stops import NONE_RUNS, Stops, stoppable
from roah_rsbb.rqt.qt import QApplication, QEvent, QGuiApplication, QKeyEvent, QLabel, QObject, QPoint, Qt, QTimer
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.window_keys import WindowKeys
from roah_rsbb.wording.language import tr


class StopPrompt(QLabel):
    """A line above all windows that takes neither the focus nor the mouse."""

    def __init__(self) -> None:
        super().__init__(None, Qt.ToolTip | Qt.WindowStaysOnTopHint | Qt.WindowTransparentForInput, wordWrap=True,
                         textFormat=Qt.PlainText)
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        basic.enlarged(self, 1.6, bold=True)
        self._timer = QTimer(self, singleShot=True, timeout=self.hide)

    def say(self, text: str, tone: basic.Tone, for_s: float) -> None:
        """Show a text for some time, at the top of the active window."""
        self.setText(text)
        basic.set_style(self, f"{tone.css} padding: 0.4em 0.8em;")
        window = QApplication.activeWindow()
        area = QGuiApplication.primaryScreen().availableGeometry() if window is None else window.frameGeometry()
        self.setFixedWidth(min(area.width(), self.fontMetrics().horizontalAdvance(text) + round(4 * basic.em())))
        self.setFixedHeight(self.heightForWidth(self.width()))
        self.move(area.topLeft() + QPoint((area.width() - self.width()) // 2, 0))
        self.show()
        self.raise_()
        self._timer.start(round(for_s * 1000))


class StopKeys(WindowKeys):
    """Watches the keys of all windows of the process."""

    def __init__(self, model: Model, stops: Stops) -> None:
        super().__init__()
        self._model = model
        self._stops = stops
        self._presses = DoublePress()
        self.prompt = StopPrompt()

    def end(self) -> None:
        """Stop watching."""
        super().end()
        self.prompt.close()

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        if event.type() != QEvent.KeyPress or event.key() != Qt.Key_Escape or event.isAutoRepeat():
            return False
        if event.modifiers() == Qt.NoModifier:
            target = self._stops.target()
            return self._press(event, "Esc", [target.zone] if target.zone else [], target.why_off)
        if event.modifiers() == Qt.ShiftModifier:
            running = stoppable(self._model)
            return self._press(event, "Shift+Esc", running, self._stops.target().why_off or tr(NONE_RUNS))
        return False

    def _press(self, event: QKeyEvent, key: str, running: List[str], why_off: str) -> bool:
        """Handle a press of a key. Returns whether the press has no other effect."""
        if not running:
            self.prompt.say(why_off, basic.IDLE, presses.WITHIN_S)
            return False
        what = (key, running[0], self._model.identity_of(running[0])) if key == "Esc" else (key,)
        # The time when the key was pressed: a busy process may handle both presses at once.
        if self._presses.press(event.timestamp() / 1000, what):
            self.prompt.hide()
            self._stops.stop(running)
            return True
        text = tr("■ STOP {zones}?  Press {key} again within {time:.0f} s",
                  zones=", ".join(running), key=key, time=presses.WITHIN_S)
        self.prompt.say(text, basic.STOP, presses.WITHIN_S)
        return False
