"""A loop and other threads: calls from them into it, and log lines that it does not wait for."""

import asyncio
import concurrent.futures
import logging
import logging.handlers
import queue
from typing import Callable, TypeVar

T = TypeVar("T")

# A referee's command takes milliseconds. A longer wait would only hide that the box is stuck.
ANSWER_TIMEOUT_S = 5.0
# Seconds. Who takes no lines does not keep a process from ending.
FLUSH_S = 2.0


def call_in_loop(loop: asyncio.AbstractEventLoop, function: Callable[[], T]) -> T:
    """Run a function in the thread of a loop, from another one, and return its result or raise its exception.

    Raises concurrent.futures.TimeoutError if the loop does not answer within `ANSWER_TIMEOUT_S`.
    """
    done: concurrent.futures.Future[T] = concurrent.futures.Future()

    def run() -> None:
        if not done.set_running_or_notify_cancel():
            return
        try:
            done.set_result(function())
        except Exception as error:
            done.set_exception(error)

    loop.call_soon_threadsafe(run)
    try:
        return done.result(ANSWER_TIMEOUT_S)
    finally:
        done.cancel()


class LogLines(logging.handlers.QueueHandler):
    """Handles the lines of a logger in another thread, because a terminal may take none (Ctrl-S, a pipe that nobody
    reads), and everything in the loop would wait for it. rospy's log file has those of a node at once, as before."""

    def __init__(self, logger_name: str = "rosout") -> None:
        """Create it when the logger has its handlers: after `rospy.init_node`."""
        lines: queue.SimpleQueue[logging.LogRecord] = queue.SimpleQueue()
        super().__init__(lines)
        self._logger = logging.getLogger(logger_name)
        self._handlers = list(self._logger.handlers)
        self._listener = logging.handlers.QueueListener(lines, *self._handlers, respect_handler_level=True)
        self._logger.handlers = [self]
        self._listener.start()

    def flush(self) -> None:
        """Handle the remaining lines, and all later ones in their own threads. `logging.shutdown` calls it, and Python
        calls that when the process ends."""
        if self in self._logger.handlers:
            self._logger.handlers = self._handlers
            self._listener.enqueue_sentinel()
            thread = self._listener._thread
            if thread is not None:
                thread.join(FLUSH_S)

    def close(self) -> None:
        """Flush, for good."""
        self.flush()
        super().close()
