"""Threads that write the journal, and sync it to the disk, many records at once. The loop does not wait for a disk."""

import threading
from typing import Callable

# Records within this time (s) are synced together. It is half of what a power failure may lose (docs/architecture.md,
# "Write first, then act").
GROUP_S = 0.05
# Failed syncs are retried after this time.
RETRY_S = 0.5


class Syncer:
    """Calls `work` after `wake`. All methods may be called from any thread. The simulator has another one."""

    def __init__(self, work: Callable[[], bool], group_s: float) -> None:
        """`work` writes or syncs everything, `group_s` after `wake`, and returns whether it succeeded; otherwise it is
        repeated."""
        self._work, self._group_s = work, group_s
        self._changed = threading.Condition()
        self._is_wanted = self._hurry = self._ended = False
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Work soon."""
        with self._changed:
            if not self._is_wanted:
                self._is_wanted = True
                self._changed.notify_all()

    def work(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """`wake` and `wait`, in one step."""
        with self._changed:
            self._is_wanted = self._hurry = True
            self._changed.notify_all()
            if self._ended:  # nobody works any more
                return is_done()
            return self._changed.wait_for(is_done, timeout)

    def wait(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """Work now, and wait until something is done, at most `timeout` seconds; returns whether it is."""
        with self._changed:
            self._hurry = True
            self._changed.notify_all()
            return self._changed.wait_for(is_done, timeout)

    def end(self) -> None:
        """Do the rest, and end the thread."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join()

    def _run(self) -> None:
        ended, succeeded = False, True
        while not ended:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._is_wanted)
                self._changed.wait_for(lambda: self._ended or self._hurry, self._group_s if succeeded else RETRY_S)
                is_wanted, ended = self._is_wanted, self._ended
                self._hurry = self._is_wanted = False
            if is_wanted:
                succeeded = self._work()
                with self._changed:
                    self._is_wanted = self._is_wanted or not succeeded
                    self._changed.notify_all()
