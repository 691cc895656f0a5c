"""What a robot says on its private channel, as the core takes it."""

from typing import Optional, Union

from roah_rsbb.comm import frame
from roah_rsbb.comm.heartbeat import Heartbeat
from roah_rsbb.core.messages import RobotReport
from roah_rsbb.nodes.core import wire_convert
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb


class ReportReader:
    """Reads the payloads of one private channel."""

    def __init__(self) -> None:
        self._heartbeat = Heartbeat()
        self._last: Optional[RobotReport] = None

    def __call__(self, payload: bytes) -> Union[RobotReport, pb.BenchmarkState]:
        """A robot's report, or another box's state; raises BadDatagram."""
        time = self._heartbeat.time_of(payload)
        if self._last is not None and time is not None:
            return self._last._replace(time=time)
        message = frame.private_message(payload)
        if not isinstance(message, pb.RobotState):
            return message
        self._last = wire_convert.report_of(message)
        self._heartbeat.remember(payload, message)
        return self._last
