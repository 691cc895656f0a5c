"""Whole runs of box, comm node and dummy robot, with real sockets and ROS between them; and a killed comm node."""

import time

import rospy
from support.box_case import TABLET, BoxCase
from support.comm_case import NODE
from support.connections import kill, wait_follows
from support.dummy_launch import DummyRobot, launch_dummy
from support.robots import wire
from support.run_logs import RunLog

from roah_rsbb.msg import DevicesState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState

NO_GOAL = [BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.STOP]
# The dummy's reports in HWV, in order.
NOTIFICATIONS = ["going to the door", "guiding the visitor", "going to the door"]


class DummyCase(BoxCase):
    """A test case with a dummy robot."""

    def dummy(self, team: str, **arguments: object) -> DummyRobot:
        """Launch the dummy robot of a team."""
        return self._leaving(DummyRobot(team, **arguments))

    def begin(self, zone: str) -> None:
        """Connect and start."""
        self.box.connect(zone)
        self.box.start(zone)

    def complete(self, zone: str) -> RunLog:
        """A whole run; returns its log."""
        self.begin(zone)
        self.box.wait_text(zone, "Benchmark completed by the robot")
        self.box.wait_details(zone, lambda d: d.messages_saved > 0, "the robot says that it saves data")
        log = self.leave(zone)
        self.assertEqual(log.values("/rsbb_log/rsbb_state"), NO_GOAL)
        return log


class TestTaskBenchmarks(DummyCase):
    def test_one_after_the_other(self) -> None:
        self.robot = self.dummy("Alpha")
        self.assertEqual(self.box.wait_zone("Tasks", lambda z: z.code, "there is an event"), "HGTKMH")
        self.complete("Tasks")
        self.robot.wait_printed("HGTKMH: complete")
        self.box.wait_zone("Tasks", lambda z: z.code == "HWV", "the next event is there")
        self.welcoming_visitors()
        self.box.wait_zone("Tasks", lambda z: z.code == "HCFGAC", "the next event is there")
        self.catering()
        self.assertEqual(self.robot.warnings, [])
        self.assertNotIn("Traceback", self.robot.text)

    def welcoming_visitors(self) -> None:
        log = self.complete("Tasks")
        self.assertEqual(log.values("/activation_event"), ["the bell rang"])
        self.assertEqual(log.values("/visitor"), ["Deli Man"])
        self.assertEqual(log.values("/notification"), NOTIFICATIONS)

    def catering(self) -> None:
        self.home_is_published()
        log = self.complete("Tasks")
        self.assertEqual(log.values("/command"), ["close the blinds, light, and show me the map"])
        for topic, values in (("devices/switch_1", [1]), ("devices/switch_2", [1]), ("devices/switch_3", [1, 0]),
                              ("devices/dimmer", [70]), ("devices/blinds", [100, 0]), ("tablet/display_map", [1, 0])):
            self.assertEqual(log.values(f"/rsbb_log/{topic}"), values, topic)

    def home_is_published(self) -> None:
        """A ring of the bell, a call and a place on the tablet's map come through to the robot."""
        for topic in ("devices/bell", "tablet/call", "tablet/position"):
            wait_follows(NODE, f"/roah_rsbb/{topic}", "/dummy_robot")
        publisher = rospy.Publisher("/devices/state", DevicesState, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        publisher.publish(DevicesState(rospy.Time.now(), False, False, False, 0, 0, False))
        self.robot.wait_printed("the bell rings")
        now = wire(time.time())
        self.participant(TABLET).send(pb.TabletBeacon(last_call=now, last_pos=now, x=1.25, y=-2.5))
        self.robot.wait_printed("the tablet calls")
        self.robot.wait_printed("the tablet sends me to 1.25, -2.50")


class TestRestart(DummyCase):
    def test_a_comm_node_that_is_killed(self) -> None:
        """It restarts, and the box continues with it. The dummy, which kept running, begins again."""
        robot = self._leaving(launch_dummy("Eta", never_end=True))
        self.begin("Back")
        self.box.wait_details("Back", lambda d: d.robot_state == "EXECUTING", "the robot executes")
        robot.wait_printed("HGTKMH: executing")
        kill(NODE)
        robot.wait_printed("HGTKMH: executing", times=2)
        self.assertEqual(robot.text.count("HGTKMH: preparing"), 2, robot.text)
        stops = robot.text.count("stopped")
        self.box.command("stop", "Back")
        robot.wait_printed("stopped", times=stops + 1)
        log = self.leave("Back")
        cycle = [BoxState.PREPARE, BoxState.WAITING_RESULT]
        self.assertEqual(log.values("/rsbb_log/rsbb_state"), [BoxState.STOP, *cycle, *cycle, BoxState.STOP])
