"""Which of a robot's messages are new: the order of their `time` decides, not that of arrival.

UDP reorders and duplicates, and a stale datagram must never move the state machine (docs/protocol.md, "State
machines"). A robot may also have its clock set back; it would then be stale for ever. Such a
robot differs from a reordering network in this: nothing newer arrives any more, while several older
times arrive in rising order. As long as the first timeline lives, replayed datagrams have no chance.
What falls below the rising times begins them anew, or one straggler from just before the clock was set
back would stand above all that follows.
"""

import enum
from dataclasses import dataclass
from typing import Optional

from roah_rsbb.core.restart.saved import Mono

# For this long nothing may have come on the old timeline before a new one is believed. A robot sends
# every second: it may lose one datagram and still be taken for alive.
QUIET_S = 2.5
# So many messages with rising times make a new timeline.
RISING = 3


class Verdict(enum.Enum):
    """What to do with a message."""

    FRESH = "fresh"
    DUPLICATE = "duplicate"
    STALE = "stale"
    CLOCK_SET_BACK = "clock set back"  # accept it: the robot's timeline starts anew here


@dataclass
class TimelineState:
    """The newest time of a robot's messages. What was old before a restart is old after it, too."""

    newest: Optional[int] = None  # nanoseconds, the robot's clock
    newest_mono: Mono = 0.0


class Timeline:
    """The times of one robot's messages on one channel, in nanoseconds."""

    def __init__(self, state: Optional[TimelineState] = None) -> None:
        self.state = state or TimelineState()
        self._candidate: Optional[int] = None
        self._rising = 0

    def begin_after(self, mono: float, time_ns: int) -> None:
        """A time that came at `mono` (s), but not on this channel."""
        self._accept(mono, time_ns)

    def judge(self, mono: float, time_ns: int) -> Verdict:
        """Judge a message that arrived at `mono` (s) and carries `time_ns`; accepted ones count."""
        newest = self.state.newest
        if newest is None or time_ns > newest:
            self._accept(mono, time_ns)
            return Verdict.FRESH
        if time_ns in (newest, self._candidate):
            return Verdict.DUPLICATE
        is_rising = self._candidate is not None and time_ns > self._candidate
        self._rising = self._rising + 1 if is_rising else 1
        self._candidate = time_ns
        if self._rising >= RISING and mono - self.state.newest_mono >= QUIET_S:
            self._accept(mono, time_ns)
            return Verdict.CLOCK_SET_BACK
        return Verdict.STALE

    def _accept(self, mono: float, time_ns: int) -> None:
        self.state.newest = time_ns
        self.state.newest_mono = mono
        self._candidate = None
        self._rising = 0
