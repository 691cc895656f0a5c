"""The dummy set-up with dummy robots of several teams, and dummy robots that cannot be."""

import contextlib
import os
import pathlib

from support.box_case import PACKAGE, NetworkCase
from support.box_client import BoxClient
from support.programs import Program, own
from support.robots import BOX, BROADCAST, CONFIG, PASSWORDS, RSBB_PORT
from support.waiting import wait_until

LOG_DIR = os.path.join(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros")), "roah_rsbb_test")
FILES = {
    "benchmarks_file": CONFIG.parents[2] / "config" / "benchmarks.yaml", "schedule_file": CONFIG / "dummy_set_up.yaml",
    "passwords_file": CONFIG / "passwords.yaml",
}


def command_lines() -> str:
    """The data of processes that every user of this machine can read."""
    lines = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # processes end meanwhile
            lines.append(path.read_text(errors="replace").replace("\0", " "))
    return "\n".join(lines)


class TestDummySetUp(NetworkCase):
    def test_three_robots(self) -> None:
        """The teams of the schedule come first, then others that have a password."""
        files = (f"{name}:={path}" for name, path in FILES.items())
        launched = self._leaving(Program(
            "roslaunch", PACKAGE, "roah_rsbb_dummy.launch", "robots:=3", "gui:=none", "tablet:=false",
            "devices:=false", "modules:=false", "ground_truth:=false", f"rsbb_host:={BROADCAST}",
            f"rsbb_port:={RSBB_PORT}", f"bind_host:={BOX}", f"log_dir:={LOG_DIR}", *files,
        ))
        box = BoxClient()
        self.addCleanup(box.close)
        box.wait_heard()
        wait_until(lambda: len(box.gui.active_robots) == 3, lambda: f"three robots are active:\n{box.gui}")
        self.assertEqual({robot.team for robot in box.gui.active_robots}, {"Gamma", "Beta", "Alpha"})
        for number, team in enumerate(("Gamma", "Beta", "Alpha"), 2):
            launched.wait_printed(f"A dummy robot of team {team} at 127.0.0.{number}")
        self.assertNotIn(PASSWORDS["Gamma"], command_lines() + launched.text)
        box.connect("Hall")
        box.start("Hall")
        box.wait_text("Hall", "Benchmark completed by the robot")
        launched.wait_printed("Gamma: HGTKMH: complete")


class TestThatCannotBe(NetworkCase):
    """The node alone, on its own public ports."""

    def node(self, port: int, **params: object) -> Program:
        given = {"rsbb_port": RSBB_PORT + port, **FILES, **params}
        return self._leaving(Program(
            own("dummy_robots"), f"__name:=dummies_{port}",
            *(f"_{name}:={value}" for name, value in given.items()),
        ))

    def assert_ended(self, node: Program, *texts: str) -> None:
        self.assertEqual(node.wait_ended(), 1)
        for text in texts:
            self.assertIn(text, node.text)
        self.assertNotIn("Traceback", node.text)

    def test_more_than_there_are_teams(self) -> None:
        teams = len(PASSWORDS)
        node = self.node(50, robots=teams + 1)
        node.wait_printed(f"{teams} dummy robots instead of {teams + 1}: {CONFIG}")
        node.wait_printed("A dummy robot of team", times=teams)

    def test_wrong_parameters(self) -> None:
        self.assert_ended(self.node(60, robots=0, passwords_file=""),
                          "parameter /dummies_60/robots: found 0, expected a whole number from 1 to 200",
                          "parameter /dummies_60/passwords_file: found nothing, expected a path")

    def test_files_with_errors(self) -> None:
        self.assert_ended(self.node(70, schedule_file=CONFIG / "broken" / "schedule.yaml"),
                          "no dummy robots: the configuration is invalid, see the errors of the core")

    def test_a_name_for_no_address(self) -> None:
        self.assert_ended(self.node(80, rsbb_host="no.such.host.invalid"),
                          "the dummy robot of team Gamma ended: ", "no.such.host.invalid")
