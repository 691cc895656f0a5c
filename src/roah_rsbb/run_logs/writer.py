"""Writes run logs, one rosbag per run, in a separate thread (docs/ros_interface.md, "Run log").

Theory of operation. Disk access must not delay the answer to a datagram, so the loop only puts jobs into a queue.
The thread hands entries to the operating system as they arrive, and ends the bags' chunks once a second.

The journal has every entry of a run. If a file fails (the disk is full, the file was removed, the process was
killed), run and log continue: entries that arrive in the meantime are dropped here. When the file can be written
again, it is rewritten completely. The loop puts the journal's entries into the same queue: earlier entries are among
them, later entries follow in the queue. No entry is lost or duplicated.
"""

import contextlib
import errno
import logging
import os
import queue
import threading
import time
from typing import Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Set

from roah_rsbb import platform
from roah_rsbb.core import effects
from roah_rsbb.run_logs.bag_file import DRAFT, WRITE_ERRORS, GrowingBag, try_out, write_whole
from roah_rsbb.run_logs.messages import LogEntry, message_of
from roah_rsbb.run_logs.names import is_log_name, log_name, unused
from roah_rsbb.run_logs.salvage import is_closed

# Interval at which chunks are ended and files checked.
CHECK_S = 1.0
# A file that cannot be written is retried after this time.
RETRY_S = 2.0
# A log is rewritten only if the disk has this much space (bytes) beyond the size of the old file.
ROOM = 32 * 1024
# When this many jobs wait for a slow disk, further entries come from the journal later.
MAX_WAITING = 10_000
# Time limit for completing the logs when the node ends.
STOP_S = 5.0

_REMEDIES = {
    errno.ENOSPC: "free space on the disk of log_dir",
    errno.EDQUOT: "free space on the disk of log_dir",
    errno.EROFS: "make the disk of log_dir writable",
    errno.EACCES: "make log_dir writable for this user",
    errno.EPERM: "make log_dir writable for this user",
}

_log = logging.getLogger(__name__)


class _Log:
    """The log of a run. Only the writer's thread uses it."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.bag: Optional[GrowingBag] = None  # None: to be rewritten when possible
        self.requested = False  # the loop was asked for its entries
        self.retry_at = 0.0  # monotonic time (s)
        self.is_over = False  # no further entries
        self.reported: List[str] = []  # problems that the referee was informed of


class RunLogWriter:
    """Writes the bags of all runs. Call all methods except `check` in the loop's thread."""

    def __init__(
        self, log_dir: str, box_uuid: str, on_problem: Callable[[str], None],
        on_repaired: Optional[Callable[[str, str], None]] = None,
        entries_of: Callable[[int], Optional[Sequence[LogEntry]]] = lambda port: (),
        post: Callable[[Callable[[], None]], None] = lambda function: function(),
    ) -> None:
        """`on_problem` is called in the writer's thread with a problem and its remedy; `on_repaired` with the text of
        a problem that is solved and with what to report instead. `entries_of` returns all entries of the run with
        this port, in order, or None if they cannot be read now; it is called in the loop's thread, through `post`."""
        self._log_dir = log_dir
        self._box_uuid = box_uuid
        self._on_problem = on_problem
        self._on_repaired = on_repaired or (lambda problem, text: on_problem(text))
        self._entries_of = entries_of
        self._post = post
        self._jobs: queue.Queue[Optional[Callable[[], None]]] = queue.Queue()
        self._requests: queue.Queue[Optional[int]] = queue.Queue()
        self._skipped: Set[int] = set()
        self.files: Dict[int, str] = {}  # path of each run's log by the run's port
        # Used in the thread only:
        self._logs: Dict[int, _Log] = {}
        self._left_open: Optional[Iterator[str]] = None
        self._known: Dict[str, int] = {}
        self._ending = False
        self._thread = threading.Thread(target=self._work, name="run logs", daemon=True)
        self._thread.start()

    def check(self) -> str:
        """Why logs cannot be written to the log directory, with the remedy; empty if they can."""
        try:
            os.makedirs(self._log_dir, exist_ok=True)
        except OSError as error:
            return f"log_dir {self._log_dir} cannot be created: {error.strerror}. Choose another log_dir"
        if not os.access(self._log_dir, os.W_OK | os.X_OK):
            return f"log_dir {self._log_dir} is not writable: choose another log_dir, or make it writable"
        return ""

    def opened(self, effect: effects.RunOpened, utc: float) -> None:
        """A run has begun."""
        name = log_name(utc, effect.team, effect.robot, effect.round, effect.run, self._box_uuid)
        path = unused(os.path.join(self._log_dir, name), effect.port, self.files.values())
        self.files[effect.port] = path
        self._jobs.put(lambda: self._open(effect.port, path))

    def resumed(self, port: int, path: str) -> None:
        """A run continues after a restart; `path` is its log, empty if unknown."""
        name = os.path.basename(path) or log_name(time.time(), f"port{port}", "", 0, 0, self._box_uuid)
        self.files[port] = path = os.path.join(self._log_dir, name)
        self._jobs.put(lambda: self._rewrite(port, _Log(path)))

    def logged(self, effect: effects.RunLogged, utc: float) -> None:
        """Add an entry to a run's log."""
        port = effect.port
        if port in self._skipped:
            return
        if self._jobs.qsize() < MAX_WAITING:
            self._jobs.put(lambda: self._write(port, (effect.topic, effect.value, utc)))
        else:
            self._skipped.add(port)
            self._jobs.put(lambda: self._fall_behind(port))

    def closed(self, effect: effects.RunClosed) -> None:
        """A run has ended."""
        self.files.pop(effect.port, None)
        self._jobs.put(lambda: self._close(effect.port))

    def repair(self, known: Mapping[int, str]) -> None:
        """Repair the logs that a killed process left open, when there is nothing else to do.

        Call it once at the start, after `resumed` for all runs that continue. `known` has the paths of the journal's
        runs by port.
        """
        self._jobs.put(lambda: self._begin_repairs({os.path.basename(path): port for port, path in known.items()}))

    def stop(self) -> None:
        """Write the remaining entries, close all bags and end the thread."""
        self._jobs.put(None)
        deadline = time.monotonic() + STOP_S
        with contextlib.suppress(queue.Empty):
            while True:
                port = self._requests.get(timeout=max(0.0, deadline - time.monotonic()))
                if port is None:
                    self._thread.join()
                    return
                self._answer(port)

    def _answer(self, port: int) -> None:
        """Give the thread a run's entries. Entries that are logged later follow in the queue."""
        try:
            entries = self._entries_of(port)
        except Exception:
            _log.error("internal error, please report it: no entries for a run log", exc_info=True)
            entries = None
        if entries is None:
            self._jobs.put(lambda: self._not_now(port))
            return
        self._skipped.discard(port)
        self._jobs.put(lambda: self._rewrite_with(port, entries))

    # -- in the writer's thread ---------------------------------------------------------------------

    def _work(self) -> None:
        check_at = time.monotonic() + CHECK_S
        while True:
            try:
                job = self._jobs.get(timeout=0.0 if self._left_open else max(0.0, check_at - time.monotonic()))
            except queue.Empty:
                job = self._repair_next
            if job is None:
                break
            self._do(job)
            if time.monotonic() >= check_at:
                self._do(self._check_all)
                check_at = time.monotonic() + CHECK_S
        self._do(self._end)
        self._requests.put(None)

    @staticmethod
    def _do(job: Callable[[], None]) -> None:
        try:
            job()
        except Exception:
            # A failure in one log must not end the others.
            _log.error("internal error, please report it: a run log could not be written", exc_info=True)

    def _end(self) -> None:
        """Close all logs. The loop waits in `stop` and answers requests immediately."""
        self._ending = True
        for port, log in list(self._logs.items()):
            log.is_over = True
            if log.bag is None:
                self._request(port, log)
            else:
                self._finish(port, log)
        with contextlib.suppress(queue.Empty):
            while any(log.requested for log in self._logs.values()):
                self._do(self._jobs.get(timeout=STOP_S))

    def _check_all(self) -> None:
        for port, log in list(self._logs.items()):
            if log.bag is not None:
                self._check_file(log)
            elif not log.requested and time.monotonic() >= log.retry_at:
                self._request(port, log)

    def _check_file(self, log: _Log) -> None:
        try:
            log.bag.flush()
            is_in_place = log.bag.is_in_place()
        except WRITE_ERRORS as error:
            self._fail(log, error)
            return
        if not is_in_place:
            # The file may have been moved: close it so that it is readable.
            with contextlib.suppress(*WRITE_ERRORS):
                log.bag.close()
            self._fail(log, None)

    # -- jobs ---------------------------------------------------------------------------------------

    def _open(self, port: int, path: str) -> None:
        log = self._logs[port] = _Log(path)
        try:
            os.makedirs(self._log_dir, exist_ok=True)
            log.bag = GrowingBag(path)
        except WRITE_ERRORS as error:
            self._fail(log, error)

    def _write(self, port: int, entry: LogEntry) -> None:
        log = self._logs.get(port)
        if log is None or log.bag is None:
            return
        try:
            log.bag.write(message_of(entry))
        except WRITE_ERRORS as error:
            self._fail(log, error)

    def _fall_behind(self, port: int) -> None:
        log = self._logs.get(port)
        if log is not None and log.bag is not None:
            self._fail(log, OSError("its disk is too slow"))

    def _close(self, port: int) -> None:
        log = self._logs.get(port)
        if log is None:
            return
        log.is_over = True
        if log.bag is not None:
            self._finish(port, log)

    def _finish(self, port: int, log: _Log) -> None:
        try:
            log.bag.close()
        except WRITE_ERRORS as error:
            self._fail(log, error)
        else:
            del self._logs[port]

    # -- rewriting ----------------------------------------------------------------------------------

    def _fail(self, log: _Log, error: Optional[Exception]) -> None:
        """Stop writing a log for now. `error` None: its file was removed."""
        if log.bag is not None:
            log.bag.abandon()
            log.bag = None
        self._report(log, error)

    def _report(self, log: _Log, error: Optional[Exception]) -> None:
        log.retry_at = time.monotonic() + RETRY_S
        text = (f"The run log {log.path} was removed and is being written again: do not move or delete log_dir while "
                "the box runs")
        if error is not None:
            remedy = _REMEDIES.get(getattr(error, "errno", None), "check the disk of log_dir")
            text = (f"The run log {log.path} cannot be written: {getattr(error, 'strerror', None) or error}. "
                    f"The run continues, and its log will be completed later: {remedy}")
        if text not in log.reported:
            log.reported.append(text)
            self._on_problem(text)

    def _rewrite(self, port: int, log: _Log) -> None:
        self._logs[port] = log
        self._request(port, log)

    def _request(self, port: int, log: _Log) -> None:
        """Ask the loop for a run's entries if they can be written."""
        log.requested = False
        try:
            try_out(log.path, ROOM)
        except OSError as error:
            self._report(log, error)
            return
        log.requested = True
        if self._ending:
            self._requests.put(port)
        else:
            self._post(lambda: self._answer(port))

    def _not_now(self, port: int) -> None:
        log = self._logs[port]
        log.requested, log.retry_at = False, time.monotonic() + RETRY_S

    def _rewrite_with(self, port: int, entries: Sequence[LogEntry]) -> None:
        log = self._logs.get(port)
        if log is None or log.bag is not None:
            return
        log.requested = False
        try:
            bag, kept = write_whole(log.path, entries, stays_open=not log.is_over)
        except WRITE_ERRORS as error:
            self._report(log, error)
            return
        reported, log.reported = log.reported, []
        for problem in reported:
            self._on_repaired(problem, f"The run log {log.path} is complete again")
        if kept:
            self._on_problem(f"The run log {log.path} was damaged and has been written again. The damaged file is kept "
                             f"as {kept}")
        if log.is_over:
            del self._logs[port]
        else:
            log.bag = bag

    # -- logs that were left open -------------------------------------------------------------------

    def _begin_repairs(self, known: Dict[str, int]) -> None:
        self._known = known
        self._left_open = _unclosed(self._log_dir)

    def _repair_next(self) -> None:
        if self._left_open is None:
            return
        path = next(self._left_open, None)
        if path is None:
            self._left_open = None
            return
        port = self._known.get(os.path.basename(path))
        if port in self._logs or path in (log.path for log in self._logs.values()):
            return
        if port is not None:
            log = _Log(path)
            log.is_over = True
            self._rewrite(port, log)
            return
        text = _repair_log(path)
        if text:
            self._on_problem(text)
        else:
            _log.info("The run log %s was left open and is repaired", path)


def _unclosed(log_dir: str) -> Iterator[str]:
    """Find the run logs in a directory that were not closed and that no process writes.

    Removes leftover draft files. Their contents can be rebuilt from the journal.
    """
    for name in _file_names(log_dir):
        path = os.path.join(log_dir, name)
        with contextlib.suppress(OSError):
            if name.endswith(DRAFT):
                if is_log_name(name[:-len(DRAFT)]) and _is_unlocked(path):
                    os.remove(path)
            elif is_log_name(name) and _is_unlocked(path) and not _has_index(path):
                yield path


def _file_names(log_dir: str) -> List[str]:
    try:
        return sorted(os.listdir(log_dir))
    except OSError:
        return []


def _has_index(path: str) -> bool:
    with open(path, "rb") as file:
        return is_closed(file)


def _is_unlocked(path: str) -> bool:
    """Whether this is a file that no process has locked."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        try:
            platform.lock(file.fileno())
        except BlockingIOError:
            return False
        except OSError:
            pass  # the file system does not support locks
    return True


def _repair_log(path: str) -> str:
    """Repair a run log that was not closed. Returns a warning with its remedy; empty if all is well.

    Works on a copy. A damaged file is kept.
    """
    try:
        _, kept = write_whole(path, ())
    except WRITE_ERRORS as error:
        return (f"The run log {path} was not closed and could not be repaired: {error}. It is unchanged: "
                "solve the problem, then try 'rosbag reindex'")
    if kept:
        return (f"The run log {path} is damaged. It now has everything that could be read. The damaged file is kept as "
                f"{kept}; 'rosbag reindex' may recover more from it")
    return ""
