"""Syncs the journal to the disk in a separate thread.

SQLite hands committed data to the operating system, where it survives this process, but not a power failure. This
thread syncs it to the disk within `GROUP_S`, many commits at once. It also moves the write-ahead log into the database
(a checkpoint), so that the log stays small and the database is nearly complete by itself. The loop never waits for it.

After a failed fsync, a later success proves nothing, because Linux discards the pages that it could not write. After a
failure, data therefore counts as saved only when a checkpoint has written all of it to the database.
"""

import os
import sqlite3
import threading
import time
from typing import Callable, Optional

from roah_rsbb import durable

# Commits within this time (s) are synced together. It is half of what a power failure may lose (docs/architecture.md,
# "Write first, then act").
GROUP_S = 0.05
# The write-ahead log is moved into the database when it is this large, or this old.
CHECKPOINT_BYTES = 1_000_000
CHECKPOINT_S = 30.0
CHECKPOINT_PAUSE_S = 1.0
# Failed syncs are retried after this time.
RETRY_S = 0.5
BUSY_TIMEOUT_S = 1.0


class Disk:
    """Syncs one journal. All methods may be called from any thread.

    Tickets are rising numbers that the writer assigns to its commits.
    """

    def __init__(self, path: str, has_log: bool, on_problem: Callable[[str], None]) -> None:
        """`has_log`: whether the file has a write-ahead log; without one SQLite syncs each commit itself.

        `on_problem` is called in the thread with the reason why data cannot be saved; empty when it works again.
        """
        self._path = path
        self._has_log = has_log
        self._on_problem = on_problem
        self._problem = ""
        self._changed = threading.Condition()
        self._written = 0  # newest ticket
        self._synced = 0
        self._commits = 0
        self._waits_since: Optional[float] = None  # monotonic time (s) of the oldest commit that is not synced yet
        self._hurry = False
        self._checkpoint_wanted = False
        self._ended = False
        self._checkpointed_mono = time.monotonic()
        self._must_rewrite = False
        self._directory_synced = False
        self._thread = threading.Thread(target=self._work, name="journal", daemon=True)
        self._thread.start()

    def written(self, ticket: int, checkpoint: bool = False) -> None:
        """Everything up to this ticket was committed. `checkpoint`: move it into the database soon."""
        with self._changed:
            if self._waits_since is None:
                self._waits_since = time.monotonic()
            self._commits += 1
            self._written = max(ticket, self._written)
            self._checkpoint_wanted = self._checkpoint_wanted or checkpoint
            self._changed.notify_all()

    @property
    def synced(self) -> int:
        """The newest ticket that is on the disk."""
        return self._synced

    @property
    def problem(self) -> str:
        """Why the latest sync failed; empty if it succeeded."""
        return self._problem

    def waiting_s(self) -> float:
        """How long the oldest commit has been waiting for the disk."""
        with self._changed:
            return 0.0 if self._waits_since is None else time.monotonic() - self._waits_since

    def wait(self, ticket: int, timeout: float) -> bool:
        """Wait until this ticket is on the disk, at most `timeout` seconds; returns whether it is."""
        with self._changed:
            self._hurry = True
            self._changed.notify_all()
            return self._changed.wait_for(lambda: self._synced >= ticket, timeout)

    def end(self) -> None:
        """Sync the rest, and end the thread."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join()

    # -- in the thread ------------------------------------------------------------------------------

    def _work(self) -> None:
        ended = False
        while not ended:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._waits_since is not None)
                self._changed.wait_for(lambda: self._ended or self._hurry, RETRY_S if self._problem else GROUP_S)
                self._hurry = False
                waits, ended = self._waits_since is not None, self._ended
            if waits:
                self._sync()

    def _sync(self) -> None:
        with self._changed:
            target, commits, began = self._written, self._commits, time.monotonic()
        problem = self._problem_of(self._force)
        if not problem:
            with self._changed:
                self._synced = target
                # Commits after the beginning may have missed this sync.
                self._waits_since = began if self._commits > commits else None
                self._changed.notify_all()
            # Threads that wait for the sync must not wait for the checkpoint.
            problem = self._problem_of(self._checkpoint_if_due)
        if problem != self._problem:
            self._problem = problem
            self._on_problem(problem)

    def _problem_of(self, step: Callable[[], None]) -> str:
        try:
            step()
        except (OSError, sqlite3.Error) as error:
            self._must_rewrite = True
            return str(error)
        return ""

    def _force(self) -> None:
        """Sync all commits to the disk. Raises OSError or sqlite3.Error."""
        if not self._has_log:
            return
        if self._must_rewrite:
            self._checkpoint()
            self._must_rewrite = False
            return
        # Only the write-ahead log is opened: closing the database itself would release SQLite's locks on it.
        durable.sync(f"{self._path}-wal")
        if not self._directory_synced:
            durable.sync(os.path.dirname(self._path) or ".")
            self._directory_synced = True

    def _checkpoint_if_due(self) -> None:
        if not self._has_log:
            return
        with self._changed:
            wanted, self._checkpoint_wanted = self._checkpoint_wanted, False
        age = time.monotonic() - self._checkpointed_mono
        is_large = age >= CHECKPOINT_PAUSE_S and os.stat(f"{self._path}-wal").st_size >= CHECKPOINT_BYTES
        if wanted or is_large or age >= CHECKPOINT_S:
            self._checkpoint(must_be_whole=False)

    def _checkpoint(self, must_be_whole: bool = True) -> None:
        """Move the write-ahead log into the database. The writer does not wait for this: the next transaction after a
        whole checkpoint begins the log again and shortens its file."""
        self._checkpointed_mono = time.monotonic()
        connection = sqlite3.connect(self._path, timeout=BUSY_TIMEOUT_S, isolation_level=None)
        try:
            connection.execute("PRAGMA synchronous = FULL")
            _, in_log, moved = connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        finally:
            connection.close()
        if must_be_whole and moved < in_log:
            raise sqlite3.OperationalError(f"{in_log - moved} pages could not be moved into the database yet")
