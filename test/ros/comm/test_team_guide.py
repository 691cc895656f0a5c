"""The robot that docs/team.md shows completes benchmarks, and stops on request."""

import pathlib

from support.dummy_launch import COMM_IS_READY, comm_node
from support.modules_case import FunctionalityCase
from support.programs import Program

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "examples" / "my_ros_robot.py"
TEAM = "Alpha"
# A robot that prepares for longer than the stop takes on any machine.
SLOW = '''
import pathlib, sys
source = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
assert "WORK_S = 1.0" in source
exec(source.replace("WORK_S = 1.0", "WORK_S = 1000.0"))
'''


class TestTeamGuide(FunctionalityCase):
    def setUp(self) -> None:
        super().setUp()
        self.comm = self._leaving(comm_node(TEAM))
        self.comm.wait_printed(COMM_IS_READY)
        self.robot = self.start_robot()

    def start_robot(self, *python: str) -> Program:
        """`python`: how Python runs the example."""
        return self._leaving(Program("/usr/bin/python3", *python, str(EXAMPLE)))

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
        self.assertEqual(self.robot.warnings, [])
        self.assertNotIn("Traceback", self.robot.text)
        self.assertEqual(self.comm.warnings, [])
        self.stopped_while_it_prepares()

    def stopped_while_it_prepares(self) -> None:
        self.robot.close()
        robot = self.start_robot("-c", SLOW)
        self.begin("HGTKMH")
        robot.wait_printed("HGTKMH: preparing")
        stops = robot.text.count("stopped")
        self.box.command("stop", "HGTKMH")
        robot.wait_printed("stopped", times=stops + 1)
        self.assertNotIn("HGTKMH: executing", robot.text)
