"""Team code built with the original package of each year completes a run; that of another year is named."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import rospkg
from support.box_case import BoxCase
from support.programs import Program
from support.robots import BROADCAST, PASSWORDS, RSBB_PORT, host_of

ROS_TESTS = pathlib.Path(__file__).resolve().parents[1]
ROOT = ROS_TESTS.parents[1]
ROBOT = ROS_TESTS / "support" / "inside" / "generation_robot.py"
TEAM, ZONE = "Alpha", "HGTKMH"
GENERATE = ("import sys; from genpy import genpy_main, generator; "
            "genpy_main.genmain(['', *sys.argv[1:]], 'generate', generator.MsgGenerator())")
TYPES = ("Benchmark", "BenchmarkState", "DevicesState")


def package_of(generation: str, folder: pathlib.Path) -> None:
    """Generate the Python package roah_rsbb_comm_ros of that year, as a team's workspace has it."""
    definitions, out = folder / "definitions", folder / "roah_rsbb_comm_ros" / "msg"
    definitions.mkdir()
    out.mkdir(parents=True)
    (out.parent / "__init__.py").touch()
    for name in TYPES:
        own = ROOT / "roah_rsbb_comm_ros" / "generations" / generation / f"{name}.msg"
        shutil.copy(own if own.exists() else ROOT / "msg" / f"{name}.msg", definitions)
    include = f"-Iroah_rsbb_comm_ros:{definitions}"
    files = [str(path) for path in sorted(definitions.glob("*.msg"))]
    subprocess.run([sys.executable, "-c", GENERATE, "-p", "roah_rsbb_comm_ros", "-o", str(out), include, *files],
                   check=True)
    subprocess.run([sys.executable, "-c", GENERATE, "--initpy", "-p", "roah_rsbb_comm_ros", "-o", str(out)], check=True)


class TestGenerations(BoxCase):
    def robot_of(self, generation: str) -> Program:
        """A team's program that was built with the types of that year."""
        folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder)
        package_of(generation, folder)
        path = f"{folder}:{os.environ['PYTHONPATH']}"
        return self._leaving(Program("env", f"PYTHONPATH={path}", sys.executable, str(ROBOT)))

    def comm(self, generation: str) -> Program:
        """The comm node, by the launch file of the original name."""
        return self._leaving(Program(
            "roslaunch", "roah_rsbb_comm_ros", "test.launch", f"team_name:={TEAM}", f"rsbb_key:={PASSWORDS[TEAM]}",
            f"rsbb_host:={BROADCAST}", f"rsbb_port:={RSBB_PORT}", f"bind_host:={host_of(TEAM)}",
            f"generation:={generation}"))

    def completes(self, generation: str) -> None:
        comm, robot = self.comm(generation), self.robot_of(generation)
        self.box.connect(ZONE)
        robot.wait_printed("HGTKMH")
        robot.wait_printed("dimmer")
        self.box.start(ZONE)
        self.box.wait_text(ZONE, "Benchmark completed by the robot")
        self.box.command("disconnect", ZONE)
        self.assertNotIn("WARN", comm.text)

    def test_2015(self) -> None:
        self.completes("2015")

    def test_2018(self) -> None:
        self.completes("2018")

    def test_2019(self) -> None:
        self.completes("2019")

    def test_2020(self) -> None:
        self.completes("2020")

    def test_a_program_of_another_generation_is_named(self) -> None:
        comm = self.comm("2020")
        self.robot_of("2018")
        comm.wait_printed("/generation_robot receives nothing from /roah_rsbb/benchmark")
        comm.wait_printed("Set this node's parameter generation to 2018")

    def test_the_package_is_found(self) -> None:
        self.assertTrue((pathlib.Path(rospkg.RosPack().get_path("roah_rsbb_comm_ros")) / "generations").is_dir())
