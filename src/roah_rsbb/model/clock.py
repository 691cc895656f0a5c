"""Moments on two clocks.

Durations use the monotonic clock. Everything that is logged or sent is UTC (docs/architecture.md, "Two clocks").
The core never reads a clock: every method that needs the time takes a `Now`, which drivers make with `one_moment`.
"""

import typing
from typing import Callable, NamedTuple, NewType, Optional

# A moment on the monotonic clock of one boot, and one in UTC seconds. Only `as_json` distinguishes them from other
# numbers: the first are moved.
if typing.TYPE_CHECKING:
    Mono = float
    Utc = float
else:
    Mono, Utc = NewType("Mono", float), NewType("Utc", float)

# Two clock readings count as simultaneous within this time; a busy machine may need several attempts.
SAME_MOMENT_S = 0.005
MAX_READINGS = 10


class Now(NamedTuple):
    """One moment on both clocks, in seconds."""

    mono: Mono
    utc: Utc

    def later(self, seconds: float) -> "Now":
        """The moment `seconds` after this one, if nobody sets a clock in between."""
        return Now(self.mono + seconds, self.utc + seconds)


def one_moment(read_mono: Callable[[], float], read_utc: Callable[[], float]) -> Now:
    """Read both clocks (s) at one moment.

    If the process paused between the two readings, that would look like a step of a clock, so they are read again.
    """
    for _ in range(MAX_READINGS):
        before, utc, mono = read_mono(), read_utc(), read_mono()
        if mono - before < SAME_MOMENT_S:
            break
    return Now(mono, utc)


class Anchor(NamedTuple):
    """One moment on both clocks, and the boot of the computer to which the monotonic time belongs."""

    mono: float
    utc: float
    boot: str

    def shift(self, now: Now, boot: str, ahead_s: Optional[float] = None) -> float:
        """Return by how many seconds to move the times that were saved at this anchor, now and in this `boot`.

        Within one boot, the monotonic clock is right. On a computer that heard the other one, its own monotonic clock
        is, which is `ahead_s`. Otherwise UTC is used; if it was set back in between, the elapsed time counts as zero.
        """
        if boot == self.boot:
            return 0.0
        if ahead_s is not None:
            return min(ahead_s, now.mono - self.mono)
        passed = max(0.0, now.utc - self.utc)
        return now.mono - passed - self.mono
