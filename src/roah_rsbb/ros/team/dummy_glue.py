"""Node dummy_robot (type dummy_glue): simulates a team's own program, which works with node roah_rsbb_comm.

It replaces the program that a team writes between the comm node and its robot. It uses only the comm node's topics and
services, so it is also an example.

Parameters (private): prepare_duration, execute_duration (s); to misbehave: never_end, crash_in (prepare, execute),
save_nothing.
"""

import asyncio
import concurrent.futures
import functools
import logging
import threading
import time
from typing import Any, Awaitable, Callable, Dict, Optional

import rospy
from geometry_msgs.msg import Pose2D
from std_msgs.msg import Empty, UInt32
from std_msgs.msg import String as StringMsg
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.msg import BenchmarkState, GoalHGMF, GoalOMF
from roah_rsbb.protocol import PERCENTAGES
from roah_rsbb.robot.dummy import PHASES, DummyOptions, DummyRobot
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.ros.node import NodeParams, RosLoop, run_node
from roah_rsbb.rulebook.registry import GoalForm, ResultForm, profile_of
from roah_rsbb.srv import Bool, Percentage, ResultHOPF, ResultHPPF, String

# Time limit for a service to appear: the comm node may be starting, and advertises services with a delay.
SERVICE_S = 5.0
LOOK_S = 0.2
# The topics with the goals of benchmarks. Other benchmarks have no topic for goals.
GOAL_TYPES = {
    GoalForm.WAYPOINT: Pose2D, GoalForm.PLACEMENT: GoalHGMF, GoalForm.SWITCHES: GoalOMF, GoalForm.STRING: StringMsg,
    GoalForm.TEXT: StringMsg,
}


class Services:
    """The comm node's services with the interface of `RobotClient`, so that the same dummy can use both."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._caller = concurrent.futures.ThreadPoolExecutor(1)  # one call at a time, in order
        self._saved = 0
        self._saved_topic = rospy.Publisher("/roah_rsbb/messages_saved", UInt32, queue_size=1, latch=True)

    @property
    def messages_saved(self) -> int:
        """The amount of recorded offline data."""
        return self._saved

    @messages_saved.setter
    def messages_saved(self, count: int) -> None:
        self._saved = count
        self._saved_topic.publish(count)

    def _say(self, name: str, text: str) -> None:
        self._start_call(name, String, text)

    # Online data.
    notify = functools.partialmethod(_say, "notifications")
    activation_event = functools.partialmethod(_say, "activation_event")
    visitor = functools.partialmethod(_say, "visitor")
    final_command = functools.partialmethod(_say, "final_command")

    def set_device(self, name: str, value: Any) -> None:
        """Home devices."""
        self._start_call(f"devices/{name}/set", Percentage if name in PERCENTAGES else Bool, value)

    def display_map(self, display: bool) -> None:
        """The tablet."""
        self._start_call("tablet/map" if display else "tablet/buttons", EmptySrv)

    async def call(self, name: str, kind: type, *arguments: Any) -> None:
        """Call a service of the comm node, after the calls before it; raises ROSException or ServiceException.

        A cancelled call gives up waiting for its service, so that it does not delay the calls after it.
        """
        given_up = threading.Event()
        service = f"/roah_rsbb/{name}"

        def do() -> None:
            if _wait_for_service(service, given_up):
                rospy.ServiceProxy(service, kind)(*arguments)

        try:
            await self._loop.run_in_executor(self._caller, do)
        except asyncio.CancelledError:
            given_up.set()
            raise

    def _start_call(self, name: str, kind: type, *arguments: Any) -> None:
        """Call a service without waiting."""
        self._loop.create_task(_logged(self.call(name, kind, *arguments), name))


def _wait_for_service(service: str, given_up: threading.Event) -> bool:
    """Wait until a service is available, and return whether it is still wanted. ROSException after `SERVICE_S`."""
    deadline = time.monotonic() + SERVICE_S
    while not given_up.is_set():
        try:
            rospy.wait_for_service(service, LOOK_S)
        except rospy.ROSException:
            if time.monotonic() > deadline:
                raise
        else:
            return not given_up.is_set()
    return False


class GlueNode:
    """Follows the comm node's topics, and makes the dummy prepare and execute. Raises BadParams."""

    def __init__(self) -> None:
        log_to_ros()
        params = NodeParams()
        usual = DummyOptions()
        options = DummyOptions(
            prepare_duration=params.number("prepare_duration", usual.prepare_duration),
            execute_duration=params.number("execute_duration", usual.execute_duration),
            never_end=params.flag("never_end", usual.never_end),
            crash_in=params.choice("crash_in", "", ["", *PHASES]) or None,
            save_nothing=params.flag("save_nothing", usual.save_nothing),
        )
        params.done()
        self._ros = RosLoop()
        self._services = Services(self._ros.loop)
        self._dummy = DummyRobot(options)
        self._dummy.client = self._services
        self._code: Optional[str] = None
        self._phase: Optional[asyncio.Task] = None
        self._early: Optional[int] = None  # a state that arrived before its benchmark
        self._goal: Optional[asyncio.Future] = None  # the benchmark's next goal
        self._goal_topic: Optional[rospy.Subscriber] = None

    def run(self) -> int:
        """Run until shut down; returns the exit status."""
        self._follow("benchmark/name", StringMsg, lambda message: self._enter(message.data))
        self._follow("benchmark/state", BenchmarkState, lambda message: self._state(message.benchmark_state))
        self._follow("devices/bell", Empty, lambda _: self._dummy.on_bell())
        self._follow("tablet/call", Empty, lambda _: self._dummy.on_tablet_call())
        self._follow("tablet/position", Pose2D, lambda message: self._dummy.on_tablet_position(message.x, message.y))
        self._ros.run()
        self._ros.close()
        return 0

    def _follow(self, name: str, kind: type, take: Callable[[Any], None]) -> rospy.Subscriber:
        return rospy.Subscriber(f"/roah_rsbb/{name}", kind, lambda message: self._ros.post(lambda: take(message)))

    # -- in the loop's thread -----------------------------------------------------------------------

    def _enter(self, code: str) -> None:
        """Follow another benchmark. The type of its goal topic depends on the benchmark."""
        self._code = code or None
        if self._goal_topic is not None:
            self._goal_topic.unregister()
            self._goal_topic = None
        self._goal = None
        if self._code is None:
            # After a crash of the comm node there is no STOP.
            self._end_phase()
        form = GoalForm.NONE if self._code is None else profile_of(self._code).goal
        if form is not GoalForm.NONE:
            self._goal = self._ros.loop.create_future()
            topic = "goal/text" if form is GoalForm.TEXT else "goal"
            self._goal_topic = self._follow(topic, GOAL_TYPES[form], self._take_goal)
        if self._code is not None and self._early is not None:
            self._state(self._early)

    def _take_goal(self, message: Any) -> None:
        if self._goal is not None:
            if self._goal.done():
                self._goal = self._ros.loop.create_future()
            self._goal.set_result(_goal_of(message))

    def _end_phase(self) -> None:
        if self._phase is not None:
            self._phase.cancel()
            self._phase = None

    def _state(self, state: int) -> None:
        self._end_phase()
        self._early = None
        if self._code is None and state in (BenchmarkState.PREPARE, BenchmarkState.EXECUTE):
            self._early = state  # topics are independent: the benchmark follows
        elif state == BenchmarkState.PREPARE:
            self._phase = self._ros.loop.create_task(_logged(self._prepare(), "preparing"))
        elif state == BenchmarkState.EXECUTE:
            self._phase = self._ros.loop.create_task(_logged(self._execute(), "executing"))
        else:
            self._dummy.stop("the comm node sent STOP")

    async def _prepare(self) -> None:
        if self._goal is not None:
            self._goal = self._ros.loop.create_future()  # for the next goal
        await self._dummy.prepare(self._code)
        await self._services.call("end_prepare", EmptySrv)

    async def _execute(self) -> None:
        goal = None if self._goal is None else await asyncio.shield(self._goal)
        result = await self._dummy.execute(self._code, goal)
        await self._end_execute(result)

    async def _end_execute(self, result: Result) -> None:
        """Call the service, whose type depends on the result."""
        call = self._services.call
        if isinstance(result, HopfResult):
            await call("end_execute", ResultHOPF, result.object_class, result.object_name, Pose2D(*result.pose))
        elif isinstance(result, HppfResult):
            await call("end_execute", ResultHPPF, result.person_name, Pose2D(*result.pose))
        elif profile_of(self._code).result is ResultForm.TEXT:
            await call("end_execute", String, result or "")
        else:
            await call("end_execute", EmptySrv)


async def _logged(work: Awaitable[None], what: str) -> None:
    """Log failures, which are normal when a run ends."""
    try:
        await work
    except (rospy.ROSException, rospy.ServiceException) as error:
        rospy.logwarn("%s: %s", what, error)


_GOALS: Dict[type, Callable[[Any], Optional[Goal]]] = {
    Pose2D: lambda message: Goal(pose=Pose(message.x, message.y, message.theta)),
    GoalHGMF: lambda message: Goal(
        pose=Pose(message.target_pose.x, message.target_pose.y, message.target_pose.theta),
        object_id=message.object_type,
    ),
    GoalOMF: lambda message: Goal(initial_state=tuple(message.initial_state), switches=tuple(message.switches)),
    StringMsg: lambda message: Goal(text=message.data) if message.data else None,
}


def _goal_of(message: Any) -> Optional[Goal]:
    return _GOALS[type(message)](message)


# Loggers of the dummy's actions and of its client.
_LOGGERS = ("dummy_robot", "roah_rsbb.robot")


class _ToRos(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        (rospy.logwarn if record.levelno >= logging.WARNING else rospy.loginfo)("%s", record.getMessage())


def log_to_ros() -> None:
    """Redirect the log of this process's dummy robots to ROS. Call it after `rospy.init_node`."""
    for name in _LOGGERS:
        logger = logging.getLogger(name)
        logger.setLevel(logging.INFO)
        logger.propagate = False
        logger.addHandler(_ToRos())


def main() -> None:
    """Entry point of the node."""
    run_node("dummy_robot", __doc__, GlueNode, disable_signals=True)
