"""The state machines of a run: what the box sends to its robot, and the phases that referees see.

Theory of operation of `REACTIONS`: how a message of the robot changes the state that the box sends. The box sends a
request (STOP, PREPARE, GOAL_TX, WAITING_RESULT), and the robot reports what it is doing. Both repeat themselves until
the other has understood. Each incoming message therefore makes a pair (state that the box sends, state that the robot
reports), and the table has the reaction to each pair. Pass fresh messages only: a stale one must never change the state
(see `roah_rsbb.core.link.freshness`). The table does not contain the referee's start and stop, nor the timeouts. These
set PREPARE and STOP from outside. docs/protocol.md, "Box's next state" shows it with rows and columns swapped.

Theory of operation of `PHASES`: a run begins in phase *connected*, when its channel or its score sheet was opened. The
table has the phase that follows each pair of phase and event. An event without an entry is not possible: `following`
raises, and nothing changes. Why a referee cannot do something now, also besides the phase, is in `core/actions`. A run
that is left while it runs ends first. docs/protocol.md, "Phases of a run", shows the table.
"""

import enum
from typing import Dict, Tuple

from roah_rsbb.model.records import Phase
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

REACTIONS: Dict[Tuple[BoxState, RobotState], Reaction] = {
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
    found = REACTIONS[(box, robot)]
    if found is Reaction.RETRY_WITH_GOAL:
        return Reaction.RETRY if explicit_goal else Reaction.KEEP
    return found


class RunEvent(enum.Enum):
    """What changes the phase of a run."""

    START = "start"  # also again, after an end
    END = "end"  # it has an `EndReason`: the referee, the robots, a time limit, saved data, a module
    GIVE_UP = "no-show or withdrawal"
    LEAVE_OUT = "left out"  # the other robots of the run start without this one


class WrongPhase(RuntimeError):
    """An event is not possible in the phase of the run."""


PHASES: Dict[Tuple[Phase, RunEvent], Phase] = {
    (Phase.CONNECTED, RunEvent.START): Phase.RUNNING,
    (Phase.CONNECTED, RunEvent.GIVE_UP): Phase.ENDED,
    (Phase.CONNECTED, RunEvent.LEAVE_OUT): Phase.CONNECTED,
    (Phase.RUNNING, RunEvent.END): Phase.ENDED,
    (Phase.ENDED, RunEvent.START): Phase.RUNNING,
    # A team can still withdraw after a stop.
    (Phase.ENDED, RunEvent.GIVE_UP): Phase.ENDED,
    (Phase.ENDED, RunEvent.LEAVE_OUT): Phase.CONNECTED,
}


def is_possible(phase: Phase, event: RunEvent) -> bool:
    """Whether an event has an entry in a phase."""
    return (phase, event) in PHASES


def following(phase: Phase, event: RunEvent) -> Phase:
    """Return the phase after an event. Raises `WrongPhase`."""
    if not is_possible(phase, event):
        raise WrongPhase(f"'{event.value}' in phase {phase.value}")
    return PHASES[phase, event]
