"""Brings what was written to the journal onto the disk, in a thread of its own.

SQLite hands what is committed to the system, where it survives this process, but not a power cut. This thread
forces it to the disk within `GROUP_S`, many commits at once, and now and then moves the write-ahead log into the
database (a checkpoint). Nobody who waits for a datagram waits for a disk.
"""

import os
import sqlite3
import threading
from typing import Callable

# Commits of so many seconds go to the disk together: half of what a power cut may take (docs/architecture.md, "First
# written, then done").
GROUP_S = 0.05
# After so many commits the write-ahead log is moved into the database.
CHECKPOINT_COMMITS = 500
BUSY_TIMEOUT_S = 1.0


class Disk:
    """Syncs one journal. All methods may be called from any thread."""

    def __init__(self, path: str, on_problem: Callable[[str], None]) -> None:
        """`on_problem` is called from the thread with what keeps data from the disk; empty: it works again."""
        self._path = path
        self._on_problem = on_problem
        self._problem = ""
        self._changed = threading.Condition()
        self._written = 0
        self._synced = 0
        self._checkpointed = 0
        self._hurry = False
        self._ended = False
        self._thread = threading.Thread(target=self._work, name="journal", daemon=True)
        self._thread.start()

    def written(self) -> None:
        """Something was committed."""
        with self._changed:
            self._written += 1
            self._changed.notify_all()

    def wait(self, timeout: float) -> bool:
        """Wait until all that was committed before is on the disk, at most `timeout` seconds; False: it is not."""
        with self._changed:
            target = self._written
            self._hurry = True
            self._changed.notify_all()
            return self._changed.wait_for(lambda: self._synced >= target, timeout)

    def end(self) -> None:
        """Sync what is left, and end the thread."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join()

    # -- in the thread ------------------------------------------------------------------------------

    def _work(self) -> None:
        ended = False
        while not ended:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._written > self._synced)
                self._changed.wait_for(lambda: self._ended or self._hurry, GROUP_S)
                self._hurry = False
                target, ended = self._written, self._ended
            if target > self._synced:
                self._sync(target)

    def _sync(self, target: int) -> None:
        problem = self._force(target)
        with self._changed:
            if not problem:
                self._synced = target
            self._changed.notify_all()
        if problem != self._problem:
            self._problem = problem
            self._on_problem(problem)

    def _force(self, target: int) -> str:
        """What keeps the data from the disk; empty: nothing.

        Only the write-ahead log is opened here: to close the database itself would give up SQLite's locks on it.
        """
        try:
            fd = os.open(f"{self._path}-wal", os.O_RDONLY)
            try:
                os.fsync(fd)
            finally:
                os.close(fd)
            if target - self._checkpointed >= CHECKPOINT_COMMITS:
                self._checkpointed = target
                self._checkpoint()
        except (OSError, sqlite3.Error) as error:
            return str(error)
        return ""

    def _checkpoint(self) -> None:
        connection = sqlite3.connect(self._path, timeout=BUSY_TIMEOUT_S, isolation_level=None)
        try:
            connection.execute("PRAGMA synchronous = FULL")
            connection.execute("PRAGMA wal_checkpoint(PASSIVE)")
        finally:
            connection.close()
