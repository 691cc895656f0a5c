"""Converts between the protobuf messages of `comm` and the values of `core`."""

import time
from typing import Callable, NamedTuple, Optional, Tuple, Union

from roah_rsbb.comm import frame
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.frame import Malformed, varint
from roah_rsbb.core.settings import Budget
from roah_rsbb.model.messages import NEVER, Beacon, BoxMessage, RobotReport, TabletState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState, WireTime

# Optional fields of a RobotState, by their names in a RobotReport.
_OPTIONAL = {
    "switch_1": "devices_switch_1",
    "switch_2": "devices_switch_2",
    "switch_3": "devices_switch_3",
    "dimmer": "devices_dimmer",
    "blinds": "devices_blinds",
    "display_map": "tablet_display_map",
    "generic_result": "generic_result",
    "object_class": "object_class",
    "object_name": "object_name",
    "object_pose_x": "object_pose_x",
    "object_pose_y": "object_pose_y",
    "object_pose_theta": "object_pose_theta",
}


def report_of(message: pb.RobotState) -> RobotReport:
    """Convert a RobotState."""
    return RobotReport(
        time=time_of(message.time),
        messages_saved=message.messages_saved,
        state=RobotState(message.robot_state),
        notifications=tuple(message.notifications),
        activation_event=tuple(message.activation_event),
        visitor=tuple(message.visitor),
        final_command=tuple(message.final_command),
        **{ours: getattr(message, theirs) for ours, theirs in _OPTIONAL.items() if message.HasField(theirs)},
    )


def tablet_of(message: pb.TabletBeacon) -> TabletState:
    """Convert a TabletBeacon, which does not contain the shown view."""
    return TabletState(
        call_time=time_of(message.last_call),
        position_time=time_of(message.last_pos),
        position_x=message.x,
        position_y=message.y,
    )


def acknowledge(message: pb.BenchmarkState, time: WireTime) -> None:
    """Set the `time` of the RobotState that a BenchmarkState acknowledges."""
    _set_time(message.acknowledgement, time)


def state_message(message: BoxMessage) -> pb.BenchmarkState:
    """Build a BenchmarkState."""
    goal = message.goal
    made = pb.BenchmarkState(
        benchmark_type=message.benchmark, benchmark_state=int(message.state), initial_state=goal.initial_state,
        switches=goal.switches,
    )
    acknowledge(made, message.acknowledgement)
    if goal.text:
        made.generic_goal = goal.text
    if goal.pose is not None:
        made.target_pose_x, made.target_pose_y, made.target_pose_theta = goal.pose
    return made


def beacon_message(beacon: Beacon) -> pb.RoahRsbbBeacon:
    """Build a RoahRsbbBeacon."""
    devices, tablet = beacon.devices, beacon.tablet
    made = pb.RoahRsbbBeacon(
        devices_switch_1=devices.switch_1,
        devices_switch_2=devices.switch_2,
        devices_switch_3=devices.switch_3,
        devices_dimmer=devices.dimmer,
        devices_blinds=devices.blinds,
        devices_door_win_detect=devices.door_win_detect,
        tablet_display_map=tablet.display_map,
        tablet_position_x=tablet.position_x,
        tablet_position_y=tablet.position_y,
    )
    for robot in beacon.robots:
        made.benchmarking_teams.add(team_name=robot.team, robot_name=robot.robot, rsbb_port=robot.port)
    _set_time(made.devices_bell, devices.bell)
    _set_time(made.tablet_call_time, tablet.call_time)
    _set_time(made.tablet_position_time, tablet.position_time)
    return made


def time_of(message: pb.Time) -> WireTime:
    """A wire time as an exact pair."""
    return message.sec, message.nsec


def _set_time(field: pb.Time, time: WireTime) -> None:
    field.sec, field.nsec = time


# -- a robot's messages on its private channel --------------------------------------------------------

# Bytes. Robots send at most twenty messages a second, of at most 1 kB each.
BYTES_AT_ONCE = 80_000
BYTES_PER_SECOND = 50_000

# The beginning of a RobotState's payload: its ids, and the tag of its time.
_BEFORE_TIME = frame.ids_of(pb.RobotState) + b"\x0a"
_TIME_TAGS = 0x08, 0x10  # of the seconds and the nanoseconds
_MAX_INT64 = 2**63 - 1


class Unread(NamedTuple):
    """A message that was not read because its robot sends too much."""

    count: int  # of such messages since the last report; 0: the last report is less than a second old


class ReportReader:
    """Reads the payloads of one private channel, within its robot's budget.

    A message with many strings takes a hundred times as long to read as a usual one. A robot that sends only such
    messages would delay all other zones.

    A robot repeats its state many times a second, and only the time differs. Such a message is not read again: if
    everything after the time has the bytes of the last message, it means the same.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` returns monotonic seconds."""
        self._clock = clock
        self._budget = Budget(BYTES_AT_ONCE, BYTES_PER_SECOND)
        self._unread = OnceASecond()
        self._rest = b""  # of the last report's payload, after its time; empty: read the next one in any case
        self._report: Optional[RobotReport] = None  # the last one

    def time_of_repeat(self, payload: bytes) -> Optional[WireTime]:
        """Return the robot's time in a payload that repeats the last report but for it; None: it does not."""
        time_sent, rest = _split(payload)
        return time_sent if rest and rest == self._rest else None

    def again(self, time_sent: WireTime, size: int) -> Union[RobotReport, Unread]:
        """Return the last report with another time. `size`: of the payload that repeats it (bytes)."""
        if not self._budget.take(self._clock(), size):
            return self._not_read()
        assert self._report is not None, "it is repeated"
        self._report = RobotReport._make((time_sent, *self._report[1:]))
        return self._report

    def __call__(self, payload: bytes) -> Union[RobotReport, pb.BenchmarkState, Unread]:
        """Return a robot's report, or another box's state. Raises BadDatagram."""
        time_sent = self.time_of_repeat(payload)
        if time_sent is not None:
            return self.again(time_sent, len(payload))
        if not self._budget.take(self._clock(), len(payload)):
            return self._not_read()
        message = frame.private_message(payload)
        if not isinstance(message, pb.RobotState):
            return message
        self._report = report_of(message)
        # A second time in the rest would count instead of the first one.
        rest = _split(payload)[1]
        self._rest = b"" if pb.RobotState.FromString(rest).HasField("time") else rest
        return self._report

    def _not_read(self) -> Unread:
        self._unread.count()
        return Unread(self._unread.take(self._clock()))


def _split(payload: bytes) -> Tuple[WireTime, bytes]:
    """Return the time of a RobotState and the bytes after it; no bytes: the payload does not begin with a usual time,
    which consists of two numbers that are not negative."""
    if not payload.startswith(_BEFORE_TIME):
        return NEVER, b""
    try:
        begin = len(_BEFORE_TIME) + 1
        end = begin + payload[begin - 1]
        second, middle = varint(payload, begin + 1)
        nanosecond, last = varint(payload, middle + 1)
        tags = payload[begin], payload[middle]
    except (IndexError, Malformed):
        return NEVER, b""
    if last != end or tags != _TIME_TAGS or max(second, nanosecond) > _MAX_INT64:
        return NEVER, b""
    return (second, nanosecond), payload[end:]
