"""File names of run logs (docs/ros_interface.md, "Run log"), safe for all file systems."""

import os
import re
from typing import Container

from roah_rsbb.wording.times import formatted

SUFFIX = ".bag"
# Longest robot name in a file name (characters).
MAX_ROBOT_NAME = 40


def log_name(utc: float, team: str, robot: str, round_: int, run: int, box_uuid: str) -> str:
    """The file name of a run's log that begins at `utc` (s); `robot` is empty unless a team has several robots."""
    local = formatted(utc, "%Y-%m-%d_%H-%M-%S", in_utc=False)
    team = re.sub(r"[^\w.-]", "-", team)
    # The name comes from the robot: its characters and length are unchecked.
    robot = re.sub(r"[^A-Za-z0-9_.-]", "-", robot)[:MAX_ROBOT_NAME]
    who = f"{team}_{robot}" if robot else team
    return f"online_log_{local}_{who}_round{round_}_run{run}_{box_uuid}{SUFFIX}"


def unused(path: str, port: int, in_use: Container[str]) -> str:
    """The path, or one with the run's port if the path is in use.

    That happens if two robots have similar names, or if the same event was opened within one second.
    """
    if path not in in_use and not os.path.exists(path):
        return path
    return f"{path[:-len(SUFFIX)]}_port{port}{SUFFIX}"
