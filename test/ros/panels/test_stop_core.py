"""STOP in the window while the core is killed, restarted or hangs: it is sent until the core has it, and stops only the
run that it was meant for."""

import pathlib
import tempfile

import rospy
from support.gui_testing import limit, show, sync, wait_until, without_hurry
from support.own_core import OwnCoreCase
from support.real_input import click_at
from support.robots import CONFIG

from roah_rsbb.client import client
from roah_rsbb.protocol import RobotState
from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import CURRENT_ZONE, WindowNode
from roah_rsbb.rqt.qt import QSettings
from roah_rsbb.rqt.windows import Window
from roah_rsbb.wording import stop


class TestCore(OwnCoreCase):
    def setUp(self) -> None:
        super().setUp()
        without_hurry(self)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.log_dir = pathlib.Path(folder.name) / "logs"
        self.start()
        self.zone = self.box.document.box.zones[0]
        rospy.set_param(CURRENT_ZONE, self.zone)
        self.window = Window(WindowNode(), QSettings(f"{folder.name}/window.ini", QSettings.IniFormat))
        self.addCleanup(self.window.close)
        self.addCleanup(self.window.shutdown)
        self.client, self.strip = RefereeClient.acquire(WindowNode), self.window.strip
        self.addCleanup(RefereeClient.release)
        show(self.window, 900, 500)
        self.a_robot = self.robot(self.box.last_zone(self.zone).team)
        self.begin()

    def start(self) -> None:
        self.start_core(self.log_dir, schedule_file=CONFIG / "kill.yaml",
                        benchmarks_file=CONFIG / "kill_benchmarks.yaml")

    def begin(self) -> None:
        """A run is in progress."""
        self.box.connect(self.zone)
        self.box.start(self.zone)
        self.a_robot.wait_state(RobotState.EXECUTING)
        wait_until(lambda: self.strip.stop.is_on() and self.client.model.identity_of(self.zone)
                   == self.box.document.zones[self.zone].identity, "STOP is live")

    def press(self) -> None:
        click_at(self.strip.stop.mapToGlobal(self.strip.stop.rect().center()))
        self.shown("sent")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.shown("NOT DELIVERED. Stop the robot by hand")

    def shown(self, text: str) -> None:
        wait_until(lambda: text in self.strip.way.whole, lambda: f"'{text}' is shown, not '{self.strip.way.whole}'")

    def stops(self) -> None:
        """The robot stops, and the strip says so."""
        wait_until(lambda: self.a_robot.client.state is RobotState.STOP, "the robot has stopped")
        self.shown("the robot has stopped")

    def test_a_stop_in_the_gap_reaches_the_restarted_core(self) -> None:
        self.core.kill()
        self.press()
        self.start()
        self.stops()

    def test_a_stop_in_the_gap_does_not_reach_another_run(self) -> None:
        self.core.kill()
        self.press()
        self.start()
        for command in ("stop", "disconnect"):  # another referee; the window notices nothing of it
            self.box.command(command, self.zone)
        self.box.connect(self.zone)
        self.box.start(self.zone)
        self.a_robot.wait_did("execute HGTKMH", 2)
        sent = self.client.stops.sent()[0]
        self.client.stops._try(sent)  # it arrives late
        wait_until(lambda: not sent.calls, "the core has answered")
        wait_until(lambda: not self.client.stops.sent(), "nothing is left to say")
        self.box.wait_current()
        self.assertEqual(self.box.document.zones[self.zone].phase, "running")

    def test_a_core_that_hangs_gets_it_when_it_continues(self) -> None:
        limit(self, client, "STOP_S", 0.1)  # it is sent again and again
        self.core.stop()
        self.addCleanup(self.core.proceed)
        self.press()
        sent = self.client.stops.sent()[0]
        self.core.proceed()
        self.stops()
        wait_until(lambda: not sent.calls, "no call is left")
        sync()
