"""A real mouse and keyboard on the virtual display: events from the X server (XTEST), not from Qt.

What a widget would receive from QTest it may never receive from the X server, for instance while a modal dialog or a
menu is open.
"""

import collections
import ctypes
import sys
import time
from typing import Counter, Dict, Optional, Tuple

from PyQt5.QtCore import QAbstractNativeEventFilter

from roah_rsbb.rqt.model import presses
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
_display = ctypes.c_void_p(_x11.XOpenDisplay(None))

# Types of X events. The X Input Extension, in its events of type GENERIC, has the same ones.
KEY_RELEASE, BUTTON_RELEASE, GENERIC = 3, 5, 35


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
BETWEEN_PRESSES_S = presses.NOT_BEFORE_S + 0.05

_pressed: Dict[Tuple[str, ...], float] = {}  # keys, and when they were pressed last (monotonic seconds)


def click_at(place: QPoint) -> None:
    """Click with the left button at this position of the screen."""
    sync()
    released = _arrived.count[BUTTON_RELEASE] + 1
    _xtst.XTestFakeMotionEvent(_display, 0, place.x(), place.y(), 0)
    for is_press in (1, 0):
        _xtst.XTestFakeButtonEvent(_display, 1, is_press, 0)
    _x11.XSync(_display, 0)
    _arrived.wait(BUTTON_RELEASE, released)


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
    codes = [_x11.XKeysymToKeycode(_display, _x11.XStringToKeysym(key.encode())) for key in (*held, name)]
    for is_press, keys in ((1, codes), (0, codes[::-1])):
        for code in keys:
            _xtst.XTestFakeKeyEvent(_display, code, is_press, 0)
    _x11.XSync(_display, 0)
    _pressed[(name, *held)] = time.monotonic()
    _arrived.wait(KEY_RELEASE, released)
