"""The states, times and names of devices that both ends of a private channel share.

The core does not use protobuf, and the robot's side does not use the core. Both use these names. The numbers of the
states are those of ``BenchmarkState`` and ``RobotState`` on the wire. This module imports nothing of the project.
"""

import enum
from typing import Tuple

# A wire time: whole seconds and nanoseconds since 1970, UTC. Each may be any int64, also a negative one.
WireTime = Tuple[int, int]

# A changed state is sent at once, then ten times at intervals of 50 ms, because any datagram may be lost. After that,
# it is sent once a second.
BURST_COUNT = 10
BURST_INTERVAL_S = 0.05
PERIOD_S = 1.0

# Home devices that a robot sets: the names of their fields after ``devices_`` (``RobotState``). Switches are on or off.
SWITCHES = ("switch_1", "switch_2", "switch_3")
PERCENTAGES = ("dimmer", "blinds")


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


def wire_ns(wire_time: WireTime) -> int:
    """A wire time as nanoseconds, exactly; any int64 pair is allowed."""
    return wire_time[0] * 1_000_000_000 + wire_time[1]


def wire_seconds(wire_time: WireTime) -> float:
    """A wire time as seconds, with a float's precision (a quarter of a microsecond today)."""
    return wire_ns(wire_time) / 1e9
