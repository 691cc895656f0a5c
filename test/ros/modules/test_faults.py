"""Failures of the modules' processes and of the core, and stops at any moment."""

from support.modules_case import FaultsCase
from support.robots import Robot
from support.waiting import wait_until


class TestCrashes(FaultsCase):
    def test_modules_that_are_killed_in_the_middle_of_a_goal(self) -> None:
        robot = self.robot("Eta")
        robot.result = "found"
        modules = self.modules()
        self.begin("STB")
        self.answer("STB")
        self.goals_done(robot, 1)
        robot.wait_did("execute STB", 2)
        self.scored("STB", "time")
        before = self.box.zone_details("STB").module_scores
        modules.kill()
        details = self.box.wait_details("STB", lambda d: d.held and d, "the run is held")
        self.assertIn("Benchmarking module not connected: the run is paused", details.warnings[0])
        self.assertEqual((details.phase, details.module_scores), ("running", before))
        self.modules()
        back = "Benchmarking module is back, at step 3: the run continues"
        self.box.wait_zone("STB", lambda z: back in z.log, "back")
        robot.let("execute")
        scores, log = self.to_the_end("STB", after=1)
        self.assertEqual(scores["", "completed"], 2)
        self.assertEqual(self.of_each(scores, "result"), ["found"] * 2)
        self.assertEqual(robot.did.count("execute STB"), 2)
        self.assertEqual(len(log.values("/rsbb_log/bmbox/goal")), 2)

    def test_a_core_that_is_killed_while_the_modules_stay(self) -> None:
        self.modules()
        robot = self.robot("Iota")
        self.begin("STB 2")
        self.answer("STB 2")
        robot.wait_did("execute STB")
        self.kill_core()
        for times in (1, 2):
            self.goals_done(robot, times)
        scores, log = self.to_the_end("STB 2", after=1)
        self.assertEqual(scores["", "completed"], 2)
        self.assertEqual(robot.did.count("execute STB"), 2)
        self.assertEqual(len(log.values("/rsbb_log/bmbox/goal")), 2)

    def test_a_second_process_takes_over(self) -> None:
        """The second process has followed the run. Measurements of the first one do not change."""
        truth = self.folder / "HNF 2" / "ground_truth.yaml"
        text = truth.read_text(encoding="utf-8")
        truth.write_text(text.replace("maximum_age: 0.5", "maximum_age: 10"), encoding="utf-8")
        first = self.modules("first")
        robot = self.robot("Theta")
        self.begin("HNF 2")
        # If a pose was missing or old when the goal is done, the referee would be asked to help.
        self.box.wait_details("HNF 2", lambda d: not d.warnings, "the module sees the ground truth")
        self.answer("HNF 2")
        robot.wait_did("execute HNF")
        self.modules("second")
        two = "2 nodes drive HNF: end all but one. The first one counts"
        self.box.wait_details("HNF 2", lambda d: two in d.warnings, "the referee is warned")
        robot.let("execute")
        robot.wait_did("execute HNF", 2)
        measured = self.scored("HNF 2", "distance_error")
        first.kill()
        self.box.wait_zone("HNF 2", lambda z: "Benchmarking module is back, at step 4" in z.log, "the second is in")
        robot.let("execute")
        scores, _ = self.to_the_end("HNF 2", after=1)
        self.assertEqual(scores["", "reached"] + scores["", "timed_out"], 2)
        self.assertEqual(scores["waypoint 1", "distance_error"], measured)

class TestStops(FaultsCase):
    def test_a_stop_anywhere_and_a_start_again(self) -> None:
        self.modules()
        robot = self.robot("Eta")
        self.box.connect("STB")
        for reach in (self.at_once, self.asking, self.executing, self.between):
            self.box.start("STB")
            done = robot.did.count("execute STB")
            reach(robot, done)
            self.box.command("stop", "STB")
            self.box.wait_details("STB", lambda d: d.end_reason == "stopped", "it is stopped")
        self.box.start("STB")
        self.box.wait_details("STB", lambda d: d.phase == "running" and d.operation == 1, "it begins again")
        done = robot.did.count("execute STB")
        self.answer("STB")
        for times in (1, 2):
            self.goals_done(robot, done + times)
        said = self.listen()
        self.assertEqual(self.to_the_end("STB", after=1)[0]["", "completed"], 2)
        wait_until(lambda: said and not said[-1].progress, "nothing is said any more of a run that was left")

    def at_once(self, _robot: Robot, _done: int) -> None:
        pass

    def asking(self, _robot: Robot, _done: int) -> None:
        self.box.wait_details("STB", lambda d: d.operation == 1, "the referee is asked")

    def executing(self, robot: Robot, done: int) -> None:
        self.asking(robot, done)
        self.answer("STB")
        robot.wait_did("execute STB", done + 1)

    def between(self, robot: Robot, done: int) -> None:
        self.executing(robot, done)
        robot.let("execute")
