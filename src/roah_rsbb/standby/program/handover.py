"""Hands over to the standby when the core hangs or is gone, and no other core replaces it on this computer.

A supervisor (of roslaunch, or `box/program/supervisor.py`) starts a core that ended again, and ends one that hangs, so
that referees keep their panels and pages. If no core answers after that, for example because the disk does not, the
standby becomes the box. Before, the old core is ended, so that it can send nothing whatever happens to it, and the copy
is completed.
"""

import contextlib
import enum
import logging
import os
import signal
import threading
import time
from typing import Callable, Optional

from roah_rsbb.journal import epochs
from roah_rsbb.journal import file as files
from roah_rsbb.journal.log import NewerFormat
from roah_rsbb.signs_of_life import LOOK_S, Watch
from roah_rsbb.standby.remote import CoreState

# Seconds without a sign of life of any core, after which the box hands over: if nobody starts another core,
NOBODY_S = 3.0
# if the core that hangs still exists after it was killed, because it waits for its disk,
HUNG_S = 4.0
# if the next core is being started: it usually answers 1 to 4 s after the end of the one before.
STARTING_S = 20.0
# Seconds for the last part of the copy, and for the answer of the standby.
COPY_S, ANSWER_S = 3.0, 5.0

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
                 by: Callable[[], str], now: Callable[[], float] = time.monotonic) -> None:
        """`ask` has the copy completed, and then `complete` called with the question. `by` returns the address of the
        standby."""
        self._log_dir = log_dir
        self._is_connected, self._ask, self._by = is_connected, ask, by
        self._watch = Watch(log_dir, now)
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
        owner = Owner.NEXT if self._watch.is_starting else Owner.NOBODY
        if not silence.pid or not is_due(silence.seconds, owner, self._is_connected()):
            return
        self._watch.kill()
        lock: Optional[files.Lock] = None
        holder, owner = 0, Owner.HUNG
        if self._watch.is_gone:  # otherwise it has the journal, and the disk may block whoever opens the lock
            with contextlib.suppress(files.CannotWriteJournal):
                lock = files.lock(self._log_dir)
            owner = Owner.NEXT if lock is None else Owner.NOBODY
            holder = files.holder_of(self._log_dir) if lock is None else 0
        try:
            if is_due(silence.seconds, owner, self._is_connected()):
                self._hand_over(lock, holder)
        finally:
            self._is_handing_over = False
            if lock is not None:
                os.close(lock.fd)

    def _hand_over(self, lock: Optional[files.Lock], holder: int) -> None:
        if holder:
            with contextlib.suppress(OSError):
                os.kill(holder, signal.SIGKILL)
        _log.error("The core does not answer, and none was started again within %g s: handing over to the standby",
                   self._watch.silence.seconds)
        for event in (self._is_complete, self._is_taken):
            event.clear()
        self._question = object()
        self._ask(self._question)
        if not self._is_complete.wait(COPY_S):
            _log.error("The copy could not be completed: the standby may lack the last entries")
        self._is_handing_over = True
        if not self._is_taken.wait(ANSWER_S):
            _log.error("The standby does not take over: see its terminal. A core that is started here continues")
            return
        _log.error("The standby has taken over")
        self._watch.silence.forget()
        if lock is not None:  # otherwise the next core asks the standby before it begins
            try:
                epochs.hand_over(lock.path, time.time(), self._by())
            except (OSError, NewerFormat) as error:
                _log.error("%s cannot be written: %s", lock.path, error)
