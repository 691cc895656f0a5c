"""The times that a robot writes into its messages, and what the box's acknowledgements say of them.

The box puts a robot's messages into order by their `time` and ignores what is older than what it has
seen (docs/protocol.md, "State machines"). So two messages of one channel never carry the same time, and a
later one never an earlier time, even when the clock stands still or NTP turns it back a little. Only
when somebody set the clock back by more than `SET_BACK_S` does the time follow it: to hide that would
show the referee a skew that the robot no longer has.
"""

import math
from typing import Dict, Optional, Tuple

from roah_rsbb.protocol import WireTime

SET_BACK_S = 1.0

# How many messages are remembered for their acknowledgement: 50 s of the fastest burst, many minutes
# otherwise. An older acknowledgement than that is no news.
_REMEMBERED = 1000

_NS = 1_000_000_000


def wire_time(utc: float) -> WireTime:
    """Seconds since 1970 as they are sent."""
    return divmod(_nanoseconds(utc), _NS)


def _nanoseconds(utc: float) -> int:
    # The whole seconds apart, because the product would lose what a float of their size can still hold.
    seconds = math.floor(utc)
    return seconds * _NS + int((utc - seconds) * _NS)


class MessageTimes:
    """Gives each message of one channel its time, and knows its number again by that time."""

    def __init__(self) -> None:
        self._last_ns: Optional[int] = None
        self._count = 0
        self._numbers: Dict[int, int] = {}  # time in ns -> number of the message

    def next(self, now_utc: float) -> Tuple[WireTime, int]:
        """Time and number (1, 2, 3 ...) of the message sent now; `now_utc` in seconds."""
        now_ns = _nanoseconds(now_utc)
        if self._last_ns is not None and self._last_ns - SET_BACK_S * _NS <= now_ns <= self._last_ns:
            now_ns = self._last_ns + 1
        self._last_ns = now_ns
        self._count += 1
        self._numbers.pop(now_ns, None)
        self._numbers[now_ns] = self._count
        if len(self._numbers) > _REMEMBERED:
            del self._numbers[next(iter(self._numbers))]
        return divmod(now_ns, _NS), self._count

    def number_of(self, acknowledged: WireTime) -> Optional[int]:
        """The number of the message with exactly this time; None if it is none of the recent ones.

        Boxes echo the time exactly. What matches none is from before this program started, or from
        before the box did.
        """
        return self._numbers.get(acknowledged[0] * _NS + acknowledged[1])

    def number_reached(self, acknowledged: WireTime) -> Optional[int]:
        """The number of the last message with this time or an earlier one, for times typed by hand."""
        limit = acknowledged[0] * _NS + acknowledged[1]
        return max((number for time, number in self._numbers.items() if time <= limit), default=None)
