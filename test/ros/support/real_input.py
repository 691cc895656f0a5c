"""A real mouse and keyboard on the virtual display: events from the X server (XTEST), not from Qt. And fingers: XTEST
has none, so Qt gets what its part for X11 would report.

What a widget would receive from QTest it may never receive from the X server, for instance while a modal dialog or a
menu is open.
"""

import collections
import contextlib
import ctypes
import sys
import time
from typing import Any, Counter, Dict, Iterator, List, Optional, Tuple

from PyQt5 import sip
from PyQt5.QtCore import QAbstractNativeEventFilter
from PyQt5.QtGui import QTouchDevice

from roah_rsbb.rqt.keys import NOT_BEFORE_S
from roah_rsbb.rqt.qt import QTest
from support.gui_testing import QApplication, QPoint, QWidget, app, sync, wait_until

_x11 = ctypes.CDLL("libX11.so.6")
_xtst = ctypes.CDLL("libXtst.so.6")
_x11.XOpenDisplay.restype = ctypes.c_void_p
_x11.XOpenDisplay.argtypes = [ctypes.c_char_p]
_x11.XStringToKeysym.restype = ctypes.c_ulong
_x11.XStringToKeysym.argtypes = [ctypes.c_char_p]
_x11.XKeysymToKeycode.restype = ctypes.c_ubyte
_x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
_x11.XSync.argtypes = [ctypes.c_void_p, ctypes.c_int]
_xtst.XTestFakeMotionEvent.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_ulong]
_xtst.XTestFakeButtonEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
_xtst.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
_x11.XSetInputFocus.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_ulong]
_POINTER_ROOT, _REVERT_TO_NONE, _CURRENT_TIME = 1, 0, 0
_x11.XInternAtom.restype = _x11.XDefaultRootWindow.restype = ctypes.c_ulong
_x11.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
_x11.XDefaultRootWindow.argtypes = [ctypes.c_void_p]
_x11.XQueryTree.argtypes = [ctypes.c_void_p, ctypes.c_ulong, *[ctypes.c_void_p] * 4]
_x11.XFree.argtypes = [ctypes.c_void_p]
_x11.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
_display = ctypes.c_void_p(_x11.XOpenDisplay(None))

# Types of X events. The X Input Extension, in its events of type GENERIC, has the same ones.
KEY_RELEASE, BUTTON_RELEASE, CLIENT_MESSAGE, GENERIC = 3, 5, 33, 35


class _Arrived(QAbstractNativeEventFilter):
    """Counts the events that Qt has received from the X server, by type."""

    def __init__(self) -> None:
        super().__init__()
        self.count: Counter[int] = collections.Counter()

    def nativeEventFilter(self, _name, event) -> Tuple[bool, int]:
        head = ctypes.string_at(int(event), 10)  # the type, and in a generic event the extension's type
        kind = head[0] & 0x7F
        self.count[int.from_bytes(head[8:10], sys.byteorder) if kind == GENERIC else kind] += 1
        return False, 0

    def wait(self, kind: int, count: int) -> None:
        """Wait until so many of these have come, and Qt has handled them."""
        wait_until(lambda: self.count[kind] >= count, "the mouse and the keyboard reach a window of this process")
        sync()


_arrived = _Arrived()
app.installNativeEventFilter(_arrived)

# A press of a key that follows sooner is a bouncing key for the window.
BETWEEN_PRESSES_S = NOT_BEFORE_S + 0.05

_pressed: Dict[Tuple[str, ...], float] = {}  # keys, and when they were pressed last (monotonic seconds)


def _move_to(place: QPoint) -> None:
    """Move the mouse to a position of the screen, which Qt gives in logical pixels."""
    ratio = app.primaryScreen().devicePixelRatio()
    _xtst.XTestFakeMotionEvent(_display, 0, round(place.x() * ratio), round(place.y() * ratio), 0)


def click_at(place: QPoint, button: int = 1) -> None:
    """Click with a button, usually the left one, at this position of the screen."""
    sync()
    released = _arrived.count[BUTTON_RELEASE] + 1
    _move_to(place)
    for is_press in (1, 0):
        _xtst.XTestFakeButtonEvent(_display, button, is_press, 0)
    _x11.XSync(_display, 0)
    _arrived.wait(BUTTON_RELEASE, released)


@contextlib.contextmanager
def held_at(place: QPoint) -> Iterator[None]:
    """Hold the left button down at this position of the screen."""
    sync()
    released = _arrived.count[BUTTON_RELEASE] + 1
    _move_to(place)
    _xtst.XTestFakeButtonEvent(_display, 1, 1, 0)
    _x11.XSync(_display, 0)
    try:
        yield
    finally:
        _xtst.XTestFakeButtonEvent(_display, 1, 0, 0)
        _x11.XSync(_display, 0)
        _arrived.wait(BUTTON_RELEASE, released)


_screen = QTouchDevice()
_screen.setType(QTouchDevice.TouchScreen)
_register = ctypes.CDLL("libQt5Gui.so.5")._ZN22QWindowSystemInterface19registerTouchDeviceEPK12QTouchDevice
_register(ctypes.c_void_p(sip.unwrapinstance(_screen)))  # Qt ignores touches of a device that it does not know


class Fingers:
    """Fingers on a window. Each is put down with a number, at a place in the window."""

    def __init__(self, window: QWidget) -> None:
        self._window = window
        self._down: Dict[int, QPoint] = {}

    def put_down(self, number: int, place: QPoint) -> None:
        """Another finger touches the window."""
        touches = self._touches()
        self._down[number] = place
        touches.press(number, place, self._window).commit()

    def lift(self, number: int) -> None:
        """A finger leaves the window."""
        place = self._down.pop(number)
        self._touches().release(number, place, self._window).commit()

    def _touches(self) -> Any:
        touches = QTest.touchEvent(self._window, _screen)
        for number in self._down:
            touches.stationary(number)
        return touches


def right_click_at(place: QPoint) -> None:
    """Click with the right button at this position of the screen."""
    click_at(place, 3)


def give_focus_away() -> None:
    """No window of this process has the focus any more, as if another program were in front."""
    sync()
    _x11.XSetInputFocus(_display, _POINTER_ROOT, _REVERT_TO_NONE, _CURRENT_TIME)
    _x11.XSync(_display, 0)


def click_on(widget: QWidget, place: Optional[QPoint] = None) -> None:
    """Click on a widget, in its middle or at another place in it: once it is on, and nothing is in front of it there.
    """
    def at() -> QPoint:
        return widget.mapToGlobal(widget.rect().center() if place is None else place)

    def can_be_clicked() -> bool:
        sync()
        there = QApplication.widgetAt(at())  # asks the X server
        return widget.isEnabled() and there is not None and (there is widget or widget.isAncestorOf(there))

    wait_until(can_be_clicked, lambda: f"{widget} can be clicked at {at()}; {QApplication.widgetAt(at())} is there")
    click_at(at())


def press_key(name: str, *held: str) -> None:
    """Press a key, such as "Escape", while other keys are held."""
    again = _pressed.get((name, *held), 0.0) + BETWEEN_PRESSES_S
    wait_until(lambda: time.monotonic() > again, "the key has stopped bouncing")
    sync()
    released = _arrived.count[KEY_RELEASE] + 1 + len(held)
    send_key(name, *held)
    _pressed[(name, *held)] = time.monotonic()
    _arrived.wait(KEY_RELEASE, released)


def give_focus_to_newest() -> None:
    """The newest window on the screen, perhaps of another program, gets the keys."""
    _x11.XSetInputFocus(_display, _windows()[-1], _REVERT_TO_NONE, _CURRENT_TIME)
    _x11.XSync(_display, 0)


def send_key(name: str, *held: str) -> None:
    """Press a key in whatever window has the focus, also of another program, and wait for nothing."""
    codes = [_x11.XKeysymToKeycode(_display, _x11.XStringToKeysym(key.encode())) for key in (*held, name)]
    for is_press, keys in ((1, codes), (0, codes[::-1])):
        for code in keys:
            _xtst.XTestFakeKeyEvent(_display, code, is_press, 0)
    _x11.XSync(_display, 0)


def _windows() -> List[int]:
    """All windows on the screen, the newest last."""
    windows, count, other = ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint(), ctypes.c_ulong()
    _x11.XQueryTree(_display, _x11.XDefaultRootWindow(_display), ctypes.byref(other), ctypes.byref(other),
                    ctypes.byref(windows), ctypes.byref(count))
    found = windows[:count.value]
    _x11.XFree(windows)
    return found


class _ClientMessage(ctypes.Structure):
    _fields_ = (("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong), ("message_type", ctypes.c_ulong),
                ("format", ctypes.c_int), ("data", ctypes.c_long * 5), ("rest", ctypes.c_long * 12))


def close_all_windows() -> None:
    """Ask all windows on the screen to close, in whatever process, as a window manager does."""
    protocols, delete = (_x11.XInternAtom(_display, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
    for window in _windows():
        message = _ClientMessage(CLIENT_MESSAGE, window=window, message_type=protocols, format=32)
        message.data[0] = delete
        _x11.XSendEvent(_display, window, 0, 0, ctypes.byref(message))
    _x11.XSync(_display, 0)
