"""Writes the journal.

Theory of operation. `write` takes the changes of one event. A thread hands them to the system at once, so that they
survive the process, and another one syncs them to the disk soon after (`Syncer`). `write` waits for the first of them,
but not for a disk that hangs: `is_waiting` says whether it does, and `on_written` is called when it takes data again.
Data that cannot be written (a full disk, a missing folder) waits in memory and is written, in order, with the next
write that succeeds. Runs continue in the meantime.

Each write has a ticket, a rising number. `saved` is the newest ticket on the disk, and `why_not_saved` waits for one.

Call all methods except `why_not_saved` and `earlier_damage` in one thread.
"""

import contextlib
import os
import threading
import time
from collections import deque
from typing import Any, Callable, Deque, Iterator, List, Optional, Sequence, Tuple, Type

from roah_rsbb.document.difference import SAME, difference
from roah_rsbb.ground import durable
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal import records
from roah_rsbb.journal.contents import Opened
from roah_rsbb.journal.log import Files, Log, NewerFormat, read_chain
from roah_rsbb.journal.log_dir import (
    NOTHING,
    CannotWriteJournal,
    CoreSession,
    DamagedJournal,
    Lock,
    PreviousSession,
    Resume,
    read_previous_session,
)
from roah_rsbb.journal.records import COMPLETE_EVERY, Batch, ChangesReader, Lines, Top

# Records within this time (s) are synced together. It is half of what a power failure may lose (docs/architecture.md,
# "Write first, then act").
GROUP_S = 0.05
# Failed writes and syncs are retried after this time.
RETRY_S = 0.5
# Longest time that scores and sign-offs wait for the disk.
SYNC_TIMEOUT_S = 2.0
# A disk that takes longer than this is reported.
SLOW_S = 1.0
# For so long `write` waits. A file is usually written in 0.05 ms, and nothing else happens in the box meanwhile.
WRITE_S = 0.005

# Reported when a problem is over.
REPAIRED = ""

_AT_STAKE = "Runs continue, but what happens now is lost if the box ends or this computer is switched off"
_HANGS = ("takes no data. Robots get STOP at once, but nothing else that is new before it is written. Check the "
                 "disk of log_dir, or use another one")


class Syncer:
    """Calls `work` after `wake`. All methods may be called from any thread. The simulator has another one."""

    def __init__(self, work: Callable[[], bool], group_s: float) -> None:
        """`work` writes or syncs everything, `group_s` after `wake`, and returns whether it succeeded; otherwise it is
        repeated."""
        self._work, self._group_s = work, group_s
        self._changed = threading.Condition()
        self._is_wanted = self._hurry = self._ended = False
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Work soon."""
        with self._changed:
            if not self._is_wanted:
                self._is_wanted = True
                self._changed.notify_all()

    def work(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """`wake` and `wait`, in one step."""
        with self._changed:
            self._is_wanted = self._hurry = True
            self._changed.notify_all()
            if self._ended:  # nobody works any more
                return is_done()
            return self._changed.wait_for(is_done, timeout)

    def wait(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """Work now, and wait until something is done, at most `timeout` seconds; returns whether it is."""
        with self._changed:
            self._hurry = True
            self._changed.notify_all()
            return self._changed.wait_for(is_done, timeout)

    def end(self) -> None:
        """Do the rest, and end the thread."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join()

    def _run(self) -> None:
        ended, succeeded = False, True
        while not ended:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._is_wanted)
                self._changed.wait_for(lambda: self._ended or self._hurry, self._group_s if succeeded else RETRY_S)
                is_wanted, ended = self._is_wanted, self._ended
                self._hurry = self._is_wanted = False
            if is_wanted:
                succeeded = self._work()
                with self._changed:
                    self._is_wanted = self._is_wanted or not succeeded
                    self._changed.notify_all()


class Writer:
    """Adds to one journal. Call all methods in one thread; `log.sync` may be called in another."""

    def __init__(self, folder: str, opened: Opened, files: Optional[Files] = None) -> None:
        """`opened`: what is in the folder."""
        self.contents = opened.contents
        self.log = Log(folder, self.contents.summary, self.contents.place, files)
        if opened.newest is not None:
            self.log.continue_after(opened.segments, opened.newest)

    def begin_session(self, session: Sequence[Any], competition: Any) -> None:
        """Add a start of the core."""
        self._add({records.SESSION: session, records.COMPETITION: competition}, len(self.contents.sessions) + 1)

    def set_competition(self, competition: Any) -> None:
        """Add a change of the schedule."""
        self._add({records.COMPETITION: competition}, len(self.contents.sessions))

    def add(self, batch: Batch, session: Optional[int] = None) -> None:
        """Add the changes of an event. `session`: its number, if it is not the newest one. Raises TypeError or
        ValueError for what is not JSON; then an empty record is added."""
        contents = self.contents
        lines = records.lines_of(batch, contents.entry)
        states = {name: self._change(name, state) for name, state in batch.states.items()}
        states = {name: change for name, change in states.items() if change is not None}
        if states:
            lines[records.STATES] = states
        self._add(lines, len(contents.sessions) if session is None else session)

    def _add(self, lines: Lines, session: int) -> None:
        contents = self.contents
        utc, mono = records.time_of(lines) or (contents.utc, contents.last[0])
        entry = contents.entry + sum(len(lines.get(letter, ())) for letter in records.OF_ENTRIES)
        top = Top(utc, mono, session, entry, "".join(lines), records.identities_of(lines, contents.run_of.get))
        try:
            payload = records.encode(top, lines)
        except (TypeError, ValueError, RecursionError):
            self.log.append(records.encode(Top(utc, mono, session, contents.entry, "", ()), {}))
            raise
        with self.log.lock:
            self.log.append(payload)
            contents.take(top, lines.get)

    def _change(self, name: str, state: Any) -> Any:
        """Return how a state changed since the journal has it; None: it did not."""
        known = self.contents.states.get(name, ChangesReader())
        is_due = known.state is None or known.number % COMPLETE_EVERY == 0
        change = [state] if is_due else difference(known.state, state)
        return None if change is SAME else {"number": known.number + 1, "change": change}


class Journal:
    """Writes one journal."""

    def __init__(
        self, log_dir: str, session: CoreSession, competition: List[Any], resume: Resume,
        on_trouble: Callable[[str], None], lock: Optional[Lock] = None, file_operations: Optional[Files] = None,
        clock: Callable[[], float] = time.monotonic,
        syncer: Callable[[Callable[[], bool], float], Syncer] = Syncer,
    ) -> None:
        """`competition`: its events, each a list. `lock`: if the caller has locked the journal. `on_trouble` is called,
        in any thread, with a problem and its remedy, or with `REPAIRED`. A simulator replaces the last three. Raises
        only `DamagedJournal`; then the lock is released."""
        self.on_written: Callable[[], object] = lambda: None
        """Called in another thread when what waited was written, or cannot be."""
        self._log_dir = log_dir
        self._session = session
        self._competition = competition
        self._resume = resume
        self._on_trouble = on_trouble
        self._files = Files() if file_operations is None else file_operations
        self._clock = clock
        self._lock: Optional[int] = None if lock is None else lock.fd
        self._writer: Optional[Writer] = None
        self._is_begun = False  # this session has a segment
        self._first = 0  # number of the record of this session's start
        self._pending: Deque[Batch] = deque()  # until the journal is open
        self._adding = threading.Lock()  # of these, and of what opens the journal
        self._ticket = 0  # of the latest write
        self._asked = self._tried = 0  # number of the newest attempt to write, and of the newest that has ended
        self._retry_at = 0.0
        self._problem = ""  # why the latest write failed
        self._disk_problem = ""  # why the latest sync failed
        self._awaited = 0, 0.0  # a ticket that must be saved soon, and its monotonic time (s)
        self._slow = ""  # how the disk is slow
        self._known = REPAIRED  # the trouble that was reported
        self._reporting = threading.Lock()
        self._syncing = threading.Lock()
        self.path = os.path.join(log_dir, log_dirs.JOURNAL)
        self.previous: PreviousSession = NOTHING
        self.warnings: Tuple[str, ...] = ()  # those that nobody has taken
        self._found: Optional[Opened] = None  # at the start
        self._is_running = False  # the core has started, with or without the journal
        self._syncer, self._writing = syncer(self._sync, GROUP_S), syncer(self._write, 0.0)
        try:
            self._attempt(self._flush, DamagedJournal)
        except DamagedJournal:
            self._writing.end()
            self._syncer.end()
            raise
        self._is_running = True

    def take_warnings(self) -> Tuple[str, ...]:
        """Return what is new and must be known of the journal that was found."""
        with self._adding:
            taken, self.warnings = self.warnings, ()
        return taken

    def earlier_damage(self) -> Iterator[str]:
        """Look for damage in the part of the journal that a start does not read; returns warnings. Call it once, in any
        thread: it takes long."""
        found, self._found = self._found, None
        for problem in () if found is None else found.damage_before():
            yield f"The journal {self.path} is damaged: {problem}. {log_dirs.COPY}"

    # -- writing ------------------------------------------------------------------------------------

    def write(self, batch: Batch) -> int:
        """Let the changes of one event and all waiting data be written; returns its ticket.

        Data that cannot be written waits, and the problem is reported. Raises TypeError or ValueError for what is not
        JSON.
        """
        if batch.is_empty():
            return self._ticket
        self._await(self._ticket + 1)
        with self._adding:
            self._ticket += 1
            ticket = self._ticket
            self._pending.append(batch)
            self._take_pending()
        if not self._retry_at or self._clock() >= self._retry_at:
            self._try_to_write()
        return ticket

    def is_waiting(self, ticket: int) -> bool:
        """Whether this ticket is not written yet: the disk hangs, or this computer is busy. A problem is not waited
        for."""
        return self.committed < ticket and not self._problem

    @property
    def hangs(self) -> bool:
        """Whether the disk has taken no data for a while."""
        ticket, since = self._awaited
        return self.committed < ticket and self._clock() - since >= SLOW_S

    @property
    def next_ticket(self) -> int:
        """The ticket of the next write."""
        return self._ticket + 1

    def set_competition(self, competition: List[Any]) -> None:
        """The schedule was changed: a later start compares its own with this one."""
        with self._adding:
            self._competition = competition
            if not self._first:
                return
            self._ticket += 1
            self._writer.set_competition(self._competition)
        self._try_to_write()

    def look(self) -> None:
        """Call this about once a second: writes waiting data, and checks the folder and the speed of the disk."""
        self._try_to_write()
        self._await(self._ticket)
        ticket, since = self._awaited
        is_slow = self.saved < ticket and self._clock() - since >= SLOW_S
        self._slow = _HANGS if self.hangs else (
            f"is slow. {_AT_STAKE}. Use another disk for log_dir" if is_slow else "")
        self._report()

    def forget_previous(self) -> None:
        """Free what a core needs of the previous session only when it starts."""
        self.previous = self.previous._replace(states={}, outcomes=())

    @property
    def committed(self) -> int:
        """The newest ticket that is in the file, where other processes read it."""
        return 0 if self._writer is None else max(0, self._writer.log.written - self._first)

    @property
    def saved(self) -> int:
        """The newest ticket that is on the disk."""
        return 0 if not self._is_begun else max(0, self._writer.log.saved - self._first)

    @property
    def identity(self) -> str:
        """Identity of the journal; empty: it is not open."""
        return "" if self._writer is None else self._writer.log.uuid.hex()

    def number_of(self, ticket: int) -> int:
        """Return the number of the record of a ticket."""
        return self._first + ticket

    @property
    def problem(self) -> str:
        """Why the newest data is not on the disk, if a write has failed; empty: none has."""
        return self._problem or self._disk_problem

    def why_not_saved(self, ticket: int) -> str:
        """Wait for some time until this ticket is on the disk; returns "" or why it is not. For any thread."""
        if not self._problem and self._syncer.wait(lambda: self.saved >= ticket, SYNC_TIMEOUT_S):
            return ""
        return self.problem or f"the disk of log_dir takes longer than {SYNC_TIMEOUT_S:g} s"

    def close(self) -> None:
        """Write waiting data, and sync everything to the disk."""
        self._writing.end()
        self._attempt(self._flush)
        self._syncer.end()
        if self._writer is not None:
            with contextlib.suppress(OSError):
                self._writer.log.finish()
            self._writer.log.close()
        self._unlock()

    def _try_to_write(self) -> None:
        """Let everything be written, and wait for it, but only once for a disk that hangs."""
        hangs = self._tried < self._asked
        self._asked += 1
        asked = self._asked
        if hangs:
            self._writing.wake()
        else:
            self._writing.work(lambda: self._tried >= asked, WRITE_S)

    def _await(self, ticket: int) -> None:
        """Note since when the oldest ticket waits, or rather one that is little younger."""
        if self.saved >= self._awaited[0]:
            self._awaited = ticket, self._clock()

    # -- trouble ------------------------------------------------------------------------------------

    def _attempt(self, step: Callable[[], None], *raised: Type[Exception]) -> None:
        """Do a step. If it fails, the runs continue, and the data waits."""
        try:
            step()
        except Exception as error:
            if isinstance(error, raised):
                self._unlock()
                raise
            self._retry_at = self._clock() + RETRY_S
            self._problem = _plain(error)
        else:
            self._retry_at = 0.0
            self._problem = ""
        self._report()

    def _report(self) -> None:
        """Report what is wrong now, if that is new."""
        with self._reporting:
            trouble = REPAIRED
            if self._problem:
                trouble = (f"The journal {self.path} cannot be written: {self._problem}. {_AT_STAKE}. Free or repair "
                           "the disk of log_dir")
            elif self._disk_problem:
                trouble = (f"The journal {self.path} does not reach the disk: {self._disk_problem}. {_AT_STAKE}. "
                           "Repair the disk of log_dir")
            elif self._slow:
                trouble = f"The disk of the journal {self.path} {self._slow}"
            if trouble != self._known:
                self._known = trouble
                self._on_trouble(trouble)

    # -- in threads of their own ----------------------------------------------------------------------

    def _write(self) -> bool:
        asked = self._asked
        self._attempt(self._flush)
        self._tried = asked
        self.on_written()
        return True  # `look` tries again

    def _sync(self) -> bool:
        problem = ""
        with self._syncing:
            try:
                self._writer.log.sync()
            except OSError as error:
                problem = _plain(error)
        self._disk_problem = problem
        self._report()
        return not problem

    # -- steps --------------------------------------------------------------------------------------

    def _flush(self) -> None:
        if self._writer is None:
            self._open()
        log = self._writer.log
        if not self._is_begun:
            with self._syncing:
                log.begin()
            self._is_begun = True
        elif not log.is_in_place:
            self._restore()  # otherwise new data would be lost with the process
        log.write()
        if log.saved < log.last:
            self._syncer.wake()

    def _open(self) -> None:
        """Read the previous session, which is possible even on a full or read-only disk."""
        if self._lock is None:
            self._take_lock()
        opened, warnings = log_dirs.open_folder(
            self._log_dir, self._competition, self._resume, self._session.launch, self._is_running)
        self._found = opened._replace(newest=None)  # its records need memory
        self.previous, problems = read_previous_session(opened)
        if problems:
            warnings.append(f"The journal {self.path} is damaged: {'; '.join(problems)}. {log_dirs.COPY}")
        writer = Writer(self.path, opened, self._files)
        with self._adding:
            self.warnings += tuple(warnings)
            writer.begin_session(self._session, self._competition)
            self._first = writer.log.last
            self._writer = writer
            with contextlib.suppress(TypeError, ValueError, RecursionError):  # what is not JSON is not there
                self._take_pending()

    def _take_pending(self) -> None:
        while self._writer is not None and self._pending:
            self._writer.add(self._pending.popleft())

    def _take_lock(self) -> None:
        self.path, self._lock = log_dirs.lock(self._log_dir)

    def _unlock(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _restore(self) -> None:
        """The newest segment, its folder or log_dir was removed. Write all of them again: they are still open."""
        self._unlock()
        self._take_lock()
        there = read_chain(self.path).segments
        if there and there[-1].head.uuid != self._writer.log.uuid:  # somebody put another journal in its place
            log_dirs.set_aside(self.path)
        with self._syncing:
            self._writer.log.restore()
            self._writer.log.begin()


def _plain(error: Exception) -> str:
    """Return the error of the system in plain words."""
    if not isinstance(error, (CannotWriteJournal, NewerFormat, OSError)):
        return f"internal error, please report it: {error!r}"
    return "the disk is full" if durable.is_full(error) else getattr(error, "strerror", None) or str(error)
