"""Starts Qt and the ROS node of a program with windows. When one ends, the other ends, too."""

import signal
import sys
import time
from typing import Callable, List

import rosgraph
import rospy

from roah_rsbb.ros import connections
from roah_rsbb.rqt import language
from roah_rsbb.rqt.model.failures import log_failures
from roah_rsbb.rqt.model.garbage import collect_here
from roah_rsbb.rqt.qt import QApplication, QSettings, Qt, QTimer
from roah_rsbb.rqt.widgets import basic

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
# The interval (ms) at which Python can handle signals while Qt waits, and the end of ROS is noticed.
LOOK_MS = 200
_signalled: List[bool] = []


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


def for_rqt(create: Callable[[List[str]], QApplication], argv: List[str]) -> QApplication:
    """Return the application that rqt creates: it grows, and SIGINT waits until Qt's loop runs.

    SIGINT is blocked before Qt starts threads: one of them would take it.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    app = grow(create(argv))
    QTimer.singleShot(0, lambda: signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT}))
    return app


def init_node(name: str) -> None:
    """Start the ROS node `name`. While it waits for a master, it prints this. A signal then ends the program.

    Afterwards, a signal ends `run`. The handlers are set first: a signal that ended the program just after the node
    registered would leave its name registered at the master.
    """
    for number in _SIGNALS:
        signal.signal(number, _on_signal)
    if not rosgraph.is_master_online():
        print(f"Waiting for the ROS master at {rosgraph.get_master_uri()}: start roah_rsbb.launch", file=sys.stderr)
        while not rosgraph.is_master_online():
            if _signalled:
                raise SystemExit(0)
            time.sleep(LOOK_MS / 1000)
    connections.init_node(name, anonymous=True, disable_signals=True)


def run(app: QApplication) -> int:
    """Run until the last window is closed, a signal comes or ROS ends; returns the exit code."""
    look = QTimer()
    look.timeout.connect(lambda: app.quit() if _signalled or rospy.is_shutdown() else None)
    look.start(LOOK_MS)
    return app.exec_()


def _on_signal(*_) -> None:
    """Only record the signal: it may arrive while the windows are being created, when quitting has no effect."""
    _signalled.append(True)


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
