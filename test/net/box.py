"""The box: the real programs, in the namespace of the test's own process, with a competition made for the test."""

import functools
import os
import pathlib
import re
import shutil
import sys
import time
from typing import List, NamedTuple

import yaml
from crew import ROBOT, password_of
from namespaces import BROADCAST
from support.door_client import DoorClient
from support.programs import Program
from support.waiting import wait_until

from roah_rsbb.client.places import DoorPlaces, door_file_in, read_place
from roah_rsbb.journal.bag import missing_bags
from roah_rsbb.journal.log_dir import holder_of
from roah_rsbb.journal.reader import JournalReader, journal_in

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


# How the box runs.
WITH_ROS, WITHOUT_ROS = "with ROS", "without ROS"


class Used(NamedTuple):
    """Return the resources that a process has used so far."""

    mono: float
    cpu_s: float

    def percent_since(self, before: "Used") -> float:
        """Per cent of one core since then."""
        return 100.0 * (self.cpu_s - before.cpu_s) / (self.mono - before.mono)


class Box(DoorClient):
    """The running box, and its client."""

    def __init__(self, folder: pathlib.Path, rounds: int, kind: str) -> None:
        """`folder` is emptied for the box's files. Each benchmark can be run `rounds` times. `kind`: WITH_ROS, or
        WITHOUT_ROS."""
        self.folder, self.log_dir = folder, folder / "logs"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        _write_competition(folder, rounds)
        if kind == WITHOUT_ROS:
            self.program = Program(sys.executable, str(HERE / "box_without_ros.py"), str(folder), BROADCAST,
                                   HOME=str(folder))
            find = functools.partial(read_place, door_file_in(str(self.log_dir)))
        else:
            os.environ.update(
                ROS_MASTER_URI="http://127.0.0.1:11311", ROS_IP="127.0.0.1", ROS_HOME=str(folder / "home"),
                ROS_LOG_DIR=str(folder / "log"))
            os.environ.pop("ROS_HOSTNAME", None)
            self.program = Program(
                "roslaunch", str(HERE / "box.launch.xml"), f"folder:={folder}", f"rsbb_host:={BROADCAST}")
            find = DoorPlaces(os.environ["ROS_MASTER_URI"]).find
        super().__init__(find, "test_net")
        wait_until(lambda: self.document, lambda: f"the box is heard; it printed\n{self.program.text}")

    def close(self) -> None:
        """End it."""
        super().close()
        self.program.close()
        (self.folder / "box.txt").write_text(self.program.text, encoding="utf-8")

    def core_used(self) -> Used:
        """Return the resources that the core has used so far."""
        text = pathlib.Path(f"/proc/{holder_of(str(self.log_dir))}/stat").read_text(encoding="ascii")
        fields = text.rpartition(")")[2].split()
        return Used(time.monotonic(), (int(fields[11]) + int(fields[12])) / _TICKS_PER_S)

    def has_all_logs(self) -> bool:
        """Whether all runs that are over have their logs."""
        return not missing_bags(JournalReader(journal_in(str(self.log_dir)), checks_all=False))

    def logs_of(self, code: str, number: int) -> List[pathlib.Path]:
        """The run logs of a benchmark in a round."""
        # Where all robots run at once, each has a log with its name in it.
        who = ROBOT if code == SPEECH else TEAMS[code]
        paths = sorted(self.log_dir.glob(f"online_log_*_{who}_round{number}_run1_*.bag"), key=_when_made)
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
