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
from typing import Callable, Sequence, Tuple

from roah_rsbb.params import BadParams
from roah_rsbb.platform import ending_signals
from roah_rsbb.signs_of_life import HUNG_S, LOOK_S, SUPERVISOR, Watch, state_of

# Of the environment of the box: identifies the supervisor, so that `resume:=launch` continues after a crash only.
LAUNCH = "ROAH_RSBB_LAUNCH"
# An error that a restart does not repair, or wrong arguments.
FAILED = (1, 2)
# Seconds, so that a box that crashes at once does not fill the log.
PAUSE_S, MOST_PAUSE_S = 0.5, 8.0
# Until a box gives its first sign of life, on a slow or busy computer.
START_S = 60.0
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
    for number in ending_signals():
        signal.signal(number, lambda wish, _frame: wishes.append(wish))
    was_heard, pause_s = False, PAUSE_S
    while True:
        status, is_heard = _run(command, environment, wishes, log_dir)
        command, was_heard = again, was_heard or is_heard
        # A box that ran before is started until it runs again: its files may be changed just now.
        if wishes or status == 0 or (status in FAILED and not was_heard):
            return 0 if wishes else status
        pause_s = PAUSE_S if is_heard else min(2.0 * pause_s, MOST_PAUSE_S)
        _log.error("The box has ended unexpectedly (%s): the next one continues its runs%s", status,
                   "" if is_heard else f", in {pause_s:g} s. Repair what it says is wrong")
        _wait(pause_s, wishes)


def _wait(seconds: float, wishes: list) -> None:
    until_mono = time.monotonic() + seconds
    while not wishes and time.monotonic() < until_mono:
        time.sleep(LOOK_S)


def _run(command: Sequence[str], environment: dict, wishes: list, log_dir: Callable[[], str]) -> Tuple[int, bool]:
    """Run one process of the box to its end; returns its exit status, and whether it ever gave a sign of life."""
    box, killed, is_heard = subprocess.Popen(command, env=environment), 0, False
    until_mono, heard_by_mono = float("inf"), time.monotonic() + START_S
    try:
        watch = Watch(log_dir(), SUPERVISOR, time.monotonic)
    except BadParams:
        return box.wait(), False
    while True:
        time.sleep(LOOK_S)  # Popen.wait with a time looks twenty times as often
        box.poll()
        watch.look()
        is_heard = is_heard or watch.silence.pid == box.pid
        if box.returncode is not None:
            watch.close()
            return box.returncode, is_heard
        if not is_heard and watch.can_hear and time.monotonic() > heard_by_mono:
            _log.error("The box (process %d) has not started within %g s: %s. It is ended, and the next one starts",
                       box.pid, START_S, state_of(box.pid))
            box.kill()
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
