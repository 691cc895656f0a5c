"""The messages of run logs, as ROS serialises them: types of std_msgs, and Score of this package."""

import struct
from typing import Callable, Dict, NamedTuple, Tuple

from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.run_logs.bag import Stamp

# topic (of `roah_rsbb.model.run_log`), value, UTC (s)
LogEntry = Tuple[str, object, float]

_UINT8, _INT32, _LENGTH = struct.Struct("<B"), struct.Struct("<i"), struct.Struct("<I")
_SCORE = """\
# The value of a scoring item (or one that the referee wants it to have).
string group
string desc
int32 value
"""


class BadEntry(Exception):
    """The entry does not fit into a message."""


class Message(NamedTuple):
    """A message as stored in a bag."""

    topic: str
    stamp: Stamp
    data: bytes
    kind: Dict[str, bytes]  # header of its connection: type, md5sum, message_definition


def _kind(name: str, md5sum: str, definition: str) -> Dict[str, bytes]:
    return {"type": name.encode(), "md5sum": md5sum.encode(), "message_definition": definition.encode()}


# The sums are made of the definitions (tested).
HEADERS: Dict[LogKind, Dict[str, bytes]] = {
    LogKind.UINT8: _kind("std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n"),
    LogKind.STRING: _kind("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n"),
    LogKind.SCORE: _kind("roah_rsbb/Score", "dae5eaddb8494f806eb4f392cd53e4e9", _SCORE),
    LogKind.EMPTY: _kind("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e", ""),
}


def message_of(entry: LogEntry) -> Message:
    """Build the message of an entry; raises `BadEntry`."""
    topic, value, utc = entry
    try:
        kind = KINDS[topic]
        seconds = int(utc)
        stamp = seconds, int((utc - seconds) * 1_000_000_000)
        struct.pack("<II", *stamp)
        return Message(topic, stamp, _PACKED[kind](value), HEADERS[kind])
    except (struct.error, TypeError, ValueError, KeyError, AttributeError) as error:
        raise BadEntry(f"{topic} cannot hold {value!r}: {error}") from None


def _string(value: str) -> bytes:
    data = value.encode()
    return _LENGTH.pack(len(data)) + data


def _score(value: Tuple[str, str, int]) -> bytes:
    group, desc, number = value
    return _string(group) + _string(desc) + _INT32.pack(number)


_PACKED: Dict[LogKind, Callable[..., bytes]] = {
    LogKind.UINT8: _UINT8.pack, LogKind.STRING: _string, LogKind.SCORE: _score, LogKind.EMPTY: lambda value: b"",
}
