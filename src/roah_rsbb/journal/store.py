"""The one writer of the journal.

Theory of operation. `write` takes what one event changed and commits it before it returns, so that it outlives
the process; `disk` forces it to the disk soon after. What cannot be written (a full disk, a missing directory)
waits in memory and goes out with the first write that succeeds, in order. Runs continue meanwhile.

Each write has a ticket, a rising number. `saved` is the newest ticket on the disk, and `why_not_saved` waits for one.

All methods but `why_not_saved` belong to one thread.
"""

import contextlib
import errno
import os
import sqlite3
import time
from typing import Callable, List, Optional, Tuple

from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema
from roah_rsbb.journal.batch import Batch, Entry, Pending
from roah_rsbb.journal.before import NOTHING, Before, read_before
from roah_rsbb.journal.disk import Disk
from roah_rsbb.journal.file import CannotWrite, Holder, Resume, Session

# What could not be written is tried again after this long.
RETRY_S = 0.5
# Scores and sign-offs wait for the disk so long at most.
SYNC_TIMEOUT_S = 2.0
# A disk that takes longer than this is reported.
SLOW_S = 1.0

# What is reported when there is no trouble any more.
MENDED = ""

_AT_STAKE = "Runs continue, but what happens now is lost if the box ends or this computer is switched off"


class Journal:
    """Writes one journal."""

    def __init__(
        self, log_dir: str, session: Session, competition: str, resume: Resume, on_trouble: Callable[[str], None]
    ) -> None:
        """Never raises. `on_trouble` is called, from any thread, with what keeps the record from the disk and the
        remedy; with `MENDED` when it is over."""
        self._log_dir = log_dir
        self._session = session
        self._competition = competition
        self._on_trouble = on_trouble
        self._connection: Optional[sqlite3.Connection] = None
        self._lock: Optional[int] = None
        self._file: Optional[Tuple[int, int]] = None
        self._disk: Optional[Disk] = None
        self._pending = Pending()
        self._ticket = 0  # of the newest write
        self._committed = 0  # the newest ticket that was committed
        self._checkpoint_wanted = False
        self._retry_at = 0.0
        self._session_id = 0
        self._problem = ""  # why the last attempt to write failed
        self._is_slow = False
        self._is_log_begun = False
        self._trouble = MENDED
        self._disk_trouble = MENDED
        self.path = os.path.join(log_dir, files.FILE_NAME)
        self.before: Before = NOTHING
        self.warnings: Tuple[str, ...] = ()
        self.holders: Tuple[Holder, ...] = ()  # other cores with a journal in the directory
        self._resume = resume
        self._attempt(self._flush)

    # -- writing ------------------------------------------------------------------------------------

    def write(self, batch: Batch, checkpoint: bool = False) -> int:
        """Commit what one event changed, with all that still waits; returns its ticket.

        What cannot be written waits, and is reported as trouble. `checkpoint`: it is to be in the database itself soon,
        not only in the write-ahead log.
        """
        self._pending.add(batch)
        self._ticket += 1
        self._checkpoint_wanted = self._checkpoint_wanted or checkpoint
        if not self._retry_at or time.monotonic() >= self._retry_at:
            self._attempt(self._flush)
        return self._ticket

    def look(self) -> None:
        """To be called about once a second: write what waits, see whether the file is still there and whether the disk
        keeps up."""
        if not self._session_id or not self._pending.is_empty() or not self._is_in_place():
            self._attempt(self._flush)
        if not self._trouble or self._is_slow:
            seconds = self._disk.waiting_s() if self._disk is not None else 0.0
            self._is_slow = seconds >= SLOW_S
            self._tell(f"The disk of the journal {self.path} is slow. {_AT_STAKE}. Use another disk for log_dir"
                       if self._is_slow else MENDED)

    @property
    def saved(self) -> int:
        """The newest ticket that is on the disk."""
        return self._disk.synced if self._disk is not None else 0

    @property
    def is_in_trouble(self) -> bool:
        """Whether something keeps the record from the disk."""
        return bool(self._trouble or self._disk_trouble)

    def why_not_saved(self, ticket: int) -> str:
        """From any thread: wait until what has this ticket is on the disk, for a while; returns "" if it is, else why
        not."""
        disk = self._disk
        if disk is not None and ticket <= self._committed and disk.wait(ticket, SYNC_TIMEOUT_S):
            return ""
        problem = self._problem or (disk.problem if disk is not None else "")
        return problem or f"the disk of log_dir takes longer than {SYNC_TIMEOUT_S:g} s"

    def close(self) -> None:
        """Write what waits, bring all onto the disk and into one file."""
        self._attempt(self._flush)
        self._release()
        self._unlock()

    def entries_of(self, port: int) -> List[Entry]:
        """All entries of a robot's part in a run, also those that still wait, in order."""
        found: List[Entry] = []
        if self._connection is not None:
            with contextlib.suppress(sqlite3.Error):
                rows = self._connection.execute(
                    "SELECT utc, mono, zone, identity, port, who, kind, value FROM entries WHERE identity ="
                    " (SELECT identity FROM members WHERE port = ?) AND port = ? ORDER BY id", (port, port))
                found = [Entry(*row) for row in rows]
        return found + [entry for entry in self._pending.entries if entry.port == port]

    # -- trouble ------------------------------------------------------------------------------------

    def _attempt(self, step: Callable[[], None]) -> None:
        """Do a step. If it fails, the runs go on, and all that is to be written waits."""
        try:
            step()
        except (CannotWrite, sqlite3.Error, OSError) as error:
            self._retry_at = time.monotonic() + RETRY_S
            self._problem, self._is_slow = _plain(error), False
            self._tell(f"The journal {self.path} cannot be written: {self._problem}. {_AT_STAKE}. "
                       "Free or repair the disk of log_dir")
            return
        self._retry_at = 0.0
        self._problem = ""
        if not self._is_slow:
            self._tell(MENDED)

    def _tell(self, trouble: str) -> None:
        before, self._trouble = self._trouble, trouble
        if trouble != before:
            self._on_trouble(trouble or self._disk_trouble)

    def _on_disk_problem(self, problem: str) -> None:
        """From the thread of `Disk`."""
        text = f"The journal {self.path} does not reach the disk: {problem}. {_AT_STAKE}. Repair the disk of log_dir"
        self._disk_trouble = text if problem else MENDED
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
        """Read what was before; that is possible on a disk that is full or read-only, too. Then write."""
        connection = self._connection
        self._begin_log()
        try:
            if self.before is NOTHING and files.is_readable(connection):
                self.before = read_before(connection)
            files.prepare(connection, self._competition)
            if self.before is NOTHING:
                self.before = read_before(connection)
            cursor = connection.execute(schema.insertion("sessions"), self._session)
        except sqlite3.OperationalError as error:
            if "readonly" in str(error) and os.access(self.path, os.W_OK):
                self._release()  # it was opened when it could only be read
            raise
        self._session_id = cursor.lastrowid
        self._disk.written(self._committed)

    def _begin_log(self) -> None:
        """Empty the write-ahead log that a killed core left: what was torn in it could later look like damage."""
        if not self._is_log_begun:
            self._is_log_begun = True
            with contextlib.suppress(sqlite3.Error):
                self._connection.execute("PRAGMA synchronous = FULL")
                self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            if files.has_log(self._connection):
                self._connection.execute("PRAGMA synchronous = OFF")

    def _take(self, connection: sqlite3.Connection) -> None:
        if self._disk_trouble:
            self._on_disk_problem("")  # it was another file's
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
        """Somebody removed the file, or its directory: what it held is still in our hands, and is written anew."""
        old = self._connection
        self._unlock()
        self._take_lock()
        if os.path.exists(self.path):
            files.put_aside(self.path)
        new = files.copied(old, self.path)
        self._disk.end()
        self._take(new)
        old.close()
        self._disk.written(self._committed)

    def _flush(self) -> None:
        if self._connection is None:
            self._open()
        elif not self._is_in_place():
            self._move()  # or what is written now would be gone with the process
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
        self._pending = Pending()
        self._committed = self._ticket
        self._disk.written(self._ticket, self._checkpoint_wanted)
        self._checkpoint_wanted = False


def _held(holder: Holder, own: str) -> str:
    """The warning that another core has the journal that this one would resume from."""
    state = ", which is stopped," if files.is_stopped(holder.pid) else ""
    who = f"process {holder.pid}{state}" if holder.pid else "an unknown process"
    return (f"Another core ({who}) has the journal {holder.path}. This core does not know the runs in it, and uses "
            f"{own}. If the other core is not needed, end it and restart this: rosservice call /core/end_other_core")


def _plain(error: Exception) -> str:
    """What SQLite or the system says, in the words of whoever can help."""
    text = str(error)
    return "the disk is full" if "disk is full" in text or getattr(error, "errno", 0) == errno.ENOSPC else text


_INSERT_STATE = schema.insertion("states", " OR REPLACE")
_INSERT_ENTRY = schema.insertion("entries")
_INSERT_LINK = schema.insertion("links")
_INSERT_RUN = schema.insertion("runs", " OR IGNORE")
_INSERT_MEMBER = schema.insertion("members", " OR IGNORE")
_SET_LOG_FILE = schema.change("members", ("log_file",))
_SET_OUTCOME = schema.change("runs", ("closed_utc", "outcome"))


def _insert(connection: sqlite3.Connection, session: int, waiting: Pending) -> None:
    connection.executemany(_INSERT_STATE, waiting.states.items())
    connection.executemany(_INSERT_ENTRY, ((session, *entry) for entry in waiting.entries))
    connection.executemany(_INSERT_RUN, ((*run, None, None) for run in waiting.runs))
    connection.executemany(_INSERT_MEMBER, ((*member, None) for member in waiting.members))
    connection.executemany(_SET_LOG_FILE, ((path, port) for port, path in waiting.log_files.items()))
    connection.executemany(_SET_OUTCOME, ((*outcome, identity) for identity, outcome in waiting.outcomes.items()))
    connection.executemany(_INSERT_LINK, waiting.links)
