"""Shows a program's log lines, which rospy also publishes on /rosout, in another thread.

A line is written to the terminal, which may take none (Ctrl-S, a pipe that nobody reads). Everything in the loop would
wait for it.
"""

import logging
import logging.handlers
import queue

# Seconds. Who takes no lines does not keep a process from ending.
FLUSH_S = 2.0


class LogLines(logging.handlers.QueueHandler):
    """Handles the lines of a logger in another thread. rospy's log file has those of a node at once, as before."""

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
