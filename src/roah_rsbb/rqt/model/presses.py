"""Protection of keyboard shortcuts: a key must be pressed twice, and for the same thing."""

from typing import Hashable, Optional

# The second press must come within this time,
WITHIN_S = 2.0
# and not so soon that a bouncing key did it.
NOT_BEFORE_S = 0.1


class DoublePress:
    """Tells a deliberate second press from a mistake. Shared by all panels of a process."""

    def __init__(self) -> None:
        self._armed: Optional[Hashable] = None
        self._at = 0.0

    def press(self, now_mono: float, what: Hashable) -> bool:
        """A key for `what` (command and zone) was pressed; True: it is the second press, do it."""
        since = now_mono - self._at
        if self._armed == what and since < NOT_BEFORE_S:
            return False
        if self._armed == what and since <= WITHIN_S:
            self._armed = None
            return True
        self._armed, self._at = what, now_mono
        return False

    def armed(self, now_mono: float) -> Optional[Hashable]:
        """What the next press would do, or None."""
        return self._armed if now_mono - self._at <= WITHIN_S else None
