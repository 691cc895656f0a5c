"""HGMF, HOMF and STB, whole, with dummy robot and dummy ground truth."""

import json

from support.modules_case import FunctionalityCase

from roah_rsbb.srv import Zone, ZoneUInt8


class TestHandling(FunctionalityCase):
    def test_stb(self) -> None:
        self.dummy_robot("Eta")
        scores, log = self.conduct("STB")
        self.assertEqual(scores["", "completed"], 2)
        self.assertEqual(self.of_each(scores, "result"), ["SOME RESULT"] * 2)
        self.assertAlmostEqual(scores["", "execution_time"], sum(self.of_each(scores, "time")), places=6)
        self.assertEqual(log.values("/rsbb_log/manual_operation"), [
            "First Manual Operation", "First Manual Operation: done", "Last Manual Operation",
            "Last Manual Operation: done",
        ])
        self.assertEqual([json.loads(goal)["text"] for goal in log.values("/rsbb_log/bmbox/goal")],
                         ["GOAL 1", 'go: [there, "ä"]'])

    def test_hgmf(self) -> None:
        robot = self.dummy_robot("Epsilon", execute_s=4.0)  # the dummy world carries the object in 2 s
        scores, log = self.conduct("HGMF")
        self.assertEqual((scores["", "grasped"], scores["", "objects"]), (2, 2))
        self.assertEqual(set(self.of_each(scores, "object")), {"red cup", "blue cup"})
        self.assertTrue(all(0.0 <= error < 0.3 for error in self.of_each(scores, "distance_error")), scores)
        self.assert_mean(scores, "distance_error")
        goals = [json.loads(goal)["goal"] for goal in log.values("/rsbb_log/bmbox/goal")]
        self.assertEqual({json.loads(goal)[2] for goal in goals}, {1, 2})
        for number in (1, 2):
            robot.wait_printed(f"object_id {number}")

    def test_homf(self) -> None:
        """The robot first toggles the requested switches, then one too many, and damages one."""
        robot = self.dummy_robot("Zeta")
        entries = [((2, 3), 0), ((1, 2), 1)]

        def enter() -> None:
            pressed, damaged = entries.pop(0)
            for switch in pressed:
                self.box.call("omf_switches/button", ZoneUInt8, "HOMF", switch)
            self.box.call("omf_switches/damaged", ZoneUInt8, "HOMF", damaged)
            self.box.call("omf_switches/complete", Zone, "HOMF")
            self.box.wait_zone("HOMF", lambda z: not z.omf_complete, "they are confirmed")

        scores, _ = self.conduct("HOMF", enter)
        self.assertEqual([scores["", name] for name in ("right", "wrong", "damaged")], [3, 1, 1])
        self.assertEqual(self.of_each(scores, "changed"), ["2, 3", "1, 2"])
        robot.wait_printed("initial_state (True, False, False), switches (2, 3)")
