"""Converts a robot's messages on its private channel to the core's reports."""

import time
from typing import Callable, NamedTuple, Optional, Tuple, Union

from roah_rsbb.comm import frame
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.wire_check import Malformed, varint
from roah_rsbb.core.budget import Budget
from roah_rsbb.model.messages import NEVER, RobotReport
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import WireTime
from roah_rsbb.radio import wire_convert

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
        self._report = wire_convert.report_of(message)
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
