"""Whole runs of box, comm node and dummy robot, each with real sockets and ROS between them; and misbehaviours."""

import time

import rospy
from support.box_case import TABLET, BoxCase
from support.comm_case import NODE
from support.connections import kill, wait_follows
from support.dummy_launch import DummyRobot, launch_dummy
from support.programs import Program, own
from support.robots import wire
from support.run_logs import RunLog
from support.waiting import wait_until

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


class TestStops(DummyCase):
    def test_stopped_work_does_not_continue(self) -> None:
        """After a stop and a new start, the dummy sends its reports from the first one on."""
        robot = self.dummy("Theta", execute_duration=9.0)
        self.begin("Again")
        robot.wait_printed("HWV: executing")
        self.box.command("stop", "Again")
        robot.wait_printed("stopped: the comm node sent STOP")
        self.box.start("Again")
        self.box.wait_text("Again", "Benchmark completed by the robot")
        log = self.leave("Again")
        sent = log.values("/notification")
        # The first ones are of the time until the stop, which a busy machine delays.
        self.assertIn(sent, [NOTIFICATIONS[:before] + NOTIFICATIONS for before in range(len(NOTIFICATIONS))])
        self.assertEqual(log.values("/visitor")[-1:], ["Deli Man"])
        self.assertEqual(robot.text.count("HWV: complete"), 1, robot.text)


class TestMisbehaviour(DummyCase):
    """Each misbehaviour, and the box's reaction."""

    def test_a_wrong_clock(self) -> None:
        self.dummy("Beta", clock_offset=0.5)
        self.box.wait_details("Skewed", lambda d: any("Clock skew" in reason for reason in d.off("connect")),
                              "connect is off, because of the skew")
        wait_until(lambda: self.box.robot("Beta") and abs(self.box.robot("Beta").skew.to_sec() - 0.5) < 0.1,
                   lambda: f"the skew is shown:\n{self.box.gui.active_robots}")
        self.assertIn("Clock skew", self.box.refusal("connect", "Skewed"))

    def test_nothing_saved(self) -> None:
        robot = self.dummy("Gamma", save_nothing=True, execute_duration=60)
        self.begin("Forgetful")
        self.box.wait_text("Forgetful", "Stopped: the robot saves no offline data")
        robot.wait_printed("stopped: the comm node sent STOP")
        self.box.wait_details("Forgetful", lambda d: d.end_reason == "no_messages_saved", "that is the reason")

    def test_a_crash(self) -> None:
        robot = self._leaving(launch_dummy("Delta", crash_in="execute"))
        self.begin("Crash")
        robot.wait_ended()
        self.assertIn("crashing on request", robot.text)
        self.assertIn("HGTKMH: executing", robot.text)
        # The text names the seconds, and changes each second.
        self.box.wait_text("Crash", "WARNING: No message from the robot for ")
        self.box.wait_phase("Crash", "running")
        self.dummy("Delta")  # the same robot, repaired
        self.box.wait_text("Crash", "Benchmark completed by the robot")

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

    def test_lost_datagrams(self) -> None:
        self.dummy("Epsilon", loss=0.3, execute_duration=2.0)
        log = self.complete("Lossy")
        self.assertEqual(log.values("/activation_event"), ["the bell rang"])
        self.assertEqual(log.values("/visitor"), ["Deli Man"])
        self.assertEqual(log.values("/notification"), NOTIFICATIONS)

    def test_it_never_ends(self) -> None:
        robot = self.dummy("Zeta", never_end=True, execute_duration=0.5)
        self.begin("Endless")
        self.box.wait_zone("Endless", lambda z: z.online_data.count("going to the door") == 2, "all reports are sent")
        self.box.command("stop", "Endless")
        robot.wait_printed("stopped: the comm node sent STOP")
        self.box.start("Endless")
        robot.wait_printed("HWV: executing", times=2)
        self.box.wait_details("Endless", lambda d: d.robot_state == "EXECUTING", "the robot executes")
        self.assertNotIn("HWV: complete", robot.text)
        self.leave("Endless")
        robot.wait_printed("stopped: the comm node sent STOP", times=2)

    def test_wrong_parameters(self) -> None:
        dummy = self._leaving(Program(
            own("dummy_glue"), "_crash_in:=later", "_execute_duration:=-1", "_never_end:=perhaps",
        ))
        self.assertEqual(dummy.wait_ended(), 1)
        for text in ("crash_in: found 'later', expected one of , prepare, execute",
                     "execute_duration: found -1, expected a number of at least 0",
                     "never_end: found 'perhaps', expected true or false"):
            self.assertIn(f"parameter /dummy_robot/{text}", dummy.text)
        self.assertNotIn("Traceback", dummy.text)
