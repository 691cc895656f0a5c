"""Decides which of a robot's messages are new, by their `time` rather than by their arrival: on a channel, and in the
competition.

On a channel (`Timeline`): UDP reorders and duplicates datagrams, and a stale one must never change the state
(docs/protocol.md, "State machines"). A robot's clock may also be set back; then all its messages would be stale
forever. Such a robot differs from a network that reorders: nothing newer arrives any more, and several older times
arrive in rising order. While messages arrive on the first timeline, replayed datagrams therefore have no effect. A time
below the rising ones restarts the count; otherwise one delayed message from just before the clock was set back would be
newer than all that follow.

In the competition (`Heard`): whoever records a robot's messages can send them again later, but cannot change their
times. So each message must be newer than all that were taken from the robot, in any run. The journal has these times
*ahead*: it says a later time than that of any message that was taken, so that they survive a restart or a takeover
without a record of each message. After it, the robot is heard again as soon as its clock has passed that time, or shows
what it must show by its last messages and the time that passed.

Start and *connect* need a clock within the allowed skew. So a new channel takes only times from then on, less that
skew, and a channel that is opened again only what the robot's clock shows by then. This covers what no journal has:
other robots of the team, which has one password, and what a copy of the journal lacked.

A clock may be wrong. Times that are ahead of the box's clock are therefore kept apart, and must rise, too. A robot
whose clock was ahead is heard when it is set right.
"""

import enum
from dataclasses import dataclass
from typing import Callable, Dict, NamedTuple, Optional

from roah_rsbb.core.robots import RobotId
from roah_rsbb.model.clock import Mono, Now

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


# The journal's time is so much later (s) than that of the robot's message, at most and at least after a new record.
AHEAD_S = 1.5
LEAST_AHEAD_S = 0.5
# If the newest time is so far ahead of the box's clock (s), the box's clock was set back.
SET_BACK_S = 5.0
# Much more than the error of computed times (s), and much less than a restart takes.
ROUNDED_S = 0.001
_NS = 1_000_000_000


class HeardUpTo(NamedTuple):
    """No message that was taken from a robot is newer than this (s of its clock)."""

    near: int = 0  # of those that were not ahead of the box's clock
    ahead: int = 0  # of the others


NOTHING = HeardUpTo()
HeardState = Dict[str, Dict[str, HeardUpTo]]  # by team and robot


class RobotPast:
    """The newest times of one robot's messages (ns)."""

    def __init__(
        self, allowed_skew: float, save: Callable[[], None] = lambda: None, saved: HeardUpTo = NOTHING,
    ) -> None:
        """`allowed_skew` is in seconds. `save` must save a later time than the newest."""
        self.saved = saved
        self.near, self.ahead = saved.near * _NS, saved.ahead * _NS
        self._allowed_skew, self._save = allowed_skew, save
        self._latest = 0.0  # a time (ns) that is not ahead of the box's clock

    def is_new(self, utc: float, time_ns: int) -> bool:
        """Whether no message as new as this one was taken before. `utc`: when it arrived (s)."""
        latest = self._latest = (utc + self._allowed_skew) * _NS
        if self.near < time_ns <= latest:
            return True
        if self.near > latest + SET_BACK_S * _NS:
            self.ahead = max(self.ahead, self.near)
            self.near = round((utc - self._allowed_skew) * _NS)
        return time_ns > (self.near if time_ns <= latest else self.ahead)

    def take(self, utc: float, time_ns: int) -> None:
        """Note the time of a message for which `is_new` was just True."""
        if time_ns <= self._latest:
            self.near = time_ns
        else:
            self.ahead = time_ns
            self.near = max(self.near, round((utc - self._allowed_skew) * _NS))
        if self.near > self.saved.near * _NS or self.ahead > self.saved.ahead * _NS:
            self._save()

    def move(self) -> None:
        """Set the saved times ahead again, if they are not."""
        self.saved = HeardUpTo(_moved(self.near, self.saved.near), _moved(self.ahead, self.saved.ahead))


def _moved(newest: int, saved: int) -> int:
    is_enough = not newest or saved * _NS - newest >= LEAST_AHEAD_S * _NS
    return saved if is_enough else int((newest + AHEAD_S * _NS) // _NS)


class Heard:
    """The newest times of all robots."""

    def __init__(self, allowed_skew: float) -> None:
        """`allowed_skew` is in seconds."""
        self._allowed_skew = allowed_skew
        self._robots: Dict[RobotId, RobotPast] = {}
        self._is_due = False

    def restore(self, state: HeardState) -> None:
        """Take what was saved before a restart."""
        for team, robots in state.items():
            for robot, saved in robots.items():
                self._robots[RobotId(team, robot)] = RobotPast(self._allowed_skew, self.save, saved)

    @property
    def state(self) -> HeardState:
        """What to save."""
        state: HeardState = {}
        for robot, past in self._robots.items():
            if past.saved != NOTHING:
                state.setdefault(robot.team, {})[robot.robot] = past.saved
        return state

    def begin(self, now: Now, robot: RobotId, clock: Optional[float] = None) -> RobotPast:
        """Return the past of a robot whose channel is opened. `clock`: what its clock shows now by its messages before
        a restart (s); None: it sent none."""
        past = self._robots.setdefault(robot, RobotPast(self._allowed_skew, self.save))
        since = now.utc
        if clock is not None:
            since = min(since, clock - ROUNDED_S)
            past.near = min(past.near, round(since * _NS))
        past.near = max(past.near, round((since - self._allowed_skew) * _NS))
        past.ahead = max(other.ahead for one, other in self._robots.items() if one.team == robot.team)
        return past

    def save(self) -> None:
        """Move the saved times of all robots, which share a record."""
        self._is_due = True
        for past in self._robots.values():
            past.move()

    def take_due(self) -> bool:
        """Whether the saved times moved since the last call."""
        is_due, self._is_due = self._is_due, False
        return is_due
