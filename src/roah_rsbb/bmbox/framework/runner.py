"""Runs a module for one run: hands its requests out, gives it the outcomes, brings it back where it was.

Theory of operation. A module is a coroutine that yields what it asks for. The core keeps all steps (requests
with their outcomes) and tells them again and again; the runner goes on whenever the step that the module waits
for has an outcome. A module that was started again gets all steps at once: it is driven through its rules with
the outcomes of then, and arrives at the step that is open. What it asks for on the way must be what it asked
for then, or the rules or parameters are not those of then, and it cannot go on.

No clock, no thread, no ROS: `on_run` and `tick` are called from outside, `progress` is what there is to send.
"""

import json
import traceback
from types import SimpleNamespace
from typing import Callable, Coroutine, Dict, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Ask, Disconnected, Module, RunEnded, RunTimedOut, Stopped
from roah_rsbb.core.modules.messages import Outcome, Progress, Request, RequestKind, RunForModule
from roah_rsbb.rulebook.errors import ConfigErrors

# Of a period: a tick that is early by so little counts as of the next one.
SAME_TIME = 1e-3
REASONS: Dict[str, Type[RunEnded]] = {"timeout": RunTimedOut}


class ModuleRunner:
    """One run's module, through all attempts."""

    def __init__(
        self, kind: Type[Module], load_parameters: Callable[[], SimpleNamespace], truth: GroundTruth
    ) -> None:
        """`load_parameters` is called at each start; it may raise ConfigErrors."""
        self._kind = kind
        self._load_parameters = load_parameters
        self._truth = truth
        self.module: Optional[Module] = None  # of the attempt
        self._run: Optional[RunForModule] = None
        self._rules: Optional[Coroutine] = None  # None: no attempt is under way
        self._ask: Optional[Ask] = None
        self._request: Optional[Request] = None
        self._finished = False
        self._failed = ""
        self._is_going_back = False  # after a restart, through steps that were taken before
        self._looked: Optional[int] = None  # the period in which the watch last looked
        self.traceback = ""  # of the exception that ended the rules, for a log

    # -- the core -----------------------------------------------------------------------------------

    def on_run(self, run: RunForModule) -> None:
        """All that the core knows of the run; the same again, or something older, does nothing."""
        known = 0 if self._run is None else self._run.attempt
        if run.attempt < known:
            return
        if run.attempt > known:
            self._leave(Stopped("started again"))
            if not run.running:
                return  # nothing was begun here, and it is over
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
        self._go_on(run)

    def close(self) -> None:
        """The run was left."""
        self._leave(Disconnected("the run was left"))

    def progress(self) -> Optional[Progress]:
        """What there is to say; None: nothing yet."""
        if self._run is None:
            return None
        module = self.module
        at_all = Progress(self._run.run, self._run.attempt, self._request, failed=self._failed)
        if module is None:
            return at_all
        return at_all._replace(
            scores=module.score.values(), status=module.status, warnings=tuple(module.warnings),
            kept=json.dumps(module.kept) if module.kept else "", finished=self._finished,
        )

    # -- time ---------------------------------------------------------------------------------------

    def watching(self) -> bool:
        """Whether `tick` has something to do: a goal is executed that the module watches."""
        return (
            self._rules is not None and self._ask is not None and self._ask.watch is not None
            and self._run is not None and self._run.told_utc > 0.0
        )

    def tick(self, utc: float) -> None:
        """Let the module look, if it is time for it (UTC seconds)."""
        if not self.watching():
            return
        executing_s = max(0.0, utc - self._run.told_utc)
        watch = self._ask.watch
        # Once in each period: late ticks do not add up, and a clock that is set back does not stop the watch.
        period = int(executing_s / watch.every + SAME_TIME)
        if period == self._looked:
            return
        self._looked = period
        try:
            watch.look(executing_s)
        except Exception as error:
            self._fail(error)

    # -- the rules ----------------------------------------------------------------------------------

    def _begin(self, run: RunForModule) -> None:
        """Begin an attempt, or begin it again after a restart."""
        self._finished, self._failed, self.traceback = False, "", ""
        self.module = self._rules = self._ask = self._request = None
        self._is_going_back = bool(run.steps)
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

    def _go_on(self, run: RunForModule) -> None:
        """Go on for as long as the outcomes are there."""
        while self._rules is not None and self._ask is not None and len(run.steps) >= self._request.number:
            step = run.steps[self._request.number - 1]
            note = self._request.kind is RequestKind.NOTE is step.request.kind
            if not note and step.request != self._request:
                self._cannot_go_on(step.request)
                return
            self._request = step.request  # a note is what it was when it was first taken
            if step.outcome is None:
                return
            self._resume(_answer(step.request, step.outcome))

    def _resume(self, answer: object) -> None:
        """Let the rules go on to the next thing that they ask for."""
        self._ask = None
        try:
            ask = self._rules.send(answer)
            number = 1 if self._request is None else self._request.number + 1
            self._take(ask, number)
        except StopIteration:
            self._rules, self._finished = None, True
        except RunEnded as ended:
            self._rules, self._failed = None, f"it ended the run by itself ({ended})"
        except Exception as error:
            self._fail(error)

    def _take(self, ask: Ask, number: int) -> None:
        is_known = len(self._run.steps) >= number
        request = ask.request._replace(number=number)
        if not is_known:
            self._arrive()
            if ask.measure is not None:
                request = request._replace(note=json.dumps(ask.measure()))
        self._ask, self._request, self._looked = ask, request, None
        if is_known and self._run.steps[number - 1].outcome is None:
            self._arrive()

    def _arrive(self) -> None:
        """It is where it was before a restart: what it keeps is what it had kept then."""
        if self._is_going_back:
            self._is_going_back = False
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
            rules.close()  # it waits for something else: nothing comes any more
        except RuntimeError as error:
            self._fail(error)

    def _fail(self, error: Exception) -> None:
        self._rules = self._ask = None
        self._failed = f"{type(error).__name__}: {error}"
        self.traceback = "".join(traceback.format_exception(type(error), error, error.__traceback__))

    def _cannot_go_on(self, then: Request) -> None:
        if self._rules is not None:
            self._rules.close()
        self._rules = self._ask = None
        self._failed = (
            f"its rules or parameters were changed in the run: at step {then.number} it asked for "
            f"{_words(then)}, now for {_words(self._request)}"
        )


def _answer(request: Request, outcome: Outcome) -> object:
    return json.loads(request.note) if request.kind is RequestKind.NOTE else outcome


def _words(request: Request) -> str:
    return f"{request.kind.name.lower()} {request.text or request.goal!r}".strip()
