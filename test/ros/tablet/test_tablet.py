"""The tablet at the box, without a browser."""

import time

from support import tablet_nodes
from support.box_case import LISTENER, TABLET, BoxCase
from support.programs import Program, own
from support.robots import BROADCAST, RSBB_PORT
from support.waiting import wait_until

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb


class TestTablet(BoxCase):
    """Its beacons at the box, the referee's and the robot's."""

    def test_the_dummy_tablet_reaches_the_robot(self) -> None:
        robot = self.robot("Delta")
        wait_until(lambda: robot.tablet, "the robot hears the box")
        tablet = self._leaving(Program(
            own("dummy_tablet"), "--host", BROADCAST, "--port", str(RSBB_PORT), "--bind", TABLET,
            "--call", "--position=1.5,-2.25",
        ))
        tablet.wait_printed("the box has published the call")
        tablet.wait_printed("the box has published the position")
        wait_until(lambda: robot.tablet.position_y == -2.25, "the robot hears the position")
        self.assertEqual(robot.tablet.position_x, 1.5)
        self.assertLess(abs(time.time() - robot.tablet.call_time[0]), 60)
        wait_until(lambda: self.box.gui.tablet_position_y == -2.25, "the referee sees the position")
        self.box.connect("Room")
        self.box.start("Room")
        robot.wait_did("execute HCFGAC")
        robot.request("display_map", True)
        tablet.wait_printed("the box requests the view: map")
        robot.request("display_map", False)
        tablet.wait_printed("the box requests the view: call button", 2)
        tablet.close()
        wait_until(lambda: "The tablet has been silent" in self.box.gui.status, lambda: str(self.box.gui))


class TestPage(BoxCase):
    """Its page, where something is missing."""

    def test_without_a_browser_no_tablet_is_announced(self) -> None:
        listener = self.participant(LISTENER)
        tablet_nodes.launched_url()
        listener.wait_beacon(lambda b: True, "the box sends beacons")
        wait_until(lambda: self.count_of(listener, pb.RoahRsbbBeacon) >= 3, "time passes")
        self.assertEqual(self.count_of(listener, pb.TabletBeacon), 0)

    @staticmethod
    def count_of(listener, kind) -> int:
        return sum(isinstance(message, kind) for message, _ in list(listener.heard))
