"""Where a run is, and why it ended."""

import enum


class Phase(enum.Enum):
    """Where a run is, in the referee's eyes."""

    CONNECTED = "connected"
    RUNNING = "running"
    ENDED = "ended"


class EndReason(enum.Enum):
    """Why a run ended; the text is what the referee reads."""

    STOPPED = "Benchmark stopped by the referee"
    COMPLETED = "Benchmark completed by the robot"
    TIMEOUT = "Stopped due to timeout"
    GOALS_TIMED_OUT = "Benchmark over: every goal timed out"
    NO_MESSAGES_SAVED = "Stopped: the robot saves no offline data (messages saved stays 0)"
    MODULE_FAILED = "Stopped: the benchmarking module cannot go on"


# The benchmark ran to its end, so the zone moves on to its next event.
RAN_TO_THE_END = (EndReason.COMPLETED, EndReason.GOALS_TIMED_OUT)
