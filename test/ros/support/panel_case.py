"""Support for test cases of panels: a fake core, and a panel that shows its first zone."""

import threading
import unittest

import rospy

from roah_rsbb.client import client
from roah_rsbb.rqt import node
from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels.benchmark_control import BenchmarkControlPanel
from roah_rsbb.rqt.stop_strip import StopStrip
from support.fakes.core import FakeCore
from support.gui_testing import QApplication, limit, show, wait_until, without_hurry

DOOR = ("Achievements", "The robot detects the door with changed state")
BUMPS = ("Penalized behaviours", "Bumps into the furniture")
OLD_S = client.OLD_S


class Settings(dict):
    """rqt's settings; they come back as texts."""

    def set_value(self, key, value) -> None:
        self[key] = str(value).lower() if isinstance(value, bool) else str(value)

    def value(self, key, default=None):
        return self.get(key, default)


class CoreCase(unittest.TestCase):
    """A fake core in this process."""

    ZONE = "Home A"

    def setUp(self) -> None:
        without_hurry(self)
        # A client that has ended may still be writing its zone.
        for thread in threading.enumerate():
            if thread.name == node.CURRENT_ZONE:
                thread.join()
        rospy.set_param(node.CURRENT_ZONE, self.ZONE)
        self.core = self.new_core()
        self.addCleanup(lambda: self.core.close())  # a test may replace it
        self.zone = self.core.zones[self.ZONE]

    def new_core(self) -> FakeCore:
        return FakeCore()

    def open(self, kind: type):
        """Open one panel, until the test ends."""
        self.client = RefereeClient.acquire(WindowNode)
        self.addCleanup(RefereeClient.release)
        panel = kind(self.client)
        self.addCleanup(panel.close)
        self.addCleanup(panel.shutdown)
        self.addCleanup(self.wait_answered)
        self.addCleanup(lambda: self.core.answer_gate.set())
        show(panel)
        self.strip = StopStrip(self.client.model, self.client.stops)
        self.addCleanup(self.strip.close)
        self.strip.move(0, panel.frameGeometry().bottom() + 1)
        self.strip.show()
        panel.activateWindow()
        wait_until(lambda: QApplication.activeWindow() is panel, "the panel has the focus")
        self.wait_heard()
        return panel

    def wait_heard(self) -> None:
        """Wait until the panels show what the core says now."""
        self.core.look()
        number = self.core.number
        wait_until(lambda: self.client.model.number >= number, "the document is heard")

    def wait_answered(self) -> None:
        """Wait until all calls are answered, and the panels have shown the answers."""
        wait_until(lambda: not self.client.calls.are_waiting, "all calls are answered")

    def wait_call(self, *call: object) -> None:
        """Wait until the core receives this call. What it does then may take a moment."""
        wait_until(lambda: call in self.core.calls, lambda: f"{call} is called; there were {self.core.calls}")

    def hush(self) -> None:
        """Let the core publish no more, and wait until all that it published is heard. It does not count as silent."""
        self.core.silent = True
        wait_until(lambda: self.client.model.number == self.core.number, "the core's last document is heard")

    def fall_silent(self) -> None:
        """Let the core fall silent, and wait until the client notices it."""
        self.hush()
        limit(self, client, "OLD_S", OLD_S)
        wait_until(lambda: self.client.model.is_old, "the core is silent")


class PanelCase(CoreCase):
    """One panel that shows the first zone of a fake core."""

    PANEL = BenchmarkControlPanel

    def setUp(self) -> None:
        super().setUp()
        self.panel = self.open(self.PANEL)
