"""The strip with STOP and STOP ALL at the lower edge of each window (docs/referee.md, "How to stop a robot").

It is a tool bar that cannot be moved, hidden or covered. STOP acts when it is pressed, with whatever is open: an open
menu is closed by the same press. It is never off: where it stops nothing, it says why. The strip also shows how far a
STOP came, which part of the window has failed, and which other zones need the referee.

`KeepClear` keeps menus, lists, dialogs and floating docks off it.
"""

import time
from typing import Any, ClassVar, Dict, List, Optional, Sequence, Tuple

from roah_rsbb.rqt import basic, process
from roah_rsbb.rqt.model import Model
from roah_rsbb.rqt.qt import (
    QApplication,
    QColor,
    QDialog,
    QDockWidget,
    QEvent,
    QFontMetricsF,
    QGridLayout,
    QGuiApplication,
    QMainWindow,
    QMouseEvent,
    QObject,
    QPainter,
    QPoint,
    QPushButton,
    QRect,
    QRectF,
    QScrollArea,
    QSize,
    QSizePolicy,
    Qt,
    QTimer,
    QToolBar,
    QVBoxLayout,
    QWidget,
    QWindow,
    Signal,
)
from roah_rsbb.rqt.stops import NONE_RUNS, Stops, StopTarget, brief_of, stoppable, text_of
from roah_rsbb.wording import stop as ways
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.todo import Urgency, todo
from roah_rsbb.wording.whole_box import REPLAY_NO_COMMANDS

STOP = tr_later("■ STOP")
STOP_ALL = tr_later("■ STOP ALL")
STOP_TIP = tr_later("Stop the run at once: the button acts when it is pressed (keys: Esc twice)")
STOP_ALL_TIP = tr_later("Stop the runs of all zones. Hold the button down (keys: Shift+Esc twice).")
HOLD_IT = tr_later("To stop all zones, hold the button down until the runs stop")
FAILED = tr_later("⚠ {part} has failed and may show old values. STOP works. The log says more")
KEY_STOPS = tr_later("Esc twice: {zone}")
KEY_IS_DEAF = tr_later("{zone} · Esc is off here")
STOPS_OTHER = tr_later("STOP and Esc stop {zone}, the only run. You see {shown}")
LEAST = tr_later("The window cannot be smaller: STOP would be cut off")
# Sizes: at the least 96 x 48 logical pixels, and otherwise in units of the desktop's font.
LEAST_WIDE, LEAST_HIGH = 96, 48
WIDE_EMS, HIGH_EMS, ALL_WIDE_EMS = 12.0, 2.8, 10.0
NARROW_EMS = 64.0
# How long STOP ALL must be held.
KEEP_MS = 800
KEEP_HOLDING = tr_later("… keep holding")
# How long (s) the strip names a part that has failed, after it failed last.
FAILURE_S = 10.0
# How long (s) it says why a press stopped nothing.
SAID_S = 4.0
TOOL_BAR = "RoahRsbbStop"
# A window that takes the focus from nobody.
ABOVE_ALL = (Qt.Tool | Qt.WindowStaysOnTopHint | Qt.FramelessWindowHint | Qt.WindowDoesNotAcceptFocus
             | Qt.X11BypassWindowManagerHint)


# The word STOP and the line below it, in units of the desktop's font; and the same where the line names a zone that the
# referee may not expect. A name that is too long is written smaller, but not below 1.
WORD, LINE = 1.5, 1.0
WORD_ABOVE_NAME, NAME_SIZES = 1.1, (1.4, 1.2, 1.0)
# So many contacts on the strip are a hand.
HAND = 3


def _draw(button: QPushButton, is_live: bool, word: float, line: str = "", sizes: Sequence[float] = (LINE,)) -> None:
    """Draw STOP or STOP ALL, so that no style sheet decides whether it can be seen. `line`: below the word."""
    painter = QPainter(button)
    tone = basic.STOP if is_live else basic.IDLE
    is_down = button.isDown() and is_live
    painter.fillRect(button.rect(), QColor(tone.text if is_down else tone.background))
    painter.setPen(QColor(tone.background if is_down else tone.text))
    painter.drawRect(button.rect().adjusted(1, 1, -2, -2))
    room, high = button.width() - basic.em(), 0.0
    if line:
        for size in sizes:
            font = basic.scaled(QApplication.font(), size)
            font.setBold(len(sizes) > 1)
            metrics = QFontMetricsF(font)
            if metrics.horizontalAdvance(line) <= room:
                break
        painter.setFont(font)
        high = metrics.height() + 3
        # The end of a name is what distinguishes it, such as a number.
        painter.drawText(QRectF(0, button.height() - high, button.width(), high - 3), Qt.AlignCenter,
                         metrics.elidedText(line, Qt.ElideMiddle, room))
    font = basic.scaled(QApplication.font(), word)
    font.setBold(True)
    painter.setFont(font)
    painter.drawText(QRectF(0, 0, button.width(), button.height() - high), Qt.AlignCenter, button.text())


TOUCHES = (QEvent.TouchBegin, QEvent.TouchUpdate, QEvent.TouchEnd, QEvent.TouchCancel)


class _Touched:
    """A button that is pressed where a finger touches it. `KeepClear` says so, because Qt does not while another finger
    is elsewhere: it makes a mouse of the first one only, and gives a touch to what is around the button and touched.
    Where it does, it may be alone: a window that has just appeared is not watched yet."""

    _touched_ms = -1

    def touch(self, at_ms: int) -> None:
        """A finger is put down on it, at this time of the window system. May be called twice for a touch."""
        if at_ms != self._touched_ms:
            self._touched_ms = at_ms
            self.setDown(True)
            self.pressed.emit()

    def lift(self) -> None:
        """A finger is lifted. May be called twice for a touch."""
        self.setDown(False)
        self.released.emit()

    def event(self, event: QEvent) -> bool:
        """Follow a touch, and let Qt make no mouse of it."""
        if event.type() not in TOUCHES:
            return super().event(event)
        if event.type() == QEvent.TouchBegin:
            self.touch(event.timestamp())
        elif event.type() != QEvent.TouchUpdate:
            self.lift()
        event.accept()
        return True


class StopButton(_Touched, QPushButton):
    """STOP."""

    def __init__(self) -> None:
        super().__init__(tr(STOP))
        self.hint = ""
        self.zone = ""
        self._is_live = False
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        self.setFocusPolicy(Qt.TabFocus)  # a stray space bar after a click does nothing
        self.setToolTip(basic.tip(tr(STOP_TIP)))
        self.setFixedSize(max(LEAST_WIDE, round(WIDE_EMS * basic.em())), max(LEAST_HIGH, round(HIGH_EMS * basic.em())))

    def show_target(self, is_live: bool, hint: str = "", zone: str = "") -> None:
        """Show whether it stops a run now, and the line below the word. `zone`: one that the referee may not expect;
        its name takes the place of the line, and is larger."""
        if (is_live, hint, zone) != (self._is_live, self.hint, self.zone):
            self._is_live, self.hint, self.zone = is_live, hint, zone
            self.setAccessibleName(f"{self.text()} {zone or hint}")
            self.update()

    def is_on(self) -> bool:
        """Whether it stops a run now."""
        return self._is_live

    def keyPressEvent(self, event) -> None:
        """Enter presses it, too: Qt takes the space bar only."""
        if event.key() in (Qt.Key_Return, Qt.Key_Enter) and not event.isAutoRepeat():
            self.pressed.emit()
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event) -> None:
        if self.zone:
            _draw(self, self._is_live, WORD_ABOVE_NAME, self.zone, NAME_SIZES)
        else:
            _draw(self, self._is_live, WORD, self.hint)


class StopAllButton(_Touched, basic.CommandButton):
    """STOP ALL, which must be held down. `kept` is emitted after KEEP_MS, `too_short` if it is released before."""

    kept = Signal()
    too_short = Signal()

    def __init__(self) -> None:
        super().__init__(tr(STOP_ALL), tr(STOP_ALL_TIP))
        self._is_by_mouse = False
        self._keeping = QTimer(self, singleShot=True, timeout=self._on_kept)
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        self.pressed.connect(self._on_pressed)
        self.released.connect(self._on_released)

    def _on_pressed(self) -> None:
        self.setText(tr(KEEP_HOLDING))
        self._keeping.start(KEEP_MS)

    def _on_released(self) -> None:
        early = self._keeping.isActive()
        self._keeping.stop()
        self.setText(tr(STOP_ALL))
        if early and self.is_on():  # Qt releases a button that is disabled meanwhile
            self.too_short.emit()

    def mousePressEvent(self, event) -> None:
        self._is_by_mouse = True
        super().mousePressEvent(event)

    def keyPressEvent(self, event) -> None:
        self._is_by_mouse = False
        super().keyPressEvent(event)

    def _on_kept(self) -> None:
        self.setText(tr(STOP_ALL))
        if self._is_by_mouse and not QApplication.mouseButtons() & Qt.LeftButton:
            # An open menu took the release: Qt then leaves the button down.
            self.setDown(False)
            self.too_short.emit()
        elif self.is_on():
            self.kept.emit()

    def touch(self, at_ms: int) -> None:
        self._is_by_mouse = False
        super().touch(at_ms)

    def paintEvent(self, event) -> None:
        _draw(self, self.is_on(), 1.15)


class StopStrip(QWidget):
    """STOP at the left, STOP ALL at the right, two lines between them."""

    shown: ClassVar[List["StopStrip"]] = []  # of all windows of the process

    def __init__(self, model: Model, stops: Stops) -> None:
        super().__init__()
        self._model = model
        self._stops = stops
        self.failed: Optional[Tuple[str, float]] = None
        self._contacts = 0  # of fingers, beside the buttons
        self.said: Tuple[str, float] = ("", 0.0)  # a hint, and until when it is shown
        self.setObjectName("stop strip")
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        self.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Fixed)
        self.stop = StopButton()
        self.stop.pressed.connect(self._press)
        self.way, self.others = basic.FilledLabel(), basic.FilledLabel()
        self.stop_all = StopAllButton()
        self.stop_all.setFixedSize(max(LEAST_WIDE, round(ALL_WIDE_EMS * basic.em())), self.stop.height())
        self.stop_all.kept.connect(lambda: stops.stop(stoppable(model)))
        self.stop_all.too_short.connect(lambda: self._say(tr(HOLD_IT)))
        grid = QGridLayout(self)
        grid.setContentsMargins(2, 2, 2, 2)
        grid.addWidget(self.stop, 0, 0, 2, 1)
        grid.addWidget(self.way, 0, 1)
        grid.addWidget(self.others, 1, 1)
        grid.addWidget(self.stop_all, 0, 2, 2, 1)
        grid.setColumnStretch(1, 1)
        self.stop.raise_()  # in a window that was forced to be too small
        model.updated.connect(self.refresh)
        model.ticked.connect(self.refresh)
        stops.changed.connect(self.refresh)
        QGuiApplication.instance().focusWindowChanged.connect(self.refresh)
        process.listeners.append(self._on_failure)
        self.shown.append(self)
        self.refresh()

    def end(self) -> None:
        """Stop following."""
        self._model.updated.disconnect(self.refresh)
        self._model.ticked.disconnect(self.refresh)
        self._stops.changed.disconnect(self.refresh)
        QGuiApplication.instance().focusWindowChanged.disconnect(self.refresh)
        process.listeners.remove(self._on_failure)
        self.shown.remove(self)

    def minimumSizeHint(self) -> QSize:
        """Return the size below which STOP or STOP ALL would be cut off: no window becomes smaller."""
        return QSize(self.stop.width() + self.stop_all.width() + round(8 * basic.em()), self.stop.height() + 4)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def on_screen(self) -> QRect:
        """Return where the strip is on the screen."""
        return QRect(self.mapToGlobal(QPoint()), self.size())

    def stand_in(self, owner: QWindow) -> "StopStrip":
        """Show another strip above this one, which belongs to another window."""
        strip = StopStrip(self._model, self._stops)
        strip.setWindowFlags(ABOVE_ALL)
        strip.setAttribute(Qt.WA_ShowWithoutActivating)
        strip.setGeometry(self.on_screen())
        strip.winId()  # creates the window
        strip.windowHandle().setTransientParent(owner)
        strip.show()
        return strip

    # -- showing ------------------------------------------------------------------------------------

    def refresh(self, *_: object) -> None:
        """Show STOP first. What follows may fail: it is drawn after it."""
        target, brief = self._stops.target(), ""
        self._show_stop(target)
        self.stop_all.allow(bool(stoppable(self._model)), [target.why_off or tr(NONE_RUNS)])
        with process.reported(tr("The line beside STOP")):
            brief = brief_of(self._stops.sent())
            self._show_line(self.way, *self._way(target), brief)
        with process.reported(tr("The line of the other zones")):
            self._show_line(self.others, *self._others())
            # Where it is not visible, the line beside STOP has the space of both.
            self.others.setVisible(bool(self.others.whole) and not (brief and self._is_narrow()))

    def _show_stop(self, target: StopTarget) -> None:
        if self.stop.isDown() and not QApplication.mouseButtons() & Qt.LeftButton:
            self.stop.setDown(False)  # an open menu took the release
        if target.zone and target.zone != self._model.zone_name:
            self.stop.show_target(True, zone=target.zone)
            return
        hint = ""
        if target.zone:
            is_heard = QGuiApplication.focusWindow() is not None
            hint = tr(KEY_STOPS if is_heard else KEY_IS_DEAF, zone=target.zone)
        self.stop.show_target(bool(target.zone), hint)

    def _way(self, target: StopTarget) -> Tuple[str, basic.Tone]:
        """Return what the first line says: what the referee must know first."""
        now, sent = time.monotonic(), self._stops.sent()
        is_done = bool(sent) and sent[0].way in ways.DONE
        if sent and not is_done:
            text, must_act = text_of(sent[0])
            if must_act and self._is_narrow():
                text = "   ".join(text_of(one)[0] for one in sent)  # the second line is not visible
            return text, basic.ALARM if must_act else basic.IDLE
        if now < self.said[1]:
            return self.said[0], basic.OLD
        if self.failed is not None and now < self.failed[1]:
            return tr(FAILED, part=self.failed[0]), basic.ALARM
        if is_done:
            return text_of(sent[0])[0], basic.DONE
        if self._model.is_replay:
            return tr(REPLAY_NO_COMMANDS), basic.OFF
        if self._model.document is not None and self._model.is_old:
            return self._model.why_old(tr("The box is silent. STOP is sent until it answers")), basic.OLD
        if self.stop.zone:
            return tr(STOPS_OTHER, zone=self.stop.zone, shown=self._model.zone_name), basic.OFF
        return target.why_off, basic.OFF

    def _is_narrow(self) -> bool:
        """Whether one line is too short for a STOP that was lost."""
        return self.width() < NARROW_EMS * basic.em()

    def _others(self) -> Tuple[str, basic.Tone]:
        """Return further STOPs, then the other zones that need the referee: those first that wait for them."""
        further = list(map(text_of, self._stops.sent()[1:]))
        found: List[Tuple[int, str]] = []
        for zone in filter(None, map(self._model.zone_of, self._model.zone_names)):
            what = todo(zone)
            if zone.zone != self._model.zone_name and what.urgency >= Urgency.LOOK:
                mark = "☛" if what.urgency is Urgency.DO else "⚠"
                found.append((-what.urgency, f"{mark} {zone.zone}: {what.text}"))
        found.sort(key=lambda one: one[0])
        is_waiting = any(must_act for _, must_act in further) or (bool(found) and found[0][0] == -Urgency.DO)
        return ("   ".join([*(text for text, _ in further), *(text for _, text in found)]),
                basic.ALARM if is_waiting else basic.OLD)

    @staticmethod
    def _show_line(line: basic.FilledLabel, text: str, tone: basic.Tone, brief: str = "") -> None:
        tone = tone if text else basic.OFF
        basic.set_style(line, f"{tone.css} padding: 0 0.3em;")
        line.show_text(text.replace("\n", " "), brief)
        line.setToolTip(basic.tip(text))

    def _say(self, text: str) -> None:
        self.said = (text, time.monotonic() + SAID_S)
        self.refresh()

    def _on_failure(self, part: str) -> None:
        self.failed = (part, time.monotonic() + FAILURE_S)

    def eventFilter(self, window: QObject, event: QEvent) -> bool:
        """Say why the window does not become smaller."""
        if event.type() == QEvent.Resize:
            size, before, least = event.size(), event.oldSize(), window.minimumSize()
            if (size.width() < before.width() and size.width() <= least.width()) or (
                    size.height() < before.height() and size.height() <= least.height()):
                self._say(tr(LEAST))
        return False

    # -- stopping -----------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """The palm of a hand on the strip is STOP."""
        if event.type() in TOUCHES:
            contacts = len(event.touchPoints())
            if contacts >= HAND > self._contacts:
                self._press()
            self._contacts = 0 if event.type() in (QEvent.TouchEnd, QEvent.TouchCancel) else contacts
            event.accept()
            return True
        return super().event(event)

    def _press(self) -> None:
        target = self._stops.target()
        if target.zone:
            self._stops.stop([target.zone])
        else:
            QApplication.beep()
            self._say(target.why_off)


def strips_in_sight() -> List[QRect]:
    """Return where the strips are on the screen."""
    return [strip.on_screen() for strip in StopStrip.shown if strip.isVisible() and not strip.window().isMinimized()]


def add_strip(window: QMainWindow, model: Model, stops: Stops) -> StopStrip:
    """Put the strip at the lower edge of a main window, once."""
    strip = window.findChild(StopStrip)
    if strip is None:
        strip = StopStrip(model, stops)
        bar = QToolBar(tr(STOP), window, objectName=TOOL_BAR)
        bar.setMovable(False)
        bar.setFloatable(False)
        bar.setContextMenuPolicy(Qt.PreventContextMenu)
        bar.toggleViewAction().setVisible(False)
        bar.layout().setContentsMargins(0, 0, 0, 0)
        bar.addWidget(strip)
        window.addToolBarBreak(Qt.BottomToolBarArea)
        window.addToolBar(Qt.BottomToolBarArea, bar)
        window.installEventFilter(strip)
    return strip


# How often `KeepClear` looks for an open menu or list: Qt does not report them.
LOOK_MS = 25
SCROLLED = "ScrolledDialog"


def clear_place(wanted: QRect, strips: List[QRect], screen: QRect) -> QRect:
    """Return the place nearest to `wanted` on the screen that covers no strip; smaller if it has to be."""
    for strip in strips:
        if not wanted.intersects(strip):
            continue
        above = QRect(screen.left(), screen.top(), screen.width(), strip.top() - screen.top())
        below = QRect(screen.left(), strip.bottom() + 1, screen.width(), screen.bottom() - strip.bottom())
        area = above if above.height() >= min(wanted.height(), below.height()) else below
        wanted = QRect(wanted.topLeft(), wanted.size().boundedTo(area.size()))
        wanted.moveTop(max(area.top(), min(wanted.top(), area.bottom() + 1 - wanted.height())))
    return wanted


def _stop_at(place: QPoint) -> Optional["_Touched"]:
    """Return STOP or STOP ALL at a position of the screen, unless something is in front of it."""
    button = QApplication.widgetAt(place)
    return button if isinstance(button, _Touched) else None


def _close_menus() -> bool:
    """Close the menus and lists that are open. Returns whether one was."""
    closed: Optional[QWidget] = None
    popup = QApplication.activePopupWidget()
    while popup is not None and popup is not closed:  # a menu of a menu
        popup.close()
        closed, popup = popup, QApplication.activePopupWidget()
    return closed is not None


class KeepClear(QObject):
    """Watches what is open in this process: moves it off the strip, and lets a press or a touch on STOP through."""

    def __init__(self) -> None:
        super().__init__()
        self.popup: Optional[QWidget] = None  # the menu or list that is open, once this has seen it
        self._modal: Optional[QWidget] = None
        self._stand_ins: Dict[StopStrip, StopStrip] = {}  # by the strip that a modal dialog blocks
        self._fingers: Dict[int, _Touched] = {}  # what each finger keeps down
        self._timer = QTimer(self, timeout=self._look)
        self._timer.start(LOOK_MS)

    def end(self) -> None:
        """Stop watching."""
        self._timer.stop()
        self._stand_in(None)

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        """Press STOP where a finger touches it, and where the mouse presses it beside an open menu: Qt gives that press
        to the menu, wherever it is."""
        if event.type() == QEvent.TouchCancel:
            for finger in list(self._fingers):
                self._lift(finger)
        elif event.type() in TOUCHES:
            closed = [self._touch(point, event.timestamp()) for point in event.touchPoints()]
            return any(closed)
        elif (event.type() == QEvent.MouseButtonPress and event.button() == Qt.LeftButton
              and QApplication.activePopupWidget() is not None):
            place = event.globalPos()
            button = _stop_at(place)
            if button is not None:
                _close_menus()
                return QApplication.sendEvent(button, QMouseEvent(
                    QEvent.MouseButtonPress, button.mapFromGlobal(place), place, Qt.LeftButton, Qt.LeftButton,
                    Qt.NoModifier))
        return False

    def _touch(self, point: Any, at_ms: int) -> bool:
        """Follow a point of a touch. Returns whether it closed a menu, which must not get it then."""
        if point.state() == Qt.TouchPointReleased:
            self._lift(point.id())
        if point.state() != Qt.TouchPointPressed:
            return False
        button = _stop_at(point.screenPos().toPoint())
        if button is None:
            return False
        is_closed = _close_menus()
        self._fingers[point.id()] = button
        button.touch(at_ms)
        return is_closed

    def _lift(self, finger: int) -> None:
        button = self._fingers.pop(finger, None)
        if button is not None and button in QApplication.allWidgets():  # not deleted meanwhile
            button.lift()

    def _look(self) -> None:
        self.popup = QApplication.activePopupWidget()
        if self.popup is not None and self.popup.windowHandle() is not None:
            self._move_off(self.popup)
        self._stand_in(QApplication.activeModalWidget())
        for window in QApplication.topLevelWidgets():
            if not window.isVisible() or window.windowHandle() is None:
                continue
            window.windowHandle().installEventFilter(self)
            if isinstance(window, QDialog) or (isinstance(window, QDockWidget) and not QApplication.mouseButtons()):
                self._move_off(window)  # but no dock that is being dragged: it may be on its way to another place
            elif window.windowType() == Qt.ToolTip and not window.windowFlags() & Qt.WindowTransparentForInput:
                # A press on a tooltip would close it and do nothing else.
                window.windowHandle().setFlags(window.windowFlags() | Qt.WindowTransparentForInput)

    def _stand_in(self, modal: Optional[QWidget]) -> None:
        """Put a strip above each one that a modal dialog blocks. Ours are not modal, but others in rqt are. Qt does not
        block what belongs to the dialog."""
        if modal is not self._modal:
            for strip in self._stand_ins.values():
                strip.end()
                strip.deleteLater()
            self._modal, self._stand_ins = modal, {}
            if modal is not None and modal.windowHandle() is not None:
                self._stand_ins = {strip: strip.stand_in(modal.windowHandle()) for strip in list(StopStrip.shown)
                                   if strip.isVisible()}
        for blocked, strip in self._stand_ins.items():
            if strip.geometry() != blocked.on_screen():
                strip.setGeometry(blocked.on_screen())

    @staticmethod
    def _move_off(window: QWidget) -> None:
        frame = window.frameGeometry()
        screen = _screen_of(window)
        if screen is None:
            return
        place = clear_place(frame, strips_in_sight(), screen)
        if place == frame:
            return
        if place.height() < frame.height() and isinstance(window, QDialog):
            let_scroll(window)
        window.resize(window.width() - frame.width() + place.width(), window.height() - frame.height() + place.height())
        window.move(place.topLeft())


def let_scroll(dialog: QDialog) -> None:
    """Let the content of a dialog scroll, so that it can be smaller than its content."""
    layout = dialog.layout()
    if layout is None or dialog.findChild(QScrollArea, SCROLLED) is not None:
        return
    content, area = QWidget(), QScrollArea(widgetResizable=True)
    area.setObjectName(SCROLLED)
    content.setLayout(layout)
    area.setFrameShape(QScrollArea.NoFrame)
    area.setWidget(content)
    outer = QVBoxLayout(dialog)
    outer.setContentsMargins(0, 0, 0, 0)
    outer.addWidget(area)
    dialog.setMinimumSize(0, 0)


def _screen_of(window: QWidget) -> Optional[QRect]:
    handle = window.windowHandle()
    screen = QApplication.primaryScreen() if handle is None else handle.screen()
    return None if screen is None else screen.availableGeometry()
