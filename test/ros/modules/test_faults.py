"""Failures of the modules' processes and of the core."""

from support.modules_case import FaultsCase


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
