"""What was touched on the tablet, and what the box said of it. No I/O and no clock in here.

The box acknowledges a touch by repeating its time in the beacon. While the box is silent nothing may be
touched: a call that reached a robot minutes later would be a wrong one.
"""

from typing import NamedTuple, Optional, Tuple

# Seconds and nanoseconds since 1970, UTC, as in the message `Time`.
WireTime = Tuple[int, int]
NEVER: WireTime = (0, 0)

# The box sends a beacon each second; after this long without one it is not there.
BOX_SILENT_S = 3.5


class BoxSaid(NamedTuple):
    """What the tablet reads in the box's beacon."""

    display_map: bool
    call_time: WireTime
    position_time: WireTime


class TabletState:
    """One tablet; all its pages show the same."""

    def __init__(self) -> None:
        self.call_time = NEVER
        self.position_time = NEVER
        self.x = 0.0  # metres
        self.y = 0.0  # metres
        self._box: Optional[BoxSaid] = None
        self._box_heard_mono = float("-inf")

    def call(self, time_ns: int) -> None:
        """Somebody touched the call button; `time_ns`: UTC, nanoseconds since 1970."""
        self.call_time = divmod(time_ns, 1_000_000_000)

    def place(self, time_ns: int, x: float, y: float) -> None:
        """Somebody touched a position on the map, in metres."""
        self.position_time = divmod(time_ns, 1_000_000_000)
        self.x, self.y = x, y

    def on_box(self, now_mono: float, said: BoxSaid) -> bool:
        """The box's beacon arrived; whether that changed what pages show."""
        changed = said != self._box or not self.hears_box(now_mono)
        self._box, self._box_heard_mono = said, now_mono
        return changed

    def hears_box(self, now_mono: float) -> bool:
        """Whether the box is there."""
        return now_mono - self._box_heard_mono <= BOX_SILENT_S

    @property
    def display_map(self) -> bool:
        """The view that is wanted: True: map, False: call button."""
        return self._box is not None and self._box.display_map

    @property
    def call_is_told(self) -> bool:
        """Whether the box has repeated the last call."""
        return self._box is not None and self.call_time != NEVER and self._box.call_time == self.call_time

    @property
    def position_is_told(self) -> bool:
        """Whether the box has repeated the last position."""
        return (self._box is not None and self.position_time != NEVER
                and self._box.position_time == self.position_time)
