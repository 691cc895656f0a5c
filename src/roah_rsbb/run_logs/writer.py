"""Run logs: one rosbag for each run, written by a thread of its own (docs/ros_interface.md, "Run log").

Theory of operation. Nothing slow may stand between a datagram and its answer, so the loop only puts jobs into a
queue. Entries are handed to the system as they come, and the bags' chunks are ended once a second.

The journal knows every entry of a run. So whatever goes wrong with a file (the disk is full, somebody removed it,
the process was killed) ends neither run nor log: what arrives meanwhile is not kept here, and once the file can be
written, it is written anew as a whole. The loop gives the journal's entries for that, and puts them into the same
queue: those that came before are among them, those that come after follow in the queue. None is lost or doubled.
"""

import contextlib
import errno
import os
import queue
import threading
import time
from typing import Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Set

import rospy

from roah_rsbb.core import effects
from roah_rsbb.run_logs.bag_file import WRITE_ERRORS, GrowingBag, LogEntry, message_of, try_out, write_whole
from roah_rsbb.run_logs.names import log_name, unused
from roah_rsbb.run_logs.repair import mend, unclosed

# Chunks are ended, and files looked after, this often.
LOOK_S = 1.0
# A file that cannot be written is tried again after this long.
RETRY_S = 2.0
# A log is written anew only where there is room for so much more than it had (bytes).
ROOM = 32 * 1024
# A disk that is behind by so many jobs gets the rest from the journal, later.
MAX_WAITING = 10_000
# At the end of the node, logs may take so long to be completed.
STOP_S = 5.0

_REMEDIES = {
    errno.ENOSPC: "free space on the disk of log_dir",
    errno.EDQUOT: "free space on the disk of log_dir",
    errno.EROFS: "make the disk of log_dir writable",
    errno.EACCES: "make log_dir writable for this user",
    errno.EPERM: "make log_dir writable for this user",
}


class _Log:
    """The log of a run; only the writer's thread knows it."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.bag: Optional[GrowingBag] = None  # None: it is to be written anew when that is possible
        self.asked = False  # the loop will give its entries
        self.retry_at = 0.0  # monotonic time (s)
        self.is_over = False  # nothing will be added
        self.told: List[str] = []  # troubles that the referee was told


class RunLogWriter:
    """Writes the bags of all runs. All methods but `check` are to be called in the loop's thread."""

    def __init__(
        self, log_dir: str, box_uuid: str, on_trouble: Callable[[str], None],
        on_mended: Optional[Callable[[str, str], None]] = None,
        entries_of: Callable[[int], Sequence[LogEntry]] = lambda port: (),
        post: Callable[[Callable[[], None]], None] = lambda function: function(),
    ) -> None:
        """`on_trouble` is called from the writer's thread with what is wrong and the remedy; `on_mended` with such a
        text that holds no more, and with what to say instead. `entries_of` gives all entries of the run with this
        port, in their order; `post` calls a function in the loop's thread, and is where `entries_of` is called."""
        self._log_dir = log_dir
        self._box_uuid = box_uuid
        self._on_trouble = on_trouble
        self._on_mended = on_mended or (lambda trouble, text: on_trouble(text))
        self._entries_of = entries_of
        self._post = post
        self._jobs: queue.Queue[Optional[Callable[[], None]]] = queue.Queue()
        self._asks: queue.Queue[Optional[int]] = queue.Queue()
        self._skipped: Set[int] = set()
        self.files: Dict[int, str] = {}  # path of each run's log by the run's port
        # The thread's own:
        self._logs: Dict[int, _Log] = {}
        self._left_open: Optional[Iterator[str]] = None
        self._known: Dict[str, int] = {}
        self._ending = False
        self._thread = threading.Thread(target=self._work, name="run logs", daemon=True)
        self._thread.start()

    def check(self) -> str:
        """Why no logs can be written into the log directory, with the remedy; empty: they can."""
        try:
            os.makedirs(self._log_dir, exist_ok=True)
        except OSError as error:
            return f"log_dir {self._log_dir} cannot be made: {error.strerror}. Give another log_dir"
        if not os.access(self._log_dir, os.W_OK | os.X_OK):
            return f"log_dir {self._log_dir} is not writable: give another log_dir, or make it writable"
        return ""

    def opened(self, effect: effects.RunOpened, utc: float) -> None:
        """A run begins."""
        name = log_name(utc, effect.team, effect.robot, effect.round, effect.run, self._box_uuid)
        path = unused(os.path.join(self._log_dir, name), effect.port, self.files.values())
        self.files[effect.port] = path
        self._jobs.put(lambda: self._open(effect.port, path))

    def resumed(self, port: int, path: str) -> None:
        """A run goes on after the process was killed; `path` was its log's, empty: it is not known."""
        name = os.path.basename(path) or log_name(time.time(), f"port{port}", "", 0, 0, self._box_uuid)
        self.files[port] = path = os.path.join(self._log_dir, name)
        self._jobs.put(lambda: self._write_anew(port, _Log(path)))

    def logged(self, effect: effects.RunLogged, utc: float) -> None:
        """An entry of a run's log."""
        port = effect.port
        if port in self._skipped:
            return
        if self._jobs.qsize() < MAX_WAITING:
            self._jobs.put(lambda: self._write(port, (effect.topic, effect.value, utc)))
        else:
            self._skipped.add(port)
            self._jobs.put(lambda: self._fall_behind(port))

    def closed(self, effect: effects.RunClosed) -> None:
        """A run is over."""
        self.files.pop(effect.port, None)
        self._jobs.put(lambda: self._close(effect.port))

    def mend(self, known: Mapping[int, str]) -> None:
        """To be called once at the start, after `resumed` of all runs that go on: index again what other logs a
        killed process left open, in spare time. `known`: paths of the journal's runs, by the port."""
        self._jobs.put(lambda: self._begin_mending({os.path.basename(path): port for port, path in known.items()}))

    def stop(self) -> None:
        """Write what is left, close every bag and end the thread."""
        self._jobs.put(None)
        deadline = time.monotonic() + STOP_S
        with contextlib.suppress(queue.Empty):
            while True:
                port = self._asks.get(timeout=max(0.0, deadline - time.monotonic()))
                if port is None:
                    self._thread.join()
                    return
                self._answer(port)

    def _answer(self, port: int) -> None:
        """Give the writer a run's entries; what is logged from now on follows them."""
        try:
            entries = list(self._entries_of(port))
        except Exception:
            rospy.logerr("internal error, please report it: no entries for a run log", exc_info=True)
            self._jobs.put(lambda: self._not_now(port))
            return
        self._skipped.discard(port)
        self._jobs.put(lambda: self._begin_whole(port, entries))

    # -- in the writer's thread ---------------------------------------------------------------------

    def _work(self) -> None:
        look_at = time.monotonic() + LOOK_S
        while True:
            try:
                job = self._jobs.get(timeout=0.0 if self._left_open else max(0.0, look_at - time.monotonic()))
            except queue.Empty:
                job = self._mend_next
            if job is None:
                break
            self._do(job)
            if time.monotonic() >= look_at:
                self._do(self._look)
                look_at = time.monotonic() + LOOK_S
        self._do(self._end)
        self._asks.put(None)

    @staticmethod
    def _do(job: Callable[[], None]) -> None:
        try:
            job()
        except Exception:
            # One log that fails must not end the others.
            rospy.logerr("internal error, please report it: a run log could not be written", exc_info=True)

    def _end(self) -> None:
        """Close all logs. The loop stands, and answers at once."""
        self._ending = True
        for port, log in list(self._logs.items()):
            log.is_over = True
            if log.bag is None:
                self._ask(port, log)
            else:
                self._finish(port, log)
        with contextlib.suppress(queue.Empty):
            while any(log.asked for log in self._logs.values()):
                self._do(self._jobs.get(timeout=STOP_S))

    def _look(self) -> None:
        for port, log in list(self._logs.items()):
            if log.bag is not None:
                self._look_after(log)
            elif not log.asked and time.monotonic() >= log.retry_at:
                self._ask(port, log)

    def _look_after(self, log: _Log) -> None:
        try:
            log.bag.flush()
            is_in_place = log.bag.is_in_place()
        except WRITE_ERRORS as error:
            self._lapse(log, error)
            return
        if not is_in_place:
            # Wherever it may be now, it is readable up to here.
            with contextlib.suppress(*WRITE_ERRORS):
                log.bag.close()
            self._lapse(log, None)

    # -- jobs ---------------------------------------------------------------------------------------

    def _open(self, port: int, path: str) -> None:
        log = self._logs[port] = _Log(path)
        try:
            os.makedirs(self._log_dir, exist_ok=True)
            log.bag = GrowingBag(path)
        except WRITE_ERRORS as error:
            self._lapse(log, error)

    def _write(self, port: int, entry: LogEntry) -> None:
        log = self._logs.get(port)
        if log is None or log.bag is None:
            return
        try:
            log.bag.write(message_of(entry))
        except WRITE_ERRORS as error:
            self._lapse(log, error)

    def _fall_behind(self, port: int) -> None:
        log = self._logs.get(port)
        if log is not None and log.bag is not None:
            self._lapse(log, OSError("its disk is too slow"))

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
            self._lapse(log, error)
        else:
            del self._logs[port]

    # -- written anew -------------------------------------------------------------------------------

    def _lapse(self, log: _Log, error: Optional[Exception]) -> None:
        """A log cannot be written; `error` None: its file was removed."""
        if log.bag is not None:
            log.bag.abandon()
            log.bag = None
        self._tell(log, error)

    def _tell(self, log: _Log, error: Optional[Exception]) -> None:
        log.retry_at = time.monotonic() + RETRY_S
        text = f"The run log {log.path} was removed, and is written anew: leave log_dir where it is"
        if error is not None:
            remedy = _REMEDIES.get(getattr(error, "errno", None), "mend the disk of log_dir")
            text = (f"The run log {log.path} cannot be written: {getattr(error, 'strerror', None) or error}. "
                    f"The run goes on, and its log will be complete: {remedy}")
        if text not in log.told:
            log.told.append(text)
            self._on_trouble(text)

    def _write_anew(self, port: int, log: _Log) -> None:
        self._logs[port] = log
        self._ask(port, log)

    def _ask(self, port: int, log: _Log) -> None:
        """Ask the loop for a run's entries, if they can be written."""
        log.asked = False
        try:
            try_out(log.path, ROOM)
        except OSError as error:
            self._tell(log, error)
            return
        log.asked = True
        if self._ending:
            self._asks.put(port)
        else:
            self._post(lambda: self._answer(port))

    def _not_now(self, port: int) -> None:
        log = self._logs[port]
        log.asked, log.retry_at = False, time.monotonic() + RETRY_S

    def _begin_whole(self, port: int, entries: Sequence[LogEntry]) -> None:
        log = self._logs.get(port)
        if log is None or log.bag is not None:
            return
        log.asked = False
        try:
            bag, kept = write_whole(log.path, entries, goes_on=not log.is_over)
        except WRITE_ERRORS as error:
            self._tell(log, error)
            return
        told, log.told = log.told, []
        for trouble in told:
            self._on_mended(trouble, f"The run log {log.path} is complete again")
        if kept:
            self._on_trouble(f"The run log {log.path} was damaged, and is written anew. What it was is kept as {kept}")
        if log.is_over:
            del self._logs[port]
        else:
            log.bag = bag

    # -- what others left open ----------------------------------------------------------------------

    def _begin_mending(self, known: Dict[str, int]) -> None:
        self._known = known
        self._left_open = unclosed(self._log_dir)

    def _mend_next(self) -> None:
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
            self._write_anew(port, log)
            return
        text = mend(path)
        if text:
            self._on_trouble(text)
        else:
            rospy.loginfo("The run log %s was left open, and is readable again", path)
