"""Starts Qt and the node of a program with windows, and ends both: when one ends, the other ends, too.

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
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.process import prepare
from roah_rsbb.rqt.qt import QApplication, QMainWindow, QSettings, Qt, QTimer

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
# The interval (ms) at which the end of the node and a signal are noticed.
LOOK_MS = 200
# Seconds from a signal or a closed window until the program leaves, although it has not ended its windows.
ORDERLY_S = 1.6
# Seconds until a program that leaves no longer waits for the master to remove its node.
LEAVE_S = 0.6
must_end = threading.Event()
_wake: List[socket.socket] = []  # a pair that ends the program: Python sends it the number of each signal


def make_application(argv: List[str]) -> QApplication:
    """Create Qt's application: sharp on high-density screens, and not ended by an error in one panel."""
    QApplication.setAttribute(Qt.AA_EnableHighDpiScaling)
    QApplication.setAttribute(Qt.AA_UseHighDpiPixmaps)
    app = basic.dress(QApplication(argv))
    prepare()
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


def grow(app: QApplication) -> QApplication:
    """Let everything grow on a large screen without scaling; returns the application. Call it before any window."""
    screen = app.primaryScreen()
    factor = 1.0 if screen is None else growth(screen.availableSize().height(), basic.em())
    if factor > 1.0:
        app.setFont(basic.scaled(app.font(), factor))
    return app


def run(app: QApplication, node: WindowNode) -> int:
    """Run until the last window is closed, a signal comes or the node ends; returns the exit code. Then save and
    `leave`: after `ORDERLY_S`, this happens by itself."""
    look = QTimer(timeout=lambda: app.quit() if must_end.is_set() or node.has_ended else None)
    look.start(LOOK_MS)
    code = app.exec()
    _wake[1].send(bytes([signal.SIGTERM]))
    return int(code)


def show(name: str, make: Callable[[WindowNode, QSettings], Any]) -> NoReturn:
    """Begin a program of this name, show the window that `make` returns for its node and settings until it is closed or
    the node ends, call its `shutdown` and end this process."""
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    node = WindowNode()
    # First: a signal that ended the program just after the node registered would leave its name at the master.
    end_at_signals(node, ORDERLY_S)
    if not node.begin(name, must_end):
        leave(node, 0)
    app = grow(make_application(sys.argv[:1]))
    window = make(node, QSettings("roah_rsbb", name))
    window.show()
    code = run(app, node)
    window.shutdown()
    leave(node, code)


def leave(node: WindowNode, code: int) -> NoReturn:
    """End this process, from any thread, and its node, if that takes no longer than `LEAVE_S`."""
    threading.Thread(target=_take_leave, args=(node,), daemon=True).start()
    until_mono = time.monotonic() + LEAVE_S
    while not node.has_ended and time.monotonic() < until_mono:  # until the node is removed
        time.sleep(0.01)
    os._exit(code)


def _take_leave(node: WindowNode) -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):  # it is closed, or nobody reads it any more
            stream.flush()
    remove_leads()
    node.end()


def end_at_signals(node: WindowNode, orderly_s: float) -> None:
    """Let a signal set `must_end`, and end this process after `orderly_s` seconds. This does not need the main thread,
    which may be waiting for the master."""
    _wake[:] = socket.socketpair()
    _wake[1].setblocking(False)
    signal.set_wakeup_fd(_wake[1].fileno())
    for number in _SIGNALS:
        signal.signal(number, lambda *_: None)
    threading.Thread(target=_end, args=(node, _wake[0], orderly_s), name="end", daemon=True).start()


def _end(node: WindowNode, reading: socket.socket, orderly_s: float) -> None:
    while reading.recv(1)[0] not in _SIGNALS:
        pass
    must_end.set()
    time.sleep(orderly_s)
    leave(node, 0)


def run_rqt(main: Any) -> NoReturn:
    """Run rqt with our panels, given its `rqt_gui.main.Main`. A signal or its closed window ends the process, also
    during its start.

    qt_gui crashes or hangs if it closes its window while it loads a panel, and sometimes crashes afterwards. So the
    process ends before qt_gui closes its window. This loses nothing: rqt's settings are cleared at each start.
    """
    node = WindowNode()
    create, add_providers = main.create_application, main._add_plugin_providers

    def add_plugin_providers() -> None:
        window = next(widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QMainWindow))
        window.save_settings_before_close_signal.connect(lambda *_: leave(node, 0))
        add_providers()

    main.create_application, main._add_plugin_providers = (
        lambda argv: grow(basic.dress(create(argv)))), add_plugin_providers
    end_at_signals(node, 0.0)
    leave(node, main.main())
