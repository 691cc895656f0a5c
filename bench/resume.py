"""Measures how long robots receive nothing after the core is killed, until its supervisor has started it again."""

import os
import signal
import subprocess
import sys
import threading
import time
from typing import List, NamedTuple

from fleet import REGULAR_S, Awaited, Fleet
from load import ORIGINAL_PERIOD_S
from processes import Box, wait
from without_ros import BoxWithoutRos

from roah_rsbb.ground.signs_of_life import began
from roah_rsbb.journal.log_dir import holder_of
from roah_rsbb.protocol import BoxState

# After this time the box is considered dead.
LIMIT_S = 30.0
# While the journal is filled.
FILL_PERIOD_S, NOTE_BYTES = 0.05, 1000


class SupervisedBox(BoxWithoutRos):
    """A box without ROS, started again when it is killed. Use it as a context manager."""

    OPTIONS = ()


class Kill(NamedTuple):
    """Seconds until the last robot in a run received its state; infinity: one of them did not."""

    after_kill: float
    after_start: float  # of the next core's process
    import_rospy: float  # which a process took right afterwards, with the start of Python


def kill(box: Box, fleet: Fleet) -> Kill:
    """Kill the core (`kill -9`)."""
    log_dir = str(box.log_dir)
    pid, taken, all_there = holder_of(log_dir), [], threading.Event()

    def done(ms: float) -> None:
        taken.append(ms / 1e3)
        if len(taken) == len(fleet.robots):
            all_there.set()

    def begin() -> None:
        os.kill(pid, signal.SIGKILL)
        for robot in fleet.robots:
            robot.awaited = Awaited(BoxState.WAITING_RESULT, time.time_ns(), done)

    killed_s = time.clock_gettime(time.CLOCK_BOOTTIME)
    fleet.do(begin)
    all_there.wait(LIMIT_S)
    wait(lambda: holder_of(log_dir) not in (0, pid), "another core runs")
    started_s = int(began(holder_of(log_dir))) / os.sysconf("SC_CLK_TCK")
    after_kill = max(taken) if all_there.is_set() else float("inf")
    imported_mono = time.monotonic()
    subprocess.run([sys.executable, "-c", "import rospy"], check=True)
    return Kill(after_kill, after_kill - (started_s - killed_s), time.monotonic() - imported_mono)


def kills(box: Box, fleet: Fleet, count: int) -> List[Kill]:
    """Repeat the measurement `count` times.

    A box that was started again waits for a robot's first message, so the robots repeat theirs more often than each
    second: what is measured is the box, and not the wait for the robots.
    """
    fleet.keep_sending(ORIGINAL_PERIOD_S)
    return [kill(box, fleet) for _ in range(count)]


def fill(box: Box, fleet: Fleet, size: int) -> None:
    """Let robots send texts until the journal has so many bytes."""
    for robot in fleet.robots:
        robot.note_bytes = NOTE_BYTES
    fleet.keep_sending(FILL_PERIOD_S)
    wait(lambda: sum(path.stat().st_size for path in box.log_dir.rglob("*") if path.is_file()) >= size,
         "the journal is large", 600.0)
    for robot in fleet.robots:
        robot.note_bytes = 0
    fleet.keep_sending(REGULAR_S)
