"""Decides which of a robot's messages are new, by their `time` rather than by their arrival.

UDP reorders and duplicates datagrams, and a stale one must never change the state (docs/protocol.md, "State machines").
A robot's clock may also be set back; then all its messages would be stale forever. Such a robot differs from a network
that reorders: nothing newer arrives any more, and several older times arrive in rising order. While messages arrive on
the first timeline, replayed datagrams therefore have no effect. A time below the rising ones restarts the count;
otherwise one delayed message from just before the clock was set back would be newer than all that follow.
"""

import enum
from dataclasses import dataclass
from typing import Optional

from roah_rsbb.model.saved import Mono

# A new timeline is accepted only if nothing has arrived on the old one for this long. A robot sends every second, so it
# may lose one datagram and still count as active.
QUIET_S = 2.5
# This many messages with rising times make a new timeline.
RISING = 3


class Freshness(enum.Enum):
    """What to do with a message."""

    FRESH = "fresh"
    DUPLICATE = "duplicate"
    STALE = "stale"
    CLOCK_SET_BACK = "clock set back"  # accept it: it begins a new timeline


@dataclass
class TimelineState:
    """The newest time of a robot's messages. Older messages stay old after a restart."""

    newest: Optional[int] = None  # nanoseconds, the robot's clock
    newest_mono: Mono = 0.0


class Timeline:
    """The times of one robot's messages on one channel, in nanoseconds."""

    def __init__(self, state: Optional[TimelineState] = None) -> None:
        self.state = state or TimelineState()
        self._candidate: Optional[int] = None
        self._rising = 0

    def judge(self, mono: float, time_ns: int, can_begin: bool = True) -> Freshness:
        """Judge a message that arrived at `mono` (s) and carries `time_ns`. An accepted one moves the timeline.

        `can_begin`: whether it may belong to a new timeline.
        """
        newest = self.state.newest
        if newest is None or time_ns > newest:
            self._accept(mono, time_ns)
            return Freshness.FRESH
        if time_ns in (newest, self._candidate):
            return Freshness.DUPLICATE
        if can_begin:
            is_rising = self._candidate is not None and time_ns > self._candidate
            self._rising = self._rising + 1 if is_rising else 1
            self._candidate = time_ns
            if self._rising >= RISING and mono - self.state.newest_mono >= QUIET_S:
                self._accept(mono, time_ns)
                return Freshness.CLOCK_SET_BACK
        return Freshness.STALE

    def _accept(self, mono: float, time_ns: int) -> None:
        self.state.newest = time_ns
        self.state.newest_mono = mono
        self._candidate = None
        self._rising = 0
