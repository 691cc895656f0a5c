"""What every benchmarking module is: rules in one coroutine, and what they may ask for.

`await` hands a request to the core and gives its outcome back (`roah_rsbb.core.modules.messages`). When the
run ends for whatever reason, the `await` raises `RunEnded`, which needs no handling: a `finally` is run, and
what was scored is kept.
"""

import random
from types import SimpleNamespace
from typing import Any, Callable, Dict, Generator, List, NamedTuple, Optional, Sequence, Tuple, Union

import yaml

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose2D, Pose3
from roah_rsbb.bmbox.framework.parameters import Field
from roah_rsbb.bmbox.framework.results import BadResult, read_record
from roah_rsbb.bmbox.framework.score import Score, Value
from roah_rsbb.core.modules.messages import Outcome, OutcomeKind, Request, RequestKind, RunForModule

TRY_AGAIN = "Try again"
SKIP = "Skip"


class RunEnded(BaseException):
    """The run is over; str() is the reason. Like a cancelled task's, it is no `Exception`."""


class Stopped(RunEnded):
    """The referee stopped the run, or the robot saves no data."""


class RunTimedOut(RunEnded):
    """The run's time is up."""


class Disconnected(RunEnded):
    """The run was left."""


class Watch(NamedTuple):
    """Something to be done again and again while a goal is under way."""

    look: Callable[[float], None]  # gets the seconds for which the robot has been executing
    every: float  # seconds


class Ask(NamedTuple):
    """What a module waits for; the runner makes the request's number."""

    request: Request
    watch: Optional[Watch] = None
    measure: Optional[Callable[[], Any]] = None  # NOTE: makes what is to be remembered

    def __await__(self) -> Generator["Ask", Outcome, Outcome]:
        outcome = yield self
        return outcome


class GoalOutcome(NamedTuple):
    """How a goal ended."""

    timed_out: bool
    result: str  # YAML as the robot sent it; empty: none
    executing_s: float  # from telling the robot to execute to its result or the timeout; 0.0: it never did
    ended_utc: float  # UTC seconds


class Module:
    """Base of all modules: a subclass has a code, declares parameters and score, and implements `execute`."""

    CODE = ""
    PARAMETERS: Dict[str, Field] = {}
    SCORES: Dict[str, Value] = {}  # of the whole run
    EACH: Dict[str, Value] = {}  # of each goal, person, item …
    SUBJECTS: Tuple[str, ...] = ()  # whose poses it needs, for the check before a run

    def __init__(self, run: RunForModule, parameters: SimpleNamespace, truth: GroundTruth) -> None:
        self.run = run  # kept up to date
        self.parameters = parameters
        self.score = Score(self.SCORES, self.EACH)
        self.random = random.Random(f"{run.run} {run.attempt}")  # the same after a restart of this process
        self.kept: Dict[str, Any] = {}  # what a watch gathers: it survives a restart of this process, too
        self.status = ""  # for the referee, in a line
        self.warnings: List[str] = []  # for the referee
        self._truth = truth.for_team(run.team)

    async def execute(self) -> None:
        """The rules. The run is completed when it returns."""
        raise NotImplementedError

    # -- asking -------------------------------------------------------------------------------------

    async def referee(self, text: str, choices: Sequence[str] = (), asks_text: bool = False) -> str:
        """Have the referee do something; the run's time does not count meanwhile.

        Returns the answer: one of `choices` (the usual one first), or with `asks_text` what was typed, else "".
        """
        asked = Request(0, RequestKind.REFEREE, text, tuple(choices), asks_text)
        return (await Ask(asked)).answer

    async def goal(
        self,
        goal: Union[None, str, dict, list] = None,
        pose: Optional[Pose2D] = None,
        timeout: float = 0.0,
        text: str = "",
        watch: Optional[Callable[[float], None]] = None,
        every: float = 1.0,
        initial_state: Sequence[bool] = (),
        switches: Sequence[int] = (),
    ) -> GoalOutcome:
        """Give the robot a goal and wait for its result, or for `timeout` seconds (0: as long as the run lasts).

        `goal`: what robots of 2019 get, as YAML. `pose`: a waypoint, which goes out in the form of 2015, too.
        Neither: the robot is only told to execute. `text`: what it is about, for the referee. `watch` is called
        every so many seconds while the robot executes, with the seconds since it was told to; what it gathers
        belongs into `self.kept`.
        """
        if goal is None and pose is not None:
            goal = [float(part) for part in pose]
        text_of_goal = "" if goal is None else goal if isinstance(goal, str) else _yaml(goal)
        asked = Request(
            0, RequestKind.GOAL, text, goal=text_of_goal, pose=None if pose is None else tuple(map(float, pose)),
            initial_state=tuple(initial_state), switches=tuple(switches), timeout=float(timeout),
        )
        outcome = await Ask(asked, None if watch is None else Watch(watch, every))
        if watch is not None:
            self.kept = await self.note(lambda: self.kept)  # what was gathered is part of what is gone through again
        return GoalOutcome(
            outcome.kind is OutcomeKind.TIMED_OUT, outcome.result, outcome.executing_s, outcome.ended_utc
        )

    async def switches(self, text: str) -> Outcome:
        """HOMF: have the referee enter which switches changed (`changed`) and how many were damaged (`damaged`)."""
        return await Ask(Request(0, RequestKind.SWITCHES, text))

    async def note(self, measure: Callable[[], Any]) -> Any:
        """What `measure()` returns (JSON: no tuples), remembered: after a restart it is the same again."""
        return await Ask(Request(0, RequestKind.NOTE), measure=measure)

    # -- measuring ----------------------------------------------------------------------------------

    async def pose(self, subject: str, may_skip: bool = False) -> Optional[Pose3]:
        """Where something is now. If that cannot be had the referee is asked to see to it, and it is tried again.

        None only with `may_skip`, when the referee says so.
        """
        while True:
            found = await self.note(lambda: self._measure(subject, None))
            if "pose" in found:
                return Pose3(*found["pose"])
            choices = (TRY_AGAIN, SKIP) if may_skip else (TRY_AGAIN,)
            if await self.referee(f"{found['problem']}. See to it, then try again", choices) == SKIP:
                return None

    async def pose_at(self, subject: str, utc: float) -> Optional[Pose3]:
        """Where something was at a moment that is past (UTC seconds); None, with a warning, if nobody knows."""
        found = await self.note(lambda: self._measure(subject, utc))
        if "pose" in found:
            return Pose3(*found["pose"])
        self.warn(found["problem"])
        return None

    def peek(self, subject: str) -> Optional[Pose3]:
        """Where something is now, for a watch: not remembered, nobody is asked. None: it cannot be had."""
        try:
            return self._truth.pose(subject)
        except NoPose:
            return None

    def _measure(self, subject: str, at_utc: Optional[float]) -> Dict[str, Any]:
        try:
            return {"pose": list(self._truth.pose(subject, at_utc))}
        except NoPose as problem:
            return {"problem": str(problem)}

    # -- reading ------------------------------------------------------------------------------------

    def record(self, outcome: GoalOutcome, shape: Dict[str, type]) -> Optional[SimpleNamespace]:
        """A result with these keys, each a `float` or `str`; None if there is none, or none that can be read.

        The second is a warning to the referee. Names that are Python's get an underscore: `class_`.
        """
        if outcome.timed_out:
            return None
        try:
            return read_record(outcome.result, shape)
        except BadResult as problem:
            self.warn(str(problem))
            return None

    def referee_score(self, group: str, desc: str) -> int:
        """What the referee scored so far; KeyError for an item that the benchmarks file does not have."""
        for known in self.run.sheet:
            for item, value in known.items:
                if (item.group, item.desc) == (group, desc):
                    return value
        raise KeyError(f"no scoring item '{desc}' in group '{group}'")

    def warn(self, text: str) -> None:
        """Tell the referee of something that is not as it should be."""
        if text not in self.warnings:
            self.warnings.append(text)


def _yaml(goal: Any) -> str:
    return yaml.safe_dump(goal, default_flow_style=None, allow_unicode=True, width=1000).strip()
