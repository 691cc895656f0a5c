"""HNF, whole, with dummy robot and dummy ground truth."""

from support.modules_case import FunctionalityCase

# The dummy world drives there in half a second, from when it hears of the goal.
EXECUTE_S = 2.5


class TestNavigation(FunctionalityCase):
    def test_hnf(self) -> None:
        robot = self.dummy_robot("Beta", execute_s=EXECUTE_S)
        scores, log = self.conduct("HNF")
        self.assertEqual((scores["", "reached"], scores["", "timed_out"]), (2, 0))
        self.assertTrue(all(0.0 <= error < 0.3 for error in self.of_each(scores, "distance_error")), scores)
        self.assertTrue(all(0.0 <= error < 0.5 for error in self.of_each(scores, "orientation_error")), scores)
        errors = self.of_each(scores, "distance_error")
        self.assertAlmostEqual(scores["", "position_accuracy"], sum(errors) / 2, places=6)
        self.assertTrue(all(seconds > EXECUTE_S - 0.1 for seconds in self.of_each(scores, "time")), scores)
        robot.wait_printed("executing pose Pose(x=0.5, y=1.0, theta=3.14)")
        self.assertEqual(log.values("/notification"), ["on my way"] * 2)

    def test_hnf_in_two_arenas_at_once(self) -> None:
        robots = {"HNF": self.dummy_robot("Beta", execute_s=EXECUTE_S),
                  "HNF 2": self.dummy_robot("Theta", execute_s=EXECUTE_S)}
        for zone in robots:
            self.begin(zone)
        for zone, pose in (("HNF", "Pose(x=0.5, y=1.0, theta=3.14)"), ("HNF 2", "Pose(x=1.5, y=2.0, theta=1.57)")):
            scores, _ = self.to_the_end(zone)
            self.assertEqual(scores["", "reached"], 2)
            self.assertTrue(all(0.0 <= error < 0.3 for error in self.of_each(scores, "distance_error")), scores)
            self.assertIn(f"executing pose {pose}", robots[zone].text)

    def test_hnf_with_a_robot_that_never_arrives(self) -> None:
        self.dummy_robot("Theta", "--never-end")
        self.begin("HNF late")
        scores, _ = self.to_the_end("HNF late", end_reason="goals_timed_out")
        self.assertEqual((scores["", "reached"], scores["", "timed_out"]), (0, 2))
        self.assertEqual((scores["", "position_accuracy"], scores["", "orientation_accuracy"]), (None, None))
        self.assertEqual(self.of_each(scores, "timed_out"), [True, True])
