"""What the programs of nodes share: the command line, parameters, and the asyncio loop in the main thread.

Settings are ROS parameters: `--help` is the only option. rospy's threads hand their calls over to the loop. Its thread
is that of docs/architecture.md, "One thread owns the core".
"""

import asyncio
import concurrent.futures
import contextlib
import os
import signal
import sys
import threading
from typing import Any, Callable, Dict, Generic, Optional, Tuple, Type, TypeVar

import rospy

from roah_rsbb.ground.arguments import Parser
from roah_rsbb.ground.loop import ANSWER_TIMEOUT_S, LogLines, call_in_loop
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.ros import connections

_SETTINGS = """\
Settings are ROS parameters, of the node or given as _name:=value. The launch files set those that competitions need;
'roslaunch --ros-args roah_rsbb FILE.launch' explains them.
"""
T = TypeVar("T")
END_TASKS_S = 1.0


def explain(doc: str, settings: str = _SETTINGS) -> None:
    """Print the help of a program and end it if --help was given; end it with status 2 for any other argument.

    `doc` is the docstring of the program's module. ROS handles name:=value before, so those are not arguments here.
    """
    parser = Parser(os.path.basename(sys.argv[0]), doc.strip(), settings)
    parser.parse_args(rospy.myargv()[1:])


def run_node(
    name: str, doc: str, make: Callable[[], Any], errors: Tuple[Type[Exception], ...] = (BadParams,),
    before: Callable[[], None] = lambda: None, **options: Any
) -> None:
    """Run a node: create it, call its `run`, and end with the exit status that `run` returns.

    `before` is called before the node is registered with the ROS master.
    An exception of `errors` at the start becomes a fatal log line. `options` are those of `rospy.init_node`.
    """
    explain(doc)
    before()
    connections.init_node(name, **options)
    try:
        status = make().run()
    except errors as error:
        for line in str(error).splitlines():
            rospy.logfatal("%s", line)
        status = 1
    sys.exit(status)


class NodeParams(Params):
    """Reads them from ROS. Create it after `rospy.init_node`."""

    def __init__(self) -> None:
        super().__init__()
        self.values: Dict[str, object] = {}
        """What was read until now, or its default."""

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return str(rospy.resolve_name("~" + name))

    def _get(self, name: str, default: object) -> object:
        try:
            value = self.values[name] = rospy.get_param(self.full_name(name), default)
        except KeyError:
            return None
        return value


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


class Newest(Generic[T]):
    """Hands the newest message of each sender from rospy's threads to the loop. Older ones are dropped."""

    def __init__(self, post: Callable[[Callable[[], None]], None], take: Callable[[T], None], most: int) -> None:
        """`post` schedules a function in the loop's thread. `take` gets the messages there. `most` limits the
        senders."""
        self._post = post
        self._take = take
        self._most = most
        self._lock = threading.Lock()
        self._waiting: Dict[str, T] = {}

    def put(self, sender: str, message: T) -> None:
        """Take a message, from any thread."""
        with self._lock:
            is_first = not self._waiting
            if sender in self._waiting or len(self._waiting) < self._most:
                self._waiting[sender] = message
        if is_first:
            self._post(self._hand_over)

    def _hand_over(self) -> None:
        with self._lock:
            waiting, self._waiting = self._waiting, {}
        for message in waiting.values():
            self._take(message)
