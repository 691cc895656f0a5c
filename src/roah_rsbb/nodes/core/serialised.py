"""Builds /core/to_gui from parts that were serialised before.

With 40 zones, genpy needs 2 ms for one message, ten times a second, although usually only the timers change. genpy also
gives the position of a field in the bytes: it is where two messages differ that differ in this field only.
"""

import io
import struct
from typing import Any, Sequence, Type

import genpy

from roah_rsbb.msg import CoreToGui, ZoneState

_COUNT = struct.Struct("<I")  # of an array's elements
_DURATION = struct.Struct("<2i")


def _serialised(kind: Type[genpy.Message], message: genpy.Message) -> bytes:
    buff = io.BytesIO()
    kind.serialize(message, buff)
    return buff.getvalue()


def _first_difference(one: bytes, other: bytes) -> int:
    return next(index for index, (a, b) in enumerate(zip(one, other)) if a != b)


def _size_after_zones() -> int:
    none = _serialised(CoreToGui, CoreToGui())
    count = _first_difference(none, _serialised(CoreToGui, CoreToGui(zones=[ZoneState()])))
    return len(none) - count - _COUNT.size


_AFTER_ZONES = _size_after_zones()


class SerialisedZone:
    """A serialised ZoneState; only its timer can be changed."""

    def __init__(self, state: ZoneState) -> None:
        state.timer = genpy.Duration(-1)
        other = _serialised(ZoneState, state)
        state.timer = genpy.Duration(0)
        data = _serialised(ZoneState, state)
        timer = _first_difference(data, other)
        self._before, self._after = data[:timer], data[timer + _DURATION.size:]

    def with_timer(self, timer: genpy.Duration) -> bytes:
        """The bytes with this timer."""
        return self._before + _DURATION.pack(timer.secs, timer.nsecs) + self._after


class SerialisedToGui(CoreToGui):
    """A CoreToGui with serialised zones; its field `zones` is empty."""

    def __init__(self, zones: Sequence[bytes], **fields: Any) -> None:
        super().__init__(**fields)
        self._count, self._zones = _COUNT.pack(len(zones)), b"".join(zones)

    def serialize(self, buff: io.BytesIO) -> None:
        """Write the bytes to `buff`, like all messages of genpy."""
        data = _serialised(CoreToGui, self)
        buff.write(data[:-_AFTER_ZONES - _COUNT.size] + self._count + self._zones + data[-_AFTER_ZONES:])
