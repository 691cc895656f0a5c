"""The box's state machine: how a message of the robot changes the state that the box sends.

Theory of operation. The box sends a request (STOP, PREPARE, GOAL_TX, WAITING_RESULT), and the robot reports what it is
doing. Both repeat themselves until the other has understood. Each incoming message therefore makes a pair (state that
the box sends, state that the robot reports), and `TABLE` has the reaction to each pair. Pass fresh messages only: a
stale one must never change the state (see `roah_rsbb.core.link.timeline`). The table does not contain the referee's
start and stop, nor the timeouts. These set PREPARE and STOP from outside.

docs/protocol.md, "Box's next state" shows the table with rows and columns swapped.
"""

import enum
from typing import Dict, Tuple

from roah_rsbb.protocol import BoxState, RobotState


class Reaction(enum.Enum):
    """What the box does after a message of the robot."""

    KEEP = "keep the state"
    EXECUTE = "send the goal, or without an explicit goal wait for the result"
    AWAIT_RESULT = "the robot has the goal: wait for the result"
    RETRY = "the robot is in an unexpected state: request it to prepare again"
    RETRY_WITH_GOAL = "the robot forgot its goal: prepare again; without an explicit goal, keep"
    GOAL_DONE = "the robot finished: prepare the next goal, or stop after the last"


_BOX, _ROBOT = BoxState, RobotState

TABLE: Dict[Tuple[BoxState, RobotState], Reaction] = {
    (_BOX.STOP, _ROBOT.STOP): Reaction.KEEP,
    (_BOX.STOP, _ROBOT.PREPARING): Reaction.KEEP,
    (_BOX.STOP, _ROBOT.WAITING_GOAL): Reaction.KEEP,
    (_BOX.STOP, _ROBOT.EXECUTING): Reaction.KEEP,
    (_BOX.STOP, _ROBOT.RESULT_TX): Reaction.KEEP,
    # The robot received PREPARE late, or was busy with something else: request it again.
    (_BOX.PREPARE, _ROBOT.STOP): Reaction.KEEP,
    (_BOX.PREPARE, _ROBOT.PREPARING): Reaction.KEEP,
    (_BOX.PREPARE, _ROBOT.WAITING_GOAL): Reaction.EXECUTE,
    (_BOX.PREPARE, _ROBOT.EXECUTING): Reaction.KEEP,
    (_BOX.PREPARE, _ROBOT.RESULT_TX): Reaction.KEEP,
    (_BOX.GOAL_TX, _ROBOT.STOP): Reaction.RETRY,
    (_BOX.GOAL_TX, _ROBOT.PREPARING): Reaction.RETRY,
    (_BOX.GOAL_TX, _ROBOT.WAITING_GOAL): Reaction.KEEP,
    (_BOX.GOAL_TX, _ROBOT.EXECUTING): Reaction.AWAIT_RESULT,
    (_BOX.GOAL_TX, _ROBOT.RESULT_TX): Reaction.GOAL_DONE,
    (_BOX.WAITING_RESULT, _ROBOT.STOP): Reaction.RETRY,
    (_BOX.WAITING_RESULT, _ROBOT.PREPARING): Reaction.RETRY,
    # Without an explicit goal, this is normal until the robot has received WAITING_RESULT.
    (_BOX.WAITING_RESULT, _ROBOT.WAITING_GOAL): Reaction.RETRY_WITH_GOAL,
    (_BOX.WAITING_RESULT, _ROBOT.EXECUTING): Reaction.KEEP,
    (_BOX.WAITING_RESULT, _ROBOT.RESULT_TX): Reaction.GOAL_DONE,
}


def react(box: BoxState, robot: RobotState, explicit_goal: bool) -> Reaction:
    """Return the reaction to a fresh message of the robot. `explicit_goal`: this goal is sent to the robot."""
    found = TABLE[(box, robot)]
    if found is Reaction.RETRY_WITH_GOAL:
        return Reaction.RETRY if explicit_goal else Reaction.KEEP
    return found
