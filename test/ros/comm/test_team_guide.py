"""The robot that docs/team.md shows completes benchmarks, and stops on request."""

import pathlib

from support.dummy_launch import comm_node
from support.modules_case import FunctionalityCase
from support.programs import Program

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "examples" / "my_ros_robot.py"
TEAM = "Alpha"


class TestTeamGuide(FunctionalityCase):
    def setUp(self) -> None:
        super().setUp()
        self.comm = self._leaving(comm_node(TEAM))
        self.robot = self._leaving(Program("/usr/bin/python3", str(EXAMPLE)))

    def test_one_benchmark_after_the_other(self) -> None:
        for zone in ("HGTKMH", "HWV"):
            self.begin(zone)
            self.box.wait_text(zone, "Benchmark completed by the robot")
            log = self.leave(zone)
            self.robot.wait_printed(f"{zone}: executing")
        self.assertEqual(log.values("/notification"), ["going to the door"])
        self.conduct("HNF")
        self.robot.wait_printed("HNF: executing 0.5 1.0 3.14")
        scores, _ = self.conduct("HOPF")
        self.assertIn(True, self.of_each(scores, "instance_right"), scores)
        scores, _ = self.conduct("HPPF")
        self.assertIn(True, self.of_each(scores, "recognised"), scores)
        self.assertNotIn("WARN", self.robot.text)
        self.assertNotIn("Traceback", self.robot.text)
        self.assertNotIn("WARN", self.comm.text)
        self.stopped_while_it_prepares()

    def stopped_while_it_prepares(self) -> None:
        preparations = self.robot.text.count("HGTKMH: preparing")
        self.begin("HGTKMH")
        self.robot.wait_printed("HGTKMH: preparing", times=preparations + 1)
        stops = self.robot.text.count("stopped")
        self.box.command("stop", "HGTKMH")
        self.robot.wait_printed("stopped", times=stops + 1)
        self.assertEqual(self.robot.text.count("HGTKMH: executing"), 1)
