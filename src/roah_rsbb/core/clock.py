"""Time as the core gets it: two clocks, and a watch on the steps of one of them.

Durations use the monotonic clock; what is shown, logged or sent is UTC (docs/architecture.md, "Two clocks"). The
core never asks a clock: every method that needs the time takes a `Now`.
"""

from typing import NamedTuple, Optional

# The offset between both clocks moves by this much in one look only if UTC was set by somebody:
# NTP slews by at most 0.5 ms a second.
STEP_S = 0.05


class Now(NamedTuple):
    """One moment on both clocks, in seconds."""

    mono: float
    utc: float

    def later(self, seconds: float) -> "Now":
        """The moment `seconds` after this one, if nobody sets a clock in between."""
        return Now(self.mono + seconds, self.utc + seconds)


class ClockWatch:
    """Notices when the box's own UTC clock is stepped, by comparing it with the monotonic one."""

    def __init__(self) -> None:
        self._offset: Optional[float] = None

    def look(self, now: Now) -> float:
        """Return by how many seconds UTC was stepped since the last look (0.0: it was not)."""
        offset = now.utc - now.mono
        step = 0.0 if self._offset is None else offset - self._offset
        self._offset = offset
        return step if abs(step) > STEP_S else 0.0
