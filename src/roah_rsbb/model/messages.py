"""Messages as the core sees them: plain values, without protobuf.

The core's node converts datagrams and ROS messages to these and back. Numbers and names are those of
docs/protocol.md, "Messages".
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
