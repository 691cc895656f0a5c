"""The effects of a `Session`: datagrams and channels for the sockets, news for the robot's software."""

import enum
from dataclasses import dataclass
from typing import Optional, Tuple, Union

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot.goals import Goal


@dataclass(frozen=True)
class SendBeacon:
    """Send `message` on the public channel."""

    message: pb.RobotBeacon


@dataclass(frozen=True)
class OpenChannel:
    """Open the private channel: bind `port`, send to `host` and the same port."""

    host: str
    port: int


@dataclass(frozen=True)
class CloseChannel:
    """Close the private channel."""


@dataclass(frozen=True)
class SendState:
    """Send `message` on the private channel."""

    message: pb.RobotState


@dataclass(frozen=True)
class WouldSendState:
    """The state that would be sent without `Session.override`."""

    message: pb.RobotState


@dataclass(frozen=True)
class BenchmarkIs:
    """The benchmark changed; None if the run is over."""

    code: Optional[str]


@dataclass(frozen=True)
class StateIs:
    """The robot's state changed."""

    state: RobotState


@dataclass(frozen=True)
class Prepare:
    """Prepare for a goal, then call `Session.end_prepare`. Any earlier activity has ended."""

    benchmark: str


@dataclass(frozen=True)
class Execute:
    """Execute, then call `Session.end_execute`. `goal` is None if the box sent none."""

    benchmark: str
    goal: Optional[Goal]


@dataclass(frozen=True)
class Stop:
    """Stop all activity."""

    why: str


@dataclass(frozen=True)
class Devices:
    """State of the home devices, at the first beacon and after changes. dimmer, blinds: per cent."""

    bell: Tuple[int, int]  # time of the latest ring: seconds and nanoseconds since 1970
    switch_1: bool
    switch_2: bool
    switch_3: bool
    dimmer: int
    blinds: int
    door_win_detect: bool


@dataclass(frozen=True)
class TabletIs:
    """State of the tablet, at the first beacon and after changes. Times as in `Devices`; metres."""

    display_map: bool
    call_time: Tuple[int, int]
    position_time: Tuple[int, int]
    position_x: float
    position_y: float


@dataclass(frozen=True)
class BellRang:
    """Somebody rang the bell."""


@dataclass(frozen=True)
class TabletCalled:
    """The tablet's call button was pressed."""


@dataclass(frozen=True)
class PositionSelected:
    """A position was selected on the tablet's map, in metres."""

    x: float
    y: float


class Problem(enum.Enum):
    """Problems that a session can notice."""

    NO_BOX = "no box is received"
    BOX_SILENT = "the box is silent on the private channel"
    WRONG_PASSWORD = "the box's messages cannot be decrypted"
    SAME_NAME = "another robot has the same team and name"
    ANOTHER_BOX = "there is another box"
    UNEXPECTED_STATE = "the box sent an impossible state"
    BAD_GOAL = "the goal cannot be read"
    CHANNEL = "the private channel cannot be opened"


@dataclass(frozen=True)
class ProblemIs:
    """A problem, reported once; `over`: it has ended."""

    problem: Problem
    text: str
    over: bool = False


Effect = Union[
    SendBeacon, OpenChannel, CloseChannel, SendState, WouldSendState,
    BenchmarkIs, StateIs, Prepare, Execute, Stop,
    Devices, TabletIs, BellRang, TabletCalled, PositionSelected, ProblemIs,
]
