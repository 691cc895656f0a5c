"""The ROS side of node roah_rsbb_comm: its topics and services.

Some of them always exist, others only during a benchmark or a phase of it (docs/ros_interface.md, "Team's side").
Advertising takes time, because it involves the ROS master. A separate thread does it, in order, so that the box gets a
new state before the robot's programs do.
"""

import queue
import threading
import time
import warnings
from typing import Callable, Dict, FrozenSet, List, NamedTuple, Optional

import rospy
from geometry_msgs.msg import Pose2D
from std_msgs.msg import Empty, UInt32
from std_msgs.msg import String as StringMsg
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.msg import Benchmark, BenchmarkState, GoalOMF, TabletState
from roah_rsbb.protocol import PERCENTAGES, SWITCHES, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import Goal, HopfResult, HppfResult, Pose, Result
from roah_rsbb.ros.messages import ros_wire_time
from roah_rsbb.ros.team.generations import Types
from roah_rsbb.rulebook.registry import DEVICES, OTHER, STRINGS, TABLET, GoalForm, ResultForm, profile_of
from roah_rsbb.srv import Bool, Percentage, ResultHOPF, ResultHPPF, String

STATES: Dict[RobotState, int] = {
    RobotState.STOP: BenchmarkState.STOP,
    RobotState.PREPARING: BenchmarkState.PREPARE,
    RobotState.WAITING_GOAL: BenchmarkState.PREPARE,
    RobotState.EXECUTING: BenchmarkState.EXECUTE,
    RobotState.RESULT_TX: BenchmarkState.EXECUTE,
}

# A topic stays unadvertised for at least this time. If it returned immediately, rospy could mistake it for the old
# connection, which then breaks, and subscribers would receive nothing.
SETTLE_S = 0.5
# Sent where any result will do: the original box waits for one.
ANY_RESULT = "done"


class RobotRequests(NamedTuple):
    """Requests of the robot's programs. Each call returns immediately or raises with the reason."""

    end_prepare: Callable[[], None]
    end_execute: Callable[[Result], None]
    add_string: Callable[[str, str], None]  # field, text
    set_device: Callable[[str, object], None]  # device, bool or per cent
    display_map: Callable[[bool], None]
    messages_saved: Callable[[int], None]


class CommInterface:
    """Topics and services under /roah_rsbb. Methods may be called from any thread and return immediately."""

    def __init__(self, requests: RobotRequests, types: Types) -> None:
        """`types`: those of the generation that the team's code uses."""
        self._requests = requests
        self._types = types
        self._goal_types = {
            GoalForm.WAYPOINT: Pose2D, GoalForm.PLACEMENT: types.GoalHGMF, GoalForm.SWITCHES: GoalOMF,
            GoalForm.STRING: StringMsg,
        }
        self._code: Optional[str] = None
        self._announced: Optional[str] = None  # code
        self._state_number: Optional[int] = None
        self._always = {
            "benchmark": _topic("benchmark", types.Benchmark),
            "name": _topic("benchmark/name", StringMsg),
            "bell": _topic("devices/bell", Empty, latch=False),
            "devices": _topic("devices/state", types.DevicesState),
            "call": _topic("tablet/call", Empty, latch=False),
            "position": _topic("tablet/position", Pose2D, latch=False),
            "tablet": _topic("tablet/state", TabletState),
        }
        self._in_benchmark: List[object] = []  # topics and services that end with the benchmark
        self._in_phase: List[rospy.Service] = []
        self._state_topic: Optional[rospy.Publisher] = None
        self._ended_mono = -SETTLE_S  # end of the latest benchmark
        self._goal_topic: Optional[rospy.Publisher] = None
        self._goal_text_topic: Optional[rospy.Publisher] = None
        self._always["benchmark"].publish(Benchmark.NONE)
        self._always["name"].publish("")
        self._jobs: queue.Queue[Optional[Callable[[], None]]] = queue.Queue()
        self._thread = threading.Thread(target=self._work, name="ROS interface", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Finish all jobs, then end the thread."""
        self._jobs.put(None)
        self._thread.join()

    def show(self, effect: fx.Effect, goal: Optional[Goal]) -> None:
        """Pass an effect to the robot's programs; `goal` is the present goal."""
        if isinstance(effect, fx.BenchmarkIs):
            self._jobs.put(lambda: self._enter_benchmark(effect.code))
        elif isinstance(effect, fx.StateIs):
            self._jobs.put(lambda: self._enter_state(effect.state, goal))
        elif isinstance(effect, fx.Devices):
            self._publish("devices", self._types.devices_state(
                bell=ros_wire_time(effect.bell), switch_1=effect.switch_1, switch_2=effect.switch_2,
                switch_3=effect.switch_3, dimmer=effect.dimmer, blinds=effect.blinds,
                door_win_detect=effect.door_win_detect,
            ))
        elif isinstance(effect, fx.TabletIs):
            self._publish("tablet", TabletState(
                effect.display_map, ros_wire_time(effect.call_time), ros_wire_time(effect.position_time),
                effect.position_x, effect.position_y,
            ))
        elif isinstance(effect, fx.BellRang):
            self._publish("bell", Empty())
        elif isinstance(effect, fx.TabletCalled):
            self._publish("call", Empty())
        elif isinstance(effect, fx.PositionSelected):
            self._publish("position", Pose2D(effect.x, effect.y, 0.0))

    def _publish(self, name: str, message: object) -> None:
        self._jobs.put(lambda: self._always[name].publish(message))

    # -- in the interface's thread ------------------------------------------------------------------

    def _work(self) -> None:
        while True:
            job = self._jobs.get()
            if job is None:
                return
            try:
                job()
            except Exception:
                # The thread must continue: the next job may be a stop.
                if not rospy.core.is_shutdown_requested():
                    rospy.logerr("internal error in the ROS interface, please report it", exc_info=True)

    def _enter_benchmark(self, code: Optional[str]) -> None:
        self._end_phase()
        for part in self._in_benchmark:
            _end(part)
        self._in_benchmark = []
        self._goal_topic = self._goal_text_topic = None
        self._code = code
        if code is None:
            self._end_state_topic()
            self._announce(None)
            return
        profile = profile_of(code)
        if profile is OTHER:
            rospy.loginfo("The box runs benchmark '%s', which is not one of the shipped ones. Its name is on topic "
                          "/roah_rsbb/benchmark/name", code)
        # Discard counts from before this benchmark. A latched count is received again.
        self._requests.messages_saved(0)
        self._in_benchmark.append(rospy.Subscriber(
            "/roah_rsbb/messages_saved", UInt32, lambda message: self._requests.messages_saved(message.data)
        ))
        if self._state_topic is None:
            time.sleep(max(0.0, self._ended_mono + SETTLE_S - time.monotonic()))
            self._state_topic = _state_topic()
        self._in_benchmark += self._benchmark_services(profile.uses)
        if profile.goal is not GoalForm.NONE:
            self._goal_text_topic = _topic("goal/text", StringMsg)
            self._in_benchmark.append(self._goal_text_topic)
        if profile.goal in self._goal_types:
            self._goal_topic = _topic("goal", self._goal_types[profile.goal])
            self._in_benchmark.append(self._goal_topic)
        self._publish_state(RobotState.STOP)
        self._announce(code)

    def _end_state_topic(self) -> None:
        """End the topic of the state because no benchmark runs. Between consecutive benchmarks it remains."""
        if self._state_topic is not None:
            _end(self._state_topic)
            self._state_topic = self._state_number = None
            self._ended_mono = time.monotonic()

    def _announce(self, code: Optional[str]) -> None:
        if code != self._announced:
            self._announced = code
            self._always["name"].publish(code or "")
            self._always["benchmark"].publish(Benchmark.NONE if code is None else profile_of(code).number)

    def _enter_state(self, state: RobotState, goal: Optional[Goal]) -> None:
        self._end_phase()
        if self._code is None:
            return
        if state is RobotState.PREPARING:
            self._in_phase.append(_service("end_prepare", EmptySrv, lambda _: self._requests.end_prepare()))
        elif state is RobotState.EXECUTING:
            self._in_phase.append(self._end_execute_service(profile_of(self._code).result))
            if self._goal_text_topic is not None:
                self._goal_text_topic.publish("" if goal is None else goal.text or "")
            if self._goal_topic is not None and goal is not None:
                self._publish_goal(profile_of(self._code).goal, goal)
        self._publish_state(state)

    def _end_phase(self) -> None:
        for service in self._in_phase:
            _end(service)
        self._in_phase = []

    def _publish_state(self, state: RobotState) -> None:
        if self._state_topic is not None and STATES[state] != self._state_number:
            self._state_number = STATES[state]
            self._state_topic.publish(self._state_number)

    def _publish_goal(self, form: GoalForm, goal: Goal) -> None:
        if form is GoalForm.WAYPOINT and goal.pose is not None:
            self._goal_topic.publish(Pose2D(*goal.pose))
        elif form is GoalForm.PLACEMENT and goal.pose is not None:
            self._goal_topic.publish(self._types.GoalHGMF(goal.object_id, Pose2D(*goal.pose)))
        elif form is GoalForm.SWITCHES:
            self._goal_topic.publish(GoalOMF(list(goal.initial_state), list(goal.switches)))
        elif form is GoalForm.STRING:
            self._goal_topic.publish(StringMsg(goal.text or ""))

    def _end_execute_service(self, form: ResultForm) -> rospy.Service:
        end = self._requests.end_execute
        if form is ResultForm.OBJECT:
            return _service("end_execute", ResultHOPF, lambda r: end(
                HopfResult(r.object_class, r.object_name, _pose(r.object_pose))))
        if form is ResultForm.PERSON:
            return _service("end_execute", ResultHPPF, lambda r: end(
                HppfResult(r.person_name, _pose(r.person_pose))))
        if form is ResultForm.TEXT:
            return _service("end_execute", String, lambda r: end(r.data or None))
        return _service("end_execute", EmptySrv, lambda _: end(ANY_RESULT if form is ResultForm.ANY else None))

    def _benchmark_services(self, uses: FrozenSet[str]) -> List[rospy.Service]:
        requests = self._requests
        services = [
            _service(field, String, lambda r, field=field: requests.add_string(field, r.data))
            for field in STRINGS if field in uses
        ]
        if TABLET in uses:
            services += [
                _service("tablet/map", EmptySrv, lambda _: requests.display_map(True)),
                _service("tablet/buttons", EmptySrv, lambda _: requests.display_map(False)),
            ]
        if DEVICES not in uses:
            return services
        for name in SWITCHES:
            path = f"devices/{name}"
            services += [
                _service(f"{path}/set", Bool, lambda r, name=name: requests.set_device(name, bool(r.data))),
                _service(f"{path}/on", EmptySrv, lambda _, name=name: requests.set_device(name, True)),
                _service(f"{path}/off", EmptySrv, lambda _, name=name: requests.set_device(name, False)),
            ]
        for name in PERCENTAGES:
            path = f"devices/{name}"
            services += [
                _service(f"{path}/set", Percentage, lambda r, name=name: requests.set_device(name, r.data)),
                _service(f"{path}/max", EmptySrv, lambda _, name=name: requests.set_device(name, 100)),
                _service(f"{path}/min", EmptySrv, lambda _, name=name: requests.set_device(name, 0)),
            ]
        return services


def _topic(name: str, message: type, latch: bool = True) -> rospy.Publisher:
    return rospy.Publisher(f"/roah_rsbb/{name}", message, queue_size=10, latch=latch)


def _state_topic() -> rospy.Publisher:
    """A topic without a queue: `publish` sends immediately, so that the last STOP is not lost when the topic ends.

    A slow subscriber does not block it, because a socket holds thousands of these messages.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy recommends a queue
        return rospy.Publisher("/roah_rsbb/benchmark/state", BenchmarkState, queue_size=None, latch=True)


def _service(name: str, service: type, action: Callable[[object], None]) -> rospy.Service:
    """A service that calls `action` and returns nothing. Exceptions become its error text."""

    def handle(request: object) -> object:
        try:
            action(request)
        except ValueError as error:
            raise rospy.ServiceException(str(error)) from None
        return service._response_class()

    return rospy.Service(f"/roah_rsbb/{name}", service, handle)


def _end(part: object) -> None:
    if isinstance(part, rospy.Service):
        part.shutdown("not in this phase")
    else:
        part.unregister()


def _pose(pose: Pose2D) -> Pose:
    return Pose(pose.x, pose.y, pose.theta)
