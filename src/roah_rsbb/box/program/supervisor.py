"""Starts the box again if it ends unexpectedly, with ROS and without.

The box is a process of its own. One that was killed, that crashed or that hangs is replaced by the next one, which
continues its runs. One that fails again and again gets more time each time, because it may only be slow.
After `MOST_FAILURES` that were started in vain, the barest core is what is left (`barest.py`), unless a standby is
connected, which takes over. The same holds while a box that was killed cannot end because its disk hangs: it still has
the lock of the journal and the ports.

Beside the box runs the program that copies the journal, if it is to be copied: when the box does not answer, that one
hands over to the standby. It says all the time whether there is one that takes over (see `Lifeline`).
"""

import logging
import math
import os
import signal
import subprocess
import time
import uuid
from typing import Callable, List, Mapping, Optional, Sequence

from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.ground.linux import ending_signals, ignore_stops, status_of
from roah_rsbb.ground.params import BadParams
from roah_rsbb.ground.signs_of_life import (
    HUNG_S,
    LOG_DIR,
    LOOK_S,
    STANDBY,
    STARTING,
    TAKEN,
    Lifeline,
    Supervision,
    state_of,
)
from roah_rsbb.journal.copy_follower import PARENT, CopySettings

# Of the environment of the box: identifies the supervisor, so that `resume:=launch` continues after a crash only.
LAUNCH = "ROAH_RSBB_LAUNCH"
# An error that a restart does not repair, or wrong arguments.
FAILED = (1, 2)
# A signal ended the box in good order. Nobody wished it unless the supervisor got one, too.
BY_SIGNAL = 128 + signal.SIGTERM
# Somebody ended it, or too little memory: the box is not to blame.
KILLED = (BY_SIGNAL, *(-number for number in (signal.SIGTERM, getattr(signal, "SIGKILL", 9))))
# Seconds, so that a box that crashes at once does not fill the log.
PAUSE_S = 0.5
# Until a box gives its first sign of life, on a slow or busy computer; until the next one does.
START_S, RESTART_S = 60.0, 15.0
# A box that failed counts less, the longer it had answered: after so long it is forgotten.
STEADY_S = 5.0
# So many may fail in succession after the first one. One that answered until somebody killed it has not failed.
MOST_FAILURES = 3
# A box that was asked to end.
END_S = 10.0
# A process that was killed is gone in a moment, unless a disk that hangs keeps it.
ZOMBIE, KEPT_S = "Z", 4.0
# The program that copies, of `roah-rsbb`; seconds until it is started again: it says each time why it ended.
COPIES, COPYING_PAUSE_S = "copies", 5.0
BAREST_CORE = "barest"

_log = logging.getLogger(__name__)


class CopyingProcess:
    """The program that copies the journal, started again when it ends. Call `look` often."""

    def __init__(self, read: Callable[[], Optional[CopySettings]]) -> None:
        """`read` returns the settings, and None as long as they are not known; it may raise `BadParams`. The program is
        never started if nothing is to be copied."""
        self._read = read
        self._words: Optional[List[str]] = None
        self._process: Optional[subprocess.Popen] = None
        self._says = Supervision(time.monotonic)
        self._due_mono = float("-inf")

    def read(self) -> List[str]:
        """Return the settings as the program gets them; empty: it is not to be started, or not yet."""
        if self._words is None:
            settings = self._read()
            self._words = None if settings is None else settings.words
        return self._words or []

    def look(self) -> None:
        """Start it, if that is due."""
        if self.read() and time.monotonic() >= self._due_mono and (
                self._process is None or self._process.poll() is not None):
            self._says.close()
            self._says = Supervision(time.monotonic)
            self._process = self._says.start(
                without_ros(COPIES, *self.read()), {**os.environ, PARENT: str(os.getpid())})
            self._due_mono = time.monotonic() + COPYING_PAUSE_S

    def has_standby(self) -> bool:
        """Whether a standby takes over, or has. One of which nothing was heard lately is none. Call it often."""
        if self._process is not None:
            self._says.look(self._process.pid)
        standby = self._says.memory.get(STANDBY)
        return standby == TAKEN or (standby is not None and self._says.silence.is_alive)

    def end(self) -> None:
        """Let it copy what the box wrote last, and end it."""
        self._says.close()
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()  # it cannot end if it waits for a stick that hangs


class _Course:
    """The boxes until now, and how much time the present one has."""

    def __init__(self, start_s: float) -> None:
        self.was_heard = False  # any of them
        self.failures = 0.0  # in succession
        self.is_barest = False  # the present one
        self._start_s = start_s
        self.begin()

    def begin(self) -> None:
        """The next one starts."""
        self.answered_s, self._heard_mono = 0.0, float("inf")

    def heard(self, silent_s: float) -> None:
        """The present one gave its last sign of life so long ago."""
        self.was_heard, now_mono = True, time.monotonic()
        self._heard_mono = min(self._heard_mono, now_mono)
        self.answered_s = max(self.answered_s, now_mono - self._heard_mono - silent_s)

    def ended(self, has_failed: bool) -> None:
        """The present one ended unexpectedly."""
        self.failures = self._left() + has_failed

    @property
    def is_heard(self) -> bool:
        """Whether the present one gave a sign of life."""
        return self._heard_mono < float("inf")

    @property
    def patience_s(self) -> float:
        """How long the present one may be silent."""
        return HUNG_S * self._factor()

    @property
    def start_s(self) -> float:
        """How long its start may take."""
        return RESTART_S * self._factor() if self.failures or self.was_heard else self._start_s

    @property
    def pause_s(self) -> float:
        """How long to wait before the next one."""
        return PAUSE_S * self._factor()

    def _left(self) -> float:
        return max(0.0, self.failures - self.answered_s / STEADY_S)

    def _factor(self) -> float:
        return 2.0 ** max(0, min(math.ceil(self._left()), MOST_FAILURES) - 1)


def supervise(command: Sequence[str], again: Sequence[str],
              read: Callable[[Mapping[str, str]], Optional[CopySettings]], start_s: float = START_S) -> int:
    """Run a box until somebody ends it through its door or this process is interrupted; returns its exit status.

    `command` starts it for the first time, which may take `start_s` seconds, and `again` continues its runs. `read`
    reads its settings, of which its memory may say more (None: not yet), or raises `BadParams`: the box then says what
    is wrong, and ends.
    """
    environment = {**os.environ, LAUNCH: str(uuid.uuid4())}
    wishes: list = []  # signals that this process got
    for number in ending_signals():
        signal.signal(number, lambda wish, _frame: wishes.append(wish))
    ignore_stops()
    core, course = Supervision(time.monotonic), _Course(start_s)
    box = core.start(command, environment)
    copying = CopyingProcess(lambda: read(core.memory))
    try:
        copying.read()
    except BadParams:
        return box.wait()
    try:
        while True:
            is_ended = _watch(box, wishes, core, course, copying)
            if box.returncode is None and not wishes:
                _stop_robots_meanwhile(box, environment, wishes, core, copying)
            status = box.returncode
            # A box that ran before is started until it runs again: its files may be changed just now.
            if wishes or (status == 0 and not course.is_barest) or (status in FAILED and not course.was_heard):
                return 0 if wishes else status
            course.ended(is_ended or not course.is_heard or status not in KILLED)
            course.is_barest |= course.failures > MOST_FAILURES and not copying.has_standby()
            _log.error("The box has ended unexpectedly (%s): %s%s", status,
                       "it failed too often, and only sends STOP from now on" if course.is_barest
                       else "the next one continues its runs",
                       "" if course.is_heard else f", in {course.pause_s:g} s. Repair what it says is wrong")
            _wait(course.pause_s, wishes)
            course.begin()
            box = core.start(without_ros(BAREST_CORE) if course.is_barest else again, environment)
    finally:
        copying.end()
        core.close()


def _stop_robots_meanwhile(box: "subprocess.Popen[bytes]", environment: Mapping[str, str], wishes: list,
                           core: Supervision, copying: CopyingProcess) -> None:
    """Let the barest core stop the robots until the box that was killed is gone, or somebody ends the program."""
    _log.error("The box (process %d) was killed, and the system keeps it because the disk of log_dir hangs: the next "
               "one cannot start. Until the disk takes data again, all robots in runs are sent STOP. Check the disk",
               box.pid)
    while box.poll() is None and not wishes:
        course = _Course(RESTART_S)
        course.is_barest = True
        _watch(core.start(without_ros(BAREST_CORE), environment), wishes, core, course, copying,
               lambda: box.poll() is not None)


def _wait(seconds: float, wishes: list) -> None:
    until_mono = time.monotonic() + seconds
    while not wishes and time.monotonic() < until_mono:
        time.sleep(LOOK_S)


def _watch(box: subprocess.Popen, wishes: list, core: Supervision, course: _Course, copying: CopyingProcess,
           is_over: Callable[[], bool] = lambda: False) -> bool:
    """Wait for the end of one process of the box; returns whether it was ended here, because it did not answer. It is
    asked to end when somebody wishes that, or when it `is_over`."""
    is_killed, until_mono, heard_by_mono = False, float("inf"), time.monotonic() + course.start_s
    gone_by_mono = float("inf")
    signs: Optional[Lifeline] = None
    while True:
        time.sleep(LOOK_S)  # Popen.wait with a time looks twenty times as often
        box.poll()
        core.look(box.pid)
        silence = core.silence
        if silence.pid == box.pid:
            course.heard(silence.seconds)
        if box.returncode is not None:
            return is_killed
        has_standby, is_zombie = copying.has_standby(), status_of(box.pid)[0] == ZOMBIE
        is_dead = is_killed or is_zombie
        if is_dead:
            gone_by_mono = min(gone_by_mono, time.monotonic() + (0.0 if wishes and is_zombie else KEPT_S))
        if time.monotonic() >= gone_by_mono and (wishes or not has_standby):
            return True
        if signs is None and LOG_DIR in core.memory:
            signs = Lifeline(core.memory[LOG_DIR])
        if course.is_heard:
            copying.look()
        elif core.is_waiting:
            heard_by_mono = time.monotonic() + course.start_s
        elif time.monotonic() > heard_by_mono and not is_dead:
            is_killed = True
            _log.error("The box (process %d) has not started within %g s: %s. It is ended, and the next one starts",
                       box.pid, course.start_s, state_of(box.pid))
            box.kill()
        if signs is not None and not core.is_waiting and not silence.is_alive and not is_dead and not course.is_barest:
            signs.send(STARTING)  # the standby is to wait for it
        if until_mono == float("inf") and (wishes or is_over()):
            until_mono = time.monotonic() + END_S
            box.terminate()
        if time.monotonic() > until_mono:
            is_killed = True
            box.kill()
        if silence.pid == box.pid and silence.seconds >= course.patience_s and not is_killed:
            is_killed = True
            _log.error("The box (process %d) has not answered for %g s: %s. It is ended, and the next one continues "
                       "its runs", box.pid, course.patience_s, state_of(box.pid))
            box.kill()
