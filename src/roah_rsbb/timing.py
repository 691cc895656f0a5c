"""When both ends of a private channel send (wire protocol, Timing); every room may import this.

A changed state leaves at once, then ten times at 50 ms intervals, because any single datagram may be lost; after
that once a second.
"""

BURST_COUNT = 10
BURST_INTERVAL_S = 0.05
PERIOD_S = 1.0


def sent_after_change(seconds: float) -> int:
    """How many times a changed state was sent by so many seconds after the change; 0 before it."""
    if seconds < 0:
        return 0
    burst_s = BURST_COUNT * BURST_INTERVAL_S
    if seconds < burst_s:
        return 1 + int(seconds / BURST_INTERVAL_S)
    return 1 + BURST_COUNT + int((seconds - burst_s) / PERIOD_S)
