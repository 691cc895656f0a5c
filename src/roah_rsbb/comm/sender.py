"""When to send a state (docs/protocol.md, "Timing"). No I/O and no clock.

A changed state is sent immediately, then ten times at 50 ms intervals, because a datagram may be lost, and after that
once a second. Replies to received messages are additional, and do not change this schedule.
"""

from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, PERIOD_S


class StateSender:
    """The times at which one state is due. Nothing is due before the first `changed` or `reply`."""

    __slots__ = ("_burst_left", "_next_mono", "_reply_mono")

    def __init__(self) -> None:
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
        self._burst_left = max(0, self._burst_left - 1)
        self._next_mono += interval
        if self._next_mono <= now_mono:
            self._next_mono = now_mono + interval
