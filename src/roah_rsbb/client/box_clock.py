"""Estimates the box's clock from its messages."""

from typing import Optional

# How much slower than ours the box's clock may run: 200 ppm is a bad quartz.
DRIFT = 2e-4


class BoxClock:
    """Estimate of the box's clock from its messages.

    A message carries the clock at the moment when it was sent. The message with the least delay gives the best
    estimate. The estimate is never behind by more than that delay, however late other messages arrive.
    """

    def __init__(self) -> None:
        self._offset: Optional[float] = None  # box's clock minus our monotonic clock
        self._last_clock = 0.0
        self._last_mono = 0.0

    def sample(self, mono: float, clock: float) -> None:
        """A message sent at `clock` (box, UTC seconds) arrived at `mono` (monotonic seconds)."""
        offset = clock - mono
        if self._offset is None or clock < self._last_clock:
            self._offset = offset
        else:
            self._offset = max(offset, self._offset - DRIFT * (mono - self._last_mono))
        self._last_clock, self._last_mono = clock, mono

    def now(self, mono: float) -> float:
        """Return the box's clock at `mono` in UTC seconds; 0.0 before the first sample."""
        return 0.0 if self._offset is None else mono + self._offset
