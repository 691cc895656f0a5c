"""The keys that stop runs: Esc twice for the client's zone, Shift+Esc twice for all zones.

They work wherever the focus is: in panels, dialogs, menus and floating docks. They stop runs and never leave them. The
first press also does what Esc usually does, such as closing a dialog. The prompt says what the second press will do.
"""

from functools import partial
from typing import Callable, Dict, List

from roah_rsbb.rqt.model import presses
from roah_rsbb.rqt.model.calls import STOP, CallOutcome, Calls
from roah_rsbb.rqt.model.model import Model
from roah_rsbb.rqt.model.presses import DoublePress
from roah_rsbb.rqt.qt import QApplication, QEvent, QGuiApplication, QKeyEvent, QLabel, QObject, QPoint, Qt, QTimer
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.widgets.window_keys import WindowKeys
from roah_rsbb.srv import StopRun
from roah_rsbb.wording.language import tr

DONE_S = 4.0
FAILED_S = 15.0


class StopPrompt(QLabel):
    """A line above all windows that takes neither the focus nor the mouse."""

    def __init__(self) -> None:
        super().__init__(None, Qt.ToolTip | Qt.WindowStaysOnTopHint | Qt.WindowTransparentForInput)
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        self.setTextFormat(Qt.PlainText)
        basic.enlarged(self, 1.6, bold=True)
        self._timer = QTimer(self, singleShot=True)
        self._timer.timeout.connect(self.hide)

    def say(self, text: str, tone: basic.Tone, for_s: float) -> None:
        """Show a text for some time, at the top of the active window."""
        self.setText(text)
        basic.set_style(self, f"background: {tone.background}; color: {tone.text}; padding: 0.4em 0.8em;")
        self.adjustSize()
        window = QApplication.activeWindow()
        area = QGuiApplication.primaryScreen().availableGeometry() if window is None else window.frameGeometry()
        self.move(area.topLeft() + QPoint(max(0, (area.width() - self.width()) // 2), 0))
        self.show()
        self.raise_()
        self._timer.start(round(for_s * 1000))


class StopKeys(WindowKeys):
    """Watches the keys of all windows of the process."""

    def __init__(self, model: Model, calls: Calls) -> None:
        super().__init__()
        self._model = model
        self._calls = calls
        self._presses = DoublePress()
        self.prompt = StopPrompt()

    def end(self) -> None:
        """Stop watching."""
        super().end()
        self._calls.forget(self)
        self.prompt.close()

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        if event.type() != QEvent.KeyPress or event.key() != Qt.Key_Escape:
            return False
        if event.modifiers() == Qt.NoModifier:
            return self._press(event, "Esc", [self._model.zone_name])
        if event.modifiers() == Qt.ShiftModifier:
            return self._press(event, "Shift+Esc", self._model.zone_names)
        return False

    def _press(self, event: QKeyEvent, key: str, zones: List[str]) -> bool:
        """Handle a press of a key. Returns whether the press has no other effect."""
        if event.isAutoRepeat():
            return False
        running = [zone for zone in self._model.running_zones() if zone in zones]
        if not running:
            nothing = tr("Nothing is running in {zone}", zone=zones[0]) if len(zones) == 1 else \
                tr("Nothing is running in any zone")
            self.prompt.say(nothing, basic.IDLE, presses.WITHIN_S)
            return False
        what = (key, running[0], self._model.identity_of(running[0])) if key == "Esc" else (key,)
        # The time when the key was pressed: a busy process may handle both presses at once.
        if self._presses.press(event.timestamp() / 1000, what):
            self.stop(running)
            return True
        text = tr("■ STOP {zones}?  Press {key} again within {time:.0f} s",
                  zones=", ".join(running), key=key, time=presses.WITHIN_S)
        self.prompt.say(text, basic.ALARM, presses.WITHIN_S)
        return False

    def stop(self, zones: List[str], failed: Callable[[], None] = lambda: None) -> None:
        """Stop the runs in these zones and show the outcome; `failed()` is called if one could not be stopped."""
        what = tr("Stop {zones}", zones=", ".join(zones))
        self.prompt.say(f"{what} …", basic.ALARM, FAILED_S)
        outcomes: Dict[str, CallOutcome] = {}

        def answered(zone: str, outcome: CallOutcome) -> None:
            outcomes[zone] = outcome
            errors = [f"{name}: {found.error}" for name, found in outcomes.items() if found.error]
            if errors:
                failed()
                self.prompt.say(tr("✘ Stop failed: {errors}", errors="; ".join(errors)), basic.ALARM, FAILED_S)
            elif len(outcomes) == len(zones):
                self.prompt.say(tr("✔ {what}: done", what=what), basic.RUNNING, DONE_S)

        for zone in zones:
            request = (zone, self._model.identity_of(zone))
            self._calls.service(self, STOP, StopRun, request, partial(answered, zone))
