"""A `ModulesHost` in a thread of its own, for a box in the same process.

Rules of a competition are code of others and may block. That stops only the thread: it sends nothing more, so the core
reports the modules as missing and pauses their runs, as it does with a node that hangs.
"""

import asyncio
import contextlib
import logging
import threading
from typing import Callable, Optional, Sequence

from roah_rsbb.bmbox.host.host import ModulesHost
from roah_rsbb.model.modules import ModulesState, RunForModule

# Seconds to wait at the end. Rules that hang do not delay the box's end longer.
LEAVE_S = 1.0

_log = logging.getLogger(__name__)

Send = Callable[[ModulesState], object]
MakeHost = Callable[[asyncio.AbstractEventLoop, Send], ModulesHost]


class ModulesThread:
    """The thread. Call everything in the thread of the box's loop: `start`, then `take`, then `close`."""

    def __init__(self, make: MakeHost, send: Send, post: Callable[..., object]) -> None:
        """`make` makes the host, in the new thread. `send` is called in the box's loop by means of `post`, such as
        `loop.call_soon_threadsafe`."""
        self._make, self._send, self._post = make, send, post
        self._loop = asyncio.new_event_loop()
        self._host: Optional[ModulesHost] = None
        self._lock = threading.Lock()
        self._newest: Optional[Sequence[RunForModule]] = None  # runs that the host has not taken
        self._is_closed = False
        # A daemon: a thread that hangs does not keep the process.
        self._thread = threading.Thread(target=self._run, name="benchmarking modules", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def take(self, runs: Sequence[RunForModule]) -> None:
        """Hand the present runs over. While the thread is busy, only the newest ones wait."""
        with self._lock:
            is_first, self._newest = self._newest is None, runs
        if is_first:
            self._in_thread(self._take)

    def close(self) -> None:
        """End the thread, or abandon it if it does not end within `LEAVE_S`."""
        self._in_thread(self._loop.stop)
        self._thread.join(LEAVE_S)
        self._is_closed = True
        if self._thread.is_alive():
            _log.warning("The rules of a benchmark hang and were abandoned")

    def _in_thread(self, job: Callable[[], object]) -> None:
        with contextlib.suppress(RuntimeError):  # the thread has failed, which is in the log
            self._loop.call_soon_threadsafe(job)

    def _run(self) -> None:
        try:
            self._host = self._make(self._loop, self._post_state)
            self._host.start()
            self._loop.run_forever()
            self._host.close()
        except BaseException:  # rules may raise anything, even SystemExit
            _log.exception("internal error, please report it: the benchmarking modules ended")
        finally:
            self._loop.close()

    def _take(self) -> None:
        with self._lock:
            runs, self._newest = self._newest, None
        assert self._host is not None and runs is not None, "the loop runs once there is a host, and for new runs only"
        self._host.take(runs)

    def _post_state(self, state: ModulesState) -> None:
        if not self._is_closed:
            self._post(self._send, state)
