"""How long robots are alone when the core is killed: until the one that roslaunch starts then sends their state."""

import os
import signal
import threading
import time
from typing import List

from fleet import Awaited, Fleet
from processes import LaunchedBox, wait

from roah_rsbb.protocol import BoxState

# More than this, and the box is not coming back.
LIMIT_S = 30.0


def kill(box: LaunchedBox, fleet: Fleet) -> float:
    """Seconds from `kill -9` until the last robot in a run was sent its state; infinity: one was not."""
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
    """The same, so many times."""
    return [kill(box, fleet) for _ in range(count)]
