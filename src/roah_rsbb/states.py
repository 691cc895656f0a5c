"""The words that both ends of a private channel share: states of the box and of the robot.

The numbers are those on the wire (wire protocol, messages ``BenchmarkState`` and ``RobotState``).
This module imports nothing, so that the core, which knows no protobuf, and the robot's side, which
knows no core, both speak with the same words.
"""

import enum


class BoxState(enum.IntEnum):
    """What the box asks of the robot (``BenchmarkState.benchmark_state``)."""

    STOP = 0
    PREPARE = 1
    GOAL_TX = 2
    WAITING_RESULT = 3


class RobotState(enum.IntEnum):
    """What the robot says it is doing (``RobotState.robot_state``)."""

    STOP = 0
    PREPARING = 1
    WAITING_GOAL = 2
    EXECUTING = 3
    RESULT_TX = 4
