"""The topics and services of the comm node (docs/team_ros2.md, "Topics and services").

All of them exist as long as the node. A service that does not fit the present state answers with a reason.
"""

from typing import Any, Callable, NamedTuple, Optional

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose2D
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy
from rclpy.subscription import Subscription
from roah_rsbb_msgs.msg import Benchmark, BenchmarkState, DevicesState, GoalHGMF, GoalOMF, TabletState
from roah_rsbb_msgs.srv import Override, OverrideGoal, Percentage, ResultHOPF, ResultHPPF, String
from std_msgs.msg import Empty, UInt32
from std_msgs.msg import String as StringMsg
from std_srvs.srv import SetBool, Trigger

from roah_rsbb.protocol import PERCENTAGES, SWITCHES, RobotState, WireTime
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.rulebook.registry import STRINGS, GoalForm, profile_of
from roah_rsbb_comm.names import PREFIX, STATES, latched, unlatched

# How often the publishers of messages_saved are looked up.
LOOK_S = 0.2
_MAX_INT32, _MAX_NS = 2**31 - 1, 999_999_999


class Requests(NamedTuple):
    """Requests of the robot's programs. Each returns or raises `IllegalEvent` or ValueError with the reason."""

    end_prepare: Callable[[], None]
    end_execute: Callable[[str, Result], None]  # the service that was called, and the result
    add_string: Callable[[str, str], None]  # field, text
    set_device: Callable[[str, Any], None]  # device, bool or per cent
    display_map: Callable[[bool], None]
    messages_saved: Callable[[int], None]
    override: Callable[[Override.Request], None]
    override_goal: Callable[[OverrideGoal.Request], None]


class Interface:
    """Topics and services. `show` may be called from any thread and returns at once."""

    def __init__(self, node: Node, requests: Requests) -> None:
        self._node = node
        self._requests = requests
        self._code: Optional[str] = None
        self._shown_state = BenchmarkState.STOP
        self._make_topics()
        self._make_services()
        self._saved = SavedCount(node, requests.messages_saved)
        self._benchmark.publish(Benchmark(benchmark=Benchmark.NONE))
        self._name.publish(StringMsg(data=""))
        self._state.publish(BenchmarkState(benchmark_state=self._shown_state))

    def _make_topics(self) -> None:
        def topic(name: str, kind: type, qos: Any = None) -> Any:
            return self._node.create_publisher(kind, PREFIX + name, qos or latched())

        self._benchmark = topic("benchmark", Benchmark)
        self._name = topic("benchmark/name", StringMsg)
        self._state = topic("benchmark/state", BenchmarkState)
        self._devices = topic("devices/state", DevicesState)
        self._bell = topic("devices/bell", Empty, unlatched())
        self._tablet = topic("tablet/state", TabletState)
        self._call = topic("tablet/call", Empty, unlatched())
        self._position = topic("tablet/position", Pose2D, unlatched())
        self._goal_text = topic("goal/text", StringMsg)
        self._waypoint = topic("goal/waypoint", Pose2D)
        self._placement = topic("goal/placement", GoalHGMF)
        self._switches = topic("goal/switches", GoalOMF)

    def _make_services(self) -> None:
        asks = self._requests
        self._serve("end_prepare", Trigger, lambda _: asks.end_prepare())
        self._serve("end_execute", Trigger, lambda _: asks.end_execute("end_execute", None))
        self._serve("end_execute/object", ResultHOPF, lambda request: asks.end_execute(
            "end_execute/object", HopfResult(request.object_class, request.object_name, _pose(request.object_pose))))
        self._serve("end_execute/person", ResultHPPF, lambda request: asks.end_execute(
            "end_execute/person", HppfResult(request.person_name, _pose(request.person_pose))))
        self._serve("end_execute/text", String, lambda request: asks.end_execute("end_execute/text", request.data))
        for field in STRINGS:
            self._serve(field, String, lambda request, field=field: asks.add_string(field, request.data))
        self._serve("tablet/map", Trigger, lambda _: asks.display_map(True))
        self._serve("tablet/buttons", Trigger, lambda _: asks.display_map(False))
        for name in SWITCHES:
            self._serve(f"devices/{name}/set", SetBool, lambda request, name=name: asks.set_device(name, request.data))
            self._serve(f"devices/{name}/on", Trigger, lambda _, name=name: asks.set_device(name, True))
            self._serve(f"devices/{name}/off", Trigger, lambda _, name=name: asks.set_device(name, False))
        for name in PERCENTAGES:
            self._serve(f"devices/{name}/set", Percentage,
                        lambda request, name=name: asks.set_device(name, request.data))
            self._serve(f"devices/{name}/max", Trigger, lambda _, name=name: asks.set_device(name, 100))
            self._serve(f"devices/{name}/min", Trigger, lambda _, name=name: asks.set_device(name, 0))
        self._serve("override", Override, asks.override)
        self._serve("override_goal", OverrideGoal, asks.override_goal)

    def _serve(self, name: str, kind: type, action: Callable[[Any], None]) -> None:
        """Offer a service that calls `action`, and answers with its reason if it refuses."""

        def handle(request: Any, response: Any) -> Any:
            try:
                action(request)
                response.success = True
            except (IllegalEvent, ValueError) as error:
                response.success, response.message = False, str(error)
            return response

        self._node.create_service(kind, PREFIX + name, handle)

    def show(self, effect: fx.Effect, goal: Optional[Goal]) -> None:
        """Publish an effect; `goal` is the present goal."""
        if isinstance(effect, fx.BenchmarkIs):
            self._enter_benchmark(effect.code)
        elif isinstance(effect, fx.StateIs):
            self._enter_state(effect.state, goal)
        elif isinstance(effect, fx.Devices):
            self._devices.publish(DevicesState(
                bell=_ros_time(effect.bell), switch_1=effect.switch_1, switch_2=effect.switch_2,
                switch_3=effect.switch_3, dimmer=min(effect.dimmer, 255), blinds=min(effect.blinds, 255),
                door_win_detect=effect.door_win_detect,
            ))
        elif isinstance(effect, fx.TabletIs):
            self._tablet.publish(TabletState(
                display_map=effect.display_map, call_time=_ros_time(effect.call_time),
                position_time=_ros_time(effect.position_time),
                position_x=effect.position_x, position_y=effect.position_y,
            ))
        elif isinstance(effect, fx.BellRang):
            self._bell.publish(Empty())
        elif isinstance(effect, fx.TabletCalled):
            self._call.publish(Empty())
        elif isinstance(effect, fx.PositionSelected):
            self._position.publish(Pose2D(x=effect.x, y=effect.y))

    def _enter_benchmark(self, code: Optional[str]) -> None:
        self._code = code
        self._saved.restart()
        self._name.publish(StringMsg(data=code or ""))
        self._benchmark.publish(Benchmark(benchmark=Benchmark.NONE if code is None else profile_of(code).number))

    def _enter_state(self, state: RobotState, goal: Optional[Goal]) -> None:
        if state is RobotState.EXECUTING and self._code is not None:
            self._publish_goal(profile_of(self._code).goal, goal)
        if STATES[state] != self._shown_state:
            self._shown_state = STATES[state]
            self._state.publish(BenchmarkState(benchmark_state=self._shown_state))

    def _publish_goal(self, form: GoalForm, goal: Optional[Goal]) -> None:
        """Publish the goal before the state EXECUTE."""
        if form is GoalForm.NONE:
            return
        self._goal_text.publish(StringMsg(data="" if goal is None else goal.text or ""))
        if goal is None:
            return
        if form is GoalForm.WAYPOINT and goal.pose is not None:
            self._waypoint.publish(_pose_2d(goal.pose))
        elif form is GoalForm.PLACEMENT and goal.pose is not None:
            self._placement.publish(GoalHGMF(object_type=goal.object_id, target_pose=_pose_2d(goal.pose)))
        elif form is GoalForm.SWITCHES:
            self._switches.publish(GoalOMF(initial_state=list(goal.initial_state), switches=list(goal.switches)))


class SavedCount:
    """Subscribes to messages_saved: the newest count of a run, from latched publishers and from others.

    A subscription that asks for latched messages receives nothing from a publisher that does not latch, which would
    warn about it. So the subscription is made for what the publishers offer. At the beginning of a run, it is made
    again and receives what was latched before.
    """

    def __init__(self, node: Node, report: Callable[[int], None]) -> None:
        self._node = node
        self._report = report
        self._latched: Optional[Subscription] = None
        self._must_restart = False
        self._subscribe(unlatched())
        node.create_timer(LOOK_S, self._look)

    def restart(self) -> None:
        """A run has begun or ended, so earlier counts do not belong to it. From any thread."""
        self._must_restart = True

    def _subscribe(self, qos: Any) -> Subscription:
        return self._node.create_subscription(
            UInt32, f"{PREFIX}messages_saved", lambda message: self._report(message.data), qos)

    def _look(self) -> None:
        publishers = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(f"{PREFIX}messages_saved"))
        offered = [publisher.qos_profile.durability for publisher in publishers]
        if self._latched is not None and (self._must_restart or DurabilityPolicy.TRANSIENT_LOCAL not in offered):
            self._node.destroy_subscription(self._latched)
            self._latched = None
        self._must_restart = False
        if self._latched is None and DurabilityPolicy.TRANSIENT_LOCAL in offered:
            self._latched = self._subscribe(latched())


def _ros_time(time: WireTime) -> Time:
    """A wire time within the limits of the message."""
    return Time(sec=max(-_MAX_INT32, min(time[0], _MAX_INT32)), nanosec=max(0, min(time[1], _MAX_NS)))


def _pose(pose: Pose2D) -> Pose:
    return Pose(pose.x, pose.y, pose.theta)


def _pose_2d(pose: Pose) -> Pose2D:
    return Pose2D(x=pose.x, y=pose.y, theta=pose.theta)
