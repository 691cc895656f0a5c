"""Tests a module's rules without ROS, robot or clock: the test plays core, referee and robot.

    rehearsal = Rehearsal(STB, {"goals": ["A"], "goal_timeout": 15.0})
    rehearsal.answer()                       # the referee did the first manual operation
    rehearsal.result("found it", seconds=4)  # the robot finished the first goal
    assert rehearsal.score["A", "time"] == 4.0
"""

import json
import os
from types import SimpleNamespace
from typing import Any, Dict, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose3
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import load_rules
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.model.fields import answered
from roah_rsbb.model.modules import OutcomeKind, Request, RequestKind, RequestOutcome, RunForModule, Step

UTC0 = 1_800_000_000.0


class Poses(GroundTruth):
    """Ground truth that the test sets: a pose for each subject, or None if it is not available."""

    def __init__(self, **subjects: Optional[Pose3]) -> None:
        self.subjects: Dict[str, Optional[Pose3]] = dict(subjects)

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        pose = self.subjects.get(frame)
        if pose is None:
            raise NoPose(f"The pose of {frame} is not available")
        return pose


class Rehearsal:
    """One attempt of a module from its start."""

    def __init__(
        self, kind: Type[Module], parameters: Optional[Dict[str, Any]] = None, truth: Optional[GroundTruth] = None,
        **run: Any,
    ) -> None:
        """`run`: fields of `RunForModule` that the rules use."""
        self._kind = kind
        self._parameters = dict(parameters or {})
        self.truth = truth or Poses()
        self.utc = UTC0
        fields = {"zone": "zone", "team": "Team", "round": 1, "number": 1, "running": True, **run}
        self.run = RunForModule("rehearsal", 1, benchmark=kind.CODE, **fields)
        self.runner = self._runner()
        self._publish()

    # -- looking ------------------------------------------------------------------------------------

    @property
    def asked(self) -> Optional[Request]:
        """The request that the module waits for; None if it is finished."""
        return None if not self.run.steps or self.run.steps[-1].outcome is not None else self.run.steps[-1].request

    @property
    def finished(self) -> bool:
        """Whether the rules have finished."""
        return self.runner.progress().finished

    @property
    def failed(self) -> str:
        """Why the module failed; empty if it did not."""
        return self.runner.progress().failed

    @property
    def score(self) -> Any:
        """The module's score."""
        return self.module.score

    @property
    def module(self) -> Module:
        """The module itself."""
        return self.runner.module

    # -- referee and robot --------------------------------------------------------------------------

    def answer(self, answer: Any = "", **values: Any) -> None:
        """The referee fills in the form: its first field, or fields by their names; "" is the usual answer if there are
        choices. Raises `BadValue`."""
        fields = self._expect(RequestKind.REFEREE).fields
        name = fields[0].name if fields else "answer"
        given = values if answer == "" else {name: answer, **values}
        self._done(RequestOutcome(OutcomeKind.DONE, values=json.dumps(answered(fields, given))))

    def switches(self, *changed: int, damaged: int = 0) -> None:
        """The referee enters switches."""
        self._expect(RequestKind.SWITCHES)
        self._done(RequestOutcome(OutcomeKind.DONE, changed=changed, damaged=damaged))

    def executes(self, seconds: float, step: float = 0.1) -> None:
        """The robot executes the goal for some seconds; the runner ticks every `step` seconds."""
        self._expect(RequestKind.GOAL)
        if not self.run.told_utc:
            self.run = self.run._replace(told_utc=self.utc)
            self._publish()
        steps = max(1, round(seconds / step))
        for _ in range(steps):
            self.runner.tick(self.utc)
            self.utc += seconds / steps
        self.run = self.run._replace(kept=self.runner.progress().kept)

    def result(self, result: str = "", seconds: float = 0.0) -> None:
        """The robot finishes the goal after executing it for `seconds` in total."""
        self._expect(RequestKind.GOAL)
        self._done(RequestOutcome(OutcomeKind.DONE, result=result, executing_s=seconds))

    def time_out(self, seconds: float = 0.0) -> None:
        """The goal times out after the robot executed it for `seconds`."""
        self._expect(RequestKind.GOAL)
        self._done(RequestOutcome(OutcomeKind.TIMED_OUT, executing_s=seconds))

    def end(self, reason: str = "stopped", elapsed_s: float = 0.0) -> None:
        """The run ends: stopped, timeout, no_messages_saved."""
        self.run = self.run._replace(running=False, end_reason=reason, elapsed_s=elapsed_s, told_utc=0.0)
        self._publish()

    def restart(self, **parameters: Any) -> None:
        """The module's process crashes and restarts, with these parameters changed."""
        self._parameters.update(parameters)
        self.runner = self._runner()
        self._publish()

    # -- playing the core ---------------------------------------------------------------------------

    def _runner(self) -> ModuleRunner:
        return ModuleRunner(self._kind, lambda: SimpleNamespace(**self._parameters), self.truth)

    def _expect(self, kind: RequestKind) -> Request:
        asked = self.asked
        if asked is None or asked.kind is not kind:
            raise AssertionError(f"the module waits for {asked}, not for {kind.name}; {self.failed}")
        return asked

    def _done(self, outcome: RequestOutcome) -> None:
        last = self.run.steps[-1]._replace(outcome=outcome._replace(ended_utc=self.utc))
        self.run = self.run._replace(steps=(*self.run.steps[:-1], last), told_utc=0.0)
        self._publish()

    def _publish(self) -> None:
        """Give the module the state of the run, take its requests, and answer notes immediately."""
        self.runner.on_run(self.run)
        progress = self.runner.progress()
        while self.run.running and progress.request is not None and progress.request.number > len(self.run.steps):
            steps = (*self.run.steps, Step(progress.request))
            if progress.request.kind is RequestKind.NOTE:
                steps = (*steps[:-1], Step(progress.request, RequestOutcome(OutcomeKind.DONE, ended_utc=self.utc)))
            self.run = self.run._replace(steps=steps, kept=progress.kept)
            self.runner.on_run(self.run)
            progress = self.runner.progress()


def rehearse(rules: str, truth: Optional[GroundTruth] = None, **run: Any) -> Rehearsal:
    """Rehearse a competition's own rules with the parameters in the YAML file beside them; raises ConfigErrors."""
    kind = load_rules(rules)
    parameters = read_parameters(os.path.splitext(rules)[0] + ".yaml", kind.CODE, kind.PARAMETERS)
    return Rehearsal(kind, vars(parameters), truth, **run)
