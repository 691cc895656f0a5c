"""Two boxes on one network: one that is heard in time gives up, a later one is a loud warning at both."""

import os
import signal

import rospy
from std_srvs.srv import Empty
from support.box_case import LISTENER, BoxCase
from support.box_client import BoxClient
from support.own_core import OTHER, OTHER_CORE
from support.programs import Program, own
from support.robots import BOX, CONFIG
from support.waiting import wait_until

EARLY_BOX, LATER_BOX = "127.0.0.5", "127.0.0.6"
LISTENING_S = 5.0
SHUTDOWN = f"{OTHER}/roah_rsbb_shutdown"


class TestTwoBoxes(BoxCase):
    def second_core(self, host: str, listen_duration: float) -> Program:
        """Another core, at `host`, whose names in ROS all begin with /other."""
        params = {
            **{name: rospy.get_param(f"/roah_rsbb_core/{name}") for name in ("rsbb_host", "rsbb_port")},
            "bind_host": host, "benchmarks_file": rospy.get_param("/roah_rsbb_core/benchmarks_file"),
            "schedule_file": CONFIG / "box.yaml", "passwords_file": CONFIG / "passwords.yaml",
            "log_dir": os.path.join(rospy.get_param("/roah_rsbb_core/log_dir"), "other"),
            "listen_duration": listen_duration, "end_launch": True,
        }
        return self._leaving(Program(
            own("roah_rsbb_core"), *OTHER_CORE, f"roah_rsbb_shutdown:={SHUTDOWN}",
            *(f"_{name}:={value}" for name, value in params.items()),
        ))

    def test_a_box_that_hears_another_one_at_first_gives_up(self) -> None:
        self.box.wait_zone("Two boxes", lambda z: "listening" not in z.state, "the first box transmits")
        listener = self.participant(LISTENER)
        second = self.second_core(EARLY_BOX, LISTENING_S)
        ends = []

        def end_launch(_request: object) -> list:
            """As the shutdown node of a launch: all of its nodes are interrupted."""
            ends.append(second.ended_mono)
            second.signal(signal.SIGINT)
            return []

        self.addCleanup(rospy.Service(SHUTDOWN, Empty, end_launch).shutdown)
        self.assertNotEqual(second.wait_ended(), 0)
        self.assertEqual(ends, [None], "it had the launch ended before it ended itself, or it would be started again")
        self.assertIn(
            f"Another RSBB is running at {BOX}: stop that one, or give this one another rsbb_host or rsbb_port",
            second.text,
        )
        self.assertIn("[FATAL]", second.text)
        self.assertNotIn("Traceback", second.text)
        self.assertNotIn(EARLY_BOX, {host for _, host in listener.heard}, "it only listened")
        self.assertFalse([warning for warning in self.box.details.warnings if EARLY_BOX in warning])

    def test_a_box_that_comes_later_is_reported_to_every_referee(self) -> None:
        robot = self.robot("Zeta")
        self.box.connect("Two boxes")
        self.box.start("Two boxes")
        robot.wait_did("execute HGTKMH")
        # It does not listen first, as if the two networks had only now become one.
        second = self.second_core(LATER_BOX, 0.0)
        other = BoxClient(prefix=OTHER)
        self.addCleanup(other.close)
        other.wait_heard()
        for client, host in ((self.box, LATER_BOX), (other, BOX)):
            warning = f"ANOTHER RSBB is transmitting from {host}: stop it, robots obey both"
            wait_until(lambda c=client, w=warning: w in c.details.warnings, lambda w=warning: f"the warning: {w}")
            wait_until(lambda c=client, w=warning: w in c.gui.status, lambda w=warning: f"the status: {w}")
        second.wait_printed("[ERROR]")
        self.assertEqual(self.box.zone_details("Two boxes").phase, "running")
        robot.let("execute")
        self.box.wait_text("Two boxes", "Benchmark completed by the robot")
        clock = other.gui.clock
        wait_until(lambda: other.gui.clock > clock, "the other box continues, too")
        self.assertIsNone(second.ended_mono)
