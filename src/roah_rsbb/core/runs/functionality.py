"""A run of a functionality benchmark: the module sends requests, the core carries them out and answers.

`roah_rsbb.model.modules` has their messages. The core knows goals, manual operations and timeouts, but no rule
of any benchmark.
"""

import json
from dataclasses import dataclass, field
from typing import Any, List, Mapping, Optional, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level
from roah_rsbb.core.modules import (
    GOAL_OVERHEAD,
    Driver,
    GoalState,
    Modules,
    NumberedSwitches,
    RunningGoal,
    SwitchesState,
    goal_json,
    result_text,
    scores_json,
)
from roah_rsbb.core.runs.machine import Reaction, react
from roah_rsbb.core.runs.run import CONTINUED, EXECUTING, FELL_BACK, Assignment, Run, RunContext, RunState
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.modules import (
    OutcomeKind,
    Progress,
    Request,
    RequestKind,
    RequestOutcome,
    RunForModule,
    Step,
)
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import NOBODY, By, EndReason, Occurred, Phase, ScoreValue
from roah_rsbb.protocol import BoxState
from roah_rsbb.rulebook.benchmarks import NO_LIMIT
from roah_rsbb.rulebook.registry import ResultForm
from roah_rsbb.scoring.book import Marked

# No benchmark has more steps. A module with more is out of control.
MAX_STEPS = 2000

BEGINS = say("Started: the benchmarking module begins")
NEW_GOAL = say("Requested the robot to prepare for a new goal")
GOAL_SENT = say("Robot prepared, goal sent")
GOAL_TAKEN = say("Robot received the goal, waiting for its result")
COMPLETED, TIMED_OUT = say("Goal completed by the robot"), say("Goal timed out")
COMPLETE = say("Benchmark complete")
COMPLETE_BUT = say("Benchmark complete: {late} of {number} goals timed out")
FAILED = say("Stopped: the benchmarking module cannot continue: {why}")
MODULE_MISSING, OPERATION = say("the benchmarking module is missing"), say("manual operation")
HELD = say("Benchmarking module not connected: the run is paused until it is back")
ASKED = say("Manual operation: {text}")
LEFT, PAUSED_LEFT = say("Benchmark timeout: {time}"), say("Benchmark timeout: {time} (paused)")


@dataclass
class FunctionalityState:
    """The part of the state that only functionality runs have."""

    attempt: int
    steps: List[Step] = field(default_factory=list)
    scores: Tuple[ScoreValue, ...] = ()
    switches: Optional[SwitchesState] = None
    held: bool = False  # the module is missing, so the run is paused
    kept: str = ""  # JSON that the core keeps for the module
    goal: Optional[GoalState] = None  # of the last step


class FunctionalityRun(Run):
    """One robot, one event, and a benchmarking module that drives it."""

    def __init__(
        self, now: Now, assignment: Assignment, context: RunContext, modules: Modules,
        state: Optional[RunState] = None, of_module: Optional[FunctionalityState] = None,
    ) -> None:
        """`state` and `of_module` belong to a run that continues after a restart of the core."""
        super().__init__(now, assignment, context, state)
        self.of_module = of_module or FunctionalityState(0)
        self.switches = None if self.of_module.switches is None else NumberedSwitches(self.of_module.switches)
        goal = self.of_module.goal
        self._goal = None if goal is None else RunningGoal(self.of_module.steps[-1].request, goal)
        self._modules = modules
        self._max_goal = context.settings.max_datagram - GOAL_OVERHEAD
        self._node = ""  # of the modules that drive this attempt
        self._progress: Optional[Progress] = None

    @property
    def attempt(self) -> int:
        """The number of starts."""
        return self.of_module.attempt

    @property
    def steps(self) -> List[Step]:
        """The module's requests in this attempt, and their outcomes."""
        return self.of_module.steps

    @property
    def scores(self) -> Tuple[ScoreValue, ...]:
        """See `ZoneRun`."""
        return self.of_module.scores

    @property
    def held(self) -> bool:
        """Whether the run is paused because the module is missing."""
        return self.of_module.held

    def open(self, now: Now) -> None:
        """See `Run.open`."""
        super().open(now)
        self._changed()

    def resume(self) -> None:
        """See `Run.resume`. Modules continue by themselves, as after their own restart."""
        super().resume()
        self._changed()

    # -- the referee --------------------------------------------------------------------------------

    def _begin(self, now: Now) -> None:
        """Begin a new attempt. The module begins again, too."""
        self.of_module = FunctionalityState(self.attempt + 1)
        self.switches, self._goal, self._node, self._progress = None, None, "", None
        self._set_state(now, BoxState.STOP, BEGINS)
        self._changed()

    def _score_changed(self, now: Now, marked: Marked) -> None:
        """See `ZoneRun._score_changed`. Modules can read the referee's scores."""
        super()._score_changed(now, marked)
        self._changed()

    @property
    def asked(self) -> Optional[Request]:
        """The manual operation that the referee must do now; None: no operation."""
        request = self._open_request()
        wanted = (RequestKind.REFEREE, RequestKind.SWITCHES)
        return request if request is not None and request.kind in wanted else None

    def complete_operation(self, now: Now, values: Mapping[str, Any]) -> None:
        """The referee has done the manual operation that the module asks for. `values`: of its fields."""
        asked = self.asked
        assert asked is not None, "it was checked before"
        answer = _answer_words(asked, values)
        self._emit(effects.RunLogged(self.port, run_log.MANUAL_OPERATION, f"{asked.text}: done {answer}".rstrip()))
        self.say(now, Level.INFO, f"Manual operation done: {asked.text} {answer}".rstrip())
        text = json.dumps(values, ensure_ascii=False) if values else ""
        self._answer_referee(now, RequestOutcome(OutcomeKind.DONE, values=text, ended_utc=now.utc))

    @property
    def entering(self) -> Optional[NumberedSwitches]:
        """The switches that the referee enters; None: there are none now."""
        return self.switches if self.phase is Phase.RUNNING else None

    def enter_switches(self, now: Now, topic: str, value: int) -> None:
        """The referee saw a switch change, or damaged ones: `topic` of the log says which. Raises `Refused`."""
        switches = self.switches
        assert switches is not None, "it was checked before"
        if topic == run_log.OMF_BUTTON:
            switches.press(value)
        else:
            switches.state.damaged = value
        self._emit(effects.RunLogged(self.port, topic, value))
        text = json.dumps({"changed": switches.changed, "on": switches.on, "damaged": switches.damaged})
        self._emit(effects.RunLogged(self.port, run_log.SWITCHES, text))
        self.say(now, Level.INFO, f"Switches changed: {switches.changed or 'none'}, damaged: {switches.damaged}")

    def complete_switches(self, now: Now) -> None:
        """The referee confirms the entered switches."""
        switches = self.switches
        assert switches is not None, "a module cannot ask for switches before (see `_problem`)"
        text = json.dumps({"switches": switches.changed, "damaged_switches": switches.damaged})
        self._emit(effects.RunLogged(self.port, run_log.OMF_COMPLETE, text))
        self.say(now, Level.INFO, "Switches confirmed by the referee")
        self._answer_referee(now, RequestOutcome(
            OutcomeKind.DONE, ended_utc=now.utc, changed=tuple(switches.changed), damaged=switches.damaged
        ))

    def _answer_referee(self, now: Now, outcome: RequestOutcome) -> None:
        self._answer(outcome)
        self._set_pauses(now)

    def _begin_again(self, now: Now) -> None:
        """See `Run._begin_again`. Without a goal, the robot waits for the module."""
        goal = self._goal
        if goal is None:
            self._set_state(now, BoxState.STOP, CONTINUED)
        else:
            goal.state.told = None  # its time counts from the new request
            self._set_state(now, BoxState.PREPARE, NEW_GOAL)
        self._changed()

    # -- the module ---------------------------------------------------------------------------------

    def on_modules(self, now: Now) -> None:
        """A node of modules was heard or is missing: update this run's driver, and take its progress."""
        driver = self._modules.driver(now, self.event.benchmark.code, self.zone)
        self._note_driver(now, driver)
        if driver is None or not self.attempt:
            return
        progress = self._modules.progress(driver.node).get(self.identity)
        if progress is None or progress.attempt != self.attempt or progress == self._progress:
            return
        self._take(now, progress)

    def _note_driver(self, now: Now, driver: Optional[Driver]) -> None:
        if self.phase is not Phase.RUNNING:
            self.of_module.held = False
            return
        if driver is None:
            if not self.held:
                self.of_module.held = True
                self._set_pauses(now)
                self.say(now, Level.ERROR, "Benchmarking module is missing: the run is paused")
            return
        if self._node not in ("", driver.node):
            self.say(now, Level.WARNING, f"Benchmarking module is back, at step {len(self.steps)}: the run continues")
        elif self.held:
            self.say(now, Level.WARNING, "Benchmarking module is heard again: the run continues")
        self._node = driver.node
        if self.held:
            self.of_module.held = False
            self._set_pauses(now)

    def _take(self, now: Now, progress: Progress) -> None:
        """Do what the module requests. Its scores count even after the attempt."""
        if _number(progress) < len(self.steps) and not progress.failed:
            return  # it was restarted, and has not yet reached the current step
        before, self._progress = self._progress, progress
        if progress.scores != self.scores and self._has_caught_up(progress):
            self.of_module.scores = progress.scores
            self._emit(effects.RunLogged(self.port, run_log.MODULE_SCORE, scores_json(self.scores)))
            self._record_changed(now)
        for warning in progress.warnings:
            if before is None or warning not in before.warnings:
                self.say(now, Level.WARNING, f"Benchmarking module: {warning}")
        if self.phase is not Phase.RUNNING:
            return
        if progress.kept != self.of_module.kept:
            self.of_module.kept = progress.kept
            self._changed()
        if progress.failed:
            self._end(now, EndReason.MODULE_FAILED, FAILED(why=progress.failed))
        elif self._open_request() is not None:
            return
        elif progress.finished and _number(progress) == len(self.steps):
            self._end_by_module(now)
        elif progress.request is not None and progress.request.number == len(self.steps) + 1:
            self._open(now, progress.request)

    def _has_caught_up(self, progress: Progress) -> bool:
        """Whether the module knows all steps. One that was restarted and fails before that has no scores of the later
        steps: those that the core has stay."""
        number, steps = _number(progress), self.steps
        if number != len(steps) or progress.request is None:
            return number >= len(steps)
        kinds = {progress.request.kind, steps[-1].request.kind}
        return progress.request == steps[-1].request or kinds == {RequestKind.NOTE}

    def _end_by_module(self, now: Now) -> None:
        """End the run: the module has no more requests. The benchmark counts as completed if the robot completed a
        goal."""
        ends = [step.outcome.kind for step in self.steps
                if step.request.kind is RequestKind.GOAL and step.outcome is not None]
        late = 0 if self.event.benchmark.profile.runs_until_timeout else ends.count(OutcomeKind.TIMED_OUT)
        if late and late == len(ends):
            self._end(now, EndReason.GOALS_TIMED_OUT)
        elif late:
            self._end(now, EndReason.COMPLETED, COMPLETE_BUT(late=late, number=len(ends)))
        else:
            self._end(now, EndReason.COMPLETED, COMPLETE)

    def _open(self, now: Now, request: Request) -> None:
        problem = self._problem(request)
        if problem:
            self._end(now, EndReason.MODULE_FAILED, FAILED(why=problem))
            return
        self.steps.append(Step(request))
        if request.kind is RequestKind.NOTE:
            self._answer(RequestOutcome(OutcomeKind.DONE, ended_utc=now.utc))
            return
        if request.kind is RequestKind.GOAL:
            self._open_goal(now, request)
        else:
            self._emit(effects.RunLogged(self.port, run_log.MANUAL_OPERATION, request.text))
            self.say(now, Level.INFO, f"Manual operation: {request.text}")
            self._set_pauses(now)
        self._changed()

    def _problem(self, request: Request) -> str:
        """Return what is wrong with a request; empty: nothing. The module is at fault, not the robot."""
        if len(self.steps) >= MAX_STEPS:
            return f"it made more than {MAX_STEPS} requests"
        size = len(request.goal.encode()) + len(request.initial_state) * 2 + len(request.switches) * 6
        if size > self._max_goal:
            return f"its goal takes {size} bytes, and a datagram can carry {self._max_goal}"
        if request.kind is RequestKind.SWITCHES and self.switches is None:
            return "it requests switches, but none of its goals had any"
        return ""

    def _answer(self, outcome: RequestOutcome) -> None:
        self.steps[-1] = self.steps[-1]._replace(outcome=outcome)
        self._changed()

    def _open_request(self) -> Optional[Request]:
        if self.phase is not Phase.RUNNING or not self.steps or self.steps[-1].outcome is not None:
            return None
        return self.steps[-1].request

    def _changed(self) -> None:
        self._emit(effects.ModuleRunsChanged())

    def for_module(self) -> RunForModule:
        """Return what the module needs to know of the run."""
        event, goal = self.event, self.of_module.goal
        return RunForModule(
            self.identity, self.attempt, self.zone, event.benchmark.code, event.team, event.round, event.run,
            running=self.phase is Phase.RUNNING,
            end_reason="" if self.end_reason is None else self.end_reason.name.lower(),
            elapsed_s=self.book.state.elapsed_s,
            goal_timeout=_or_zero(event.benchmark.timeout),
            total_timeout=_or_zero(event.benchmark.total_timeout),
            told_utc=0.0 if goal is None or goal.told is None else goal.told.utc,
            sheet=tuple(self.sheet.groups()),
            steps=tuple(self.steps),
            kept=self.of_module.kept,
        )

    # -- goals --------------------------------------------------------------------------------------

    def _open_goal(self, now: Now, request: Request) -> None:
        self._goal = RunningGoal(request)
        self._goal.start(now)
        self.of_module.goal = self._goal.state
        if request.initial_state:
            self.of_module.switches = SwitchesState(request.initial_state)
            self.switches = NumberedSwitches(self.of_module.switches)
        self._emit(effects.RunLogged(self.port, run_log.GOAL, goal_json(request)))
        self.happened(now, Occurred.GOAL, text=request.text)
        self._set_pauses(now)
        if not self.state.asks:
            self._set_state(now, BoxState.PREPARE, NEW_GOAL)

    def _step(self, now: Now, report: RobotReport) -> None:
        """React to a message of the robot, if there is a goal. Between goals, the robot waits."""
        goal = self._goal
        if goal is None:
            return
        explicit = goal.request.explicit_goal
        reaction = react(self.message.state, report.state, explicit)
        if reaction is Reaction.EXECUTE:
            if goal.state.told is None:
                goal.state.told = now
                self._changed()
            if explicit:
                self._set_state(now, BoxState.GOAL_TX, GOAL_SENT, goal.message)
            else:
                self._set_state(now, BoxState.WAITING_RESULT, EXECUTING)
        elif reaction is Reaction.AWAIT_RESULT:
            self._set_state(now, BoxState.WAITING_RESULT, GOAL_TAKEN)
        elif reaction is Reaction.RETRY:
            self._set_state(now, BoxState.PREPARE, FELL_BACK(state=report.state.name))
        elif reaction is Reaction.GOAL_DONE:
            self._goal_done(now, goal, result_text(report))

    def _goal_done(self, now: Now, goal: RunningGoal, result: str) -> None:
        seconds = goal.executing_s(now.mono - self._leave_out_outage(now, self.state.away_s))
        if result:
            self._emit(effects.RunLogged(self.port, run_log.RESULT, result))
            if self.event.benchmark.profile.result is ResultForm.OBJECT:
                self._emit(effects.RunLogged(self.port, run_log.HOPF_RESULT, result))
            self.show_online(now, f"result: {result}")
        self.say(now, Level.INFO, f"Goal completed by the robot in {seconds:.1f} s")
        self._close_goal(RequestOutcome(OutcomeKind.DONE, result=result, executing_s=seconds, ended_utc=now.utc))

    def _goal_timed_out(self, now: Now, goal: RunningGoal, due: float) -> None:
        seconds = goal.executing_s(due)
        self.say(now, Level.WARNING, f"Goal timed out after {goal.request.timeout:g} s")
        self._close_goal(RequestOutcome(
            OutcomeKind.TIMED_OUT, executing_s=seconds, ended_utc=now.utc - (now.mono - due)
        ))

    def _close_goal(self, outcome: RequestOutcome) -> None:
        self.state.desc = TIMED_OUT if outcome.kind is OutcomeKind.TIMED_OUT else COMPLETED
        self._goal = self.of_module.goal = None
        self._answer(outcome)

    # -- time ---------------------------------------------------------------------------------------

    def _set_pauses(self, now: Now, by: By = NOBODY) -> None:
        """Pause the clock while the referee works or the module is missing. The goal continues while the referee works
        for it, but not while the referee decides whether the run continues."""
        super()._set_pauses(now, by)
        if self._goal is not None:
            self._goal.clock.set_paused(now, self.held or self.times.state.paused or self.state.asks)

    def deadline(self) -> Optional[float]:
        """See `Run.deadline`. Includes the goal's timeout."""
        goal = None if self._goal is None else self._goal.clock.deadline()
        return min((t for t in (super().deadline(), goal) if t is not None), default=None)

    def tick(self, now: Now) -> None:
        """See `Run.tick`. A goal that ends before or together with the run ends first."""
        goal = self._goal
        if goal is not None and self.phase is Phase.RUNNING and goal.clock.is_over(now):
            due = goal.clock.deadline()
            assert due is not None, "it is over"
            if all(due <= t for t in self._ends()):
                self._goal_timed_out(now, goal, due)
        super().tick(now)

    def _goal_number(self) -> int:
        number = sum(step.request.kind is RequestKind.GOAL for step in self.steps)
        return 0 if self._goal is None else number

    def _end(
        self, now: Now, reason: EndReason, desc: str = "", by: By = NOBODY, left_out_s: float = 0.0,
    ) -> None:
        self._goal = self.of_module.goal = None
        self.of_module.held = False
        super()._end(now, reason, desc, by, left_out_s)
        self._changed()

    def close(self, now: Now, by: By = NOBODY) -> None:
        """See `Run.close`."""
        super().close(now, by)
        self._changed()

    # -- for the referee ------------------------------------------------------------------------------

    def limit(self) -> float:
        """Seconds of the present or last goal, which the module's parameters may set."""
        goals = [step.request.timeout for step in self.steps if step.request.kind is RequestKind.GOAL]
        return (goals[-1] or self.event.benchmark.total_timeout) if goals else super().limit()

    def timer(self, now: Now) -> float:
        """Seconds left of the current goal, or of the run if it has no goal now."""
        left = super().timer(now)
        return left if self._goal is None else min(left, self._goal.clock.left(now))

    @property
    def goal(self) -> Optional[RunningGoal]:
        """See `ZoneRun`."""
        return self._goal if self._goal is not None and self._goal.request.timeout else None

    @property
    def why_paused(self) -> str:
        """See `ZoneRun`."""
        if self.held:
            return MODULE_MISSING
        return OPERATION if self.asked is not None else super().why_paused

    def start_off(self, now: Now) -> List[str]:
        """Return why the run cannot be started. Reasons of the module come first."""
        return self._modules.start_off(now, self.event.benchmark.code, self.zone) + super().start_off(now)

    def warnings(self, now: Now) -> List[str]:
        """Return the referee's warnings. Those of the robot come first: it may be moving."""
        found = super().warnings(now)
        if self.held:
            found.append(HELD)
        found += self._modules.warnings(now, self.event.benchmark.code, self.zone)
        if self._progress is not None:
            found += self._progress.warnings
        return found

    @property
    def module_status(self) -> str:
        """What the module reports that it is doing."""
        return "" if self._progress is None else self._progress.status

    def status_lines(self, now: Now) -> List[str]:
        """Return the open manual operation, the time left for the benchmark, and what the module reports."""
        lines: List[str] = []
        if self.phase is Phase.RUNNING:
            if self.asked is not None:
                lines.append(ASKED(text=self.asked.text))
            if self.clock.limit != NO_LIMIT:
                minutes, seconds = divmod(int(self.clock.left(now)), 60)
                left = PAUSED_LEFT if self.clock.paused else LEFT
                lines.append(left(time=f"{minutes:02d}:{seconds:02d}"))
        return lines + ([self.module_status] if self.module_status else []) + super().status_lines(now)


def _answer_words(asked: Request, values: Mapping[str, Any]) -> str:
    words = [(field.label, value if isinstance(value, str) else json.dumps(value))
             for field in asked.fields for value in [values[field.name]]]
    return ", ".join(text if len(words) == 1 else f"{label}: {text}" for label, text in words)


def _or_zero(limit: float) -> float:
    """Return a limit as modules know it: 0 means no limit."""
    return 0.0 if limit == NO_LIMIT else limit


def _number(progress: Progress) -> int:
    return 0 if progress.request is None else progress.request.number
