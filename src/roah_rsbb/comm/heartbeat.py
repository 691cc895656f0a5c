"""Recognises a robot's message that differs from the previous one only in its time, as most messages do.

Then only the time is read. Checking, parsing and converting a whole message takes 40 µs more: 0.8 points of CPU for 200
messages a second (40 robots at the original's pace, which may use 12 %), 8 points for 100 robots at 50 ms.

A serialised RobotState begins with its time, because all implementations of protobuf write fields in the order of their
numbers. Other orders are valid, but not recognised.
"""

from typing import NamedTuple, Optional, Tuple

from roah_rsbb.comm import frame, wire_check
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

# Ids of a RobotState, and the tag of its time; then come the time's size and the time.
_IDS = frame.ids_of(pb.RobotState)
_BEGIN = _IDS + b"\x0a"
_SECONDS_TAG, _NANOSECONDS_TAG = 0x08, 0x10
_MAX_INT64 = 2**63 - 1


class _Split(NamedTuple):
    """The parts of a payload."""

    time: Tuple[int, int]  # s, ns
    rest: bytes  # everything after it


class Heartbeat:
    """Remembers one RobotState, and compares payloads with it."""

    def __init__(self) -> None:
        self._rest: Optional[bytes] = None

    def remember(self, payload: bytes, message: pb.RobotState) -> None:
        """Compare with this payload from now on; `message` is its content."""
        split = _split(payload)
        # Other encoders may repeat the time, and the later one would count. So accept only protobuf's own encoding.
        is_sure = split is not None and _IDS + message.SerializeToString() == payload
        self._rest = split.rest if is_sure else None

    def time_of(self, payload: bytes) -> Optional[Tuple[int, int]]:
        """The time (s, ns) of a payload that otherwise equals the remembered one; None if it may differ."""
        if self._rest is None or not payload.endswith(self._rest):
            return None
        split = _split(payload)
        return split.time if split is not None and split.rest == self._rest else None


def _split(payload: bytes) -> Optional[_Split]:
    """Split a payload; None unless it begins like protobuf's own encoding of a RobotState."""
    if not payload.startswith(_BEGIN):
        return None
    try:
        size, begin = wire_check.varint(payload, len(_BEGIN))
        time, rest = payload[begin:begin + size], payload[begin + size:]
        if time[0] != _SECONDS_TAG:
            return None
        seconds, position = wire_check.varint(time, 1)
        if time[position] != _NANOSECONDS_TAG:
            return None
        nanoseconds, end = wire_check.varint(time, position + 1)
    except (IndexError, wire_check.Malformed):
        return None
    if end != size or max(seconds, nanoseconds) > _MAX_INT64:
        return None
    return _Split((seconds, nanoseconds), rest)
