"""The states and the timing that both ends of a private channel share.

The core, which knows no protobuf, and the robot's side, which knows no core, both use these words. The numbers of the
states are those of ``BenchmarkState`` and ``RobotState`` on the wire. This module imports nothing of the project.
"""

import enum

# A changed state leaves at once, then ten times at 50 ms intervals, because any datagram may be lost; after that once
# a second.
BURST_COUNT = 10
BURST_INTERVAL_S = 0.05
PERIOD_S = 1.0


class BoxState(enum.IntEnum):
    """What the box asks of the robot (``BenchmarkState.benchmark_state``)."""

    STOP = 0
    PREPARE = 1
    GOAL_TX = 2
    WAITING_RESULT = 3


class RobotState(enum.IntEnum):
    """What the robot reports that it is doing (``RobotState.robot_state``)."""

    STOP = 0
    PREPARING = 1
    WAITING_GOAL = 2
    EXECUTING = 3
    RESULT_TX = 4


def sent_after_change(seconds: float) -> int:
    """How many times a changed state was sent `seconds` after the change; 0 before the change."""
    if seconds < 0:
        return 0
    burst_s = BURST_COUNT * BURST_INTERVAL_S
    if seconds < burst_s:
        return 1 + int(seconds / BURST_INTERVAL_S)
    return 1 + BURST_COUNT + int((seconds - burst_s) / PERIOD_S)
