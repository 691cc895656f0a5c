"""Converts a robot's messages on its private channel to the core's reports."""

import time
from typing import Callable, NamedTuple, Union

from roah_rsbb.comm import frame
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.core.budget import Budget
from roah_rsbb.core.messages import RobotReport
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert

# Bytes. Robots send at most twenty messages a second, of at most 1 kB each.
BYTES_AT_ONCE = 80_000
BYTES_PER_SECOND = 50_000


class Unread(NamedTuple):
    """A message that was not read because its robot sends too much."""

    count: int  # of such messages since the last report; 0: the last report is less than a second old


class ReportReader:
    """Reads the payloads of one private channel, within its robot's budget.

    A message with many strings takes a hundred times as long to read as a usual one. A robot that sends only such
    messages would delay all other zones.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` returns monotonic seconds."""
        self._clock = clock
        self._budget = Budget(BYTES_AT_ONCE, BYTES_PER_SECOND)
        self._unread = OnceASecond()

    def __call__(self, payload: bytes) -> Union[RobotReport, pb.BenchmarkState, Unread]:
        """Return a robot's report, or another box's state. Raises BadDatagram."""
        now_mono = self._clock()
        if not self._budget.take(now_mono, len(payload)):
            self._unread.count()
            return Unread(self._unread.take(now_mono))
        message = frame.private_message(payload)
        return wire_convert.report_of(message) if isinstance(message, pb.RobotState) else message
