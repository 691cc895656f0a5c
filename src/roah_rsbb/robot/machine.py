"""The robot's state machine, as tables (docs/protocol.md, "Robot's next state").

The box leads. It repeats what it wants (`BoxState`) until the robot's own state shows that it was
heard, so most entries say "keep": the robot hears the same word many times. One goal goes

    STOP --PREPARE--> PREPARING ==> WAITING_GOAL --GOAL_TX--> EXECUTING ==> RESULT_TX --STOP--> STOP

where ``==>`` are the robot's own two events. Where a benchmark has no explicit goal the box says
WAITING_RESULT instead of GOAL_TX; where another goal follows it says PREPARE instead of the last
STOP. A STOP at any other moment is the referee's, or the clock's: the robot halts.

What cannot follow (a goal for a robot that did not prepare) is an error: the robot goes to STOP,
where the box finds it and starts again with PREPARE.
"""

import enum
from typing import Dict, NamedTuple, Tuple

from roah_rsbb.protocol import BoxState, RobotState


class IllegalEvent(Exception):
    """The robot's owner asked for what makes no sense now. Nothing was changed; str() says why."""


class Act(enum.Enum):
    """What a step asks of the robot, beside the new state."""

    KEEP = "go on"
    PREPARE = "prepare for a goal"
    EXECUTE = "read the goal and execute it"
    EXECUTE_NO_GOAL = "execute: there is no explicit goal"
    HALT = "stop at once"
    END = "the benchmark is over"
    ERROR = "stop: the box asked for what cannot follow"


class Step(NamedTuple):
    """An entry of the table: the robot's next state, and what to do."""

    state: RobotState
    act: Act


class Own(enum.Enum):
    """What the robot itself brings about."""

    PREPARATION_COMPLETE = "preparation complete"
    GOAL_COMPLETE = "goal complete"


_KEEP, _PREPARE, _EXECUTE, _NO_GOAL, _HALT, _END, _ERROR = Act
_R = RobotState

# (benchmark state received, the robot's present state) -> step.
BOX_TABLE: Dict[Tuple[BoxState, RobotState], Step] = {
    (BoxState.STOP, _R.STOP): Step(_R.STOP, _KEEP),
    (BoxState.STOP, _R.PREPARING): Step(_R.STOP, _HALT),
    (BoxState.STOP, _R.WAITING_GOAL): Step(_R.STOP, _HALT),
    (BoxState.STOP, _R.EXECUTING): Step(_R.STOP, _HALT),
    (BoxState.STOP, _R.RESULT_TX): Step(_R.STOP, _END),

    (BoxState.PREPARE, _R.STOP): Step(_R.PREPARING, _PREPARE),
    (BoxState.PREPARE, _R.PREPARING): Step(_R.PREPARING, _KEEP),
    (BoxState.PREPARE, _R.WAITING_GOAL): Step(_R.WAITING_GOAL, _KEEP),
    # The box may not have heard yet that the robot executes. See also PREPARE_ENDS_GOAL.
    (BoxState.PREPARE, _R.EXECUTING): Step(_R.EXECUTING, _KEEP),
    (BoxState.PREPARE, _R.RESULT_TX): Step(_R.PREPARING, _PREPARE),

    (BoxState.GOAL_TX, _R.STOP): Step(_R.STOP, _ERROR),
    (BoxState.GOAL_TX, _R.PREPARING): Step(_R.STOP, _ERROR),
    (BoxState.GOAL_TX, _R.WAITING_GOAL): Step(_R.EXECUTING, _EXECUTE),
    (BoxState.GOAL_TX, _R.EXECUTING): Step(_R.EXECUTING, _KEEP),
    (BoxState.GOAL_TX, _R.RESULT_TX): Step(_R.RESULT_TX, _KEEP),

    (BoxState.WAITING_RESULT, _R.STOP): Step(_R.STOP, _ERROR),
    (BoxState.WAITING_RESULT, _R.PREPARING): Step(_R.STOP, _ERROR),
    (BoxState.WAITING_RESULT, _R.WAITING_GOAL): Step(_R.EXECUTING, _NO_GOAL),
    (BoxState.WAITING_RESULT, _R.EXECUTING): Step(_R.EXECUTING, _KEEP),
    (BoxState.WAITING_RESULT, _R.RESULT_TX): Step(_R.RESULT_TX, _KEEP),
}

# Benchmarks in which PREPARE while EXECUTING means that the goal (a waypoint) timed out and the next
# one follows: what robots in the field do (docs/protocol.md, "Robot's next state").
PREPARE_ENDS_GOAL = frozenset({"HNF"})

# (own event, the robot's present state) -> next state. There is no other own event.
OWN_TABLE: Dict[Tuple[Own, RobotState], RobotState] = {
    (Own.PREPARATION_COMPLETE, _R.PREPARING): _R.WAITING_GOAL,
    (Own.GOAL_COMPLETE, _R.EXECUTING): _R.RESULT_TX,
}


def box_step(benchmark: str, received: BoxState, state: RobotState) -> Step:
    """The step of a robot in `state` that hears `received` from the box in benchmark `benchmark`."""
    if (received, state) == (BoxState.PREPARE, RobotState.EXECUTING) and benchmark in PREPARE_ENDS_GOAL:
        return Step(RobotState.PREPARING, Act.PREPARE)
    return BOX_TABLE[received, state]


def own_step(event: Own, state: RobotState) -> RobotState:
    """The state after an own event; `IllegalEvent` when `event` cannot happen in `state`."""
    following = OWN_TABLE.get((event, state))
    if following is None:
        when = next(before for known, before in OWN_TABLE if known is event)
        raise IllegalEvent(
            f"{event.value}: the robot is in {state.name}, this is only possible in {when.name}"
        )
    return following


def error_text(received: BoxState, state: RobotState) -> str:
    """What to tell the robot's owner about an `Act.ERROR` step."""
    return (
        f"the box sent {received.name} to a robot in {state.name}, which has no goal to wait for: stopped. "
        "Normal after a restart of this program in the middle of a run; the box starts again with PREPARE"
    )
