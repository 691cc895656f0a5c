"""Starts the box again if it ends unexpectedly: what roslaunch does for a box with ROS.

The box is a process of its own. One that was killed, that crashed or that hangs is replaced by the next one within a
second, which continues its runs. Beside it runs the program that copies the journal, if it is to be copied: when the
box does not answer, that one hands over to the standby.
"""

import logging
import os
import signal
import subprocess
import time
import uuid
from typing import Callable, Optional, Sequence

from roah_rsbb.arguments import without_ros
from roah_rsbb.copies.settings import CopySettings
from roah_rsbb.params import BadParams
from roah_rsbb.platform import ending_signals, ignore_stops
from roah_rsbb.signs_of_life import LOOK_S, STARTING, SUPERVISOR, Signs, Watch, state_of

# Of the environment of the box: identifies the supervisor, so that `resume:=launch` continues after a crash only.
LAUNCH = "ROAH_RSBB_LAUNCH"
# An error that a restart does not repair, or wrong arguments.
FAILED = (1, 2)
# It ends by a fault of its own: nobody killed it, and it could not say what to repair.
CRASHED = (-signal.SIGSEGV, -signal.SIGABRT, -7, -signal.SIGFPE, -signal.SIGILL)  # 7: SIGBUS, unknown to Windows
# A signal ended the box in good order. Nobody wished it unless the supervisor got one, too.
BY_SIGNAL = 128 + signal.SIGTERM
# Seconds, so that a box that crashes at once does not fill the log.
PAUSE_S, MOST_PAUSE_S = 0.5, 8.0
# Until a box gives its first sign of life, on a slow or busy computer.
START_S = 60.0
# A box that was asked to end.
END_S = 10.0
# The program that copies, of `roah-rsbb`; seconds until it is started again: it says each time why it ended.
COPIES, COPYING_PAUSE_S = "copies", 5.0

_log = logging.getLogger(__name__)


class CopyingProcess:
    """The program that copies the journal, started again when it ends. Call `look` often."""

    def __init__(self, settings: CopySettings) -> None:
        """It is never started if nothing is to be copied."""
        self._command = without_ros(COPIES, *settings.words) if settings.words else []
        self._process: Optional[subprocess.Popen] = None
        self._due_mono = float("-inf")

    def look(self) -> None:
        """Start it, if that is due."""
        if self._command and time.monotonic() >= self._due_mono and (
                self._process is None or self._process.poll() is not None):
            self._process, self._due_mono = subprocess.Popen(self._command), time.monotonic() + COPYING_PAUSE_S

    def end(self) -> None:
        """Let it copy what the box wrote last, and end it."""
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()  # it cannot end if it waits for a stick that hangs


def supervise(command: Sequence[str], again: Sequence[str], read: Callable[[], CopySettings]) -> int:
    """Run a box until somebody ends it through its door or this process is interrupted; returns its exit status.

    `command` starts it for the first time, and `again` continues its runs. `read` reads its settings, or raises
    `BadParams`: the box then says what is wrong, and ends.
    """
    environment = {**os.environ, LAUNCH: str(uuid.uuid4())}
    wishes: list = []  # signals that this process got
    for number in ending_signals():
        signal.signal(number, lambda wish, _frame: wishes.append(wish))
    ignore_stops()
    box = subprocess.Popen(command, env=environment)
    try:
        found = read()
    except BadParams:
        return box.wait()
    was_heard, pause_s = False, PAUSE_S
    copying, signs, watch = CopyingProcess(found), Signs(found.log_dir), Watch(
        found.log_dir, SUPERVISOR, time.monotonic)
    try:
        while True:
            is_heard = _watch(box, wishes, watch, signs, copying)
            status, was_heard = box.returncode, was_heard or is_heard
            # A box that ran before is started until it runs again: its files may be changed just now.
            if wishes or status == 0 or (status in FAILED and not was_heard):
                return 0 if wishes else status
            if status in CRASHED:
                watch.failed()
            pause_s = PAUSE_S if is_heard else min(2.0 * pause_s, MOST_PAUSE_S)
            _log.error("The box has ended unexpectedly (%s): the next one continues its runs%s", status,
                       "" if is_heard else f", in {pause_s:g} s. Repair what it says is wrong")
            _wait(pause_s, wishes)
            box = subprocess.Popen(again, env=environment)
    finally:
        copying.end()
        watch.close()


def _wait(seconds: float, wishes: list) -> None:
    until_mono = time.monotonic() + seconds
    while not wishes and time.monotonic() < until_mono:
        time.sleep(LOOK_S)


def _watch(box: subprocess.Popen, wishes: list, watch: Watch, signs: Signs, copying: CopyingProcess) -> bool:
    """Wait for the end of one process of the box; returns whether it ever gave a sign of life."""
    killed, is_heard, until_mono, heard_by_mono = 0, False, float("inf"), time.monotonic() + START_S
    while True:
        watch.wait(LOOK_S)  # Popen.wait with a time looks twenty times as often
        box.poll()
        watch.look()
        is_heard = is_heard or watch.silence.pid == box.pid
        if box.returncode is not None:
            return is_heard
        if is_heard or not watch.can_hear:
            copying.look()
        elif watch.waiting == box.pid:
            watch.waiting, heard_by_mono = 0, time.monotonic() + START_S
        else:
            signs.send(STARTING)  # the standby is to wait for it
            if time.monotonic() > heard_by_mono:
                _log.error("The box (process %d) has not started within %g s: %s. It is ended, and the next one "
                           "starts", box.pid, START_S, state_of(box.pid))
                watch.failed()
                box.kill()
        if wishes and until_mono == float("inf"):
            until_mono = time.monotonic() + END_S
            box.terminate()
        if time.monotonic() > until_mono:
            box.kill()
        if watch.is_hung and watch.silence.pid == box.pid != killed:
            killed = box.pid
            _log.error("The box (process %d) has not answered for %g s: %s. It is ended, and the next one continues "
                       "its runs", killed, watch.patience_s, state_of(killed))
            watch.kill()
