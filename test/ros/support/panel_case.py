"""Support for test cases of panels: a fake core, and a panel that shows its first zone."""

import unittest

import rospy

from roah_rsbb.rqt.model.client import Client
from roah_rsbb.rqt.panels.benchmark_control import BenchmarkControlPanel
from support.fakes.core import FakeCore
from support.gui_testing import show, wait_until

DOOR = ("Achievements", "The robot detects the door with changed state")
BUMPS = ("Penalized behaviours", "Bumps into the furniture")


class PanelCase(unittest.TestCase):
    """A fake core, and one panel that shows its first zone."""

    PANEL = BenchmarkControlPanel

    def setUp(self) -> None:
        rospy.set_param("current_zone", "Home A")
        self.core = FakeCore()
        self.addCleanup(lambda: self.core.close())  # a test may replace it
        self.zone = self.core.zones["Home A"]
        self.client = Client.acquire()
        self.addCleanup(Client.release)
        self.panel = self.PANEL(self.client)
        self.addCleanup(self.panel.close)
        self.addCleanup(self.panel.shutdown)
        self.addCleanup(lambda: self.core.answer_gate.set())
        show(self.panel)
        wait_until(lambda: self.client.model.zone is not None and not self.client.model.is_old, "the core is heard")

    def wait_call(self, *call: object) -> None:
        wait_until(lambda: call in self.core.calls, f"{call} is called; there were {self.core.calls}")
