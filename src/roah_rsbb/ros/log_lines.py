"""Shows a node's log lines, and publishes them on /rosout, in another thread.

rospy writes each line to the terminal, and waits while that takes none (Ctrl-S): so would everything in the loop.
"""

import logging
import logging.handlers
import queue


class LogLines(logging.handlers.QueueHandler):
    """Handles the lines of `rospy.loginfo` and so on in another thread. rospy's log file has them at once, as before.
    """

    def __init__(self, logger_name: str = "rosout") -> None:
        """Create it after `rospy.init_node`, which adds the handlers."""
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
            self._listener.stop()

    def close(self) -> None:
        """Flush, for good."""
        self.flush()
        super().close()
