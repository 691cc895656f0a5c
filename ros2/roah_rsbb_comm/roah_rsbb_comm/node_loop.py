"""A node's two threads: an asyncio loop in the main thread, and rclpy's executor in the other.

The client of the box lives in the loop. Callbacks of ROS hand their calls over to it with `call` and `post`. The loop
publishes by itself, so that nothing that the executor does delays a STOP.
"""

import asyncio
import concurrent.futures
import logging
import signal
import sys
import threading
import traceback
from typing import Any, Callable, Dict, Optional, TypeVar

import rclpy
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

T = TypeVar("T")


class CannotStart(Exception):
    """The node cannot start. The text names the remedy."""


class NodeLoop:
    """Runs a node until a signal, a failure or the end of ROS."""

    def __init__(self, node: Node, executor: Executor) -> None:
        self.loop = asyncio.new_event_loop()
        self.loop.set_exception_handler(self._log_failure)
        self._node = node
        self._executor = executor
        self._executor.add_node(node)
        self._failure: Optional[str] = None
        self._is_ending = False

    def call(self, function: Callable[[], T]) -> T:
        """From another thread: run a function in the loop, and return its result or raise its exception.

        It takes milliseconds. On a computer that is very busy it waits: to give up would end the node during a run.
        """
        done: concurrent.futures.Future[T] = concurrent.futures.Future()

        def run() -> None:
            try:
                done.set_result(function())
            except Exception as error:
                done.set_exception(error)

        self.post(run)
        return done.result()

    def post(self, function: Callable[[], object]) -> None:
        """From any thread: run a function in the loop soon. Without effect after its end."""
        try:
            self.loop.call_soon_threadsafe(function)
        except RuntimeError:
            if not self._is_ending:
                raise

    def in_executor(self, function: Callable[[], object]) -> None:
        """From any thread: run a function in the executor soon."""
        if not self._is_ending:
            self._executor.create_task(function)

    def fail(self, text: str) -> None:
        """In the loop: end the node with this message."""
        self._failure = self._failure or text
        self.loop.stop()

    def run(self) -> int:
        """Run until the end; returns the exit status."""
        for number in (signal.SIGINT, signal.SIGTERM):
            self.loop.add_signal_handler(number, self.loop.stop)
        spinning = threading.Thread(target=self._spin, name="ROS executor", daemon=True)
        spinning.start()
        self.loop.run_forever()
        self._is_ending = True
        if self._failure is not None:
            self._node.get_logger().fatal(self._failure)
        self._executor.shutdown(timeout_sec=1.0)
        spinning.join(1.0)
        return 0 if self._failure is None else 1

    def close(self) -> None:
        """End the loop, after what used it."""
        tasks = asyncio.all_tasks(self.loop)
        for task in tasks:
            task.cancel()
        if tasks:
            self.loop.run_until_complete(asyncio.wait(tasks, timeout=1.0))
        self.loop.close()

    def _spin(self) -> None:
        why = "the executor of ROS has ended"
        try:
            self._executor.spin()
        except ExternalShutdownException:
            why = "ROS was shut down"
        except Exception as error:
            traceback.print_exc()
            why = f"internal error in a callback, please report it: {type(error).__name__}: {error}"
        if not self._is_ending:
            self.post(lambda: self.fail(why))

    def _log_failure(self, _loop: asyncio.AbstractEventLoop, context: Dict[str, Any]) -> None:
        """A timer or reader of the loop failed, which must not happen."""
        error = context.get("exception")
        if error is not None:
            traceback.print_exception(type(error), error, error.__traceback__)
        self.fail(f"internal error, please report it: {context['message']}: {error}")


class _ToRos(logging.Handler):
    """Passes records of Python's loggers on to ROS."""

    def __init__(self, node: Node) -> None:
        super().__init__(logging.INFO)
        self._log = node.get_logger()

    def emit(self, record: logging.LogRecord) -> None:
        # A call of rclpy's logger may not change its severity: each line of code has one.
        text = self.format(record)
        if record.levelno >= logging.ERROR:
            self._log.error(text)
        elif record.levelno >= logging.WARNING:
            self._log.warning(text)
        else:
            self._log.info(text)


def run_node(name: str, make: Callable[[Node], Any]) -> None:
    """Make a node's part from the node, and call its `run`. Ends the process."""
    node, status = None, 1
    try:
        # Signals end the loop, and the loop ends ROS.
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node(name)
        logging.basicConfig(level=logging.INFO, format="%(message)s", handlers=[_ToRos(node)])
        status = make(node).run()
    except (CannotStart, ValueError, OSError) as error:
        for line in str(error).splitlines():
            get_logger(name).fatal(line)
    except KeyboardInterrupt:  # before the loop ran
        status = 130
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    sys.exit(status)
