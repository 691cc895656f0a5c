"""The journal's folder: finds and locks it, sets one aside from which the core cannot resume, and begins a new one.

A journal is never deleted. One that is set aside is renamed, and `results --journal` can read it.
"""

import contextlib
import enum
import os
import time
from typing import Any, List, NamedTuple, Tuple

from roah_rsbb.ground import linux
from roah_rsbb.ground.linux import boot_id
from roah_rsbb.journal.contents import Contents, Opened, no_journal, open_journal
from roah_rsbb.journal.log import NEWEST, NewerFormat, identity

__all__ = [
    "FILE_NAME", "CannotWriteJournal", "CoreSession", "DamagedJournal", "JournalInUse", "Lock", "Resume", "boot_id",
    "holder_of", "identity", "is_stopped", "lock", "open_folder", "same_competition", "set_aside",
]

# The folder of the segments, in log_dir.
FILE_NAME = "roah_rsbb_journal"


class CannotWriteJournal(Exception):
    """The journal cannot be written now: its folder is missing, full or read-only. This may be temporary."""


class JournalInUse(CannotWriteJournal):
    """Another process uses the journal. The text says which one, since when, and how to end it."""


class DamagedJournal(CannotWriteJournal):
    """There is a journal, but nothing of it can be read. The text names the remedy."""


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


class Lock(NamedTuple):
    """A journal that belongs to this core as long as it keeps the file descriptor open."""

    path: str
    fd: int


def lock(log_dir: str) -> Lock:
    """Lock the journal in the folder. Raises `JournalInUse` or `CannotWriteJournal`."""
    path = os.path.join(log_dir, FILE_NAME)
    try:
        os.makedirs(log_dir, exist_ok=True)
        fd = _locked(path)
        with contextlib.suppress(OSError):  # a full or read-only disk
            os.ftruncate(fd, 0)
            os.pwrite(fd, f"{os.getpid()}\n".encode("ascii"), 0)
    except OSError as error:
        if _may_be_there(path):
            raise DamagedJournal(_unusable(path, error)) from None
        raise CannotWriteJournal(f"{log_dir}: {error.strerror}") from None
    return Lock(path, fd)


def _may_be_there(path: str) -> bool:
    """Whether something is at a path, or nobody can say because a folder on the way cannot be searched."""
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError:
        pass
    return True


def _unusable(path: str, error: OSError) -> str:
    return (f"The journal {path} cannot be read: {error.filename or path}: {error.strerror}. The core does not begin "
            "an empty one beside it. Make the folder and all files in it readable for the user of the box (chown), or "
            "remove what does not belong there, and start again")


def holder_of(log_dir: str) -> int:
    """Return the process that locked the journal in the folder last; 0: unknown."""
    try:
        with open(os.path.join(log_dir, f"{FILE_NAME}.lock"), "rb") as file:
            return _pid_in(file.fileno())
    except OSError:
        return 0


def _in_use(path: str, fd: int) -> str:
    pid, since = _pid_in(fd), time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(os.fstat(fd).st_mtime))
    who = f"process {pid}{', which is stopped' if is_stopped(pid) else ''}" if pid else "an unknown process"
    return (f"The journal {path} is in use by {who}, since {since}. This core waits until that process ends, and then "
            f"continues its runs. If it hangs, end it: kill -9 {pid or 'PID'}. If it is another box, use another "
            "log_dir")


def _pid_in(fd: int) -> int:
    text = os.pread(fd, 20, 0).decode("ascii", errors="replace").strip()
    return int(text) if text.isdigit() else 0


def is_stopped(pid: int) -> bool:
    """Whether a process is stopped (SIGSTOP, Ctrl-Z, a debugger) and does nothing."""
    return linux.status_of(pid)[0] in ("t", "T")


def _locked(path: str) -> int:
    """Lock the journal at a path; returns the descriptor. Raises `JournalInUse` or OSError."""
    fd = _lock_file(f"{path}.lock")
    try:
        linux.lock(fd)
    except BlockingIOError:
        try:
            raise JournalInUse(_in_use(path, fd)) from None
        finally:
            os.close(fd)
    return fd


def _lock_file(path: str) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        with contextlib.suppress(OSError):  # a read-only file is enough for a lock
            return os.open(path, os.O_RDONLY)
        raise error


COPY = ("A copy may have what is missing: compare with 'results --journal COPY verify' (docs/backup.md), and keep both "
         "until the results are final")
_NOT_EMPTY = ("Put the newest copy of the journal in its place (docs/backup.md), or, to begin without the runs so far, "
              "start once with resume:=never")


def open_folder(
    log_dir: str, competition: List[Any], resume: Resume, launch: str, late: bool = False,
) -> Tuple[Opened, List[str]]:
    """Open the journal in a locked folder for a competition (a list of its events, each a list). Nothing is written
    unless it must be set aside. `late`: the core already runs without it, so it is set aside. Returns it,
    empty if a new one begins, and warnings. Raises `CannotWriteJournal` or `DamagedJournal`, or OSError."""
    path, warnings = os.path.join(log_dir, FILE_NAME), []
    try:
        found = _opened(path)
        why = _why_not_resumed(found.contents, competition, resume, launch, late) if found.segments else ""
    except NewerFormat as error:
        found, why = no_journal(), str(error)
    if not found.segments and not why and found.problems:
        if resume is not Resume.NEVER:
            raise DamagedJournal(
                f"The journal {path} is damaged and cannot be continued: {'; '.join(found.problems)}. The core does "
                f"not begin an empty one beside it. {_NOT_EMPTY}")
        why = f"it is damaged ({'; '.join(found.problems)})"
    if why:
        warnings.append(f"The journal {path} is not continued: {why}. It is kept as {set_aside(path)}")
        return no_journal(), warnings
    damage = found.problems + found.holes
    if damage:
        warnings.append(f"The journal {path} is damaged: {'; '.join(damage)}. {COPY}")
    if found.torn:
        warnings.append(f"The journal {path} is not complete, as after a power failure: {found.torn}")
    return found, warnings


def _opened(path: str) -> Opened:
    """Read a journal. Raises `NewerFormat`, and `DamagedJournal` if it is there but cannot be read: a core that began
    without its runs would contradict it."""
    try:
        return open_journal(path)
    except OSError as error:
        raise DamagedJournal(_unusable(path, error)) from None


def set_aside(path: str) -> str:
    """Rename a journal; returns its new path. Raises `CannotWriteJournal`."""
    aside = _aside(path)
    try:
        for name in ("", NEWEST):
            with contextlib.suppress(FileNotFoundError):
                os.rename(path + name, aside + name)
    except OSError as error:
        raise CannotWriteJournal(f"{path} cannot be set aside: {error.strerror}") from None
    return aside


def _aside(path: str) -> str:
    stamp = time.strftime("%Y-%m-%d_%H-%M-%S")
    names = (f"{path}_aside_{stamp}{number}" for number in ("", *(f"_{n}" for n in range(2, 1000))))
    return next(name for name in names if not os.path.exists(name))


def _why_not_resumed(contents: Contents, competition: List[Any], resume: Resume, launch: str, late: bool) -> str:
    """Return why the core cannot resume from a journal; empty: it can."""
    if late:
        return ("it was not there when this core started, as if its disk had been missing. To continue it, end the "
                "core, put it back in its place, and start again")
    if not same_competition(contents.competition, competition):
        return "it belongs to another competition: none of its events is in the schedule"
    sessions = contents.sessions
    if not sessions or resume is Resume.ALWAYS or (resume is Resume.LAUNCH and sessions[-1][-1] == launch):
        return ""
    return f"the parameter resume of this core is '{resume.value}'"


def same_competition(saved: Any, present: List[Any]) -> bool:
    """Whether two schedules have an event in common, or nothing is known of the saved one. Times are ignored, because
    they may change during the day."""
    try:
        return saved is None or bool({tuple(e[:-1]) for e in saved} & {tuple(e[:-1]) for e in present})
    except TypeError:
        return True
