"""The core in functionality benchmarks: messages to robots."""

from support.fakes.modules import ModulesCase

from roah_rsbb.model.modules import OutcomeKind
from roah_rsbb.protocol import BoxState, RobotState

WAYPOINT = {"goal": "[1.5, -2, 0.25]", "pose": (1.5, -2.0, 0.25)}


class TestOnTheWire(ModulesCase):
    """What robots of all generations receive and answer. The test makes each datagram of the robot."""

    def begin(self, team: str, zone: str):
        robot = self.raw_robot(team)
        self.join(robot, zone)
        self.fbm.wait_attempt(zone)
        return robot

    def test_a_goal_is_sent_in_both_forms_and_only_in_goal_tx(self) -> None:
        self.fbm = self.modules("HNF")
        robot = self.begin("Alpha", "Wire")
        self.assertEqual(robot.wait_sent(BoxState.STOP).benchmark_type, "HNF")
        self.fbm.asks("Wire", text="Waypoint 1", timeout=100.0, **WAYPOINT)
        sent = robot.wait_sent(BoxState.PREPARE)
        self.assertFalse(sent.HasField("generic_goal") or sent.HasField("target_pose_x"))
        robot.send(RobotState.WAITING_GOAL)
        sent = robot.wait_sent(BoxState.GOAL_TX)
        self.assertEqual(sent.generic_goal, "[1.5, -2, 0.25]")
        self.assertEqual((sent.target_pose_x, sent.target_pose_y, sent.target_pose_theta), (1.5, -2.0, 0.25))
        robot.send(RobotState.EXECUTING)
        sent = robot.wait_sent(BoxState.WAITING_RESULT)
        self.assertFalse(sent.HasField("generic_goal") or sent.HasField("target_pose_x"))
        robot.send(RobotState.RESULT_TX)
        self.assertEqual(self.fbm.wait_outcome("Wire").kind, OutcomeKind.DONE)
        self.fbm.says("Wire", finished=True)
        robot.wait_sent(BoxState.STOP)
        self.wait_phase("Wire", "ended", "completed")

    def test_a_result_comes_in_in_either_form(self) -> None:
        self.fbm = self.modules("HOPF")
        robot = self.begin("Beta", "Table")
        of_2015 = {"object_class": "mug", "object_name": "red mug", "object_pose_x": 0.5, "object_pose_y": -1.0,
                   "object_pose_theta": 3.0}
        of_2019 = {"generic_result": "{class: mug, instance: red mug, x: 0.5, y: -1, theta: 3}"}
        for result, text in (
            (of_2015, '{"class": "mug", "instance": "red mug", "x": 0.5, "y": -1.0, "theta": 3.0}'),
            (of_2019, of_2019["generic_result"]), ({**of_2015, **of_2019}, of_2019["generic_result"]), ({}, ""),
        ):
            self.fbm.asks("Table")
            robot.wait_sent(BoxState.PREPARE)
            robot.send(RobotState.WAITING_GOAL)
            sent = robot.wait_sent(BoxState.WAITING_RESULT)
            self.assertFalse(sent.HasField("generic_goal"), "there is no explicit goal")
            robot.send(RobotState.EXECUTING)
            robot.send(RobotState.RESULT_TX, **result)
            self.assertEqual(self.fbm.wait_outcome("Table").result, text)
        log = self.leave("Table")
        self.assertEqual(len(log.values("/rsbb_log/opf_result")), 3)
        self.assertEqual(len(log.values("/rsbb_log/bmbox/goal")), 4)
