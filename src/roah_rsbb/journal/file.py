"""The journal's file: finds, checks and migrates it, or sets it aside and begins a new one.

A file from which the core cannot resume is never deleted. It is renamed, and `results --journal` can read it.
"""

import contextlib
import enum
import fcntl
import functools
import json
import os
import pathlib
import sqlite3
import time
from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import pages, schema
from roah_rsbb.journal.damage import find_damage, text_of
from roah_rsbb.journal.reader import JournalError
from roah_rsbb.journal.recover import recover

FILE_NAME = "roah_rsbb_journal.sqlite3"
# Files that SQLite keeps next to its database.
COMPANIONS = ("", "-wal", "-shm")
# Up to this many cores with the same log_dir get their own journals.
MAX_CORES = 20
COMPETITION = "competition"


class CannotWriteJournal(Exception):
    """The journal cannot be written now: its folder is missing, full or read-only. This may be temporary."""


class Resume(enum.Enum):
    """When a core resumes from an existing journal (parameter `resume`)."""

    ALWAYS = "always"
    LAUNCH = "launch"  # only within one roslaunch: after a crash, but not after a new start
    NEVER = "never"


class CoreSession(NamedTuple):
    """One start of the core."""

    utc: float
    mono: float
    boot_id: str  # identifies the computer's start, and so its monotonic clock
    pid: int
    box_uuid: str
    launch: str  # id of its roslaunch; empty if none


class File(NamedTuple):
    """An open journal."""

    connection: sqlite3.Connection
    warnings: Tuple[str, ...]


def boot_id() -> str:
    """The id of the computer's start; empty if unknown."""
    try:
        with open("/proc/sys/kernel/random/boot_id", encoding="ascii") as file:
            return file.read().strip()
    except OSError:
        return ""


class Holder(NamedTuple):
    """A process that has locked a journal."""

    path: str  # of the journal
    pid: int  # 0 if unknown


class Lock(NamedTuple):
    """A journal that belongs to this core as long as it keeps the file descriptor open."""

    path: str
    fd: int
    holders: Tuple[Holder, ...]  # of the journals before it


def lock(log_dir: str) -> Lock:
    """Lock the first journal in the folder that no other core uses. Raises `CannotWriteJournal`."""
    base, suffix = os.path.splitext(FILE_NAME)
    holders: List[Holder] = []
    try:
        os.makedirs(log_dir, exist_ok=True)
        for number in range(1, MAX_CORES + 1):
            path = os.path.join(log_dir, FILE_NAME if number == 1 else f"{base}_{number}{suffix}")
            fd = _lock_file(f"{path}.lock")
            try:
                fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                holders.append(Holder(path, _pid_in(fd)))
                os.close(fd)
                continue
            with contextlib.suppress(OSError):  # a full or read-only disk
                os.ftruncate(fd, 0)
                os.pwrite(fd, f"{os.getpid()}\n".encode("ascii"), 0)
            return Lock(path, fd, tuple(holders))
    except OSError as error:
        raise CannotWriteJournal(f"{log_dir}: {error.strerror}") from None
    raise CannotWriteJournal(
        f"{log_dir}: {MAX_CORES} cores have journals there: end some of them, or set another log_dir"
    )


def _pid_in(fd: int) -> int:
    text = os.pread(fd, 20, 0).decode("ascii", errors="replace").strip()
    return int(text) if text.isdigit() else 0


def is_stopped(pid: int) -> bool:
    """Whether a process is stopped (SIGSTOP, Ctrl-Z, a debugger) and does nothing."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split()[0] in "tT"
    except (OSError, IndexError):
        return False


def _lock_file(path: str) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        with contextlib.suppress(OSError):  # a read-only file is enough for a lock
            return os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        raise error


def open_file(path: str, competition: str, resume: Resume, launch: str) -> File:
    """Open the journal for a competition (JSON: a list of its events, each a list), or begin a new one.

    `launch`: the id of the new session's roslaunch. An existing journal is not changed, and can be read even if it
    cannot be written. Call `prepare` next. Raises `CannotWriteJournal`.
    """
    warnings: List[str] = []
    if os.path.exists(path):
        warnings += _replace_if_log_is_damaged(path)
        try:
            why = _why_not(path, competition, resume, launch)
        except sqlite3.OperationalError as error:
            raise CannotWriteJournal(f"{path}: {error}") from None
        if why:
            aside = set_aside(path)
            warnings.append(f"The journal {path} is not continued: {why}. It is kept as {aside}")
        else:
            warnings += _damage(path)
    try:
        connection = _connect(path)
    except (sqlite3.Error, OSError) as error:
        raise CannotWriteJournal(f"{path}: {error}") from None
    return File(connection, tuple(warnings))


def has_log(connection: sqlite3.Connection) -> bool:
    """Whether the journal has a write-ahead log; some file systems cannot have one."""
    return connection.execute("PRAGMA journal_mode").fetchone()[0] == "wal"


def prepare(connection: sqlite3.Connection, competition: str) -> None:
    """Bring an open journal up to date. Raises sqlite3.Error."""
    if not _number(connection, "application_id"):
        schema.create(connection)
    schema.migrate(connection, _number(connection, "user_version"))
    connection.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (COMPETITION, competition))


def set_aside(path: str) -> str:
    """Rename a journal and its companion files; returns its new path. Raises `CannotWriteJournal`."""
    base, suffix = os.path.splitext(path)
    stamp = time.strftime("%Y-%m-%d_%H-%M-%S")
    names = (f"{base}_aside_{stamp}{number}{suffix}" for number in ("", *(f"_{n}" for n in range(2, 1000))))
    aside = next(name for name in names if not os.path.exists(name))
    try:
        for companion in COMPANIONS:
            if os.path.exists(path + companion):
                os.rename(path + companion, aside + companion)
    except OSError as error:
        raise CannotWriteJournal(f"{path} cannot be set aside: {error.strerror}") from None
    return aside


def _replace_if_log_is_damaged(path: str) -> List[str]:
    """Set a journal with a damaged write-ahead log aside, and write its readable part to a new file: SQLite would
    silently drop everything after the damage. Returns warnings."""
    try:
        frames = pages.read_frames(f"{path}-wal")
    except OSError:
        return []
    if not pages.is_damaged(frames):
        torn = (f"The end of the write-ahead log of the journal {path} is torn or damaged: what happened last "
                "before the core ended may be missing")
        return [torn] if pages.is_torn(frames) else []
    aside = set_aside(path)
    kept = f"The write-ahead log of the journal {path} is damaged. It is kept as {aside}"
    try:
        recover(aside, path)
    except JournalError as error:
        return [f"{kept}. Nothing could be recovered from it: {error}"]
    return [f"{kept}. The box resumes from the recovered part"]


def _damage(path: str) -> List[str]:
    """Warnings about damage in a journal that the core resumes from."""
    try:
        with contextlib.closing(_connect(path)) as connection:
            found = find_damage(connection) if schema.is_readable(connection) else []
    except (sqlite3.Error, UnicodeDecodeError):
        return []  # it cannot be read yet
    return [f"The journal {path} is damaged: {'; '.join(map(text_of, found))}"] if found else []


def _connect(path: str) -> sqlite3.Connection:
    try:
        return _connect_as(path, path)
    except sqlite3.OperationalError:
        if not (os.path.exists(path) and _is_at_rest(path)):
            raise
    # The journal is closed, but SQLite cannot create its companion files: read it without them.
    return _connect_as(path, f"{pathlib.Path(path).resolve().as_uri()}?immutable=1")


def _is_at_rest(path: str) -> bool:
    """Whether the journal is complete without its companion files."""
    try:
        return os.stat(f"{path}-wal").st_size == 0
    except OSError:
        return True


def _connect_as(path: str, address: str) -> sqlite3.Connection:
    connection = sqlite3.connect(address, uri=address != path, timeout=1.0, isolation_level=None)
    # Also read damaged text that is not UTF-8: its readers detect the damage.
    schema.add_functions(connection)
    connection.text_factory = functools.partial(str, encoding="utf-8", errors="replace")
    try:
        mode = connection.execute("PRAGMA journal_mode = WAL").fetchone()[0]
        # Another thread syncs (see `disk`). Without a write-ahead log, each commit syncs itself.
        connection.execute(f"PRAGMA synchronous = {'OFF' if mode == 'wal' else 'FULL'}")
        connection.execute("PRAGMA wal_autocheckpoint = 0")
        connection.execute("PRAGMA journal_size_limit = 0")  # the log shrinks when it begins again
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def _why_not(path: str, competition: str, resume: Resume, launch: str) -> str:
    """Return why the core cannot resume from a journal; empty: it can. Raises OperationalError if it is locked now."""
    try:
        connection = _connect(path)
    except sqlite3.OperationalError:
        raise
    except sqlite3.DatabaseError as error:
        return f"it is damaged, or not a journal ({error})"
    try:
        if _is_empty(connection):
            return ""  # the core ended before it wrote anything
        return _problem_of(connection, competition) or _why_not_resumed(connection, resume, launch)
    except sqlite3.OperationalError:
        raise
    except (sqlite3.DatabaseError, ValueError) as error:
        return f"it is damaged ({error})"
    finally:
        connection.close()


def _is_empty(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0


def _problem_of(connection: sqlite3.Connection, competition: str) -> str:
    if _number(connection, "application_id") != schema.APPLICATION_ID:
        return "it belongs to another program"
    version = _number(connection, "user_version")
    if version > schema.VERSION:
        return f"a newer version of roah_rsbb wrote it (tables of version {version}, known up to {schema.VERSION})"
    if any(v not in schema.MIGRATIONS for v in range(version, schema.VERSION)):
        return f"its tables have version {version}, which this version of roah_rsbb no longer reads"
    found = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
    if found != "ok":
        return f"it is damaged ({found})"
    if version == schema.VERSION and not schema.is_whole(connection):
        return "it is damaged (its tables are not a journal's)"
    row = connection.execute("SELECT value FROM meta WHERE key = ?", (COMPETITION,)).fetchone()
    if row is not None and not same_competition(row[0], competition):
        return "it belongs to another competition: none of its events is in the schedule"
    return ""


def _why_not_resumed(connection: sqlite3.Connection, resume: Resume, launch: str) -> str:
    row = connection.execute("SELECT launch FROM sessions ORDER BY id DESC LIMIT 1").fetchone()
    if row is None or resume is Resume.ALWAYS or (resume is Resume.LAUNCH and row[0] == launch):
        return ""
    return f"the parameter resume of this core is '{resume.value}'"


def same_competition(saved: str, present: str) -> bool:
    """Whether two schedules have an event in common. Times are ignored, because they may change during the day.

    Raises ValueError for an invalid saved schedule.
    """
    try:
        events = {tuple(event[:-1]) for event in json.loads(saved)}
    except (TypeError, KeyError, RecursionError) as error:
        raise ValueError(f"its schedule cannot be read: {error}") from None
    return bool(events & {tuple(event[:-1]) for event in json.loads(present)})


def _number(connection: sqlite3.Connection, pragma: str) -> int:
    return connection.execute(f"PRAGMA {pragma}").fetchone()[0]


def identity(path: str) -> Optional[Tuple[int, int]]:
    """Identify the file at a path; None if it is missing. A deleted file stays writable, so compare identities."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_dev, found.st_ino


def copied(connection: sqlite3.Connection, path: str) -> sqlite3.Connection:
    """Copy an open journal to a new file, completely or not at all. Raises sqlite3.Error."""
    draft = f"{path}.draft"
    for companion in COMPANIONS:
        if os.path.exists(draft + companion):
            os.remove(draft + companion)
    with contextlib.closing(sqlite3.connect(draft, isolation_level=None)) as new:
        connection.backup(new)
        new.execute("PRAGMA journal_mode = DELETE")
    os.rename(draft, path)
    return _connect(path)
