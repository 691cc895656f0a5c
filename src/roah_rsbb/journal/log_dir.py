"""The box's log_dir: the journal's folder, which one process locks, and what is kept beside it.

A journal is never deleted. One from which the core cannot resume is renamed, and `results --journal` can read it.
"""

import contextlib
import enum
import json
import os
import threading
import time
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.ground import durable, linux
from roah_rsbb.journal.contents import DAMAGED, Contents, Opened, no_journal, open_journal
from roah_rsbb.journal.log import NEWEST, NewerFormat

# In log_dir: the folder of the journal's segments, the ports that were used, and the configuration in force.
JOURNAL, PORTS, CONFIGURATION = "roah_rsbb_journal", "used_private_ports", "configuration.json"


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
    path = os.path.join(log_dir, JOURNAL)
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
        with open(os.path.join(log_dir, f"{JOURNAL}.lock"), "rb") as file:
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
    path, warnings = os.path.join(log_dir, JOURNAL), []
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


# -- what the previous session left -----------------------------------------------------------------


class PreviousSession(NamedTuple):
    """Everything that a core needs to resume. Values are those of JSON."""

    states: Dict[str, Any]  # by name
    outcomes: Tuple[Any, ...]  # the records of all runs, including active ones; oldest first
    log_files: Dict[int, str]  # path of the run log by port
    ended_logs: Tuple[str, ...]  # those of the runs that are over
    last_port: Optional[int]  # the highest used private port
    last: Optional[CoreSession]  # the session that wrote the states, with the times of its last record


NOTHING = PreviousSession({}, (), {}, (), None, None)


def read_previous_session(opened: Opened) -> Tuple[PreviousSession, List[str]]:
    """Return the state before the new session, and what is damaged in it, in words. Raises OSError."""
    contents, found, problems = opened.contents, {}, []
    for run, outcome in opened.outcomes(contents.runs.values()):
        identity = run.row[0]
        found[identity] = outcome
        if outcome is DAMAGED:
            earlier = found[identity] = opened.earlier_outcome(identity)
            problems.append(f"the newest record of the run {identity} is damaged; "
                            f"{'there is no other' if earlier is None else 'an earlier one counts'}")
    ordered = sorted(contents.runs.values(), key=lambda run: run.row[-1])
    outcomes = [found[run.row[0]] for run in ordered if found[run.row[0]] is not None]
    members = [member for run in contents.runs.values() for member in run.members]
    last = None
    if contents.sessions:
        mono, utc = contents.last
        last = CoreSession(*contents.sessions[contents.stated - 1])._replace(mono=mono, utc=utc)
    previous = PreviousSession(
        states={name: state.state for name, state in contents.states.items() if state.state is not None},
        outcomes=tuple(outcomes), log_files={member[0]: member[4] for member in members if member[4]},
        ended_logs=tuple([member[4] for run in contents.runs.values() if run.closed is not None
                          for member in run.members if member[4]]),
        last_port=max(contents.run_of, default=None), last=last,
    )
    problems += [f"the state of {name} is damaged" for name, state in contents.states.items() if state.state is None]
    return previous, problems


# -- used private ports -----------------------------------------------------------------------------

LARGEST_PORT = 65535
_DIGITS = 5


def begin_thread(work: Callable[[], None]) -> None:
    """Run a function in a thread of its own."""
    threading.Thread(target=work, name="ports", daemon=True).start()


class PortRecord:
    """The private ports that a competition used, so that none is used twice, even across restarts.

    It is a text file with one port a line. A thread appends a port when it is used (docs/protocol.md, "Channels"),
    because a slow disk must not delay the box. The journal has it, too, before it is used: it is written, and synced
    within 0.05 s and the time of the disk. A power failure meanwhile may take the record of a connect, and so its port.
    A line that a power failure truncated contains a smaller number, or is empty. Both are harmless, because only the
    largest number counts.
    """

    def __init__(self, log_dir: str, begin: Callable[[Callable[[], None]], None] = begin_thread) -> None:
        """`begin` runs a function that may wait for the disk."""
        self.path = os.path.join(log_dir, PORTS)
        self._begin = begin

    def read(self) -> Tuple[Optional[int], List[str]]:
        """Return the largest used port (None if no port was used), and warnings about invalid lines.

        Raises OSError if the file exists but cannot be read.
        """
        try:
            with open(self.path, encoding="ascii", errors="replace") as file:
                lines = file.read().split()
        except FileNotFoundError:
            return None, []
        ports = [int(line) for line in lines if len(line) <= _DIGITS and line.isdigit() and int(line) <= LARGEST_PORT]
        warnings = []
        if len(ports) < len(lines):
            warnings.append(f"{self.path}: {len(lines) - len(ports)} lines are not UDP ports and were skipped")
        return max(ports, default=None), warnings

    def add(self, port: int, on_problem: Callable[[OSError], None]) -> None:
        """Record a port. `on_problem` is called from another thread if it does not reach the disk."""
        self._begin(lambda: _append(self.path, port, on_problem))


def _append(path: str, port: int, on_problem: Callable[[OSError], None]) -> None:
    """Append a port to the file, and sync that to the disk."""
    try:
        fd = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        try:
            # Begin with a line break, in case the previous line is truncated.
            os.write(fd, f"\n{port}\n".encode("ascii"))
            os.fsync(fd)
        finally:
            os.close(fd)
    except OSError as error:
        on_problem(error)


# -- the configuration in force ---------------------------------------------------------------------

# After a crash, the core continues with what it had read, whatever an editor has since done to the files. Runs that
# were connected before a change of the configuration also need the earlier files. Passwords are never copied to this
# place (docs/journal.md, "The configuration in force").

# What the files of a version are, in their order. A box without rules for standings has three, or an empty path as the
# fourth if there are decisions.
NAMES = ("benchmarks", "schedule", "passwords", "standings", "decisions")


class Texts(NamedTuple):
    """The files of a version: their paths, and their contents (None: not kept, or could not be read)."""

    paths: Tuple[str, ...]
    texts: Tuple[Optional[str], ...]


class InForce(NamedTuple):
    """The versions that are still needed."""

    launch: str  # the launch in which the present version was read
    present: int
    versions: Dict[int, Texts]
    edits: Tuple[Mapping[str, Any], ...] = ()  # of the schedule while the box ran, the newest last: JSON
    unwritten: Optional[str] = None  # the text of the schedule file without the edits that it lacks; None: it has all


def read_in_force(log_dir: str) -> Optional[InForce]:
    """Read what the last core left; None: nothing that can be read."""
    try:
        with open(os.path.join(log_dir, CONFIGURATION), encoding="utf-8") as file:
            found = json.load(file)
        versions = {int(number): Texts(tuple(map(str, paths)), tuple(None if t is None else str(t) for t in texts))
                    for number, (paths, texts) in found["versions"].items()}
        present = int(found["present"])
        edits, unwritten = tuple(map(dict, found.get("edits", ()))), found.get("unwritten")
        return InForce(str(found["launch"]), present, versions, edits,
                       None if unwritten is None else str(unwritten)) if present in versions else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def kept_files(log_dir: str, version: Optional[int] = None) -> Dict[str, str]:
    """Return the contents of a version (default, and if it is not kept: the present one) by `NAMES`, without passwords.
    Empty: nothing that can be read."""
    kept = read_in_force(log_dir)
    if kept is None:
        return {}
    found = kept.versions.get(kept.present if version is None else version, kept.versions[kept.present])
    return {name: text for name, text in zip(NAMES, found.texts) if text is not None}


def write_in_force(log_dir: str, what: InForce) -> None:
    """Replace the file, and wait until it is on the disk. Raises OSError, and the old file stays."""
    os.makedirs(log_dir, exist_ok=True)
    text = json.dumps(what._asdict())
    durable.write_file(os.path.join(log_dir, CONFIGURATION), text.encode("utf-8"), durable.USUAL)
