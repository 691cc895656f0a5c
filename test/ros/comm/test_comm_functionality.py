"""All functionality benchmarks in sequence, in one comm node and one dummy robot: goals of every type."""

from support.dummy_launch import DummyRobot
from support.modules_case import FunctionalityCase

from roah_rsbb.srv import Zone, ZoneUInt8


class TestOneAfterTheOther(FunctionalityCase):
    def setUp(self) -> None:
        super().setUp()
        self.robot = self._leaving(DummyRobot("Alpha", execute_duration=1.5))

    def test_all(self) -> None:
        for benchmark in (self.hnf, self.hgmf, self.homf, self.stb, self.hopf, self.hppf, self.hnf_again, self.hpff):
            benchmark()
        self.assertEqual(self.robot.warnings, [])
        self.assertNotIn("Traceback", self.robot.text)
        self.assertIsNone(self.robot.comm.ended_mono, self.robot.text)

    def hnf(self) -> None:
        scores, log = self.conduct("HNF")
        self.assertEqual((scores["", "reached"], scores["", "timed_out"]), (2, 0))
        self.assertEqual(log.values("/notification"), ["on my way"] * 2)
        self.robot.wait_printed("HNF: executing pose Pose(x=1.0, y=0.5, theta=0.0)")
        self.robot.wait_printed("HNF: executing pose Pose(x=0.5, y=1.0, theta=3.14)")

    def hnf_again(self) -> None:
        self.conduct("HNF")
        self.robot.wait_printed("HNF: executing pose Pose(x=0.5, y=1.0, theta=3.14)", times=2)

    def hgmf(self) -> None:
        scores, _ = self.conduct("HGMF")
        self.assertEqual(scores["", "objects"], 2)
        for number in (1, 2):
            self.robot.wait_printed(f"object_id {number}")

    def homf(self) -> None:
        """The referee enters the requested switches, then one too many, and damage."""
        entries = [((2, 3), 0), ((1, 2), 1)]

        def enter() -> None:
            pressed, damaged = entries.pop(0)
            for switch in pressed:
                self.box.call("omf_switches/button", ZoneUInt8, "HOMF", switch)
            self.box.call("omf_switches/damaged", ZoneUInt8, "HOMF", damaged)
            self.box.call("omf_switches/complete", Zone, "HOMF")
            self.box.wait_zone("HOMF", lambda z: not z.omf_complete, "they are confirmed")

        scores, log = self.conduct("HOMF", enter)
        self.assertEqual([scores["", name] for name in ("right", "wrong", "damaged")], [3, 1, 1])
        self.assertEqual(self.of_each(scores, "changed"), ["2, 3", "1, 2"])
        self.assertEqual(log.values("/notification"), ["switching"] * 2)
        self.robot.wait_printed("HOMF: executing initial_state (True, False, False), switches (2, 3)")
        self.robot.wait_printed("HOMF: executing initial_state (False, False, True), switches (1,)")

    def stb(self) -> None:
        scores, _ = self.conduct("STB")
        self.assertEqual(scores["", "completed"], 2)
        self.robot.wait_printed("STB: executing '{details: 4, goal: GOAL 1}'")

    def hopf(self) -> None:
        scores, _ = self.conduct("HOPF")
        self.assertIn(True, self.of_each(scores, "instance_right"), scores)  # it is always the red cup to the dummy

    def hppf(self) -> None:
        self.conduct("HPPF")
        self.robot.wait_printed("HPPF: complete, HppfResult(person_name='Annie'")

    def hpff(self) -> None:
        self.conduct("HPFF")
        self.assertNotIn("HPFF: complete", self.robot.text)
