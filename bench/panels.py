"""Measures the referees' side: the size of messages, the resources of a client window, and the time of a click.

Importing it gives this process a virtual display.
"""

import random
import sys
import time
from typing import List

import rospy
from fleet import Fleet, Robot
from processes import ROOT, Measured
from python_qt_binding.QtCore import QSettings
from support import gui_testing
from support.gui_testing import Qt, QTest

from roah_rsbb.protocol import BoxState
from roah_rsbb.rqt.app.window import Window

SETTLE_S = 3.0  # time in which a new window builds itself


class ClickBench:
    """The client window in this process, on the virtual display."""

    def __init__(self, folder: str) -> None:
        rospy.set_param("current_zone", "zone 0")
        self._window = Window(QSettings(f"{folder}/window.ini", QSettings.IniFormat))
        self._window.show()
        self._buttons = self._window.panels["BenchmarkControlPanel"].buttons
        gui_testing.wait_until(lambda: self._is_on("stop"), "the window shows the run")

    def close(self) -> None:
        self._window.shutdown()
        self._window.close()

    def measure(self, fleet: Fleet, robot: Robot, count: int) -> List[float]:
        """Milliseconds from a click on START until the box sends PREPARE."""
        dice, taken = random.Random(3), []
        for _ in range(count):
            self._click(fleet, robot, "stop", BoxState.STOP)
            taken.append(self._click(fleet, robot, "start", BoxState.PREPARE))
            QTest.qWait(dice.randrange(100))
        return taken

    def _is_on(self, name: str) -> bool:
        return self._buttons[name].isVisible() and self._buttons[name].isEnabled()

    def _click(self, fleet: Fleet, robot: Robot, name: str, expects: BoxState) -> float:
        gui_testing.wait_until(lambda: self._is_on(name), f"the button {name} is on")
        # A second stop would leave the run.
        if name == "stop":
            gui_testing.wait_until(lambda: robot.box_state is BoxState.WAITING_RESULT, "the robot executes")
        return fleet.ask(lambda: QTest.mouseClick(self._buttons[name], Qt.LeftButton), robot, expects)


def window_cpu(seconds: float) -> float:
    """Share of a processor (per cent) that a client window with all panels uses, with the zones of the running core."""
    window = Measured(sys.executable, str(ROOT / "scripts" / "roah_rsbb_window"))
    try:
        time.sleep(SETTLE_S)
        return window.cpu_percent(seconds)
    finally:
        window.close()
