"""Starts Qt and the ROS node of a program with windows, and ends both: when one ends, the other ends, too.

After a signal or a closed window, a program has ended within `ORDERLY_S + LEAVE_S`, even if the ROS master hangs. It
ends without running destructors: Qt's could crash, because Python destroys widgets in any order.
"""

import contextlib
import os
import signal
import sys
import threading
import time
from typing import Any, Callable, List, NoReturn

import rosgraph
import rospy

from roah_rsbb.ros import connections, display
from roah_rsbb.rqt import language
from roah_rsbb.rqt.model.failures import log_failures
from roah_rsbb.rqt.model.garbage import collect_here
from roah_rsbb.rqt.qt import QApplication, QMainWindow, QSettings, Qt, QTimer
from roah_rsbb.rqt.widgets import basic

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
# The interval (ms) at which the end of ROS and a signal are noticed.
LOOK_MS = 200
# Seconds from a signal or a closed window until the program leaves, although it has not ended its windows.
ORDERLY_S = 1.6
# Seconds until a program that leaves no longer waits for the master to remove its node.
LEAVE_S = 0.6
_must_end = threading.Event()
_wake: List[int] = []  # a pipe that ends the program: Python writes the number of each signal into it


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


def grow(app: QApplication) -> QApplication:
    """Let everything grow on a large screen without scaling; returns the application. Call it before any window."""
    screen = app.primaryScreen()
    factor = 1.0 if screen is None else growth(screen.availableSize().height(), basic.em())
    if factor > 1.0:
        app.setFont(basic.scaled(app.font(), factor))
    return app


def run_rqt(main: Any) -> NoReturn:
    """Run rqt, given its `rqt_gui.main.Main`. A signal or its closed window ends the process, also during its start.

    qt_gui crashes or hangs if it closes its window while it loads a panel, and sometimes crashes afterwards. So the
    process ends before qt_gui closes its window. This loses nothing: rqt's settings are cleared at each start.
    """
    create, add_providers = main.create_application, main._add_plugin_providers

    def add_plugin_providers() -> None:
        window = next(widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QMainWindow))
        window.save_settings_before_close_signal.connect(lambda *_: leave(0))
        add_providers()

    main.create_application, main._add_plugin_providers = lambda argv: grow(create(argv)), add_plugin_providers
    _end_at_signals(0.0)
    leave(main.main())


def init_node(name: str) -> None:
    """Start the ROS node `name`. While it waits for a master, it prints this. A signal then ends the program.

    Afterwards, a signal ends `run`. Signals are watched first: a signal that ended the program just after the node
    registered would leave its name registered at the master.
    """
    _end_at_signals(ORDERLY_S)
    if not rosgraph.is_master_online():
        print(f"Waiting for the ROS master at {rosgraph.get_master_uri()}: start roah_rsbb.launch", file=sys.stderr)
        while not rosgraph.is_master_online():
            if _must_end.wait(LOOK_MS / 1000):
                leave(0)
    connections.init_node(name, anonymous=True, disable_signals=True)


def run(app: QApplication) -> int:
    """Run until the last window is closed, a signal comes or ROS ends; returns the exit code. Then save and `leave`:
    after `ORDERLY_S`, this happens by itself."""
    look = QTimer(timeout=lambda: app.quit() if _must_end.is_set() or rospy.is_shutdown() else None)
    look.start(LOOK_MS)
    code = app.exec_()
    os.write(_wake[1], bytes([signal.SIGTERM]))
    return code


def show(name: str, make: Callable[[QSettings], Any]) -> NoReturn:
    """Start the node `name`, show the window that `make` returns for its settings until it is closed or ROS ends, call
    its `shutdown` and end this process."""
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    init_node(name)
    app = grow(make_application(sys.argv[:1]))
    window = make(QSettings("roah_rsbb", name))
    window.show()
    code = run(app)
    window.shutdown()
    leave(code)


def leave(code: int) -> NoReturn:
    """End this process, from any thread: remove the node from the master, if it answers within `LEAVE_S`."""
    threading.Thread(target=_take_leave, daemon=True).start()
    until_mono = time.monotonic() + LEAVE_S
    while not rospy.is_shutdown() and time.monotonic() < until_mono:  # it becomes true when the node is removed
        time.sleep(0.01)
    os._exit(code)


def _take_leave() -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):  # it is closed, or nobody reads it any more
            stream.flush()
    rospy.signal_shutdown("the program ends")


def _end_at_signals(orderly_s: float) -> None:
    """Let a signal set `_must_end`, and end this process after `orderly_s` seconds. This does not need the main thread,
    which may be waiting for the master."""
    _wake[:] = os.pipe()
    os.set_blocking(_wake[1], False)
    signal.set_wakeup_fd(_wake[1])
    for number in _SIGNALS:
        signal.signal(number, lambda *_: None)
    threading.Thread(target=_end, args=(_wake[0], orderly_s), name="end", daemon=True).start()


def _end(reading: int, orderly_s: float) -> None:
    while os.read(reading, 1)[0] not in _SIGNALS:
        pass
    _must_end.set()
    time.sleep(orderly_s)
    leave(0)


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
