"""Names of run logs (docs/ros_interface.md, "Run log"), without anything in them that a file system minds."""

import os
import re
import time
from typing import Container

SUFFIX = ".bag"
# Characters of a robot's name in the name of a file.
MAX_ROBOT_NAME = 40
_UUID = r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}"
_LOG_NAME = re.compile(rf"online_log_\d{{4}}(-\d\d){{2}}_\d\d(-\d\d){{2}}_.+_{_UUID}(_port\d+)?\{SUFFIX}")


def log_name(utc: float, team: str, robot: str, round_: int, run: int, box_uuid: str) -> str:
    """The name of a run's log that begins at `utc` (s); `robot` only where several of a team may be in the run."""
    local = time.strftime("%Y-%m-%d_%H-%M-%S", time.localtime(utc))
    team = re.sub(r"[^\w.-]", "-", team)
    # A robot's name comes from the robot: what is in it, and how long it is, nobody has checked.
    robot = re.sub(r"[^A-Za-z0-9_.-]", "-", robot)[:MAX_ROBOT_NAME]
    who = f"{team}_{robot}" if robot else team
    return f"online_log_{local}_{who}_round{round_}_run{run}_{box_uuid}{SUFFIX}"


def unused(path: str, port: int, in_use: Container[str]) -> str:
    """The path itself, or with the run's port in it when there is such a log: of a robot whose name looks the
    same, or of the same event a moment ago."""
    if path not in in_use and not os.path.exists(path):
        return path
    return f"{path[:-len(SUFFIX)]}_port{port}{SUFFIX}"


def is_log_name(name: str) -> bool:
    """Whether a file of this name is a run log of a box."""
    return _LOG_NAME.fullmatch(name) is not None
