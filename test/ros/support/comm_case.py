"""Support for test cases of node roah_rsbb_comm: follows its topics, counts and calls its services."""

import contextlib
import itertools
import select
import threading
from typing import Any, Dict, Iterator, List, Optional, Set, Tuple

import rosgraph
import rospy
import rosservice
from geometry_msgs.msg import Pose2D
from roscpp.srv import SetLoggerLevel
from rosgraph_msgs.msg import Log
from std_msgs.msg import String as StringMsg
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.msg import Benchmark, BenchmarkState, GoalHGMF, GoalOMF
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.ros import messages
from roah_rsbb.srv import Override
from support.box_case import NetworkCase
from support.connections import wait_sends
from support.listener import Listener
from support.raw_box import RawBox
from support.robots import RSBB_PORT
from support.waiting import LIMIT_S, happened, wait_until

NODE = "/roah_rsbb_comm"
# The logger that teams know from the node's documentation.
LOGGER = "ros.roah_rsbb_comm_ros"

# From here on: what the node's documentation says, in its words.
NUMBERS = {
    "HGTKMH": 1, "HWV": 2, "HCFGAC": 3, "HOPF": 4, "HNF": 5, "HSUF": 6, "STB": 7, "HPPF": 8, "HPFF": 9, "HGMF": 10,
    "HOMF": 11,
}
STOP, PREPARE, GOAL_TX, WAITING_RESULT = range(4)  # of Override
SAYS_STOP, SAYS_PREPARE, SAYS_EXECUTE = range(3)  # on /roah_rsbb/benchmark/state
ALWAYS = {
    "benchmark": "roah_rsbb/Benchmark", "benchmark/name": "std_msgs/String",
    "devices/bell": "std_msgs/Empty", "devices/state": "roah_rsbb/DevicesState",
    "tablet/call": "std_msgs/Empty", "tablet/position": "geometry_msgs/Pose2D", "tablet/state": "roah_rsbb/TabletState",
}
GOALS: Dict[str, type] = {"HNF": Pose2D, "HGMF": GoalHGMF, "HOMF": GoalOMF, "STB": StringMsg}

_ports = itertools.count(RSBB_PORT + 1)


@contextlib.contextmanager
def reported_with(what: str) -> Iterator[None]:
    """Add a description to failures. (rostest shows no text of a unittest's subTest.)"""
    try:
        yield
    except AssertionError as error:
        raise AssertionError(f"{what}: {error}") from error


class CommRefusal(Exception):
    """A service call failed; the text is the node's own."""


class Heard:
    """The messages on one topic since this was made."""

    def __init__(self, name: str, kind: type) -> None:
        self.messages: List[Any] = []
        self._subscriber = rospy.Subscriber(
            f"/roah_rsbb/{name}", kind, self._take, queue_size=100, tcp_nodelay=True
        )

    def close(self) -> None:
        """Stop listening."""
        self._subscriber.unregister()

    def wait_connected(self) -> None:
        """Wait until the node publishes to this listener."""
        wait_sends(NODE, self._subscriber)

    def wait_count(self, count: int) -> Any:
        """Wait until this many messages have arrived, and return the last one."""
        wait_until(lambda: len(self.messages) >= count, lambda: f"{count} messages on {self._subscriber.name}; there "
                   f"are {self.messages}")
        return self.messages[-1]

    def wait_last(self, condition, what: str) -> Any:
        """Wait until the last message fulfils a condition, and return it."""
        return wait_until(lambda: self.messages and condition(self.messages[-1]) and self.messages[-1],
                          lambda: f"{what}; on {self._subscriber.name} there are {self.messages}")

    def _take(self, message: Any) -> None:
        self.messages.append(message)
        happened()


class CommCase(NetworkCase):
    """A test case with the node that its .test file launched."""

    def setUp(self) -> None:
        super().setUp()
        self.log: List[Tuple[int, str]] = []
        self._log_lock = threading.Lock()
        rosout = rospy.Subscriber("/rosout", Log, self._on_log, queue_size=1000)
        self.addCleanup(rosout.unregister)
        self.benchmarks = self.heard("benchmark", Benchmark)
        self.states = self.heard("benchmark/state", BenchmarkState)
        rospy.wait_for_service("/roah_rsbb/override", LIMIT_S)
        self.benchmarks.wait_count(1)
        wait_until(lambda: any(c.callerid_pub == NODE for c in rosout.impl.connections), "the node's log is followed")

    def heard(self, name: str, kind: type) -> Heard:
        """Listen from now on."""
        heard = Heard(name, kind)
        self.addCleanup(heard.close)
        return heard

    def latched(self, name: str, kind: type) -> Any:
        """Return what a new listener on a topic receives.

        It needs a connection of its own. A second subscriber of one process of rospy receives the last message from
        the first one, but not if that one connected in the moment between registration and latching of the publisher.
        """
        listener = self.listener(name, kind)
        try:
            return self.next_of(listener)
        finally:
            listener.close()

    def listener(self, name: str, kind: type) -> Listener:
        """A connection to a topic from now on.

        It has all that was sent before the topic ended. rospy drops what it has not read yet when it notices the end.
        """
        listener = Listener(f"/roah_rsbb/{name}", kind)
        self.addCleanup(listener.close)
        return listener

    def next_of(self, listener: Listener) -> Any:
        """Wait for a new message, and return the newest."""
        while True:
            message = listener.take()
            if message is not None:
                return message
            self.assertTrue(select.select([listener], (), (), LIMIT_S)[0], "nothing is sent")

    def _on_log(self, message: Log) -> None:
        if message.name == NODE:
            with self._log_lock:
                self.log.append((message.level, message.msg))
            happened()

    # -- the log ------------------------------------------------------------------------------------

    def logged(self, level: int, since: int = 0) -> List[str]:
        """Return what the node logged at that level, from the entry `since`."""
        with self._log_lock:
            return [text for known, text in self.log[since:] if known == level]

    def wait_logged(self, level: int, *parts: str, since: int = 0) -> str:
        """Wait for an entry that contains all parts, and return it."""
        return wait_until(
            lambda: next((t for t in self.logged(level, since) if all(part in t for part in parts)), None),
            lambda: f"the log says {parts}; it says\n" + "\n".join(text for _, text in self.log[since:]),
        )

    def log_sent(self) -> None:
        """Make the node log what it sends, as the documentation describes."""
        rospy.wait_for_service(f"{NODE}/set_logger_level", LIMIT_S)
        rospy.ServiceProxy(f"{NODE}/set_logger_level", SetLoggerLevel)(LOGGER, "debug")

    # -- topics and services ------------------------------------------------------------------------

    def _of_node(self, part: int) -> Set[str]:
        state = rosgraph.Master("/test").getSystemState()[part]
        prefix = "/roah_rsbb/"
        return {name[len(prefix):] for name, nodes in state if NODE in nodes and name.startswith(prefix)}

    @property
    def published(self) -> Dict[str, Optional[str]]:
        """Topics that the node publishes, with their types."""
        types = dict(rosgraph.Master("/test").getTopicTypes())
        return {name: types.get(f"/roah_rsbb/{name}") for name in self._of_node(0)}

    @property
    def subscribed(self) -> Set[str]:
        """Topics that it subscribes to."""
        return self._of_node(1)

    @property
    def services(self) -> Set[str]:
        """Services that it offers now, without those that simulate the box."""
        return self._of_node(2) - {"override", "override_goal"}

    def wait_services(self, *names: str) -> None:
        """Wait until it offers exactly these services besides override."""
        wait_until(lambda: self.services == set(names), lambda: f"services {names}; there are {self.services}")

    def type_of(self, service: str) -> Optional[str]:
        """The type of a service."""
        return rosservice.get_service_type(f"/roah_rsbb/{service}")

    def call(self, service: str, kind: type = EmptySrv, *request: Any, **fields: Any) -> None:
        """Call a service; raises `CommRefusal`."""
        name = f"/roah_rsbb/{service}"
        rospy.wait_for_service(name, LIMIT_S)
        try:
            rospy.ServiceProxy(name, kind)(*request, **fields)
        except rospy.ServiceException as error:
            assert messages.was_answered(str(error)), f"{name} did not answer: {error}"
            raise CommRefusal(messages.reason(str(error))) from None

    def override(self, number: int, state: int = STOP, **fields: Any) -> None:
        """Play the box."""
        self.call("override", Override, benchmark_type=number, benchmark_state=state, **fields)

    def end_override(self) -> None:
        """Back to normal."""
        self.override(0)
        self.wait_benchmark(0)

    def wait_benchmark(self, number: int) -> None:
        """Wait until the node publishes it."""
        self.benchmarks.wait_last(lambda m: m.benchmark == number, f"benchmark {number}")

    def wait_said(self, state: int) -> None:
        """Wait until the node publishes that state."""
        self.states.wait_last(lambda m: m.benchmark_state == state, f"state {state}")

    @property
    def said(self) -> List[int]:
        """All states that it said."""
        return [message.benchmark_state for message in self.states.messages]


class ChannelCase(CommCase):
    """A test case with a box of which each datagram is the test's."""

    def setUp(self) -> None:
        super().setUp()
        self.box = self.new_box()

    def new_box(self, **how: object) -> RawBox:
        """A box; `how`: see `RawBox`."""
        return self._leaving(RawBox(self.network, "Alpha", **how))

    def tearDown(self) -> None:
        self.box.beacon()  # lists nobody: the run is over
        self.wait_benchmark(0)

    def new_port(self) -> int:
        """A port that no run had."""
        return next(_ports)

    def begin(self, code: str) -> None:
        """A run, up to its STOP, which has been heard."""
        self.states.messages.clear()
        self.box.run(self.new_port())
        self.box.send(code, BoxState.STOP)
        self.wait_benchmark(NUMBERS[code])
        self.wait_said(SAYS_STOP)

    def prepare(self, code: str) -> None:
        """PREPARE, and the robot waits for its goal."""
        self.box.send(code, BoxState.PREPARE)
        self.wait_said(SAYS_PREPARE)
        self.call("end_prepare")
        self.box.wait_state(RobotState.WAITING_GOAL)
