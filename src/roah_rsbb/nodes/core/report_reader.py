"""What a robot says on its private channel, as the core takes it."""

import time
from typing import Callable, NamedTuple, Union

from roah_rsbb.comm import frame
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.core.budget import Budget
from roah_rsbb.core.messages import RobotReport
from roah_rsbb.nodes.core import wire_convert
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

# Bytes. Robots send up to twenty messages a second, of at most 1 kB each.
BYTES_AT_ONCE = 80_000
BYTES_PER_SECOND = 50_000


class Unread(NamedTuple):
    """A message that was not read because its robot sends too much."""

    count: int  # of such messages since they were reported last; 0: that is less than a second ago


class ReportReader:
    """Reads the payloads of one private channel, as far as its robot's budget goes.

    To read a message of many strings takes a hundred times as long as the usual one. A robot that sends such
    messages all the time would hold up all other zones.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` gives a monotonic time in seconds."""
        self._clock = clock
        self._budget = Budget(BYTES_AT_ONCE, BYTES_PER_SECOND)
        self._unread = OnceASecond()

    def __call__(self, payload: bytes) -> Union[RobotReport, pb.BenchmarkState, Unread]:
        """A robot's report, or another box's state; raises BadDatagram."""
        now_mono = self._clock()
        if not self._budget.take(now_mono, len(payload)):
            self._unread.count()
            return Unread(self._unread.take(now_mono))
        message = frame.private_message(payload)
        return wire_convert.report_of(message) if isinstance(message, pb.RobotState) else message
