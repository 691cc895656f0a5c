"""Measures the referees' side: the size of messages, the resources of a client window, and the time of a click.

Importing it gives this process a virtual display.
"""

import random
import sys
import time
from typing import Any, List, Tuple

import rospy
from fleet import Fleet, Robot
from processes import ROOT, Measured
from python_qt_binding.QtCore import QSettings
from support import gui_testing
from support.gui_testing import Qt, QTest

from roah_rsbb.protocol import BoxState
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.windows import Window

SETTLE_S = 3.0  # time in which a new window builds itself


class ClickBench:
    """The client window in this process, on the virtual display."""

    def __init__(self, folder: str) -> None:
        rospy.set_param("current_zone", "zone 0")
        self._window = Window(WindowNode(), QSettings(f"{folder}/window.ini", QSettings.IniFormat))
        self._window.show()
        self._start = self._window.panels["BenchmarkControlPanel"].buttons["start"]
        self._stop = self._window.strip.stop
        gui_testing.wait_until(self._stop.is_on, "the window shows the run")

    def close(self) -> None:
        self._window.shutdown()
        self._window.close()

    def measure(self, fleet: Fleet, robot: Robot, count: int) -> Tuple[List[float], List[float]]:
        """Milliseconds from a click on START until the box sends PREPARE, and from a click on STOP until it sends STOP.
        """
        dice, starts, stops = random.Random(3), [], []
        for _ in range(count):
            gui_testing.wait_until(lambda: robot.box_state is BoxState.WAITING_RESULT, "the robot executes")
            stops.append(self._click(fleet, robot, self._stop, BoxState.STOP))
            starts.append(self._click(fleet, robot, self._start, BoxState.PREPARE))
            QTest.qWait(dice.randrange(100))
        return starts, stops

    @staticmethod
    def _click(fleet: Fleet, robot: Robot, button: Any, expects: BoxState) -> float:
        gui_testing.wait_until(lambda: button.isVisible() and button.is_on(), f"the button {button.text()} is on")
        return fleet.ask(lambda: QTest.mouseClick(button, Qt.LeftButton), robot, expects)


def window_cpu(seconds: float) -> float:
    """Share of a processor (per cent) that a client window with all panels uses, with the zones of the running core."""
    window = Measured(sys.executable, str(ROOT / "scripts" / "panel"), "window")
    try:
        time.sleep(SETTLE_S)
        return window.cpu_percent(seconds)
    finally:
        window.close()
