"""Moments on two clocks.

Durations use the monotonic clock. Everything that is logged or sent is UTC (docs/architecture.md, "Two clocks").
The core never reads a clock: every method that needs the time takes a `Now`, which drivers make with `one_moment`.
"""

from typing import Callable, NamedTuple

# Two clock readings count as simultaneous within this time; a busy machine may need several attempts.
SAME_MOMENT_S = 0.005
MAX_READINGS = 10


class Now(NamedTuple):
    """One moment on both clocks, in seconds."""

    mono: float
    utc: float

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
