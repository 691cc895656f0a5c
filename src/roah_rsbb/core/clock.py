"""Time in the core: two clocks, and detection of steps of the UTC clock.

Durations use the monotonic clock. Everything that is shown, logged or sent is UTC (docs/architecture.md, "Two clocks").
The core never reads a clock: every method that needs the time takes a `Now`, which drivers make with `one_moment`.
"""

from typing import Callable, NamedTuple, Optional

# If the offset between the clocks changes by this much between two calls, somebody has set UTC: NTP slews by at most
# 0.5 ms a second.
STEP_S = 0.05
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


class ClockWatch:
    """Detects steps of the box's own UTC clock by comparing it with the monotonic one."""

    def __init__(self) -> None:
        self._offset: Optional[float] = None

    def look(self, now: Now) -> float:
        """Return by how many seconds UTC was stepped since the last call; 0.0: it was not."""
        offset = now.utc - now.mono
        step = 0.0 if self._offset is None else offset - self._offset
        self._offset = offset
        return step if abs(step) > STEP_S else 0.0
