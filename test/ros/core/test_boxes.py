"""Two boxes on one network: a later one is a loud warning at both."""

import os

import rospy
from support.box_case import BoxCase
from support.box_client import BoxClient
from support.own_core import OTHER, OTHER_CORE
from support.programs import Program, own
from support.robots import BOX, CONFIG
from support.waiting import wait_until

LATER_BOX = "127.0.0.6"


class TestTwoBoxes(BoxCase):
    def second_core(self, host: str) -> Program:
        """Another core, at `host`, whose names in ROS all begin with /other."""
        params = {
            **{name: rospy.get_param(f"/roah_rsbb_core/{name}") for name in ("rsbb_host", "rsbb_port")},
            "bind_host": host, "benchmarks_file": rospy.get_param("/roah_rsbb_core/benchmarks_file"),
            "schedule_file": CONFIG / "box.yaml", "passwords_file": CONFIG / "passwords.yaml",
            "log_dir": os.path.join(rospy.get_param("/roah_rsbb_core/log_dir"), "other"),
            "listen_duration": 0.0,
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

    def test_a_box_that_comes_later_is_reported_to_every_referee(self) -> None:
        robot = self.robot("Zeta")
        self.box.connect("Two boxes")
        self.box.start("Two boxes")
        robot.wait_did("execute HGTKMH")
        # It does not listen first, as if the two networks had only now become one.
        second = self.second_core(LATER_BOX)
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
