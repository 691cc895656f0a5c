"""Run logs: one rosbag for each run, written by a thread of its own (ROS interface, Run log).

Nothing slow may stand between a datagram and its answer, so the loop only puts entries into a queue. The
bags are flushed about once a second while they grow. What goes wrong with a file is told, once for each
file and reason, and never ends a run.
"""

import os
import queue
import threading
import time
from typing import Callable, Dict, Optional

import rosbag
import rospy
from std_msgs.msg import Empty, String, UInt8

from roah_rsbb.core import effects
from roah_rsbb.core.run_log import KINDS, LogKind
from roah_rsbb.journal.log_names import log_name, unused
from roah_rsbb.msg import Score

FLUSH_S = 1.0


def _message(entry: effects.RunLogged):
    kind = KINDS[entry.topic]
    if kind is LogKind.UINT8:
        return UInt8(entry.value)
    if kind is LogKind.STRING:
        return String(entry.value)
    if kind is LogKind.SCORE:
        return Score(*entry.value)
    return Empty()


class _Bag:
    """A bag that grows."""

    def __init__(self, path: str, resume: bool = False) -> None:
        """Raises OSError."""
        self.path = path
        if resume:
            self._index()
        self._file = open(path, "r+b" if resume else "w+b")  # noqa: SIM115 (closed with the bag)
        self._bag = rosbag.Bag(self._file, "a" if resume else "w")
        self._dirty = False

    def _index(self) -> None:
        with rosbag.Bag(self.path, "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass

    def write(self, entry: effects.RunLogged, utc: float) -> None:
        self._bag.write(entry.topic, _message(entry), rospy.Time.from_sec(utc))
        self._dirty = True

    def flush(self) -> None:
        """Hand all to the system, so that it outlives this process; `rosbag reindex` then makes it readable."""
        if self._dirty:
            self._dirty = False
            self._bag.flush()
            self._file.flush()  # without this the index stays behind, and the rest cannot be read without it

    def close(self) -> None:
        self._bag.close()


class RunLogWriter:
    """Writes the bags of all runs. `on_trouble` is called from the writer's thread with a text."""

    def __init__(self, log_dir: str, box_uuid: str, on_trouble: Callable[[str], None]) -> None:
        self._log_dir = log_dir
        self._box_uuid = box_uuid
        self._on_trouble = on_trouble
        self._jobs: queue.Queue[Optional[Callable[[], None]]] = queue.Queue()
        self._bags: Dict[int, _Bag] = {}
        self.files: Dict[int, str] = {}  # path of each run's log by the run's port
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
        """A run goes on after a restart of the core, and so does its log."""
        self.files[port] = path
        self._jobs.put(lambda: self._open(port, path, resume=True))

    def logged(self, effect: effects.RunLogged, utc: float) -> None:
        """An entry of a run's log."""
        self._jobs.put(lambda: self._write(effect, utc))

    def closed(self, effect: effects.RunClosed) -> None:
        """A run is over."""
        self.files.pop(effect.port, None)
        self._jobs.put(lambda: self._close(effect.port))

    def stop(self) -> None:
        """Write what is left, close every bag and end the thread."""
        self._jobs.put(None)
        self._thread.join()

    # -- in the writer's thread ---------------------------------------------------------------------

    def _work(self) -> None:
        next_flush = time.monotonic() + FLUSH_S
        while True:
            try:
                job = self._jobs.get(timeout=max(0.0, next_flush - time.monotonic()))
            except queue.Empty:
                self._flush()
                next_flush = time.monotonic() + FLUSH_S
                continue
            if job is None:
                break
            job()
            if time.monotonic() >= next_flush:
                self._flush()
                next_flush = time.monotonic() + FLUSH_S
        for port in list(self._bags):
            self._close(port)

    def _open(self, port: int, path: str, resume: bool = False) -> None:
        try:
            os.makedirs(self._log_dir, exist_ok=True)
            self._bags[port] = _Bag(path, resume)
        except (OSError, rosbag.ROSBagException) as error:
            self._trouble(path, error)

    def _write(self, entry: effects.RunLogged, utc: float) -> None:
        bag = self._bags.get(entry.port)
        if bag is None:
            return
        try:
            bag.write(entry, utc)
        except (OSError, ValueError, rosbag.ROSBagException) as error:
            self._give_up(entry.port, error)

    def _flush(self) -> None:
        for port in list(self._bags):
            self._flush_one(port)

    def _flush_one(self, port: int) -> None:
        try:
            self._bags[port].flush()
        except (OSError, ValueError, rosbag.ROSBagException) as error:
            self._give_up(port, error)

    def _close(self, port: int) -> None:
        bag = self._bags.pop(port, None)
        if bag is None:
            return
        try:
            bag.close()
        except (OSError, ValueError, rosbag.ROSBagException) as error:
            self._trouble(bag.path, error)

    def _give_up(self, port: int, error: Exception) -> None:
        self._trouble(self._bags.pop(port).path, error)

    def _trouble(self, path: str, error: Exception) -> None:
        self._on_trouble(f"The run log {path} cannot be written: {error}. Free or mend the disk of log_dir")
