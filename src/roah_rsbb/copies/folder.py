"""A copy of the journal in another folder, from which a core can resume.

The folder is often a USB stick: it can vanish at any moment, and be another one when it is back.
"""

import contextlib
import fcntl
import os
import sqlite3
from typing import Dict, Optional, Tuple

from roah_rsbb.copies.rows import COLUMNS, CannotReadJournal, Known, Rows, known_of
from roah_rsbb.journal import file as files
from roah_rsbb.journal import in_force, ports, schema

# What a restart needs besides the journal.
FILES = (ports.FILE_NAME, in_force.FILE_NAME)
BUSY_S = 1.0

FileContent = Dict[str, bytes]


class CannotWriteCopy(Exception):
    """The copy cannot be written now. The text says why, and what to do."""


class JournalFiles:
    """The small files beside a journal. Reads those that changed."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._read: Dict[str, Tuple[int, int, int]] = {}

    def changed(self) -> FileContent:
        """Return the files that changed since the last call. Raises `CannotReadJournal`."""
        found: FileContent = {}
        for name in FILES:
            path = os.path.join(self._folder, name)
            try:
                stat = os.stat(path)
                state = stat.st_ino, stat.st_size, stat.st_mtime_ns
                if state != self._read.get(name):
                    with open(path, "rb") as file:
                        found[name] = file.read()
                    self._read[name] = state
            except FileNotFoundError:
                continue
            except OSError as error:
                raise CannotReadJournal(f"{path}: {error.strerror}") from None
        return found


class CopyFolder:
    """A copy that is open for writing. Call all methods in one thread."""

    def __init__(self, folder: str) -> None:
        """Raises `CannotWriteCopy`."""
        self._folder = folder
        self.path = os.path.join(folder, files.FILE_NAME)
        self.known = Known()
        self.box_uuid = ""  # of the core that wrote the newest session
        self.aside = ""  # where the previous contents were moved
        self._connection: Optional[sqlite3.Connection] = None
        self._lock: Optional[int] = None
        with self._writing():
            if not os.path.isdir(folder):
                raise CannotWriteCopy("the folder is missing. Plug the stick in again, or create the folder")
            self._device = os.stat(folder).st_dev
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
                _replace(os.path.join(self._folder, name), content)
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
        if not files.is_readable(self._connection):
            schema.create(self._connection)
            _sync_folder(self._folder)
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
            return (files.is_readable(connection) and schema.is_whole(connection)
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


def _replace(path: str, content: bytes) -> None:
    """Write a file whole or not at all."""
    draft = f"{path}.new"
    with open(draft, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(draft, path)
    _sync_folder(os.path.dirname(path))


def _sync_folder(path: str) -> None:
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)
