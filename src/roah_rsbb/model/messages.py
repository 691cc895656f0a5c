"""Messages as the core sees them: plain values, without protobuf.

The core's node converts datagrams and ROS messages to these and back. Numbers and names are those of
docs/protocol.md, "Messages". `LinkSample` is a second of the link record: how well a robot and the box hear each other.
"""

import json
from typing import NamedTuple, Optional, Tuple

from roah_rsbb.protocol import BoxState, RobotState, WireTime

NEVER: WireTime = (0, 0)


class RobotReport(NamedTuple):
    """One RobotState, decoded. `None` and `()` mean that the robot sent no such field."""

    time: WireTime
    messages_saved: int
    state: RobotState
    notifications: Tuple[str, ...] = ()
    activation_event: Tuple[str, ...] = ()
    visitor: Tuple[str, ...] = ()
    final_command: Tuple[str, ...] = ()
    switch_1: Optional[bool] = None
    switch_2: Optional[bool] = None
    switch_3: Optional[bool] = None
    dimmer: Optional[int] = None  # per cent, unchecked
    blinds: Optional[int] = None  # per cent, unchecked
    display_map: Optional[bool] = None
    generic_result: Optional[str] = None
    object_class: Optional[str] = None
    object_name: Optional[str] = None
    object_pose_x: Optional[float] = None  # metres
    object_pose_y: Optional[float] = None  # metres
    object_pose_theta: Optional[float] = None  # radians

    def lines(self) -> str:
        """The fields that were sent, as YAML lines for the run log."""
        return "\n".join(f"{name}: {_yaml(value)}" for name, value in zip(self._fields, self)
                         if value is not None and value != ())


class GoalMessage(NamedTuple):
    """A goal in the forms of all generations of robots."""

    text: str = ""  # YAML, for robots of 2019; empty: not in this form
    pose: Optional[Tuple[float, float, float]] = None  # for robots of 2015: metres, metres, radians
    initial_state: Tuple[bool, ...] = ()  # of switches
    switches: Tuple[int, ...] = ()  # to toggle, in this order


NO_GOAL = GoalMessage()


class BoxMessage(NamedTuple):
    """The BenchmarkState that the box is sending on a private channel."""

    benchmark: str  # code
    state: BoxState
    acknowledgement: WireTime = NEVER  # `time` of the last RobotState
    goal: GoalMessage = NO_GOAL  # in GOAL_TX

    def repeats(self, before: Optional["BoxMessage"]) -> bool:
        """Whether it requests the same as `before`; None: there was no message before."""
        return before is not None and self == before._replace(acknowledgement=self.acknowledgement)

    def lines(self) -> str:
        """The message as YAML lines for the run log."""
        lines = [f"benchmark: {self.benchmark}", f"state: {self.state.name}",
                 f"acknowledgement: {_yaml(self.acknowledgement)}"]
        lines += [f"goal_{name}: {_yaml(value)}" for name, value in zip(self.goal._fields, self.goal) if value]
        return "\n".join(lines)


class DevicesState(NamedTuple):
    """State of the home devices, as the beacon carries it."""

    bell: WireTime = NEVER  # last ring
    switch_1: bool = False
    switch_2: bool = False
    switch_3: bool = False
    dimmer: int = 0  # per cent
    blinds: int = 0  # per cent
    door_win_detect: bool = False


class DevicesSeen(NamedTuple):
    """The home devices, as faces get them (docs/door.md, "Calls of the home devices")."""

    devices: DevicesState
    connected: bool  # whether their controller is
    text: str  # details of the connection, or why there is none


class TabletState(NamedTuple):
    """State of the tablet, as the beacon carries it."""

    display_map: bool = False  # False: call button
    call_time: WireTime = NEVER
    position_time: WireTime = NEVER
    position_x: float = 0.0  # metres
    position_y: float = 0.0  # metres


class BenchmarkingRobot(NamedTuple):
    """A robot in a run, as the beacon lists it."""

    team: str
    robot: str
    port: int


class Beacon(NamedTuple):
    """The box's RoahRsbbBeacon."""

    robots: Tuple[BenchmarkingRobot, ...]
    devices: DevicesState
    tablet: TabletState


def _yaml(value: object) -> str:
    """A value as one line of flow-style YAML (JSON's subset of it)."""
    if isinstance(value, (BoxState, RobotState)):
        return value.name
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(_yaml(item) for item in value) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return str(value)


# No robot needs longer to answer. A later answer is not an answer to the first datagrams.
ANSWER_S = 0.5


class LinkSample(NamedTuple):
    """Measurements of a robot's link since the previous sample, usually for one second.

    From the robot to the box:
    `received`: datagrams that were newer than all before.
    `lost`: datagrams that the robot must have sent, but that did not arrive in order. This is based on the robot's
    times: the next message is due a second after each message, and ten in half a second after a change of state. They
    are counted when the next message arrives, so during a silence only `gap_s` grows. Not counted: losses at the end of
    a run, bursts of a robot from which no burst was received yet, bursts after new online data, and most of a burst
    that was cut short. Too large for a robot that sends less often than the rules require. A delayed datagram counts as
    lost, and as `stale` when it arrives.
    `skipped_states`: states that the robot went through without the box receiving them. Usually their datagrams were
    lost. A robot that goes through two states at once sends none for the first.
    `duplicates`, `stale`: datagrams that arrived twice, or after a newer one. Copies of older ones are stale, too.
    `unreadable`: datagrams that could not be decrypted or parsed, whoever sent them to this port.
    `gap_s`: the longest time without a newer message up to the sample, in seconds, including the part before the
    previous sample. Up to about 1 s is normal.
    `late_s`: the difference in delay between the slowest message and the fastest of the last 2.5 s, in seconds. Causes
    are a radio that waits or repeats, and a busy robot. The delay common to all messages is not included.

    From the box to the robot, and back. The robot does not acknowledge what it receives. This direction is therefore
    only visible where the robot must react: to the box's changes of state, and to the acknowledgement of online data.
    `answers`: how many of these the robot reacted to. `unanswered`: datagrams of the box, at least `ANSWER_S` old, that
    a newer message of the robot does not react to. They were lost, or the robot is slow. Too large for a robot that
    repeats acknowledged strings. `round_trip_s`, `round_trip_max_s`: the shortest and the longest time, in seconds,
    from first sending something to the arrival of the reaction. This includes the robot's own delay (up to 0.2 s if it
    reads its messages five times a second), and repetitions if the first datagrams were lost. The shortest one of a run
    is closest to the network's. None: nothing was sent that needs a reaction.

    Clocks, robot's minus box's, in seconds:
    `skew_s`: the largest difference of the last 2.5 s between a message's time and its arrival. The true skew is
    larger than this by the travel time of the fastest message. None: nothing was heard since a clock was set.
    `skew_max_s`: an upper limit of the true skew. A reaction is sent after what it reacts to, which gives the limit.
    """

    seconds: float  # since the previous sample
    received: int = 0
    lost: int = 0
    skipped_states: int = 0
    duplicates: int = 0
    stale: int = 0
    unreadable: int = 0
    gap_s: float = 0.0
    late_s: float = 0.0
    answers: int = 0
    unanswered: int = 0
    round_trip_s: Optional[float] = None
    round_trip_max_s: Optional[float] = None
    skew_s: Optional[float] = None
    skew_max_s: Optional[float] = None
    host: str = ""  # the robot's address; empty: not known yet
