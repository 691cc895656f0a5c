"""Keys that must be pressed twice for the same command."""

from typing import Hashable, Optional

# The second press must come within this time, seconds.
WITHIN_S = 2.0
# A press that follows sooner is a bouncing key, seconds.
NOT_BEFORE_S = 0.1


class DoublePress:
    """Distinguishes a deliberate second press from a mistake. Shared by all panels of a process."""

    def __init__(self) -> None:
        self._armed: Optional[Hashable] = None
        self._at = 0.0

    def press(self, now_mono: float, what: Hashable) -> bool:
        """A key for `what` (command and zone) was pressed. Returns whether it is the second press: then act."""
        since = now_mono - self._at
        if self._armed == what and since < NOT_BEFORE_S:
            return False
        if self._armed == what and since <= WITHIN_S:
            self._armed = None
            return True
        self._armed, self._at = what, now_mono
        return False

    def armed(self, now_mono: float) -> Optional[Hashable]:
        """Return what the next press will do, or None."""
        return self._armed if now_mono - self._at <= WITHIN_S else None
