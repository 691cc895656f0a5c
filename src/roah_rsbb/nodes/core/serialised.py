"""Builds the panels' messages from parts that were serialised before.

With 100 zones, genpy needs 15 ms for one message, and no robot gets an answer meanwhile, although usually only times
have changed. genpy also gives the positions of fields in the bytes: they are where two messages differ that differ in
one field only.
"""

import io
import math
import struct
from typing import Any, List, Sequence, Tuple, Type

import genpy

from roah_rsbb.msg import CoreToGui, RobotInfo, ZoneState

_COUNT = struct.Struct("<I")  # of an array's elements
_DURATION = struct.Struct("<2i")
_TIME = struct.Struct("<2I")
_MAX_TIME, _MAX_DURATION = 2**32 - 1, 2**31 - 1


def duration_bytes(seconds: float) -> bytes:
    """Return the bytes of a duration, limited to its range, as `ros.times.ros_duration`."""
    return _DURATION.pack(*_split(min(max(seconds, -_MAX_DURATION), _MAX_DURATION)))


def time_bytes(utc: float) -> bytes:
    """Return the bytes of a UTC time, limited to its range, as `ros.times.ros_time`."""
    return _TIME.pack(*_split(min(max(utc, 0.0), _MAX_TIME)))


def _split(seconds: float) -> Tuple[int, int]:
    whole = math.floor(seconds)
    return whole, int((seconds - whole) * 1e9)


def _serialised(kind: Type[genpy.Message], message: genpy.Message) -> bytes:
    buff = io.BytesIO()
    kind.serialize(message, buff)
    return buff.getvalue()


def _first_difference(one: bytes, other: bytes, begin: int = 0) -> int:
    """Return the first place from `begin` on at which they differ. Bisection, because a loop over all bytes is slow."""
    end = len(one)
    while end - begin > 1:
        middle = (begin + end) // 2
        if one[begin:middle] == other[begin:middle]:
            begin = middle
        else:
            end = middle
    return begin


def _other(value: Any) -> Any:
    """Return a value whose first byte differs."""
    return not value if isinstance(value, bool) else type(value)(value.secs ^ 1, value.nsecs)


class Serialised:
    """A serialised message in which some fields can be changed: times, durations and bools."""

    def __init__(self, message: genpy.Message, *fields: str) -> None:
        """`fields`: those that can be changed, in the order of the message."""
        kind, names = type(message), message.__slots__
        data = _serialised(kind, message)
        # What follows the last of these fields does not move them, and may be long.
        beginning = kind()
        for name in names[:names.index(fields[-1]) + 1]:
            setattr(beginning, name, getattr(message, name))
        one = _serialised(kind, beginning)
        for field in fields:
            setattr(beginning, field, _other(getattr(message, field)))
        other = _serialised(kind, beginning)
        self._between: List[bytes] = []
        end = 0
        for field in fields:
            begin = _first_difference(one, other, end)
            self._between.append(data[end:begin])
            end = begin + (1 if isinstance(getattr(message, field), bool) else _DURATION.size)
        self._last = data[end:]

    def with_values(self, *values: bytes) -> bytes:
        """Return the bytes with these values of the fields."""
        parts: List[bytes] = []
        for between, value in zip(self._between, values):
            parts += (between, value)
        return b"".join((*parts, self._last))


class _Assembled(genpy.Message):
    """A message whose last arrays are given as serialised elements; their fields are empty."""

    AFTER = 0  # bytes after the arrays

    def __init__(self, *arrays: Sequence[bytes], **fields: Any) -> None:
        super().__init__(**fields)
        self._arrays = b"".join(_COUNT.pack(len(elements)) + b"".join(elements) for elements in arrays)
        self._counts = _COUNT.size * len(arrays)

    def serialize(self, buff: io.BytesIO) -> None:
        """Write the bytes to `buff`, like all messages of genpy."""
        whole = io.BytesIO()
        super().serialize(whole)
        data = whole.getvalue()
        end = len(data) - self.AFTER
        buff.write(data[:end - self._counts] + self._arrays + data[end:])


def _size_after_zones() -> int:
    none = _serialised(CoreToGui, CoreToGui())
    count = _first_difference(none, _serialised(CoreToGui, CoreToGui(zones=[ZoneState()])))
    assert _first_difference(none, _serialised(CoreToGui, CoreToGui(active_robots=[RobotInfo()]))) == (
        count - _COUNT.size), "the robots come immediately before the zones"
    return len(none) - count - _COUNT.size


class SerialisedToGui(_Assembled, CoreToGui):
    """A CoreToGui with serialised robots and zones."""

    AFTER = _size_after_zones()
