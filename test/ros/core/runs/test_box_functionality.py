"""The core in functionality benchmarks: messages to robots, actions of referees, faults of modules."""


from support.box_client import Refusal
from support.fakes.modules import ModulesCase

from helpers.forms import answer_in, form
from roah_rsbb.model.fields import entered
from roah_rsbb.model.modules import OutcomeKind, RequestKind, ScoreValue
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot.goals import HopfResult, Pose
from roah_rsbb.srv import Zone, ZoneUInt8

REFEREE, SWITCHES = RequestKind.REFEREE, RequestKind.SWITCHES
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


class TestReferee(ModulesCase):
    def form(self):
        """What the referee is asked for in zone Hands."""
        return entered(self.box.zone_details("Hands").fields("operation"))

    def test_manual_operations(self) -> None:
        self.fbm = self.modules("STB")
        self.robot("Gamma")
        self.started("Hands")
        self.fbm.asks("Hands", REFEREE, text="Place it")
        number = self.wait_asked("Hands", "Place it")
        self.assertEqual((number, self.form()), (1, ()))
        self.assertIn("Manual operation: Place it", self.box.zone("Hands").state)
        self.assertRefused("has no field 'answer'", "Hands", 1, "yes")
        self.box.command("manual_operation_complete", "Hands")
        self.assertEqual(self.fbm.wait_outcome("Hands").values, "")
        self.box.wait_zone("Hands", lambda z: not z.manual_operation, "nothing is asked any more")

        self.fbm.asks("Hands", REFEREE, text="No pose", form=form("try again", "skip"))
        self.assertEqual(self.wait_asked("Hands", "No pose"), 2)
        self.assertEqual(self.form()[0].choices, ("try again", "skip"))
        self.assertRefused("that manual operation is over", "Hands", 1, "skip")
        self.assertRefused("Answer: choose one of try again, skip", "Hands", 2, "fly")
        self.answer("Hands", 2, "skip")
        self.assertEqual(answer_in(self.fbm.wait_outcome("Hands")), "skip")

        self.fbm.asks("Hands", REFEREE, text="Which mug?", form=form(asks_text=True))
        self.wait_asked("Hands", "Which mug?")
        self.assertEqual([field.kind for field in self.form()], ["text"])
        self.answer("Hands", 0, "the blue one, ä")
        self.assertEqual(answer_in(self.fbm.wait_outcome("Hands")), "the blue one, ä")
        self.assertEqual(self.leave("Hands").values("/rsbb_log/manual_operation"), [
            "Place it", "Place it: done", "No pose", "No pose: done skip", "Which mug?",
            "Which mug?: done the blue one, ä",
        ])

    def test_what_the_module_says_and_scores(self) -> None:
        self.fbm = self.modules("STB", warnings=("frame robot is old",))
        self.robot("Gamma")
        self.started("Hands")
        score = ScoreValue("goal 1", "time", "1.5", "s", "Time")
        self.fbm.says("Hands", status="Goal 1 of 2", warnings=("nothing works",), scores=(score,))
        details = self.box.wait_details("Hands", lambda d: d.module_scores and d, "there is a score")
        self.assertEqual(tuple(getattr(details.module_scores[0], name) for name in score._fields), score)
        self.assertEqual(details.module_status, "Goal 1 of 2")
        # The robot's first datagram may be late: then there is a third one about its clock, until the next.
        self.box.wait_details("Hands", lambda d: list(d.warnings) == ["frame robot is old", "nothing works"],
                              "both warnings of the module")
        self.box.command("stop", "Hands")
        self.fbm.says("Hands", scores=(score._replace(value="2.5"),))
        self.box.wait_details("Hands", lambda d: d.module_scores[0].value == "2.5", "the last score is taken, too")
        self.assertIn('"value": 2.5', self.leave("Hands").values("/rsbb_log/bmbox/score")[-1])
        self.box.wait_details("Hands", lambda d: not d.module_scores, "the run is left with its score")

    def test_switches(self) -> None:
        self.fbm = self.modules("HOMF")
        robot = self.robot("Delta")
        self.started("Switches")
        self.assertFalse(self.box.zone("Switches").omf)
        self.switches_refused("has no switches to enter", "button", 1)
        self.fbm.asks("Switches", initial_state=(True, False, False), switches=(2, 3))
        robot.wait_did("execute HOMF")
        self.assertEqual((robot.goals[0].initial_state, robot.goals[0].switches), ((True, False, False), (2, 3)))
        zone = self.box.wait_zone("Switches", lambda z: z.omf and z, "there are switches")
        self.assertEqual((bytes(zone.omf_switches), zone.omf_damaged, zone.omf_complete), (b"\x01", 0, False))
        self.box.call("omf_switches/button", ZoneUInt8, "Switches", 2)
        self.switches_refused("the robot has not finished", "complete")
        robot.let("execute")
        self.fbm.wait_outcome("Switches")
        self.fbm.asks("Switches", SWITCHES, text="Enter the switches")
        self.box.wait_zone("Switches", lambda z: z.omf_complete, "the switches are to be confirmed")
        self.assertRefused("has no manual operation now", "Switches", 0, "")
        self.switches_refused("numbered 1 to 3", "button", 4)
        self.box.call("omf_switches/button", ZoneUInt8, "Switches", 1)
        self.box.call("omf_switches/damaged", ZoneUInt8, "Switches", 1)
        self.box.wait_zone("Switches", lambda z: (bytes(z.omf_switches), z.omf_damaged) == (b"\x02", 1),
                           "all is entered")
        self.box.call("omf_switches/complete", Zone, "Switches")
        outcome = self.fbm.wait_outcome("Switches")
        self.assertEqual((outcome.changed, outcome.damaged), ((2, 1), 1))
        self.fbm.says("Switches", finished=True)
        self.wait_phase("Switches", "ended", "completed")
        self.box.wait_zone("Switches", lambda z: not z.omf, "there are no switches any more")
        log = self.leave("Switches")
        self.assertEqual(log.values("/rsbb_log/omf_button"), [2, 1])
        self.assertEqual(log.values("/rsbb_log/omf_damaged"), [1])
        self.assertEqual(log.values("/rsbb_log/omf_complete"), ['{"switches": [2, 1], "damaged_switches": 1}'])

    def test_zones_without_a_module(self) -> None:
        self.robot("Theta")
        self.box.connect("Task")
        self.assertRefused("has no manual operation now", "Task", 0, "")
        for name, request in (("button", (1,)), ("damaged", (1,)), ("complete", ())):
            self.switches_refused("which has no switches", name, *request, zone="Task")
        self.assertRefused("no zone 'Tusk'", "Tusk", 0, "")

    def answer(self, zone: str, operation: int, answer: str) -> None:
        self.box.act("operation", zone, operation=operation, answer=answer)

    def assertRefused(self, why: str, *request) -> None:
        with self.assertRaisesRegex(Refusal, why):
            self.answer(*request)

    def switches_refused(self, why: str, name: str, *value: int, zone: str = "Switches") -> None:
        kind = ZoneUInt8 if value else Zone
        with self.assertRaisesRegex(Refusal, why):
            self.box.call(f"omf_switches/{name}", kind, zone, *value)


class TestStops(ModulesCase):
    def test_a_stop_in_each_state_and_a_start_again(self) -> None:
        self.fbm = self.modules("HNF")
        self.bot = self.robot("Epsilon", prepares=False)
        for attempt, reach in enumerate((self.asking, self.preparing, self.executing, self.between), 1):
            self.started("Stops", attempt)
            reach(attempt)
            stops = self.bot.did.count("stop")
            self.box.command("stop", "Stops")
            self.wait_phase("Stops", "ended", "stopped")
            self.bot.wait_state(RobotState.STOP)
            if reach != self.asking:
                self.bot.wait_did("stop", stops + 1)
            run = self.fbm.wait_run("Stops", lambda run: not run.running, "the module receives the stop")
            self.assertEqual((run.end_reason, run.attempt), ("stopped", attempt))
            self.assertEqual(self.box.zone_details("Stops").operation, 0)
        self.started("Stops", 5)
        self.assertEqual(self.fbm.runs["Stops"].steps, ())
        self.fbm.says("Stops", finished=True)
        self.wait_phase("Stops", "ended", "completed")

    def asking(self, _attempt: int) -> None:
        self.fbm.asks("Stops", REFEREE, text="Place it")
        self.wait_asked("Stops", "Place it")

    def preparing(self, _attempt: int) -> None:
        prepared = self.bot.did.count("prepare HNF")
        self.fbm.asks("Stops", **WAYPOINT)
        self.bot.wait_did("prepare HNF", prepared + 1)

    def executing(self, attempt: int) -> None:
        executed = self.bot.did.count("execute HNF")
        self.preparing(attempt)
        self.bot.let("prepare")
        self.bot.wait_did("execute HNF", executed + 1)
        self.assertEqual(self.bot.goals[-1].pose, WAYPOINT["pose"])

    def between(self, attempt: int) -> None:
        self.executing(attempt)
        self.bot.let("execute")
        self.fbm.wait_outcome("Stops")
        self.bot.wait_state(RobotState.RESULT_TX)


class TestResults(ModulesCase):
    def test_a_robot_of_ours_is_understood(self) -> None:
        self.fbm = self.modules("HOPF")
        robot = self.robot("Beta")
        robot.result = HopfResult("mug", "red mug", Pose(0.5, -1.0, 3.0))
        self.started("Table")
        self.fbm.asks("Table", timeout=100.0)
        robot.wait_did("execute HOPF")
        robot.let("execute")
        self.assertIn('"red mug"', self.fbm.wait_outcome("Table").result)
        self.assertEqual(robot.goals, [None])
