"""Node dummy_robot (executable dummy): simulates a team's own program, which works with the comm node.

It offers the action roah_rsbb/run, and calls the services of devices and tablet. The behaviour is that of all dummy
robots of this project.
"""

import asyncio
from concurrent.futures import Future
from typing import Any, Dict, Optional

from geometry_msgs.msg import Pose2D
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from roah_rsbb_msgs.action import Run
from roah_rsbb_msgs.srv import Percentage
from std_msgs.msg import Empty
from std_srvs.srv import SetBool, Trigger

from roah_rsbb.protocol import PERCENTAGES, SWITCHES
from roah_rsbb.robot.dummy import PHASES, DummyOptions, DummyRobot
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.rulebook.registry import GoalForm, profile_of
from roah_rsbb_comm.names import PREFIX, RUN, unlatched
from roah_rsbb_comm.node_loop import CannotStart, NodeLoop, run_node


class Box:
    """The comm node with the interface of `RobotClient`, so that the same dummy can use both."""

    def __init__(self, node: Node) -> None:
        def client(kind: type, name: str) -> Any:
            return node.create_client(kind, PREFIX + name)

        self._log = node.get_logger()
        self._devices = {name: client(SetBool, f"devices/{name}/set") for name in SWITCHES}
        self._devices.update({name: client(Percentage, f"devices/{name}/set") for name in PERCENTAGES})
        self._views = {True: client(Trigger, "tablet/map"), False: client(Trigger, "tablet/buttons")}
        self._saved = 0
        self.handle: Any = None  # the action's present goal

    @property
    def messages_saved(self) -> int:
        """The amount of recorded offline data."""
        return self._saved

    @messages_saved.setter
    def messages_saved(self, count: int) -> None:
        self._saved = count
        self._feedback(messages_saved=count)

    def notify(self, text: str) -> None:
        """Online data."""
        self._feedback(notification=text)

    def activation_event(self, text: str) -> None:
        """Online data."""
        self._feedback(activation_event=text)

    def visitor(self, text: str) -> None:
        """Online data."""
        self._feedback(visitor=text)

    def final_command(self, text: str) -> None:
        """Online data."""
        self._feedback(final_command=text)

    def set_device(self, name: str, value: Any) -> None:
        """Home devices."""
        self._call(self._devices[name], data=value)

    def display_map(self, display: bool) -> None:
        """The tablet."""
        self._call(self._views[display])

    def _feedback(self, **fields: Any) -> None:
        if self.handle is not None:
            self.handle.publish_feedback(Run.Feedback(**fields))

    def _call(self, client: Any, **fields: Any) -> None:
        """Call a service without waiting."""
        if not client.service_is_ready():
            self._log.warning(f"{client.srv_name} is missing: start the comm node in the same namespace")
            return
        client.call_async(client.srv_type.Request(**fields)).add_done_callback(self._log_refusal)

    def _log_refusal(self, done: Any) -> None:
        if not done.result().success:
            self._log.warning(done.result().message)


class DummyNode:
    """Offers the action, and makes the dummy prepare and execute. Raises CannotStart or ValueError."""

    def __init__(self, node: Node) -> None:
        usual = DummyOptions()
        durations = [FloatingPointRange(from_value=0.0, to_value=1e6)]

        def parameter(name: str, default: Any, description: str, **more: Any) -> Any:
            return node.declare_parameter(name, default, ParameterDescriptor(
                description=f"{description}. Restart the node to change it", read_only=True, **more)).value

        crash_in = parameter("crash_in", "", f"crash in a phase: {', '.join(PHASES)}; empty: never")
        if crash_in not in ("", *PHASES):
            raise CannotStart(f"parameter crash_in: found {crash_in}, expected one of {', '.join(PHASES)}")
        options = DummyOptions(
            prepare_duration=parameter("prepare_duration", usual.prepare_duration, "seconds from PREPARE until ready",
                                       floating_point_range=durations),
            execute_duration=parameter("execute_duration", usual.execute_duration, "seconds for each goal",
                                       floating_point_range=durations),
            never_end=parameter("never_end", usual.never_end, "execute until the box stops the robot"),
            crash_in=crash_in or None,
            save_nothing=parameter("save_nothing", usual.save_nothing, "report that no offline data is saved"),
        )
        self._ros = NodeLoop(node, SingleThreadedExecutor())
        self._box = Box(node)
        self._dummy = DummyRobot(options)
        self._dummy.client = self._box
        for name, kind, take in (
            ("devices/bell", Empty, lambda _: self._dummy.on_bell()),
            ("tablet/call", Empty, lambda _: self._dummy.on_tablet_call()),
            ("tablet/position", Pose2D, lambda message: self._dummy.on_tablet_position(message.x, message.y)),
        ):
            node.create_subscription(kind, PREFIX + name, take, unlatched())
        self._works: Dict[bytes, Future[Run.Result]] = {}  # by goal
        ActionServer(node, Run, RUN, self._end, handle_accepted_callback=self._begin, cancel_callback=self._cancel)

    def run(self) -> int:
        """Run until the end; returns the exit status."""
        status = self._ros.run()
        self._ros.close()
        return status

    # The goals. The executor never waits, because a cancelled goal must stop the robot at once.

    def _begin(self, handle: Any) -> None:
        """In the executor: let the dummy carry out a goal in the loop."""
        work = asyncio.run_coroutine_threadsafe(self._work(handle), self._ros.loop)
        self._works[bytes(handle.goal_id.uuid)] = work
        work.add_done_callback(lambda _: self._ros.in_executor(handle.execute))  # which calls `_end`

    def _cancel(self, handle: Any) -> CancelResponse:
        """In the executor: stop working for a goal."""
        self._works[bytes(handle.goal_id.uuid)].cancel()
        return CancelResponse.ACCEPT

    def _end(self, handle: Any) -> Run.Result:
        """In the executor: report how the work for a goal has ended."""
        work = self._works.pop(bytes(handle.goal_id.uuid))
        if work.cancelled():
            handle.canceled()
            return Run.Result()
        result = work.result()
        handle.succeed()
        return result

    async def _work(self, handle: Any) -> Run.Result:
        self._box.handle = handle
        goal = handle.request
        try:
            if goal.phase == Run.Goal.PREPARE:
                await self._dummy.prepare(goal.benchmark)
                return Run.Result()
            return _result(await self._dummy.execute(goal.benchmark, _goal(goal)))
        except asyncio.CancelledError:
            self._dummy.stop("the comm node cancelled the goal")
            raise
        finally:
            if self._box.handle is handle:
                self._box.handle = None


def _goal(message: Run.Goal) -> Optional[Goal]:
    """The goal of the action in the form of the client."""
    form = profile_of(message.benchmark).goal
    pose = Pose(message.pose.x, message.pose.y, message.pose.theta)
    if form is GoalForm.NONE:
        return None
    return Goal(
        text=message.goal or None, pose=pose if form in (GoalForm.WAYPOINT, GoalForm.PLACEMENT) else None,
        object_id=message.object_type if form is GoalForm.PLACEMENT else None,
        initial_state=tuple(message.initial_state), switches=tuple(message.switches),
    )


def _result(result: Result) -> Run.Result:
    """A result of the client in the form of the action."""
    fields: Dict[str, Any] = {}
    if isinstance(result, HopfResult):
        fields = {"object_class": result.object_class, "object_name": result.object_name}
    elif isinstance(result, HppfResult):
        fields = {"person_name": result.person_name}
    elif result is not None:
        fields = {"result": result}
    if isinstance(result, (HopfResult, HppfResult)):
        fields["pose"] = Pose2D(x=result.pose.x, y=result.pose.y, theta=result.pose.theta)
    return Run.Result(**fields)


def main() -> None:
    """Entry point of the node."""
    run_node("dummy_robot", DummyNode)
