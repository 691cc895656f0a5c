"""Starts Qt and the host of a program with windows, and ends both: when one ends, the other ends, too.

After a signal or a closed window, a program has ended within `ORDERLY_S + LEAVE_S`, even if a ROS master hangs. It
ends without running destructors: Qt's could crash, because Python destroys widgets in any order.
"""

import contextlib
import os
import signal
import socket
import sys
import threading
import time
from typing import Any, Callable, List, NoReturn

from roah_rsbb.ground.linux import remove_leads
from roah_rsbb.ros import display
from roah_rsbb.rqt import language
from roah_rsbb.rqt.model.failures import log_failures
from roah_rsbb.rqt.model.garbage import collect_here
from roah_rsbb.rqt.qt import QApplication, QSettings, Qt, QTimer
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.with_ros.node import WindowNode

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
# The interval (ms) at which the end of the host and a signal are noticed.
LOOK_MS = 200
# Seconds from a signal or a closed window until the program leaves, although it has not ended its windows.
ORDERLY_S = 1.6
# Seconds until a program that leaves no longer waits for its host, such as for the master to remove its node.
LEAVE_S = 0.6
must_end = threading.Event()
_wake: List[socket.socket] = []  # a pair that ends the program: Python sends it the number of each signal


def make_application(argv: List[str]) -> QApplication:
    """Create Qt's application: sharp on high-density screens, and not ended by an error in one panel."""
    log_failures()
    QApplication.setAttribute(Qt.AA_EnableHighDpiScaling)
    QApplication.setAttribute(Qt.AA_UseHighDpiPixmaps)
    app = QApplication(argv)
    collect_here()
    language.install()
    return app


# On a higher screen everything grows, in units of the desktop's font: with the usual font, from 1080 pixels on.
HIGH_SCREEN_EMS = 64
MOST_GROWTH = 3.0
# Less than that is not worth a font that differs from the desktop's.
LEAST_GROWTH = 1.05


def growth(high_px: float, em_px: float) -> float:
    """Return the factor by which texts and buttons grow on a screen of this height."""
    factor = min(MOST_GROWTH, high_px / (HIGH_SCREEN_EMS * em_px))
    return factor if factor >= LEAST_GROWTH else 1.0


# At the first start a window takes at most this share of the screen's width and height.
MOST_OF_SCREEN = 0.95


def open_at(window: Any, width: float, height: float, saved: Any) -> None:
    """Give a window its place: the saved one (None: there is none), or its first size in pixels. All of it is on the
    screen, also without a window manager: at its lower edge is STOP."""
    area = QApplication.primaryScreen().availableGeometry()
    window.resize(round(min(width, area.width() * MOST_OF_SCREEN)), round(min(height, area.height() * MOST_OF_SCREEN)))
    if saved is None or not window.restoreGeometry(saved):
        return
    place = window.geometry()
    areas = [area, *(screen.availableGeometry() for screen in QApplication.screens())]
    area = next((one for one in areas if one.contains(place.topLeft())), area)
    if not (window.isMaximized() or window.isFullScreen() or area.contains(place)):
        window.resize(place.size().boundedTo(area.size()))
        window.move(max(area.left(), min(place.left(), area.right() + 1 - window.width())),
                    max(area.top(), min(place.top(), area.bottom() + 1 - window.height())))


def grow(app: QApplication) -> QApplication:
    """Let everything grow on a large screen without scaling; returns the application. Call it before any window."""
    screen = app.primaryScreen()
    factor = 1.0 if screen is None else growth(screen.availableSize().height(), basic.em())
    if factor > 1.0:
        app.setFont(basic.scaled(app.font(), factor))
    return app


def run(app: QApplication, host: WindowNode) -> int:
    """Run until the last window is closed, a signal comes or the host ends; returns the exit code. Then save and
    `leave`: after `ORDERLY_S`, this happens by itself."""
    look = QTimer(timeout=lambda: app.quit() if must_end.is_set() or host.has_ended else None)
    look.start(LOOK_MS)
    code = app.exec()
    _wake[1].send(bytes([signal.SIGTERM]))
    return int(code)


def show(host: WindowNode, name: str, make: Callable[[QSettings], Any]) -> NoReturn:
    """Begin a program of this name, show the window that `make` returns for its settings until it is closed or the host
    ends, call its `shutdown` and end this process."""
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    # First: a signal that ended the program just after the node registered would leave its name at the master.
    end_at_signals(host, ORDERLY_S)
    if not host.begin(name, must_end):
        leave(host, 0)
    app = grow(make_application(sys.argv[:1]))
    window = make(QSettings("roah_rsbb", name))
    window.show()
    code = run(app, host)
    window.shutdown()
    leave(host, code)


def leave(host: WindowNode, code: int) -> NoReturn:
    """End this process, from any thread, and its host, if that takes no longer than `LEAVE_S`."""
    threading.Thread(target=_take_leave, args=(host,), daemon=True).start()
    until_mono = time.monotonic() + LEAVE_S
    while not host.has_ended and time.monotonic() < until_mono:  # with ROS: the node is removed
        time.sleep(0.01)
    os._exit(code)


def _take_leave(host: WindowNode) -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):  # it is closed, or nobody reads it any more
            stream.flush()
    remove_leads()
    host.end()


def end_at_signals(host: WindowNode, orderly_s: float) -> None:
    """Let a signal set `must_end`, and end this process after `orderly_s` seconds. This does not need the main thread,
    which may be waiting for the master."""
    _wake[:] = socket.socketpair()
    _wake[1].setblocking(False)
    signal.set_wakeup_fd(_wake[1].fileno())
    for number in _SIGNALS:
        signal.signal(number, lambda *_: None)
    threading.Thread(target=_end, args=(host, _wake[0], orderly_s), name="end", daemon=True).start()


def _end(host: WindowNode, reading: socket.socket, orderly_s: float) -> None:
    while reading.recv(1)[0] not in _SIGNALS:
        pass
    must_end.set()
    time.sleep(orderly_s)
    leave(host, 0)


class PanelSettings:
    """The settings of one panel outside rqt: QSettings with the methods of rqt's settings."""

    def __init__(self, settings: QSettings, name: str) -> None:
        self._settings = settings
        self._name = name

    def set_value(self, key: str, value) -> None:
        """Save a value."""
        self._settings.setValue(f"{self._name}/{key}", value)

    def value(self, key: str, default=None):
        """Return the saved value, or `default`."""
        return self._settings.value(f"{self._name}/{key}", default)
