"""A copy of the journal in another folder, from which a core can resume.

The folder is often a USB stick: it can vanish at any moment, and be another one when it is back.
"""

import contextlib
import fcntl
import os
import sqlite3
from typing import Optional

from roah_rsbb import durable
from roah_rsbb.copies.copy import CannotWriteCopy, Copy, FileContent
from roah_rsbb.copies.rows import COLUMNS, Rows, known_of
from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema

BUSY_S = 1.0


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
        """Write rows and files, on the disk when this returns. Raises `CannotWriteCopy`."""
        with self._writing():
            # The files come first: the journal refers to them.
            for name, content in beside.items():
                # Only the owner may read it: it can be the teams' passwords.
                durable.write_file(os.path.join(self._folder, name), content)
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                for table, found in rows.tables.items():
                    columns = COLUMNS[table]
                    self._connection.executemany(
                        f"INSERT OR REPLACE INTO {table} ({', '.join(columns)})"
                        f" VALUES ({', '.join('?' * len(columns))})", found)
                self._connection.execute("COMMIT")
            except BaseException:
                with contextlib.suppress(sqlite3.Error):
                    self._connection.execute("ROLLBACK")
                raise
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

    @contextlib.contextmanager
    def _writing(self):
        try:
            yield
        except (sqlite3.Error, files.CannotWriteJournal) as error:
            raise CannotWriteCopy(f"{error}. Repair or replace the stick") from None
        except OSError as error:
            raise CannotWriteCopy(f"{error.strerror}. Repair or replace the stick") from None

    def _open(self) -> None:
        if os.path.exists(self.path) and not _is_journal(self.path):
            self.aside = files.set_aside(self.path)
        self._connection = sqlite3.connect(self.path, timeout=BUSY_S, isolation_level=None, check_same_thread=False)
        self._connection.text_factory = lambda value: value.decode("utf-8", errors="replace")
        schema.add_functions(self._connection)
        # Some file systems cannot have a write-ahead log. SQLite then uses another way that is as safe.
        self._connection.execute("PRAGMA journal_mode = WAL").fetchone()
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
