"""A copy of the journal in another folder, from which a core can resume.

The folder is often a USB stick: it can vanish at any moment, and be another one when it is back.
"""

import contextlib
import fcntl
import itertools
import os
import sqlite3
from typing import Optional, Sequence

from roah_rsbb import durable
from roah_rsbb.copies.copy import CannotWriteCopy, Copy, FileContent
from roah_rsbb.copies.rows import COLUMNS, Row, Rows, known_of
from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema

BUSY_S = 1.0
# Rows that are inserted by one statement, in which SQLite 3.31 allows 999 values.
TOGETHER = 50
# Pages of SQLite's write-ahead log after which it is written into the file: with many parts, about 40 MB. Usually, as
# by default.
HURRYING_PAGES, USUAL_PAGES = 10_000, 1000
_REMEDY = "Check the disk or stick of the copy"


class Stick:
    """The folder of a copy, which is often where a stick is mounted."""

    def __init__(self, folder: str, log_dir: str) -> None:
        self._folder = folder
        self._log_dir = log_dir
        self._has_other_device = False

    def open(self) -> "CopyFolder":
        """Open the copy. Raises `CannotWriteCopy`."""
        self._check_device()
        return CopyFolder(self._folder)

    def _check_device(self) -> None:
        """Refuse to write into the empty folder where the stick was mounted."""
        try:
            has_other = os.stat(self._folder).st_dev != os.stat(self._log_dir).st_dev
        except OSError:
            return  # the folder is missing, which is reported when it is opened
        if self._has_other_device and not has_other:
            raise CannotWriteCopy("the stick is not mounted. Plug it in again")
        self._has_other_device = has_other


class CopyFolder(Copy):
    """A copy that is open for writing. Call all methods in one thread."""

    def __init__(self, folder: str) -> None:
        """Raises `CannotWriteCopy`."""
        self._folder = folder
        self.path = os.path.join(folder, files.FILE_NAME)
        super().__init__()
        self._connection: Optional[sqlite3.Connection] = None
        self._lock: Optional[int] = None
        with self._writing():
            if not os.path.isdir(folder):
                raise CannotWriteCopy("the folder is missing. Plug the stick in again, or create the folder")
            self._lock = _locked(f"{self.path}.lock")
            try:
                self._open()
            except BaseException:
                self.close()
                raise

    def close(self) -> None:
        """Close the files. Never raises: the stick may be gone."""
        if self._connection is not None:
            with contextlib.suppress(sqlite3.Error):
                self._connection.close()
            self._connection = None
        if self._lock is not None:
            with contextlib.suppress(OSError):
                os.close(self._lock)
            self._lock = None

    def check(self) -> None:
        """Raise `CannotWriteCopy` if the path no longer leads to this copy."""
        if files.identity(self.path) != self._file:
            raise CannotWriteCopy("it was removed. Plug the stick in again")

    def write(self, rows: Rows, beside: FileContent) -> None:
        """Write rows and files. With the last part, everything is on the disk when this returns. Raises
        `CannotWriteCopy`."""
        with self._writing():
            was_hurrying = self._is_hurrying
            self._hurry(not rows.is_last)
            # The files come first: the journal refers to them.
            for name, content in beside.items():
                # Only the owner may read it: it can be the teams' passwords.
                durable.write_file(os.path.join(self._folder, name), content)
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                for table, found in rows.tables.items():
                    self._insert(table, found)
                self._connection.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):
                    self._connection.execute("ROLLBACK")
                raise
            if was_hurrying and rows.is_last:
                self._connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()  # puts all parts on the disk
            self.known.add(rows)
            if rows.tables.get("sessions"):
                self.box_uuid = self._newest_core()

    def set_aside(self) -> None:
        """Keep the contents under another name, and begin a new copy. Raises `CannotWriteCopy`."""
        with self._writing():
            self._connection.close()
            self._connection = None
            self.aside = files.set_aside(self.path)
            self._open()

    # -- steps --------------------------------------------------------------------------------------

    def _insert(self, table: str, rows: Sequence[Row]) -> None:
        """Insert rows, many in each statement: alone, each takes twice as long."""
        columns = COLUMNS[table]
        statement = f"INSERT OR REPLACE INTO {table} ({', '.join(columns)}) VALUES "
        values = f"({', '.join('?' * len(columns))})"
        rest = len(rows) - len(rows) % TOGETHER
        self._connection.executemany(
            statement + ", ".join([values] * TOGETHER),
            (tuple(itertools.chain.from_iterable(rows[i:i + TOGETHER])) for i in range(0, rest, TOGETHER)))
        self._connection.executemany(statement + values, rows[rest:])

    def _hurry(self, is_hurrying: bool) -> None:
        """Do not wait for the disk with each part of many. The copy stays undamaged, and resumes with what it has."""
        if self._has_log and is_hurrying != self._is_hurrying:
            self._is_hurrying = is_hurrying
            self._connection.execute(f"PRAGMA synchronous = {'NORMAL' if is_hurrying else 'FULL'}")
            self._connection.execute(f"PRAGMA wal_autocheckpoint = {HURRYING_PAGES if is_hurrying else USUAL_PAGES}")

    @contextlib.contextmanager
    def _writing(self):
        try:
            yield
        except (sqlite3.Error, files.CannotWriteJournal) as error:
            raise CannotWriteCopy(f"{error}. {_REMEDY}") from None
        except OSError as error:
            raise CannotWriteCopy(f"{error.strerror}. {_REMEDY}") from None

    def _open(self) -> None:
        if os.path.exists(self.path) and not _is_journal(self.path):
            self.aside = files.set_aside(self.path)
        self._connection = sqlite3.connect(self.path, timeout=BUSY_S, isolation_level=None, check_same_thread=False)
        self._connection.text_factory = lambda value: value.decode("utf-8", errors="replace")
        schema.add_functions(self._connection)
        # Some file systems cannot have a write-ahead log. SQLite then uses another way that is as safe.
        self._has_log = self._connection.execute("PRAGMA journal_mode = WAL").fetchone() == ("wal",)
        self._is_hurrying = False
        self._connection.execute("PRAGMA synchronous = FULL")
        if not schema.is_readable(self._connection):
            schema.create(self._connection)
            durable.sync(self._folder)
        self._file = files.identity(self.path)
        self.known = known_of(self._connection)
        self.box_uuid = self._newest_core()

    def _newest_core(self) -> str:
        row = self._connection.execute("SELECT box_uuid FROM sessions ORDER BY id DESC LIMIT 1").fetchone()
        return "" if row is None else row[0]


def _is_journal(path: str) -> bool:
    """Whether a file is an undamaged journal of this version."""
    try:
        with contextlib.closing(sqlite3.connect(path, timeout=BUSY_S, isolation_level=None)) as connection:
            return (schema.is_readable(connection) and schema.is_whole(connection)
                    and connection.execute("PRAGMA quick_check(1)").fetchone()[0] == "ok")
    except sqlite3.OperationalError:
        raise
    except sqlite3.DatabaseError:
        return False


def _locked(path: str) -> int:
    """Lock the copy, as a core locks its journal. Raises OSError or `CannotWriteCopy`."""
    fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.ftruncate(fd, 0)
        os.pwrite(fd, f"{os.getpid()}\n".encode("ascii"), 0)
    except BlockingIOError:
        os.close(fd)
        raise CannotWriteCopy("another core or copy uses the folder. Use another folder, or end that one") from None
    except BaseException:
        os.close(fd)
        raise
    return fd
