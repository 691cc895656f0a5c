"""Hands over to the standby when the core hangs or is gone, and no other core replaces it on this computer.

A supervisor (of roslaunch, or `box/program/supervisor.py`) starts a core that ended again, and ends one that hangs, so
that referees keep their panels and pages. If no core answers after that, for example because the disk does not, the
standby becomes the box. Before, the old core is ended, so that it can send nothing whatever happens to it, and the copy
is completed.
"""

import contextlib
import enum
import functools
import logging
import os
import signal
import threading
import time
from typing import Callable, Optional, Tuple

from roah_rsbb.ground.signs_of_life import CONNECTED, LOOK_S, STANDBY, TAKEN, Lifeline, Watch
from roah_rsbb.journal import epochs
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.log import NewerFormat
from roah_rsbb.standby.remote import CoreState

# Seconds without a sign of life of any core, after which the box hands over: if nobody starts another core,
NOBODY_S = 3.0
# if the core that hangs still exists after it was killed, because it waits for its disk,
HUNG_S = 4.0
# if the next core is being started: it usually answers 1 to 4 s after the end of the one before.
STARTING_S = 20.0
# Seconds for the last part of the copy, and for the answer of the standby.
COPY_S, ANSWER_S = 3.0, 5.0
# For the lock of the journal. A disk that hangs gives none.
LOCK_S = 2.0

_log = logging.getLogger(__name__)


class Owner(enum.Enum):
    """Who has the journal of this computer."""

    NOBODY = "nobody"
    HUNG = "hung"  # the core that does not answer
    NEXT = "next"  # a core that is starting


PATIENCE_S = {Owner.NOBODY: NOBODY_S, Owner.HUNG: HUNG_S, Owner.NEXT: STARTING_S}


def is_due(silent_s: float, owner: Owner, is_connected: bool) -> bool:
    """Whether to hand over now. `silent_s`: since the last sign of life of a core; `is_connected`: the standby is."""
    return is_connected and silent_s >= PATIENCE_S[owner]


class Handover:
    """Watches the core, in a thread, and hands over."""

    def __init__(self, log_dir: str, is_connected: Callable[[], bool], ask: Callable[[object], None],
                 by: Callable[[], str], lifeline: Lifeline, now: Callable[[], float] = time.monotonic) -> None:
        """`ask` has the copy completed, and then `complete` called with the question. `by` returns the address of the
        standby. `lifeline`: to the supervisor, which counts on a standby that takes over."""
        self._log_dir = log_dir
        self._is_connected, self._ask, self._by = is_connected, ask, by
        self._watch = Watch(log_dir, now)
        self._lifeline, self._said, self._is_refused = lifeline, "", False
        self._is_handing_over = False
        self._question: object = None
        self._is_complete, self._is_taken, self._ended = threading.Event(), threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._work, name="handover", daemon=True)

    def start(self) -> None:
        """Start to watch."""
        self._thread.start()

    def end(self) -> None:
        """End the thread soon."""
        self._ended.set()

    def state(self) -> CoreState:
        """From any thread: what the standby hears of the core."""
        return CoreState(self._watch.silence.is_alive, self._is_handing_over)

    def complete(self, question: object) -> bool:
        """From any thread: the copy is complete. Returns whether this was the question of a handover."""
        is_own = question is self._question
        if is_own:
            self._is_complete.set()
        return is_own

    def taken(self) -> None:
        """From any thread: the standby becomes the box."""
        self._is_taken.set()

    def _work(self) -> None:
        while not self._ended.wait(LOOK_S):
            self.look()
        self._watch.close()

    def look(self) -> None:
        """Hand over, if that is due."""
        self._watch.look()
        silence = self._watch.silence
        self._is_refused &= not silence.is_alive
        self._inform()
        owner = Owner.NEXT if self._watch.is_starting else Owner.NOBODY
        if not silence.pid or not is_due(silence.seconds, owner, self._is_connected()):
            return
        if self._is_refused and self._lifeline.has_supervisor:
            return  # it stops the robots: see `box/program/supervisor.py`
        self._watch.kill()
        lock: Optional[log_dirs.Lock] = None
        holder, owner = 0, Owner.HUNG
        if self._watch.is_gone:  # otherwise it has the journal
            lock, holder, owner = self._lock()
        try:
            if is_due(silence.seconds, owner, self._is_connected()):
                self._hand_over(lock, holder)
        finally:
            self._is_handing_over = False
            if lock is not None:
                os.close(lock.fd)

    def _inform(self) -> None:
        """Let the supervisor know whether a standby takes over."""
        says = TAKEN if self._is_taken.is_set() else CONNECTED if self._is_connected() and not self._is_refused else ""
        if says != self._said:
            self._said = says
            if says:
                self._lifeline.keep(STANDBY, says)
            else:
                self._lifeline.drop(STANDBY)
        self._lifeline.send()

    def _wait(self, event: threading.Event, seconds: float) -> bool:
        """Wait for an event, and let the supervisor know meanwhile; returns whether it came."""
        until_mono = time.monotonic() + seconds
        while not event.wait(LOOK_S) and time.monotonic() < until_mono:
            self._inform()
        return event.is_set()

    def _lock(self) -> Tuple[Optional[log_dirs.Lock], int, Owner]:
        """Lock the journal, if the disk allows that in time; returns the lock, or who has it."""
        trial = _Trial(functools.partial(log_dirs.lock, self._log_dir))
        self._wait(trial.ended, LOCK_S)
        lock = trial.take()
        if lock is not None:
            return lock, 0, Owner.NOBODY
        return None, log_dirs.holder_of(self._log_dir), Owner.NEXT if trial.ended.is_set() else Owner.HUNG

    def _hand_over(self, lock: Optional[log_dirs.Lock], holder: int) -> None:
        if holder:
            with contextlib.suppress(OSError):
                os.kill(holder, signal.SIGKILL)
        _log.error("The core does not answer, and none was started again within %g s: handing over to the standby",
                   self._watch.silence.seconds)
        for event in (self._is_complete, self._is_taken):
            event.clear()
        self._question = object()
        self._ask(self._question)
        if not self._wait(self._is_complete, COPY_S):
            _log.error("The copy could not be completed: the standby may lack the last entries")
        self._is_handing_over = True
        if not self._wait(self._is_taken, ANSWER_S):
            self._is_refused = True
            _log.error("The standby does not take over: see its terminal. A core that is started here continues")
            return
        _log.error("The standby has taken over")
        self._watch.silence.forget()
        if lock is not None:  # otherwise the next core asks the standby before it begins
            try:
                epochs.hand_over(lock.path, time.time(), self._by())
            except (OSError, NewerFormat) as error:
                _log.error("%s cannot be written: %s", lock.path, error)


class _Trial:
    """Locks the journal in a thread of its own. A lock that comes too late is given back."""

    def __init__(self, lock: Callable[[], log_dirs.Lock]) -> None:
        self.ended = threading.Event()
        self._lock, self._is_late, self._mutex = lock, False, threading.Lock()
        self._found: Optional[log_dirs.Lock] = None
        threading.Thread(target=self._work, name="lock for the handover", daemon=True).start()

    def _work(self) -> None:
        found: Optional[log_dirs.Lock] = None
        with contextlib.suppress(log_dirs.CannotWriteJournal):
            found = self._lock()
        with self._mutex:
            if self._is_late and found is not None:
                os.close(found.fd)
            elif not self._is_late:
                self._found = found
        self.ended.set()

    def take(self) -> Optional[log_dirs.Lock]:
        """Return the lock; None: there is none, and none is kept that comes from now on."""
        with self._mutex:
            self._is_late = True
            return self._found
