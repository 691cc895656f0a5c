"""Detects steps of the box's UTC clock."""

from typing import Optional

from roah_rsbb.model.clock import Now

# If the offset between the clocks changes by this much between two calls, somebody has set UTC: NTP slews by at most
# 0.5 ms a second.
STEP_S = 0.05


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
