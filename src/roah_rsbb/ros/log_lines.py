"""Shows a node's log lines, and publishes them on /rosout, in another thread.

For each line, rospy calls the ROS master and waits for its answer. A slow master would delay everything in the loop.
"""

import atexit
import logging
import logging.handlers
import queue


class LogLines:
    """Handles the lines of `rospy.loginfo` and so on in another thread. rospy's log file has them at once, as before.
    """

    def __init__(self, logger_name: str = "rosout") -> None:
        """Create it after `rospy.init_node`, which adds the handlers."""
        self._logger = logging.getLogger(logger_name)
        self._handlers = list(self._logger.handlers)
        lines: queue.SimpleQueue[logging.LogRecord] = queue.SimpleQueue()
        self._listener = logging.handlers.QueueListener(lines, *self._handlers, respect_handler_level=True)
        self._logger.handlers = [logging.handlers.QueueHandler(lines)]
        self._listener.start()
        atexit.register(self.close)

    def close(self) -> None:
        """Handle the remaining lines, and all later ones in their own threads."""
        atexit.unregister(self.close)
        self._logger.handlers = self._handlers
        self._listener.stop()
