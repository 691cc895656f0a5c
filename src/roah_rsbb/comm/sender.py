"""When to send a state (docs/protocol.md, "Timing"). No I/O and no clock.

A changed state is sent immediately, then ten times at 50 ms intervals, because a datagram may be lost, and after that
once a second. Replies to received messages are additional, and do not change this schedule.
"""

import math

from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, PERIOD_S

# Seconds. What is not urgent is done at multiples of it, so that a box with many robots wakes up less often.
GRID_S = 0.1


def on_grid(mono: float) -> float:
    """Return the last time (s, monotonic) up to `mono` at which things are done that are not urgent."""
    return math.floor(mono / GRID_S + 1e-6) * GRID_S  # one that is on the grid stays, rounded or not


class StateSender:
    """The times at which one state is due. Nothing is due before the first `changed` or `reply`."""

    __slots__ = ("_burst_left", "_is_on_grid", "_next_mono", "_reply_mono")

    def __init__(self, is_on_grid: bool = False) -> None:
        """`is_on_grid`: what is sent once a second is sent at multiples of `GRID_S`."""
        self._is_on_grid = is_on_grid
        self._next_mono = float("inf")
        self._reply_mono = float("inf")
        self._burst_left = 0

    def changed(self, now_mono: float) -> None:
        """The state changed: it is due now, and a new burst follows."""
        self._next_mono = now_mono
        self._burst_left = BURST_COUNT

    def reply(self, now_mono: float) -> None:
        """One additional message is due now; the schedule does not change."""
        self._reply_mono = min(self._reply_mono, now_mono)

    @property
    def deadline(self) -> float:
        """When the next message is due (seconds, monotonic clock); infinity if none is due."""
        return min(self._next_mono, self._reply_mono)

    def due(self, now_mono: float) -> bool:
        """Whether to send now. True counts as sent, and moves the deadline.

        After a delay, only one message is due, and the intervals start again.
        """
        if now_mono < self.deadline:
            return False
        self._reply_mono = float("inf")
        if now_mono >= self._next_mono:
            self._advance(now_mono)
        return True

    def _advance(self, now_mono: float) -> None:
        interval = BURST_INTERVAL_S if self._burst_left else PERIOD_S
        next_mono = self._next_mono + interval
        if next_mono <= now_mono:
            next_mono = now_mono + interval
        if self._burst_left:
            self._burst_left -= 1
        elif self._is_on_grid:
            next_mono = on_grid(next_mono)
        self._next_mono = next_mono
