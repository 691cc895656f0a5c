"""The asyncio loop in the main thread. rospy's threads hand their calls over to it.

It is the thread of docs/architecture.md, "One thread owns the core".
"""

import asyncio
import concurrent.futures
import contextlib
import signal
from typing import Any, Callable, Dict, Optional, TypeVar

import rospy

from roah_rsbb.ground.loop import ANSWER_TIMEOUT_S, LogLines, call_in_loop

T = TypeVar("T")

END_TASKS_S = 1.0


def _log_failure(_loop: asyncio.AbstractEventLoop, context: Dict[str, Any]) -> None:
    """Log the exception of a timer or reader. The others continue."""
    error = context.get("exception")
    trace = (type(error), error, error.__traceback__) if error is not None else None
    rospy.logerr("internal error, please report it: %s", context["message"], exc_info=trace)


class RosLoop:
    """An asyncio loop that lives as long as the ROS node. Create it after `rospy.init_node(disable_signals=True)`."""

    def __init__(self, loop: Optional[asyncio.AbstractEventLoop] = None) -> None:
        """`loop`: one that runs already; then create this in another thread."""
        self.loop = loop or asyncio.new_event_loop()
        self.loop.set_exception_handler(_log_failure)
        self._why = "shutdown"
        self._log_lines = LogLines()

    def call(self, function: Callable[[], T]) -> T:
        """From a thread of rospy: run a function in the loop's thread, and return its result or raise its exception.

        Raises ServiceException if the loop does not answer within `ANSWER_TIMEOUT_S`.
        """
        try:
            return call_in_loop(self.loop, function)
        except concurrent.futures.TimeoutError:
            raise rospy.ServiceException(
                f"{rospy.get_name()} did not answer within {ANSWER_TIMEOUT_S:.0f} s: check its log"
            ) from None

    def post(self, function: Callable[[], object]) -> None:
        """From any thread: run a function in the loop's thread soon, without waiting."""
        self.loop.call_soon_threadsafe(function)

    def run(self) -> None:
        """Run until the node is shut down, by a signal, by ROS or by `stop`."""
        for number in (signal.SIGINT, signal.SIGTERM):
            self.loop.add_signal_handler(number, self.stop, f"signal {number}")
        self.end_with_node()
        if not rospy.is_shutdown():
            self.loop.run_forever()

    def end_with_node(self) -> None:
        """Stop the loop when ROS shuts the node down."""
        rospy.core.add_preshutdown_hook(lambda reason: self.loop.call_soon_threadsafe(self.loop.stop))

    def stop(self, why: str) -> None:
        """In the loop's thread: end `run`."""
        self._why = why
        self.loop.stop()

    def close(self) -> None:
        """End the ROS node. Call it after `run`, when everything else is closed."""
        tasks = asyncio.all_tasks(self.loop)
        for task in tasks:
            task.cancel()
        if tasks:
            # ROS may shut down at the same moment and stop the loop: then the tasks are dropped.
            with contextlib.suppress(RuntimeError):
                self.loop.run_until_complete(asyncio.wait(tasks, timeout=END_TASKS_S))
        self.end_node()
        self.loop.close()

    def end_node(self) -> None:
        """End the ROS node alone."""
        self._log_lines.close()
        rospy.signal_shutdown(self._why)
