"""The touches on the tablet, and their acknowledgement by the box. No I/O and no clock.

The box acknowledges a touch by repeating its time in the beacon. While the box is silent, touches are refused: a call
must not reach a robot minutes later.
"""

from typing import NamedTuple, Optional, Tuple

# Seconds and nanoseconds since 1970, UTC, as in the message `Time`.
WireTime = Tuple[int, int]
NEVER: WireTime = (0, 0)

# The box sends a beacon each second; after this time without one, it counts as silent.
BOX_SILENT_S = 3.5


class BoxPart(NamedTuple):
    """The tablet's part of the box's beacon."""

    display_map: bool
    call_time: WireTime
    position_time: WireTime


class ShownTablet:
    """The state of one tablet, which all its pages show."""

    def __init__(self) -> None:
        self.call_time = NEVER
        self.position_time = NEVER
        self.x = 0.0  # metres
        self.y = 0.0  # metres
        self._box: Optional[BoxPart] = None
        self._box_heard_mono = float("-inf")

    def call(self, time_ns: int) -> None:
        """The call button was touched; `time_ns`: UTC, nanoseconds since 1970."""
        self.call_time = divmod(time_ns, 1_000_000_000)

    def place(self, time_ns: int, x: float, y: float) -> None:
        """A position on the map was touched, in metres."""
        self.position_time = divmod(time_ns, 1_000_000_000)
        self.x, self.y = x, y

    def on_box(self, now_mono: float, said: BoxPart) -> bool:
        """A beacon of the box arrived; returns whether that changed the state."""
        changed = said != self._box or not self.hears_box(now_mono)
        self._box, self._box_heard_mono = said, now_mono
        return changed

    def hears_box(self, now_mono: float) -> bool:
        """Whether the box's beacons arrive."""
        return now_mono - self._box_heard_mono <= BOX_SILENT_S

    @property
    def display_map(self) -> bool:
        """The requested view: map (True) or call button (False)."""
        return self._box is not None and self._box.display_map

    @property
    def call_is_acknowledged(self) -> bool:
        """Whether the box has acknowledged the latest call."""
        return self._box is not None and self.call_time != NEVER and self._box.call_time == self.call_time

    @property
    def position_is_acknowledged(self) -> bool:
        """Whether the box has acknowledged the latest position."""
        return (self._box is not None and self.position_time != NEVER
                and self._box.position_time == self.position_time)
