"""The box: the real nodes, in the namespace of the test's own process, with a competition made for the test."""

import os
import pathlib
import re
import shutil
import time
import xmlrpc.client
from typing import List, NamedTuple

import rosgraph
import rospy
import yaml
from crew import ROBOT, password_of
from namespaces import BROADCAST
from support.box_client import BoxClient
from support.programs import Program

from roah_rsbb.ros import connections

HERE = pathlib.Path(__file__).resolve().parent
# Whatever a robot misses in an outage, it has time for its goal afterwards.
GOAL_TIMEOUT_S = 60
# The run of HPFF ends by this timeout alone.
FOLLOWING_S = 14
_TICKS_PER_S = os.sysconf("SC_CLK_TCK")

# Each benchmark has a zone and a team of its own, so that all run at once.
TEAMS = {
    "HGTKMH": "Alpha", "HWV": "Beta", "HCFGAC": "Gamma", "HOPF": "Delta", "HNF": "Epsilon", "HPPF": "Zeta",
    "HPFF": "Eta", "HGMF": "Theta", "HOMF": "Iota", "STB": "Kappa",
}
SPEECH = "HSUF"  # of all teams at once


class Used(NamedTuple):
    """Return the resources that a process has used so far."""

    mono: float
    cpu_s: float

    def percent_since(self, before: "Used") -> float:
        """Per cent of one core since then."""
        return 100.0 * (self.cpu_s - before.cpu_s) / (self.mono - before.mono)


class Box(BoxClient):
    """The running box, and its client."""

    def __init__(self, folder: pathlib.Path, rounds: int) -> None:
        """`folder` is emptied for the box's files. Each benchmark can be run `rounds` times."""
        self.folder = folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        _write_competition(folder, rounds)
        os.environ.update(
            ROS_MASTER_URI="http://127.0.0.1:11311", ROS_IP="127.0.0.1", ROS_HOME=str(folder / "home"),
            ROS_LOG_DIR=str(folder / "log"))
        os.environ.pop("ROS_HOSTNAME", None)
        self.program = Program(
            "roslaunch", str(HERE / "box.launch.xml"), f"folder:={folder}", f"rsbb_host:={BROADCAST}")
        self.program.wait_printed("started core service")
        connections.init_node("test_net", disable_signals=True)
        super().__init__()
        self.wait_heard()
        self._core_pid = 0

    def close(self) -> None:
        """End it."""
        super().close()
        rospy.signal_shutdown("the test is over")
        self.program.close()
        (self.folder / "box.txt").write_text(self.program.text, encoding="utf-8")

    @property
    def core_pid(self) -> int:
        """The core's process."""
        uri = rosgraph.Master("/test_net").lookupNode("/roah_rsbb_core")
        return xmlrpc.client.ServerProxy(uri).getPid("/test_net")[2]

    def core_used(self) -> Used:
        """Return the resources that the core has used so far."""
        self._core_pid = self._core_pid or self.core_pid
        text = pathlib.Path(f"/proc/{self._core_pid}/stat").read_text(encoding="ascii")
        fields = text.rpartition(")")[2].split()
        return Used(time.monotonic(), (int(fields[11]) + int(fields[12])) / _TICKS_PER_S)

    def logs_of(self, code: str, number: int) -> List[pathlib.Path]:
        """The run logs of a benchmark in a round."""
        # Where all robots run at once, each has a log with its name in it.
        who = ROBOT if code == SPEECH else TEAMS[code]
        paths = sorted((self.folder / "logs").glob(f"online_log_*_{who}_round{number}_run1_*.bag"), key=_when_made)
        # Who was connected again has a newer one.
        return sorted({_team(path): path for path in paths}.values())


def _when_made(path: pathlib.Path) -> int:
    return path.stat().st_mtime_ns


def _team(path: pathlib.Path) -> str:
    return path.name.split("_")[4]


def _write_competition(folder: pathlib.Path, rounds: int) -> None:
    zones = []
    for code, team in [*TEAMS.items(), (SPEECH, "ALL")]:
        zones.append({"zone": code, "schedule": [
            {"benchmark": code, "team": team, "round": number, "run": 1,
             "scheduled_time": f"2015-12-31 {9 + number // 60:02}:{number % 60:02}:00"}
            for number in range(1, rounds + 1)]})
    # Times are no strings in a schedule.
    text = re.sub(r"'(2015-[^']*)'", r"\1", yaml.safe_dump(zones, sort_keys=False))
    (folder / "schedule.yaml").write_text(text, encoding="utf-8")
    passwords = {team: password_of(team) for team in TEAMS.values()}
    (folder / "passwords.yaml").write_text(yaml.safe_dump(passwords), encoding="utf-8")
    shutil.copytree(str(HERE.parent / "ros" / "config" / "modules"), str(folder / "modules"))
    for path in (folder / "modules").glob("*.yaml"):
        seconds = FOLLOWING_S if path.stem == "HPFF" else GOAL_TIMEOUT_S
        text = re.sub(r"(?m)^goal_timeout:.*$", f"goal_timeout: {seconds}", path.read_text(encoding="utf-8"))
        path.write_text(text, encoding="utf-8")
