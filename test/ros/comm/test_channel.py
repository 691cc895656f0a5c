"""The comm node and a box whose every datagram is the test's: topics, goals, results."""

import rospy
from geometry_msgs.msg import Pose2D
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv
from support.comm_case import (
    ALWAYS,
    GOALS,
    NUMBERS,
    SAYS_EXECUTE,
    SAYS_PREPARE,
    SAYS_STOP,
    ChannelCase,
    reported_with,
)
from support.raw_box import now

from roah_rsbb.msg import BenchmarkState, DevicesState, GoalHGMF, TabletState
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.srv import ResultHOPF, ResultHPPF

STOP, PREPARE, GOAL_TX, WAITING_RESULT = (
    BoxState.STOP, BoxState.PREPARE, BoxState.GOAL_TX, BoxState.WAITING_RESULT
)


class TestHome(ChannelCase):
    """Devices and tablet, from the box's beacons."""

    def test_devices(self) -> None:
        bells = self.heard("devices/bell", Empty)
        bells.wait_connected()
        ring = now()
        devices = self.heard("devices/state", DevicesState)
        devices.wait_connected()
        self.box.beacon(devices_bell=ring, devices_switch_1=True, devices_dimmer=70, devices_blinds=20)
        first = devices.wait_last(lambda m: m.dimmer == 70, "the devices' state")
        self.assertEqual(
            (first.switch_1, first.switch_2, first.switch_3, first.blinds, first.door_win_detect),
            (True, False, False, 20, False),
        )
        self.assertEqual((first.bell.secs, first.bell.nsecs), (ring.sec, ring.nsec))
        bells.wait_count(1)
        count, rings = len(devices.messages), len(bells.messages)
        # The same again is no change; another beacon's change comes after it.
        self.box.beacon()
        self.box.beacon(devices_switch_3=True, devices_door_win_detect=True)
        last = devices.wait_last(lambda m: m.switch_3, "the change")
        self.assertTrue(last.door_win_detect)
        self.assertEqual((len(devices.messages), len(bells.messages)), (count + 1, rings))

        self.box.beacon(devices_bell=now())
        bells.wait_count(rings + 1)
        late_bell, late_state = self.heard("devices/bell", Empty), self.heard("devices/state", DevicesState)
        self.assertTrue(late_state.wait_count(1).switch_3)
        late_bell.wait_connected()
        self.box.beacon(devices_bell=now())
        bells.wait_count(rings + 2)
        late_bell.wait_count(1)
        self.assertEqual(len(late_bell.messages), 1, "a ring is not latched")
        self.assertEqual(len(bells.messages), rings + 2, "nothing else is a ring")
        self.box.beacon(devices_switch_1=False, devices_switch_3=False, devices_door_win_detect=False)

    def test_tablet(self) -> None:
        calls, positions = self.heard("tablet/call", Empty), self.heard("tablet/position", Pose2D)
        tablet = self.heard("tablet/state", TabletState)
        for heard in (calls, positions, tablet):
            heard.wait_connected()
        self.box.beacon(tablet_display_map=True, tablet_position_x=0.5, tablet_position_y=-0.5)
        tablet.wait_last(lambda m: m.display_map and (m.position_x, m.position_y) == (0.5, -0.5), "the tablet's state")
        tablet.messages.clear()
        self.box.beacon(tablet_call_time=now())
        calls.wait_count(1)
        self.box.beacon(tablet_position_time=now(), tablet_position_x=1.5, tablet_position_y=-2.5)
        selected = positions.wait_count(1)
        self.assertEqual((selected.x, selected.y, selected.theta), (1.5, -2.5, 0.0))
        tablet.wait_count(2)  # a topic of its own: it may come later
        count = len(tablet.messages)
        self.assertEqual(count, 2)
        self.box.beacon()
        called, placed = now(), self.box.beacon_message.tablet_position_time
        self.box.beacon(tablet_display_map=False, tablet_call_time=called)
        calls.wait_count(2)
        last = tablet.wait_count(count + 1)
        self.assertEqual((last.call_time.secs, last.call_time.nsecs), (called.sec, called.nsec))
        self.assertEqual((last.position_time.secs, last.position_time.nsecs), (placed.sec, placed.nsec))

        late = [self.heard("tablet/call", Empty), self.heard("tablet/position", Pose2D)]
        self.assertFalse(self.heard("tablet/state", TabletState).wait_count(1).display_map)
        for heard in late:
            heard.wait_connected()
        self.box.beacon(tablet_call_time=now(), tablet_position_time=now())
        calls.wait_count(3)
        positions.wait_count(2)
        for heard in late:
            heard.wait_count(1)
        self.assertEqual([len(heard.messages) for heard in (*late, calls, positions)], [1, 1, 3, 2],
                         "neither call nor position is latched, nor published without news")


class TestGoals(ChannelCase):
    """/roah_rsbb/goal, whose type changes in one node."""

    def test_a_type_for_each_benchmark(self) -> None:
        pose = {"target_pose_x": 1.5, "target_pose_y": -2.0, "target_pose_theta": 3.0}
        for code, fields, expected in (
            ("HNF", pose, Pose2D(1.5, -2.0, 3.0)),
            ("HGMF", {"generic_goal": "[0.25, 1.5, 7]"}, GoalHGMF(7, Pose2D(0.25, 1.5, 0.0))),
            ("HOMF", {"initial_state": [True, False], "switches": [2, 1]}, GOALS["HOMF"]([True, False], [2, 1])),
            ("STB", {"generic_goal": "goal: GOAL 1\ndetails: 4\n"}, GOALS["STB"]("goal: GOAL 1\ndetails: 4\n")),
            ("HNF", {"generic_goal": "- 1\n- 2.5\n- -0.5\n"}, Pose2D(1.0, 2.5, -0.5)),
        ):
            with reported_with(code):
                self.begin(code)
                early = self.heard("goal", GOALS[code])
                early.wait_connected()
                self.prepare(code)
                self.assertEqual(early.messages, [])
                self.box.send(code, GOAL_TX, **fields)
                self.box.wait_state(RobotState.EXECUTING)
                self.assertEqual(early.wait_count(1), expected)
                self.box.send(code, GOAL_TX, **fields)  # the box had not heard yet
                self.assertEqual(self.latched("goal", GOALS[code]), expected)
                self.call("end_execute")
                self.box.wait_state(RobotState.RESULT_TX)
                self.assertEqual(len(early.messages), 1)
                early.close()
                self.box.beacon()
                self.wait_benchmark(0)
                self.assertEqual(self.published, ALWAYS)


class TestResults(ChannelCase):
    """A result goes out in the forms of all generations."""

    def execute(self, code: str) -> None:
        self.begin(code)
        self.prepare(code)
        self.box.send(code, WAITING_RESULT)
        self.box.wait_state(RobotState.EXECUTING)

    def test_object(self) -> None:
        self.execute("HOPF")
        self.call("end_execute", ResultHOPF, "cups", "red_cup", Pose2D(0.1, 0.2, 1.23))
        said = self.box.wait_state(RobotState.RESULT_TX)
        self.assertEqual((said.object_class, said.object_name), ("cups", "red_cup"))
        self.assertEqual((said.object_pose_x, said.object_pose_y, said.object_pose_theta), (0.1, 0.2, 1.23))
        self.assertEqual(said.generic_result, '{class: "cups", instance: "red_cup", x: 0.1, y: 0.2, theta: 1.23}')

    def test_person(self) -> None:
        self.execute("HPPF")
        self.call("end_execute", ResultHPPF, "Annie", Pose2D(1.0, 2.0, -0.5))
        said = self.box.wait_state(RobotState.RESULT_TX)
        self.assertEqual(said.generic_result, '{person_name: "Annie", x: 1.0, y: 2.0, theta: -0.5}')


class TestRun(ChannelCase):
    """The beginning of a run, and its end."""

    def test_the_box_no_longer_lists_the_robot(self) -> None:
        self.begin("STB")
        self.prepare("STB")
        self.box.send("STB", GOAL_TX, generic_goal="go")
        self.wait_said(SAYS_EXECUTE)
        self.box.beacon()
        self.wait_benchmark(0)
        self.assertEqual((self.services, self.published), (set(), ALWAYS))
        # The next run, on another port, begins again.
        self.begin("HGTKMH")
        self.assertEqual(self.latched("benchmark/state", BenchmarkState).benchmark_state, SAYS_STOP)
        self.assertEqual([m.benchmark for m in self.benchmarks.messages][-4:], [0, NUMBERS["STB"], 0, 1])

    def test_a_call_at_the_wrong_moment(self) -> None:
        """The phase ended while the call was under way: it fails with the reason."""
        self.begin("HGTKMH")
        self.box.send("HGTKMH", PREPARE)
        self.wait_said(SAYS_PREPARE)
        prepared = rospy.ServiceProxy("/roah_rsbb/end_prepare", EmptySrv, persistent=True)
        prepared.wait_for_service()
        self.addCleanup(prepared.close)
        prepared()
        self.box.wait_state(RobotState.WAITING_GOAL)
        with self.assertRaises(rospy.ServiceException):
            prepared()
        self.assertEqual(self.box.received[-1].robot_state, RobotState.WAITING_GOAL)
