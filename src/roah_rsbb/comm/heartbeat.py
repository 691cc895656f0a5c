"""Recognises a robot's message that says what the last one said, at another time: most of them are such.

Only its time is read then. To check, parse and convert the whole message takes ten times as long, in code and data
that have left the processor's caches since the last datagram.

A serialised RobotState begins with its time: every implementation of protobuf writes fields in the order of their
numbers. One that is written otherwise is valid, and just not recognised.
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
    """A payload, divided."""

    time: Tuple[int, int]  # s, ns
    rest: bytes  # all after it


class Heartbeat:
    """Remembers one RobotState, and compares payloads with it."""

    def __init__(self) -> None:
        self._rest: Optional[bytes] = None

    def remember(self, payload: bytes, message: pb.RobotState) -> None:
        """Compare with this payload from now on, which was read as this message."""
        split = _split(payload)
        # Protobuf itself writes no field twice: in other bytes a second time might come, which would count instead.
        is_sure = split is not None and _IDS + message.SerializeToString() == payload
        self._rest = split.rest if is_sure else None

    def time_of(self, payload: bytes) -> Optional[Tuple[int, int]]:
        """The time (s, ns) of a payload that else says what the remembered one says; None: that is not sure."""
        if self._rest is None or not payload.endswith(self._rest):
            return None
        split = _split(payload)
        return split.time if split is not None and split.rest == self._rest else None


def _split(payload: bytes) -> Optional[_Split]:
    """None where the payload does not begin as protobuf itself writes a RobotState."""
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
