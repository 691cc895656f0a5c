"""Starts the box again if it ends unexpectedly: what roslaunch does for a box with ROS.

The box is a process of its own. One that was killed, that crashed or that hangs is replaced by the next one within a
second, which continues its runs.
"""

import logging
import os
import signal
import subprocess
import time
import uuid
from typing import Callable, Sequence

from roah_rsbb.params import BadParams
from roah_rsbb.signs_of_life import HUNG_S, LOOK_S, SUPERVISOR, Watch, state_of

# Of the environment of the box: identifies the supervisor, so that `resume:=launch` continues after a crash only.
LAUNCH = "ROAH_RSBB_LAUNCH"
# Ended by itself: with success, an error that a restart does not repair, or wrong arguments.
ENDED = (0, 1, 2)
# Seconds, so that a box that crashes at once does not fill the log.
PAUSE_S = 0.5
# A box that was asked to end.
END_S = 10.0

_log = logging.getLogger(__name__)


def supervise(command: Sequence[str], again: Sequence[str], log_dir: Callable[[], str]) -> int:
    """Run a box until it ends by itself or this process is interrupted; returns its exit status.

    `command` starts it for the first time, and `again` continues its runs. `log_dir` returns that of the box, or raises
    `BadParams`: the box then says what is wrong, and ends.
    """
    environment = {**os.environ, LAUNCH: str(uuid.uuid4())}
    wishes: list = []  # signals that this process got
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda wish, _frame: wishes.append(wish))
    while True:
        status = _run(command, environment, wishes, log_dir)
        command = again
        if wishes or status in ENDED:
            return 0 if wishes else status
        _log.error("The box has ended unexpectedly (%s): the next one continues its runs", status)
        time.sleep(PAUSE_S)


def _run(command: Sequence[str], environment: dict, wishes: list, log_dir: Callable[[], str]) -> int:
    """Run one process of the box to its end; returns its exit status."""
    box, killed = subprocess.Popen(command, env=environment), 0
    until_mono = float("inf")
    try:
        watch = Watch(log_dir(), SUPERVISOR, time.monotonic)
    except BadParams:
        return box.wait()
    while True:
        try:
            status = box.wait(LOOK_S)
            watch.close()
            return status
        except subprocess.TimeoutExpired:
            watch.look()
        if wishes and until_mono == float("inf"):
            until_mono = time.monotonic() + END_S
            box.terminate()
        if time.monotonic() > until_mono:
            box.kill()
        if watch.is_hung and watch.silence.pid == box.pid != killed:
            killed = box.pid
            _log.error("The box (process %d) has not answered for %g s: %s. It is ended, and the next one continues "
                       "its runs", killed, HUNG_S, state_of(killed))
            watch.kill()
