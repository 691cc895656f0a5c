"""A run's log (rosbag) from the journal's entries. This alone of all results needs ROS's Python, but no master."""

import os
from typing import List, Optional

from roah_rsbb.core import run_log
from roah_rsbb.results.run_result import RobotPart, RunResult


class NoBag(Exception):
    """The bag cannot be written; the text names the remedy."""


def write_bag(result: RunResult, port: Optional[int], path: str) -> int:
    """Write a new bag with all that belongs into the run log of a robot; returns the number of messages.

    `port`: of the robot; None: the run has only one. Raises `NoBag`.
    """
    try:
        from roah_rsbb.run_logs.bag_file import WRITE_ERRORS, write_whole
    except ImportError as error:
        raise NoBag(
            f"a bag cannot be written here ({error}): do it on a computer with ROS, from a copy of the journal"
        ) from None
    if os.path.exists(path):
        raise NoBag(f"{path}: there is such a file already: name another one")
    robot = _robot(result, port)
    entries = [(e.kind, e.value, e.utc) for e in result.entries if e.port == robot.port and e.kind in run_log.KINDS]
    try:
        write_whole(path, entries)
    except WRITE_ERRORS as error:
        raise NoBag(f"{path}: {error}: name another place, or make room there") from None
    return len(entries)


def _robot(result: RunResult, port: Optional[int]) -> RobotPart:
    robots: List[RobotPart] = [robot for robot in result.robots if port in (None, robot.port)]
    if len(robots) == 1:
        return robots[0]
    known = ", ".join(f"{robot.port} ({robot.robot} of team {robot.team})" for robot in result.robots)
    raise NoBag(f"say which robot's log it shall be, with --port: {known or 'this run has none'}")
