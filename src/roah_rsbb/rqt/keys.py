"""Keys that work in all windows of the process, the page that lists all keys, and the frame around what has the focus.

Esc twice stops the run that STOP names, Shift+Esc twice those of all zones, wherever the focus is: in panels, dialogs,
menus and floating docks. They stop runs and never leave them. The first press also does what Esc usually does, such as
closing a dialog. The prompt says what the second press will do.

Not while another program is in front: a global grab (XGrabKey) fails for the second window on a screen (BadAccess),
gets nothing while another program's menu is open, nor in Wayland, and would make each Esc in an editor half a STOP.
"""

from typing import Callable, Hashable, List, Optional

from roah_rsbb.rqt import basic
from roah_rsbb.rqt.model import Model
from roah_rsbb.rqt.qt import (
    QAbstractSpinBox,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QEvent,
    QGridLayout,
    QGuiApplication,
    QKeyEvent,
    QLabel,
    QLineEdit,
    QObject,
    QPainter,
    QPalette,
    QPen,
    QPoint,
    QRect,
    QSplitter,
    Qt,
    QTimer,
    QWidget,
)
from roah_rsbb.rqt.stops import NONE_RUNS, Stops, stoppable
from roah_rsbb.wording.device import SHARED_KEYS
from roah_rsbb.wording.language import tr, tr_later

# The second press must come within this time, seconds.
WITHIN_S = 2.0
# A press that follows sooner is a bouncing key, seconds.
NOT_BEFORE_S = 0.1


class DoublePress:
    """Distinguishes a deliberate second press from a mistake. Shared by all panels of a process."""

    def __init__(self) -> None:
        self._armed: Optional[Hashable] = None
        self._at = 0.0

    def press(self, now_mono: float, what: Hashable) -> bool:
        """A key for `what` (command and zone) was pressed. Returns whether it is the second press: then act."""
        since = now_mono - self._at
        if self._armed == what and since < NOT_BEFORE_S:
            return False
        if self._armed == what and since <= WITHIN_S:
            self._armed = None
            return True
        self._armed, self._at = what, now_mono
        return False

    def armed(self, now_mono: float) -> Optional[Hashable]:
        """Return what the next press will do, or None."""
        return self._armed if now_mono - self._at <= WITHIN_S else None


class StopPrompt(QLabel):
    """A line above all windows that takes neither the focus nor the mouse."""

    def __init__(self) -> None:
        super().__init__(None, Qt.ToolTip | Qt.WindowStaysOnTopHint | Qt.WindowTransparentForInput, wordWrap=True,
                         textFormat=Qt.PlainText)
        self.setAttribute(Qt.WA_ShowWithoutActivating)
        basic.enlarged(self, basic.TITLE, bold=True)
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


# docs/referee.md has the same table.
KEYS = (
    (tr_later("F5 twice"), tr_later("start the benchmark of the zone")),
    *SHARED_KEYS,
    (tr_later("Tab, Shift+Tab"), tr_later("go to the next or previous control; a frame shows where you are")),
    (tr_later("Space"), tr_later("press the button in the frame")),
    (tr_later("Ctrl+F, F3, Shift+F3"), tr_later("in a log: search, next, previous")),
    ("?", tr_later("open this page; Esc closes it")),
)
PAGE_WIDE_EMS = 40


class KeysPage(QDialog):
    """The table of all keys."""

    def __init__(self, parent: Optional[QWidget]) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WA_DeleteOnClose)
        self.setWindowTitle(tr("Keys"))
        grid = QGridLayout(self)
        grid.setHorizontalSpacing(round(1.5 * basic.em()))
        for row, (key, text) in enumerate(KEYS):
            grid.addWidget(basic.enlarged(QLabel(tr(key)), basic.LEAD, bold=True), row, 0, Qt.AlignTop)
            what = basic.enlarged(QLabel(tr(text), wordWrap=True), basic.LEAD)
            grid.addWidget(what, row, 1)
        grid.setColumnStretch(1, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.Close)
        buttons.rejected.connect(self.reject)
        grid.addWidget(buttons, len(KEYS), 0, 1, 2)
        self.resize(round(PAGE_WIDE_EMS * basic.em()), self.sizeHint().height())


class WindowKeys(QObject):
    """Esc, Shift+Esc and `?`: filters the events of each window that gets the focus.

    Qt sends each key press to the window with the focus before it reaches any widget.
    """

    def __init__(self, model: Model, stops: Stops) -> None:
        super().__init__()
        self._model = model
        self._stops = stops
        self._presses = DoublePress()
        self.prompt = StopPrompt()
        self._page: Optional[KeysPage] = None
        QGuiApplication.instance().focusWindowChanged.connect(self._watch)
        self._watch(QGuiApplication.focusWindow())

    def end(self) -> None:
        """Stop watching."""
        QGuiApplication.instance().focusWindowChanged.disconnect(self._watch)
        for window in QGuiApplication.allWindows():
            window.removeEventFilter(self)
        self.prompt.close()

    def open_page(self) -> None:
        """Open the page with all keys, or bring it to the front."""
        if self._page is None:
            self._page = KeysPage(QApplication.activeWindow())
            self._page.destroyed.connect(self._forget_page)
        basic.show_alone(self._page)

    def _forget_page(self) -> None:
        self._page = None

    def _watch(self, window) -> None:
        if window is not None:
            window.installEventFilter(self)

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        if event.type() != QEvent.KeyPress:
            return False
        if event.key() == Qt.Key_Escape:
            return not event.isAutoRepeat() and self._press_escape(event)
        # In a field for text, it is a character.
        if event.text() != "?" or isinstance(QApplication.focusWidget(), (QLineEdit, QAbstractSpinBox)):
            return False
        self.open_page()
        return True

    def _press_escape(self, event: QKeyEvent) -> bool:
        """Handle Esc or Shift+Esc. Returns whether the press has no other effect."""
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
            self.prompt.say(why_off, basic.IDLE, WITHIN_S)
            return False
        what = (key, running[0], self._model.identity_of(running[0])) if key == "Esc" else (key,)
        # The time when the key was pressed: a busy process may handle both presses at once.
        if self._presses.press(event.timestamp() / 1000, what):
            self.prompt.hide()
            self._stops.stop(running)
            return True
        text = tr("■ STOP {zones}?  Press {key} again within {time:.0f} s",
                  zones=", ".join(running), key=key, time=WITHIN_S)
        self.prompt.say(text, basic.STOP, WITHIN_S)
        return False


FRAME_WIDTH = 3


class _Frame(QWidget):
    """The frame. It takes neither the mouse nor the focus."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.setObjectName("focus ring")

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        half = FRAME_WIDTH // 2 + 1
        # Light and dark: visible on every colour.
        for colour, width in ((self.palette().color(QPalette.Base), FRAME_WIDTH + 2),
                              (self.palette().color(QPalette.Highlight), FRAME_WIDTH)):
            painter.setPen(QPen(colour, width))
            painter.drawRect(self.rect().adjusted(half, half, -half, -half))


class FocusRing(QObject):
    """Keeps the frame around the widget with the focus, in the windows for which `belongs` holds."""

    def __init__(self, belongs: Callable[[QWidget], bool]) -> None:
        """`belongs(widget)`: whether the widget is one of ours."""
        super().__init__()
        self._belongs = belongs
        self._frame: Optional[_Frame] = None
        self._on: Optional[QWidget] = None
        QApplication.instance().focusChanged.connect(self._follow)

    def end(self) -> None:
        """Stop following."""
        QApplication.instance().focusChanged.disconnect(self._follow)
        self._leave()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self._on:
            if event.type() in (QEvent.Move, QEvent.Resize, QEvent.Show):
                self._place()
            elif event.type() in (QEvent.Hide, QEvent.DeferredDelete):
                self._leave()
        return False

    def _follow(self, _before: Optional[QWidget], widget: Optional[QWidget]) -> None:
        self._leave()
        parent = None if widget is None else widget.parentWidget()
        while isinstance(parent, QSplitter):  # it would treat the frame as one of its parts
            parent = parent.parentWidget()
        if parent is None or widget.focusPolicy() == Qt.NoFocus or not self._belongs(widget):
            return
        self._on = widget
        widget.installEventFilter(self)
        # Python does not notice the end of a widget that Qt created, such as a dialog's button. If it was hidden
        # before it got the focus, no other event comes.
        widget.destroyed.connect(self._forget)
        self._frame = _Frame(parent)
        self._place()
        self._frame.show()

    def _place(self) -> None:
        if self._frame is not None and self._on is not None:
            place = QRect(self._on.mapTo(self._frame.parentWidget(), QPoint()), self._on.size())
            self._frame.setGeometry(place.adjusted(-1, -1, 1, 1))
            self._frame.raise_()

    def _forget(self) -> None:
        """Leave a widget that no longer exists."""
        self._on = None
        self._leave()

    def _leave(self) -> None:
        if self._on is not None:
            self._on.removeEventFilter(self)
            self._on.destroyed.disconnect(self._forget)
        if self._frame is not None:
            self._frame.hide()
            self._frame.setParent(None)
            self._frame.deleteLater()
        self._on = self._frame = None
