"""Where the robot is in its benchmark: state, goal and result, moved by the box and by its owner."""

from typing import List, Optional, Tuple

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import BadGoal, Goal, Result, check_result, read_goal
from roah_rsbb.robot.machine import Act, Own, Step, box_step, error_text, own_step

_MAX_UINT32 = 2**32 - 1


class Progress:
    """The robot's state with all that belongs to it. Its methods return what follows for the owner."""

    def __init__(self) -> None:
        self.state = RobotState.STOP
        self.benchmark: Optional[str] = None  # code; None while there is no run
        self.goal: Optional[Goal] = None  # what is executed, where the box gave a goal
        self.result: Result = None  # of the goal that was completed last
        self._messages_saved = 0
        self._reported: Optional[Tuple[BoxState, str]] = None  # trouble that was told, until it passes

    @property
    def messages_saved(self) -> int:
        """How much offline data is recorded (a count or bytes): the box stops a run where it stays 0."""
        return self._messages_saved

    @messages_saved.setter
    def messages_saved(self, count: int) -> None:
        if not 0 <= count <= _MAX_UINT32:
            raise ValueError(f"messages_saved is a number from 0 to {_MAX_UINT32}, not {count!r}")
        self._messages_saved = int(count)

    def hear(self, message: pb.BenchmarkState, goal_needed: bool = True) -> List[fx.Effect]:
        """Take the box's word. Without `goal_needed` a goal that cannot be read does not matter."""
        received = BoxState(message.benchmark_state)
        effects: List[fx.Effect] = []
        if message.benchmark_type != self.benchmark:
            if self.benchmark is not None:
                effects += self._enter(Step(RobotState.STOP, Act.HALT), "the benchmark changed")
            self.benchmark = message.benchmark_type
            effects.append(fx.BenchmarkIs(self.benchmark))
        step = box_step(message.benchmark_type, received, self.state)
        goal = None
        if step.act is Act.EXECUTE:
            try:
                goal = read_goal(message)
            except BadGoal as bad:
                if goal_needed:
                    # Stay, and let the box repeat: to execute nothing would cost the goal at once.
                    return effects + self._report(fx.Trouble.BAD_GOAL, received, str(bad))
        if step.act is Act.ERROR:
            text = error_text(received, self.state)
            effects += self._enter(step, text)
            return effects + self._report(fx.Trouble.UNEXPECTED_STATE, received, text)
        self._reported = None
        return effects + self._enter(step, f"the box sent {received.name}", goal)

    def leave(self, why: str) -> List[fx.Effect]:
        """There is no run any more."""
        effects = self._enter(Step(RobotState.STOP, Act.HALT), why)
        if self.benchmark is not None:
            self.benchmark = None
            effects.append(fx.BenchmarkIs(None))
        self._reported = None
        return effects

    def end_prepare(self) -> List[fx.Effect]:
        """The robot's owner has prepared; IllegalEvent when that was not asked for."""
        return self._enter(Step(own_step(Own.PREPARATION_COMPLETE, self.state), Act.KEEP), "")

    def end_execute(self, result: Result) -> List[fx.Effect]:
        """The goal is complete; IllegalEvent when there is none, ValueError when `result` does not fit."""
        following = own_step(Own.GOAL_COMPLETE, self.state)
        check_result(self.benchmark or "", result)
        self.result = result
        return self._enter(Step(following, Act.KEEP), "")

    def _enter(self, step: Step, why: str, goal: Optional[Goal] = None) -> List[fx.Effect]:
        before, self.state = self.state, step.state
        effects: List[fx.Effect] = []
        if step.state is not before:
            effects.append(fx.StateIs(step.state))
            if step.state is not RobotState.EXECUTING:
                self.goal = None
            if step.act in (Act.HALT, Act.END, Act.ERROR):
                effects.append(fx.Stop(halt=step.act is not Act.END, why=why))
        if step.act is Act.PREPARE:
            effects.append(fx.Prepare(self.benchmark or ""))
        elif step.act in (Act.EXECUTE, Act.EXECUTE_NO_GOAL):
            self.goal = goal
            effects.append(fx.Execute(self.benchmark or "", goal))
        return effects

    def _report(self, trouble: fx.Trouble, received: BoxState, text: str) -> List[fx.Effect]:
        """Report trouble once: the box repeats its state many times, also the one that is wrong."""
        if self._reported == (received, trouble.name):
            return []
        self._reported = (received, trouble.name)
        return [fx.Report(trouble, text)]
