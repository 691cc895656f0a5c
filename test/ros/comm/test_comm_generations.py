"""Team code built with the original package of each year completes a run; that of another year is named."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import ClassVar

import rospkg
from support.box_case import BoxCase
from support.dummy_launch import COMM_IS_READY, comm_node, key_file
from support.programs import Program
from support.robots import BROADCAST, RSBB_PORT, host_of

ROS_TESTS = pathlib.Path(__file__).resolve().parents[1]
ROOT = ROS_TESTS.parents[1]
ROBOT = ROS_TESTS / "support" / "inside" / "generation_robot.py"
TEAM, ZONE = "Alpha", "HGTKMH"
GENERATE = """
import pathlib, sys
from genpy import genpy_main, generator

def generate(*arguments):
    try:
        genpy_main.genmain(["", "-p", "roah_rsbb_comm_ros", *arguments], "generate", generator.MsgGenerator())
    except SystemExit as ended:
        if ended.code:
            raise

for folder in map(pathlib.Path, sys.argv[1:]):
    out, definitions = str(folder / "roah_rsbb_comm_ros" / "msg"), folder / "definitions"
    generate("-o", out, f"-Iroah_rsbb_comm_ros:{definitions}", *map(str, sorted(definitions.glob("*.msg"))))
    generate("-o", out, "--initpy")
"""
GENERATIONS = ("2015", "2018", "2019", "2020")
TYPES = ("Benchmark", "BenchmarkState", "DevicesState")


def packages(folder: pathlib.Path) -> None:
    """Generate the Python package roah_rsbb_comm_ros of each year, as a team's workspace has it."""
    for generation in GENERATIONS:
        definitions, out = folder / generation / "definitions", folder / generation / "roah_rsbb_comm_ros" / "msg"
        definitions.mkdir(parents=True)
        out.mkdir(parents=True)
        (out.parent / "__init__.py").touch()
        for name in TYPES:
            own = ROOT / "roah_rsbb_comm_ros" / "generations" / generation / f"{name}.msg"
            shutil.copy(own if own.exists() else ROOT / "msg" / f"{name}.msg", definitions)
    folders = [str(folder / generation) for generation in GENERATIONS]
    subprocess.run([sys.executable, "-c", GENERATE, *folders], check=True)


class TestGenerations(BoxCase):
    folder: ClassVar[pathlib.Path]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        packages(cls.folder)

    @classmethod
    def tearDownClass(cls) -> None:
        shutil.rmtree(cls.folder)

    def robot_of(self, generation: str) -> Program:
        """A team's program that was built with the types of that year."""
        path = f"{self.folder / generation}:{os.environ['PYTHONPATH']}"
        return self._leaving(Program(sys.executable, str(ROBOT), PYTHONPATH=path))

    def comm(self, generation: str) -> Program:
        """The comm node for programs of that year."""
        return self._leaving(comm_node(TEAM, generation=generation))

    def comm_of_launch(self, generation: str) -> Program:
        """The same, by the launch file of the original name."""
        return self._leaving(Program(
            "roslaunch", "roah_rsbb_comm_ros", "test.launch", f"team_name:={TEAM}", "robot_name:=Dummy",
            f"rsbb_key_file:={key_file(TEAM)}", f"rsbb_host:={BROADCAST}", f"rsbb_port:={RSBB_PORT}",
            f"bind_host:={host_of(TEAM)}", f"generation:={generation}"))

    def completes(self, generation: str, comm: Program) -> None:
        comm.wait_printed(COMM_IS_READY)
        robot = self.robot_of(generation)
        self.box.connect(ZONE)
        robot.wait_printed("HGTKMH")
        robot.wait_printed("dimmer")
        self.box.start(ZONE)
        self.box.wait_text(ZONE, "Benchmark completed by the robot")
        self.box.command("disconnect", ZONE)
        self.assertEqual(comm.warnings, [])

    def test_2015(self) -> None:
        self.completes("2015", self.comm("2015"))

    def test_2018(self) -> None:
        self.completes("2018", self.comm_of_launch("2018"))

    def test_2019(self) -> None:
        self.completes("2019", self.comm("2019"))

    def test_2020(self) -> None:
        self.completes("2020", self.comm("2020"))

    def test_a_program_of_another_generation_is_named(self) -> None:
        comm = self.comm("2020")
        self.robot_of("2018")
        comm.wait_printed("/generation_robot receives nothing from /roah_rsbb/benchmark")
        comm.wait_printed("Set this node's parameter generation to 2018")

    def test_the_package_is_found(self) -> None:
        self.assertTrue((pathlib.Path(rospkg.RosPack().get_path("roah_rsbb_comm_ros")) / "generations").is_dir())
