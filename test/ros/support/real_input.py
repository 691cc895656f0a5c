"""A real mouse and keyboard on the virtual display: events from the X server (XTEST), not from Qt.

What a widget would receive from QTest it may never receive from the X server, for instance while a modal dialog or a
menu is open.
"""

import ctypes

from support.gui_testing import QPoint, QTest, QWidget

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


def move_to(place: QPoint) -> None:
    """Move the mouse."""
    _xtst.XTestFakeMotionEvent(_display, 0, place.x(), place.y(), 0)
    _x11.XSync(_display, 0)
    QTest.qWait(50)


def click_at(place: QPoint) -> None:
    """Click with the left button at this position."""
    move_to(place)
    for is_press in (1, 0):
        _xtst.XTestFakeButtonEvent(_display, 1, is_press, 0)
        _x11.XSync(_display, 0)
        QTest.qWait(50)


def middle_of(widget: QWidget) -> QPoint:
    """The middle of a widget on the screen."""
    return widget.mapToGlobal(widget.rect().center())


def press_key(name: str, *held: str) -> None:
    """Press a key, such as "Escape", while other keys are held."""
    codes = [_x11.XKeysymToKeycode(_display, _x11.XStringToKeysym(key.encode())) for key in (*held, name)]
    for is_press, keys in ((1, codes), (0, codes[::-1])):
        for code in keys:
            _xtst.XTestFakeKeyEvent(_display, code, is_press, 0)
    _x11.XSync(_display, 0)
    QTest.qWait(150)  # longer than a bouncing key
