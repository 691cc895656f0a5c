"""Two boxes on one network: one that hears the other in time waits for its referee, a later one is a loud warning at
both."""

import os

import rospy
from support.box_case import LISTENER, BoxCase
from support.box_client import BoxClient
from support.own_core import OTHER, OTHER_CORE
from support.programs import Program, own
from support.robots import BOX, CONFIG
from support.waiting import wait_until

EARLY_BOX, LATER_BOX = "127.0.0.5", "127.0.0.6"
LISTENING_S = 5.0


class TestTwoBoxes(BoxCase):
    def second_core(self, host: str, listen_duration: float) -> Program:
        """Another core, at `host`, whose names in ROS all begin with /other."""
        params = {
            **{name: rospy.get_param(f"/roah_rsbb_core/{name}") for name in ("rsbb_host", "rsbb_port")},
            "bind_host": host, "benchmarks_file": rospy.get_param("/roah_rsbb_core/benchmarks_file"),
            "schedule_file": CONFIG / "box.yaml", "passwords_file": CONFIG / "passwords.yaml",
            "log_dir": os.path.join(rospy.get_param("/roah_rsbb_core/log_dir"), "other"),
            "listen_duration": listen_duration,
        }
        return self._leaving(Program(
            own("roah_rsbb_core"), *OTHER_CORE, *(f"_{name}:={value}" for name, value in params.items()),
        ))

    def other_client(self) -> BoxClient:
        """The referee of the second box."""
        other = BoxClient(prefix=OTHER)
        self.addCleanup(other.close)
        other.wait_heard()
        return other

    def test_a_box_that_hears_another_one_at_first_waits_for_its_referee(self) -> None:
        self.box.wait_zone("Two boxes", lambda z: "listening" not in z.state, "the first box transmits")
        listener = self.participant(LISTENER)
        second = self.second_core(EARLY_BOX, LISTENING_S)
        other = self.other_client()
        warning = (f"ANOTHER RSBB was heard at {BOX}, so this box sends nothing until you press connect. Stop the "
                   "other box first, or take that computer off the network if it is none of yours")
        wait_until(lambda: warning in other.gui.status, "its referee sees the other box's address")
        wait_until(lambda: warning in other.warnings, "so do all others")
        second.wait_printed("[ERROR]")
        self.robot("Zeta")
        other.wait_details(
            "Two boxes", lambda d: not d.off("connect"),
            "it listened for long enough, and connects robots")
        self.assertNotIn(EARLY_BOX, {host for _, host in listener.heard}, "it only listened")
        self.assertFalse([warning for warning in self.box.warnings if EARLY_BOX in warning])

        # Its referee decides: the other one is nobody's.
        other.connect("Two boxes")
        wait_until(lambda: EARLY_BOX in {host for _, host in listener.heard}, "it transmits")
        wait_until(lambda: any(EARLY_BOX in text for text in self.box.warnings), "the first box warns")
        self.assertIsNone(second.ended_mono)

    def test_a_box_that_comes_later_is_reported_to_every_referee(self) -> None:
        robot = self.robot("Zeta")
        self.box.connect("Two boxes")
        self.box.start("Two boxes")
        robot.wait_did("execute HGTKMH")
        # It does not listen first, as if the two networks had only now become one.
        second = self.second_core(LATER_BOX, 0.0)
        other = self.other_client()
        for client, host in ((self.box, LATER_BOX), (other, BOX)):
            warning = (f"ANOTHER RSBB is transmitting from {host}, and robots obey both: stop it, or take that "
                       "computer off the network")
            wait_until(lambda c=client, w=warning: w in c.warnings, lambda w=warning: f"the warning: {w}")
            wait_until(lambda c=client, w=warning: w in c.gui.status, lambda w=warning: f"the status: {w}")
        second.wait_printed("[ERROR]")
        self.assertEqual(self.box.zone_details("Two boxes").phase, "running")
        robot.let("execute")
        self.box.wait_text("Two boxes", "Benchmark completed by the robot")
        clock = other.gui.clock
        wait_until(lambda: other.gui.clock > clock, "the other box continues, too")
        self.assertIsNone(second.ended_mono)
