"""The robot's state machine as tables (docs/protocol.md, "Robot's next state"), and the state with its goal and result.

The box leads. It repeats its state (`BoxState`) until the robot's state shows that the robot received it, so most
entries mean "keep". The course of one goal is

    STOP --PREPARE--> PREPARING ==> WAITING_GOAL --GOAL_TX--> EXECUTING ==> RESULT_TX --STOP--> STOP

where ``==>`` are the robot's own two events. In benchmarks without explicit goals, the box sends WAITING_RESULT instead
of GOAL_TX. If another goal follows, it sends PREPARE instead of the last STOP. A STOP at any other time comes from the
referee or a timeout: the robot halts.

An impossible state of the box (a goal for a robot that did not prepare) is an error. The robot goes to STOP, and the
box starts again with PREPARE.
"""

import enum
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState, WireTime
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import BadGoal, Goal, Result, check_result, read_goal
from roah_rsbb.rulebook.registry import PROFILES, profile_of


class IllegalEvent(Exception):
    """The request is not possible now. Nothing was changed; the text says why."""


class Act(enum.Enum):
    """What the robot must do in a transition."""

    KEEP = "continue"
    PREPARE = "prepare for a goal"
    EXECUTE = "read and execute the goal"
    EXECUTE_NO_GOAL = "execute without an explicit goal"
    HALT = "stop immediately"
    END = "the benchmark is over"
    ERROR = "stop: the box sent an impossible state"


class Transition(NamedTuple):
    """An entry of the table: the robot's next state and action."""

    state: RobotState
    act: Act


class RobotEvent(enum.Enum):
    """The events that the robot itself causes."""

    PREPARATION_COMPLETE = "preparation complete"
    GOAL_COMPLETE = "goal complete"


_KEEP, _PREPARE, _EXECUTE, _NO_GOAL, _HALT, _END, _ERROR = Act
_R = RobotState

# (received benchmark state, robot's present state) -> transition.
BOX_TABLE: Dict[Tuple[BoxState, RobotState], Transition] = {
    (BoxState.STOP, _R.STOP): Transition(_R.STOP, _KEEP),
    (BoxState.STOP, _R.PREPARING): Transition(_R.STOP, _HALT),
    (BoxState.STOP, _R.WAITING_GOAL): Transition(_R.STOP, _HALT),
    (BoxState.STOP, _R.EXECUTING): Transition(_R.STOP, _HALT),
    (BoxState.STOP, _R.RESULT_TX): Transition(_R.STOP, _END),

    (BoxState.PREPARE, _R.STOP): Transition(_R.PREPARING, _PREPARE),
    (BoxState.PREPARE, _R.PREPARING): Transition(_R.PREPARING, _KEEP),
    (BoxState.PREPARE, _R.WAITING_GOAL): Transition(_R.WAITING_GOAL, _KEEP),
    # The box may not have received EXECUTING yet. See also `box_transition`.
    (BoxState.PREPARE, _R.EXECUTING): Transition(_R.EXECUTING, _KEEP),
    (BoxState.PREPARE, _R.RESULT_TX): Transition(_R.PREPARING, _PREPARE),

    (BoxState.GOAL_TX, _R.STOP): Transition(_R.STOP, _ERROR),
    (BoxState.GOAL_TX, _R.PREPARING): Transition(_R.STOP, _ERROR),
    (BoxState.GOAL_TX, _R.WAITING_GOAL): Transition(_R.EXECUTING, _EXECUTE),
    (BoxState.GOAL_TX, _R.EXECUTING): Transition(_R.EXECUTING, _KEEP),
    (BoxState.GOAL_TX, _R.RESULT_TX): Transition(_R.RESULT_TX, _KEEP),

    (BoxState.WAITING_RESULT, _R.STOP): Transition(_R.STOP, _ERROR),
    (BoxState.WAITING_RESULT, _R.PREPARING): Transition(_R.STOP, _ERROR),
    (BoxState.WAITING_RESULT, _R.WAITING_GOAL): Transition(_R.EXECUTING, _NO_GOAL),
    (BoxState.WAITING_RESULT, _R.EXECUTING): Transition(_R.EXECUTING, _KEEP),
    (BoxState.WAITING_RESULT, _R.RESULT_TX): Transition(_R.RESULT_TX, _KEEP),
}

# (robot's event, robot's present state) -> next state.
EVENT_TABLE: Dict[Tuple[RobotEvent, RobotState], RobotState] = {
    (RobotEvent.PREPARATION_COMPLETE, _R.PREPARING): _R.WAITING_GOAL,
    (RobotEvent.GOAL_COMPLETE, _R.EXECUTING): _R.RESULT_TX,
}


def box_transition(benchmark: str, received: BoxState, state: RobotState) -> Transition:
    """The transition of a robot in `state` that receives `received` in benchmark `benchmark`.

    In some benchmarks PREPARE while EXECUTING means that the goal timed out and the next one follows, as existing
    robots do (docs/protocol.md, "Robot's next state").
    """
    ends_goal = profile_of(benchmark).prepare_ends_goal
    if (received, state) == (BoxState.PREPARE, RobotState.EXECUTING) and ends_goal:
        return Transition(RobotState.PREPARING, Act.PREPARE)
    return BOX_TABLE[received, state]


def event_transition(event: RobotEvent, state: RobotState) -> RobotState:
    """The state after an event of the robot; `IllegalEvent` if `event` is impossible in `state`."""
    following = EVENT_TABLE.get((event, state))
    if following is None:
        when = next(before for known, before in EVENT_TABLE if known is event)
        raise IllegalEvent(
            f"{event.value}: only possible in {when.name}, but the robot is in {state.name}"
        )
    return following


def unexpected_state_text(received: BoxState, state: RobotState) -> str:
    """The report of an `Act.ERROR` transition."""
    return (
        f"the box sent {received.name} while this robot is in {state.name} without a goal: stopped. "
        "This is normal after a restart of this program during a run: the box starts again with PREPARE"
    )


# -- the state of a robot ---------------------------------------------------------------------------

_MAX_UINT32 = 2**32 - 1


class RobotProgress:
    """The robot's state with benchmark, goal and result. Methods return the effects for the robot's software."""

    def __init__(self) -> None:
        self.state = RobotState.STOP
        self.benchmark: Optional[str] = None  # code; None without a run
        self.goal: Optional[Goal] = None  # the present goal, if the box sent one
        self.result: Result = None  # of the latest completed goal
        self._messages_saved = 0
        self._reported: Optional[Tuple[BoxState, str]] = None  # reported problem, until it is over

    @property
    def messages_saved(self) -> int:
        """The amount of recorded offline data (count or bytes). The box ends a run if this stays 0."""
        return self._messages_saved

    @messages_saved.setter
    def messages_saved(self, count: int) -> None:
        if not 0 <= count <= _MAX_UINT32:
            raise ValueError(f"messages_saved must be a number from 0 to {_MAX_UINT32}, not {count!r}")
        self._messages_saved = int(count)

    def hear(self, message: pb.BenchmarkState, goal_needed: bool = True) -> List[fx.Effect]:
        """Take a state of the box. Without `goal_needed`, an unreadable goal is ignored."""
        received = BoxState(message.benchmark_state)
        effects: List[fx.Effect] = []
        if message.benchmark_type != self.benchmark:
            if self.benchmark is not None:
                effects += self._enter(Transition(RobotState.STOP, Act.HALT), "the benchmark changed")
            self.benchmark = message.benchmark_type
            effects.append(fx.BenchmarkIs(self.benchmark))
        step = box_transition(message.benchmark_type, received, self.state)
        goal = None
        if step.act is Act.EXECUTE:
            try:
                goal = read_goal(message)
            except BadGoal as bad:
                if goal_needed:
                    # Stay in this state: the box repeats the goal. Executing nothing would lose the goal.
                    return effects + self._report(fx.Problem.BAD_GOAL, received, str(bad))
        if step.act is Act.ERROR:
            text = unexpected_state_text(received, self.state)
            effects += self._enter(step, text)
            return effects + self._report(fx.Problem.UNEXPECTED_STATE, received, text)
        self._reported = None
        return effects + self._enter(step, f"the box sent {received.name}", goal)

    def leave(self, why: str) -> List[fx.Effect]:
        """The run is over."""
        effects = self._enter(Transition(RobotState.STOP, Act.HALT), why)
        if self.benchmark is not None:
            self.benchmark = None
            effects.append(fx.BenchmarkIs(None))
        self._reported = None
        return effects

    def end_prepare(self) -> List[fx.Effect]:
        """The robot has prepared; IllegalEvent if that was not requested."""
        return self._enter(Transition(event_transition(RobotEvent.PREPARATION_COMPLETE, self.state), Act.KEEP), "")

    def end_execute(self, result: Result) -> List[fx.Effect]:
        """The goal is complete; IllegalEvent without a goal, ValueError for an unsuitable `result`."""
        following = event_transition(RobotEvent.GOAL_COMPLETE, self.state)
        check_result(self.benchmark or "", result)
        self.result = result
        return self._enter(Transition(following, Act.KEEP), "")

    def _enter(self, step: Transition, why: str, goal: Optional[Goal] = None) -> List[fx.Effect]:
        before, self.state = self.state, step.state
        effects: List[fx.Effect] = []
        if step.state is not before:
            effects.append(fx.StateIs(step.state))
            if step.state is not RobotState.EXECUTING:
                self.goal = None
            if step.act in (Act.HALT, Act.END, Act.ERROR):
                effects.append(fx.Stop(why))
        if step.act is Act.PREPARE:
            effects.append(fx.Prepare(self.benchmark or ""))
        elif step.act in (Act.EXECUTE, Act.EXECUTE_NO_GOAL):
            self.goal = goal
            effects.append(fx.Execute(self.benchmark or "", goal))
        return effects

    def _report(self, problem: fx.Problem, received: BoxState, text: str) -> List[fx.Effect]:
        """Report a problem once, although the box repeats its state."""
        if self._reported == (received, problem.name):
            return []
        self._reported = (received, problem.name)
        return [fx.ProblemIs(problem, text)]


# -- the messages that simulate the box in tests of a robot (`Session.override`) ----------------------

def override_message(
    number: int, state: int, acknowledgement: WireTime, initial_state: Iterable[bool], switches: Iterable[int]
) -> Optional[pb.BenchmarkState]:
    """Return the message that replaces the box's, for a benchmark's number; None (number 0) ends the override.

    Raises IllegalEvent, which names the known numbers.
    """
    if number == 0:
        return None
    codes = {profile.number: code for code, profile in PROFILES.items()}
    code = codes.get(number)
    if code is None:
        known = ", ".join(f"{number} {code}" for number, code in sorted(codes.items()))
        raise IllegalEvent(f"unknown benchmark number {number}: choose from {known}")
    message = _state_message(code, state, acknowledgement)
    message.initial_state.extend(initial_state)
    message.switches.extend(switches)
    return message


def override_goal_message(
    code: str, state: int, acknowledgement: WireTime, goal: str
) -> Optional[pb.BenchmarkState]:
    """Return the message that replaces the box's, with a goal (empty: none); None (empty code) ends the override.

    Raises IllegalEvent for an unknown state or an unreadable goal.
    """
    if not code:
        return None
    message = _state_message(code, state, acknowledgement)
    if goal:
        message.generic_goal = goal
        try:
            read_goal(message)
        except BadGoal as bad:
            raise IllegalEvent(str(bad)) from None
    return message


def _state_message(code: str, state: int, acknowledgement: WireTime) -> pb.BenchmarkState:
    if state not in pb.BenchmarkState.State.values():
        known = ", ".join(f"{number} {name}" for name, number in pb.BenchmarkState.State.items())
        raise IllegalEvent(f"unknown benchmark state {state}: choose from {known}")
    message = pb.BenchmarkState(benchmark_type=code, benchmark_state=state)
    message.acknowledgement.sec, message.acknowledgement.nsec = acknowledgement
    return message
