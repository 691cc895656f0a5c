"""Runs a module for one run: passes on its requests, returns the outcomes, and resumes it after a restart.

Theory of operation. A module is a coroutine that yields requests. The core keeps all steps (requests with their
outcomes) and publishes them repeatedly. The runner continues when the step that the module waits for has an outcome.
A restarted module gets all steps at once: the runner replays the recorded outcomes until it reaches the open step.
Replaying must make the same requests in the same order. Otherwise the rules or parameters have changed since the
crash, and the module fails.

There is no clock, thread or ROS here: `on_run` and `tick` are called from outside, and `progress` returns the state
to be sent.
"""

import json
import traceback
from types import SimpleNamespace
from typing import Callable, Coroutine, Dict, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Ask, Disconnected, Module, RunEnded, RunTimedOut, Stopped
from roah_rsbb.bmbox.framework.rule_files import place_of
from roah_rsbb.model.modules import Progress, Request, RequestKind, RequestOutcome, RunForModule
from roah_rsbb.rulebook.errors import ConfigErrors

# Share of a period: a tick that is early by this much belongs to the next period.
SAME_TIME = 1e-3
REASONS: Dict[str, Type[RunEnded]] = {"timeout": RunTimedOut}

# A module's class, or a function that finds it.
MakeModule = Callable[[RunForModule, SimpleNamespace, GroundTruth], Module]


class ModuleRunner:
    """The module of one run, for all attempts."""

    def __init__(
        self, kind: MakeModule, load_parameters: Callable[[], SimpleNamespace], truth: GroundTruth
    ) -> None:
        """`load_parameters` and then `kind` are called at each start; they may raise ConfigErrors."""
        self._kind = kind
        self._load_parameters = load_parameters
        self._truth = truth
        self.module: Optional[Module] = None  # of the attempt
        self._run: Optional[RunForModule] = None
        self._rules: Optional[Coroutine] = None  # None: no attempt in progress
        self._ask: Optional[Ask] = None
        self._request: Optional[Request] = None
        self._finished = False
        self._failed = ""
        self._is_replaying = False  # recorded steps, after a restart
        self._watched: Optional[int] = None  # the period of the latest call of the watch
        self.traceback = ""  # of the exception that ended the rules, for a log

    # -- the core -----------------------------------------------------------------------------------

    def on_run(self, run: RunForModule) -> None:
        """Take the state of the run. Repeated or older states have no effect."""
        known = 0 if self._run is None else self._run.attempt
        if run.attempt < known:
            return
        if run.attempt > known:
            self._leave(Stopped("restarted"))
            if not run.running:
                return  # the attempt ended before it began here
            self._run = run
            self._begin(run)
        elif self._run is None:
            return  # not started yet
        else:
            self._run = run
        if self.module is not None:
            self.module.run = run
        if not run.running:
            self._leave(REASONS.get(run.end_reason, Stopped)(run.end_reason))
            return
        self._proceed(run)

    def close(self) -> None:
        """The referee left the run."""
        self._leave(Disconnected("the run was left"))

    def progress(self) -> Optional[Progress]:
        """The state to be sent; None if there is none yet."""
        if self._run is None:
            return None
        module = self.module
        basic = Progress(self._run.run, self._run.attempt, self._request, failed=self._failed)
        if module is None:
            return basic
        return basic._replace(
            scores=module.score.values(), status=module.status, warnings=tuple(module.warnings),
            kept=json.dumps(module.kept) if module.kept else "", finished=self._finished,
        )

    # -- time ---------------------------------------------------------------------------------------

    def watching(self) -> bool:
        """Whether the module watches the present goal, so that `tick` must be called."""
        return (
            self._rules is not None and self._ask is not None and self._ask.watch is not None
            and self._run is not None and self._run.told_utc > 0.0
        )

    def tick(self, utc: float) -> None:
        """Call the watch if it is due; `utc` in seconds."""
        if not self.watching():
            return
        executing_s = max(0.0, utc - self._run.told_utc)
        watch = self._ask.watch
        # Once per period: delays do not accumulate, and a clock that is set back does not stop the watch.
        period = int(executing_s / watch.every + SAME_TIME)
        if period == self._watched:
            return
        self._watched = period
        try:
            watch.look(executing_s)
        except Exception as error:
            self._fail(error)

    # -- the rules ----------------------------------------------------------------------------------

    def _begin(self, run: RunForModule) -> None:
        """Begin an attempt, also after a restart."""
        self._finished, self._failed, self.traceback = False, "", ""
        self.module = self._rules = self._ask = self._request = None
        self._is_replaying = bool(run.steps)
        try:
            self.module = self._kind(run, self._load_parameters(), self._truth)
        except ConfigErrors as errors:
            self._failed = "; ".join(str(errors).splitlines())
            return
        except Exception as error:
            self._fail(error)
            return
        self._rules = self.module.execute()
        self._resume(None)

    def _proceed(self, run: RunForModule) -> None:
        """Continue as long as outcomes are available."""
        while self._rules is not None and self._ask is not None and len(run.steps) >= self._request.number:
            step = run.steps[self._request.number - 1]
            note = self._request.kind is RequestKind.NOTE is step.request.kind
            if not note and step.request != self._request:
                self._reject_replay(step.request)
                return
            self._request = step.request  # a note keeps its recorded value
            if step.outcome is None:
                return
            self._resume(_answer(step.request, step.outcome))

    def _resume(self, answer: object) -> None:
        """Run the rules up to their next request."""
        self._ask = None
        try:
            ask = self._rules.send(answer)
            number = 1 if self._request is None else self._request.number + 1
            self._take(ask, number)
        except StopIteration:
            self._rules, self._finished = None, True
        except RunEnded as ended:
            self._rules, self._failed = None, f"it raised {type(ended).__name__} itself ({ended})"
        except Exception as error:
            self._fail(error)

    def _take(self, ask: Ask, number: int) -> None:
        is_known = len(self._run.steps) >= number
        request = ask.request._replace(number=number)
        if not is_known:
            self._end_replay()
            if ask.measure is not None:
                request = request._replace(note=json.dumps(ask.measure()))
        self._ask, self._request, self._watched = ask, request, None
        if is_known and self._run.steps[number - 1].outcome is None:
            self._end_replay()

    def _end_replay(self) -> None:
        """The module has reached the open step: restore what it kept before the restart."""
        if self._is_replaying:
            self._is_replaying = False
            if self._run.kept:
                self.module.kept = json.loads(self._run.kept)

    def _leave(self, reason: RunEnded) -> None:
        """The run is over: let the rules clean up."""
        rules, self._rules, self._ask = self._rules, None, None
        if rules is None:
            return
        try:
            rules.throw(reason)
        except (RunEnded, StopIteration):
            return
        except Exception as error:
            self._fail(error)
            return
        try:
            rules.close()  # it waits for a further outcome, which will not come
        except RuntimeError as error:
            self._fail(error)

    def _fail(self, error: Exception) -> None:
        self._rules = self._ask = None
        self._failed = f"{type(error).__name__}: {error}"
        if self.module is not None and self.module.FILE:
            self._failed = f"{place_of(self.module.FILE, error)}: {self._failed}"
        self.traceback = "".join(traceback.format_exception(type(error), error, error.__traceback__))

    def _reject_replay(self, recorded: Request) -> None:
        if self._rules is not None:
            self._rules.close()
        self._rules = self._ask = None
        self._failed = (
            f"its rules or parameters changed during the run: step {recorded.number} was "
            f"{_words(recorded)}, now it is {_words(self._request)}"
        )


def _answer(request: Request, outcome: RequestOutcome) -> object:
    return json.loads(request.note) if request.kind is RequestKind.NOTE else outcome


def _words(request: Request) -> str:
    more = f" {request.goal}" if request.text and request.goal else ""
    return f"{request.kind.name.lower()} {request.text or request.goal!r}{more}".strip()
