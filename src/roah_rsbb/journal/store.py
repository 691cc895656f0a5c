"""Writes the journal.

Theory of operation. `write` commits the changes of one event before it returns, so that they survive the process;
`disk` syncs them to the disk soon after. Data that cannot be written (a full disk, a missing folder) waits in memory
and is written, in order, with the next write that succeeds. Runs continue in the meantime.

Each write has a ticket, a rising number. `saved` is the newest ticket on the disk, and `why_not_saved` waits for one.

Call all methods except `why_not_saved` in one thread.
"""

import contextlib
import errno
import os
import sqlite3
import time
from typing import Callable, List, Optional, Tuple

from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema
from roah_rsbb.journal.batch import Batch, NewEntry
from roah_rsbb.journal.disk import Disk
from roah_rsbb.journal.file import CannotWriteJournal, CoreSession, Holder, Resume
from roah_rsbb.journal.previous_session import NOTHING, PreviousSession, read_previous_session

# Failed writes are retried after this time.
RETRY_S = 0.5
# Longest time that scores and sign-offs wait for the disk.
SYNC_TIMEOUT_S = 2.0
# A disk that takes longer than this is reported.
SLOW_S = 1.0

# Reported when a problem is over.
REPAIRED = ""

_AT_STAKE = "Runs continue, but what happens now is lost if the box ends or this computer is switched off"


class Journal:
    """Writes one journal."""

    def __init__(
        self, log_dir: str, session: CoreSession, competition: str, resume: Resume, on_trouble: Callable[[str], None]
    ) -> None:
        """Never raises. `on_trouble` is called, in any thread, with a problem and its remedy, or with `REPAIRED`."""
        self._log_dir = log_dir
        self._session = session
        self._competition = competition
        self._on_trouble = on_trouble
        self._connection: Optional[sqlite3.Connection] = None
        self._lock: Optional[int] = None
        self._file: Optional[Tuple[int, int]] = None
        self._disk: Optional[Disk] = None
        self._pending = Batch()
        self._ticket = 0  # of the latest write
        self._committed = 0  # the latest committed ticket
        self._checkpoint_wanted = False
        self._retry_at = 0.0
        self._session_id = 0
        self._problem = ""  # why the latest write failed
        self._is_slow = False
        self._is_log_begun = False
        self._trouble = REPAIRED
        self._disk_trouble = REPAIRED
        self.path = os.path.join(log_dir, files.FILE_NAME)
        self.previous: PreviousSession = NOTHING
        self.warnings: Tuple[str, ...] = ()
        self.holders: Tuple[Holder, ...] = ()  # other cores with journals in the directory
        self._resume = resume
        self._attempt(self._flush)

    # -- writing ------------------------------------------------------------------------------------

    def write(self, batch: Batch, checkpoint: bool = False) -> int:
        """Commit the changes of one event and all waiting data; returns its ticket.

        Data that cannot be written waits, and the problem is reported. `checkpoint`: move it from the write-ahead log
        into the database soon.
        """
        self._pending.add(batch)
        self._ticket += 1
        self._checkpoint_wanted = self._checkpoint_wanted or checkpoint
        if not self._retry_at or time.monotonic() >= self._retry_at:
            self._attempt(self._flush)
        return self._ticket

    def set_competition(self, competition: str) -> None:
        """The schedule was changed: a later start compares its own with this one."""
        self._competition = competition
        if self._session_id:
            self._attempt(lambda: files.prepare(self._connection, competition))

    def look(self) -> None:
        """Call this about once a second: writes waiting data, and checks the file and the speed of the disk."""
        if not self._session_id or not self._pending.is_empty() or not self._is_in_place():
            self._attempt(self._flush)
        if not self._trouble or self._is_slow:
            seconds = self._disk.waiting_s() if self._disk is not None else 0.0
            self._is_slow = seconds >= SLOW_S
            self._report(f"The disk of the journal {self.path} is slow. {_AT_STAKE}. Use another disk for log_dir"
                       if self._is_slow else REPAIRED)

    @property
    def saved(self) -> int:
        """The newest ticket that is on the disk."""
        return self._disk.synced if self._disk is not None else 0

    def why_not_saved(self, ticket: int) -> str:
        """Wait for some time until this ticket is on the disk; returns "" or why it is not. For any thread."""
        disk = self._disk
        if disk is not None and ticket <= self._committed and disk.wait(ticket, SYNC_TIMEOUT_S):
            return ""
        problem = self._problem or (disk.problem if disk is not None else "")
        return problem or f"the disk of log_dir takes longer than {SYNC_TIMEOUT_S:g} s"

    def close(self) -> None:
        """Write waiting data, sync everything to the disk, and merge it into one file."""
        self._attempt(self._flush)
        self._release()
        self._unlock()

    def entries_of(self, port: int) -> Optional[List[NewEntry]]:
        """All entries of a robot in a run, including waiting ones, in order; None: earlier ones cannot be read now."""
        found: List[NewEntry] = []
        if self._connection is not None:
            try:
                rows = self._connection.execute(
                    "SELECT utc, mono, zone, identity, port, who, kind, value FROM entries WHERE identity ="
                    " (SELECT identity FROM members WHERE port = ?) AND port = ? ORDER BY id", (port, port))
                found = [NewEntry(*row) for row in rows]
            except sqlite3.Error:
                return None
        elif self._session_id or self.previous is not NOTHING:
            return None  # the file has some, and is not open
        return found + [entry for entry in self._pending.entries if entry.port == port]

    # -- trouble ------------------------------------------------------------------------------------

    def _attempt(self, step: Callable[[], None]) -> None:
        """Do a step. If it fails, the runs continue, and the data waits."""
        try:
            step()
        except (CannotWriteJournal, sqlite3.Error, OSError) as error:
            self._retry_at = time.monotonic() + RETRY_S
            self._problem, self._is_slow = _plain(error), False
            self._report(f"The journal {self.path} cannot be written: {self._problem}. {_AT_STAKE}. "
                       "Free or repair the disk of log_dir")
            return
        self._retry_at = 0.0
        self._problem = ""
        if not self._is_slow:
            self._report(REPAIRED)

    def _report(self, trouble: str) -> None:
        before, self._trouble = self._trouble, trouble
        if trouble != before:
            self._on_trouble(trouble or self._disk_trouble)

    def _on_disk_problem(self, problem: str) -> None:
        """Called in the thread of `Disk`."""
        text = f"The journal {self.path} does not reach the disk: {problem}. {_AT_STAKE}. Repair the disk of log_dir"
        self._disk_trouble = text if problem else REPAIRED
        self._on_trouble(self._trouble or self._disk_trouble)

    # -- steps --------------------------------------------------------------------------------------

    def _open(self) -> None:
        if self._lock is None:
            self._take_lock()
        opened = files.open_file(self.path, self._competition, self._resume, self._session.launch)
        self._take(opened.connection)
        self.warnings += opened.warnings

    def _take_lock(self) -> None:
        self.path, self._lock, self.holders = files.lock(self._log_dir)
        self.warnings += tuple(_held(holder, self.path) for holder in self.holders)

    def _begin_session(self) -> None:
        """Read the previous session, which is possible even on a full or read-only disk. Then write."""
        connection = self._connection
        self._begin_log()
        try:
            if self.previous is NOTHING and schema.is_readable(connection):
                self.previous = read_previous_session(connection)
            files.prepare(connection, self._competition)
            if self.previous is NOTHING:
                self.previous = read_previous_session(connection)
            cursor = connection.execute(schema.insertion("sessions"), self._session)
        except sqlite3.OperationalError as error:
            if "readonly" in str(error) and os.access(self.path, os.W_OK):
                self._release()  # it was opened read-only
            raise
        self._session_id = cursor.lastrowid
        self._disk.written(self._committed)

    def _begin_log(self) -> None:
        """Empty the write-ahead log of a killed core, because its truncated end could later look like damage."""
        if not self._is_log_begun:
            self._is_log_begun = True
            with contextlib.suppress(sqlite3.Error):
                self._connection.execute("PRAGMA synchronous = FULL")
                self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            if files.has_log(self._connection):
                self._connection.execute("PRAGMA synchronous = OFF")

    def _take(self, connection: sqlite3.Connection) -> None:
        if self._disk_trouble:
            self._on_disk_problem("")  # the problem of another file
        self._connection = connection
        self._file = files.identity(self.path)
        self._disk = Disk(self.path, files.has_log(connection), self._on_disk_problem)

    def _release(self) -> None:
        if self._disk is not None:
            self._disk.end()
            self._disk = None
        if self._connection is not None:
            with contextlib.suppress(sqlite3.Error):
                self._connection.execute("PRAGMA synchronous = FULL")  # or the log is gone before the database is saved
                self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._connection.close()
            self._connection = None

    def _unlock(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _is_in_place(self) -> bool:
        return files.identity(self.path) == self._file

    def _move(self) -> None:
        """The file or its folder was removed. Write its contents, which are still accessible, to a new file."""
        old = self._connection
        self._unlock()
        self._take_lock()
        if os.path.exists(self.path):
            files.set_aside(self.path)
        new = files.copied(old, self.path)
        self._disk.end()
        self._take(new)
        old.close()
        self._disk.written(self._committed)

    def _flush(self) -> None:
        if self._connection is None:
            self._open()
        elif not self._is_in_place():
            self._move()  # otherwise new data would be lost with the process
        if not self._session_id:
            self._begin_session()
        waiting, connection = self._pending, self._connection
        if waiting.is_empty():
            return
        connection.execute("BEGIN IMMEDIATE")
        try:
            _insert(connection, self._session_id, waiting)
            connection.execute("COMMIT")
        except BaseException:
            with contextlib.suppress(sqlite3.Error):
                connection.execute("ROLLBACK")
            raise
        self._pending = Batch()
        self._committed = self._ticket
        self._disk.written(self._ticket, self._checkpoint_wanted)
        self._checkpoint_wanted = False


def _held(holder: Holder, own: str) -> str:
    """Return the warning that another core uses the journal from which this one would resume."""
    state = ", which is stopped," if files.is_stopped(holder.pid) else ""
    who = f"process {holder.pid}{state}" if holder.pid else "an unknown process"
    return (f"Another core ({who}) uses the journal {holder.path}. This core does not have the runs in it, and uses "
            f"{own}. If the other core is not needed, end it and restart this: rosservice call /core/end_other_core")


def _plain(error: Exception) -> str:
    """Return the error of SQLite or the system in plain words."""
    text = str(error)
    return "the disk is full" if "disk is full" in text or getattr(error, "errno", 0) == errno.ENOSPC else text


_INSERT_STATE = schema.insertion("states", " OR REPLACE")
_INSERT_ENTRY = schema.insertion("entries")
_INSERT_LINK = schema.insertion("links")
_INSERT_RUN = schema.insertion("runs", " OR IGNORE")
_INSERT_MEMBER = schema.insertion("members", " OR IGNORE")
_SET_LOG_FILE = schema.change("members", ("log_file",))
_SET_OUTCOME = schema.change("runs", ("closed_utc", "outcome"))


def _insert(connection: sqlite3.Connection, session: int, waiting: Batch) -> None:
    connection.executemany(_INSERT_STATE, waiting.states.items())
    connection.executemany(_INSERT_ENTRY, ((session, *entry) for entry in waiting.entries))
    connection.executemany(_INSERT_RUN, ((*run, None, None) for run in waiting.runs))
    connection.executemany(_INSERT_MEMBER, ((*member, None) for member in waiting.members))
    connection.executemany(_SET_LOG_FILE, ((path, port) for port, path in waiting.log_files.items()))
    connection.executemany(_SET_OUTCOME, ((*outcome, identity) for identity, outcome in waiting.outcomes.items()))
    connection.executemany(_INSERT_LINK, waiting.links)
