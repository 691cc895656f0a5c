"""HOPF and HPPF, whole, with dummy robot and dummy ground truth."""

from support.modules_case import FunctionalityCase


class TestPerception(FunctionalityCase):
    def test_hopf(self) -> None:
        """The dummy robot always reports a red cup."""
        self.dummy_robot("Alpha")
        scores, log = self.conduct("HOPF")
        self.assertEqual((scores["", "class_accuracy"], scores["", "instance_accuracy"]), (1.0, 0.5))
        self.assertEqual(
            dict(zip(self.of_each(scores, "item"), self.of_each(scores, "instance_right"))),
            {"red cup": True, "blue cup": False},
        )
        self.assert_mean(scores, "pose_score")
        self.assertTrue(all(0.0 < score < 1.0 for score in self.of_each(scores, "pose_score")), scores)
        self.assertEqual(len(log.values("/rsbb_log/opf_result")), 2)

    def test_hppf(self) -> None:
        """The dummy robot always reports Annie."""
        self.dummy_robot("Gamma", execute_s=2.5)  # usually, the dummy world has moved the person long before
        scores, _ = self.conduct("HPPF")
        self.assertEqual((scores["", "detected"], scores["", "recognised"]), (2, 1))
        self.assertEqual(
            dict(zip(self.of_each(scores, "name"), self.of_each(scores, "recognised"))), {"annie": True, "Tom": False}
        )
        self.assert_mean(scores, "distance_error")
        self.assertLess(scores["", "distance_error"], 5.0, "in metres, and in one room")
