"""Measures how long robots receive nothing after the core is killed, until roslaunch has restarted it."""

import os
import signal
import threading
import time
from typing import List

from fleet import Awaited, Fleet
from processes import LaunchedBox, wait

from roah_rsbb.protocol import BoxState

# After this time the box is considered dead.
LIMIT_S = 30.0


def kill(box: LaunchedBox, fleet: Fleet) -> float:
    """Seconds from `kill -9` until the last robot in a run receives its state, or infinity."""
    pid, taken, all_there = box.core_pid, [], threading.Event()

    def done(ms: float) -> None:
        taken.append(ms / 1e3)
        if len(taken) == len(fleet.robots):
            all_there.set()

    def begin() -> None:
        os.kill(pid, signal.SIGKILL)
        for robot in fleet.robots:
            robot.awaited = Awaited(BoxState.WAITING_RESULT, time.time_ns(), done)

    fleet.do(begin)
    all_there.wait(LIMIT_S)
    wait(lambda: box.core_pid != pid, "another core runs")
    return max(taken) if all_there.is_set() else float("inf")


def kills(box: LaunchedBox, fleet: Fleet, count: int) -> List[float]:
    """Repeat the measurement `count` times."""
    return [kill(box, fleet) for _ in range(count)]
