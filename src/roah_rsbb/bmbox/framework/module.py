"""The base class of benchmarking modules: one coroutine with the rules, and the requests that it can make.

`await` hands a request to the core and returns its outcome (`roah_rsbb.model.modules`). When the run ends,
for whatever reason, the `await` raises `RunEnded`. Modules need not handle it: `finally` blocks run, and the score is
kept.
"""

import json
import random
from types import SimpleNamespace
from typing import Any, Callable, Dict, Generator, List, NamedTuple, Optional, Sequence, Tuple, Union

import yaml

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose2D, Pose3, Source, normalised, seen_from
from roah_rsbb.bmbox.framework.parameters import Parameter
from roah_rsbb.bmbox.framework.results import BadResult, Kind, read_record
from roah_rsbb.bmbox.framework.score import Score, Value
from roah_rsbb.model.fields import Field, TypedPose, form_of, form_text
from roah_rsbb.model.modules import (
    OutcomeKind,
    Request,
    RequestKind,
    RequestOutcome,
    RunForModule,
    form_of_one,
)
from roah_rsbb.model.reason import say

TRY_AGAIN = "Try again"
SKIP = "Skip"
POSE = say("Pose")


class RunEnded(BaseException):
    """The run is over; str() is the reason. Like `CancelledError`, it is not an `Exception`."""


class Stopped(RunEnded):
    """The referee stopped the run, or the robot saved no data."""


class RunTimedOut(RunEnded):
    """The run's time is up."""


class Disconnected(RunEnded):
    """The referee left the run."""


class GoalWatch(NamedTuple):
    """A function that is called periodically during a goal."""

    look: Callable[[float], None]  # its argument: seconds since the robot began to execute
    every: float  # seconds


class Ask(NamedTuple):
    """What a module waits for. The runner numbers the request."""

    request: Request
    watch: Optional[GoalWatch] = None
    measure: Optional[Callable[[], Any]] = None  # NOTE: makes the value to be recorded

    def __await__(self) -> Generator["Ask", RequestOutcome, RequestOutcome]:
        outcome = yield self
        return outcome


class GoalOutcome(NamedTuple):
    """How a goal ended."""

    timed_out: bool
    result: str  # YAML as the robot sent it; empty: none
    executing_s: float  # from the command to execute to the result or timeout; 0.0 if it never executed
    ended_utc: float  # UTC seconds


class Module:
    """Base of all modules. A subclass has a code, declares parameters and score values, and implements `execute`."""

    CODE = ""
    FILE = ""  # path of a competition's own rules
    PARAMETERS: Dict[str, Parameter] = {}
    SCORES: Dict[str, Value] = {}  # of the whole run
    EACH: Dict[str, Value] = {}  # of each goal, person, item …
    SUBJECTS: Tuple[str, ...] = ()  # whose poses it needs, for `check_ground_truth`

    def __init__(self, run: RunForModule, parameters: SimpleNamespace, truth: GroundTruth) -> None:
        self.run = run  # kept up to date
        self.parameters = parameters
        self.score = Score(self.SCORES, self.EACH)
        self.random = random.Random(f"{run.run} {run.attempt}")  # the same after a restart of this process
        self.kept: Dict[str, Any] = {}  # data that a watch collects; survives a restart of this process
        self.status = ""  # one line for the referee
        self.warnings: List[str] = []  # for the referee
        self._truth = truth.for_team(run.team)
        self.source = self._truth.source  # of ground truth, during the whole attempt

    @property
    def goal_timeout(self) -> float:
        """Seconds for each goal: the parameter `goal_timeout`, or else that of the benchmarks file; 0: no limit."""
        own: Optional[float] = getattr(self.parameters, "goal_timeout", None)
        return self.run.goal_timeout if own is None else own

    async def execute(self) -> None:
        """The rules. The run is completed when it returns."""
        raise NotImplementedError

    # -- asking -------------------------------------------------------------------------------------

    async def ask(self, text: str, *fields: Field) -> Dict[str, Any]:
        """Ask the referee to do something and to fill in a form (`roah_rsbb.model.fields`). The run's time is paused.

        Returns the values by the names of the fields.
        """
        outcome = await Ask(Request(0, RequestKind.REFEREE, text, form_text(fields)))
        return json.loads(outcome.values or "{}")

    async def referee(self, text: str, choices: Sequence[str] = (), asks_text: bool = False) -> str:
        """Ask the referee to do something, with a form of one answer at most. The run's time is paused.

        Returns the answer: one of `choices` (the usual one first), with `asks_text` the entered text if there is one,
        else "".
        """
        given = await self.ask(text, *form_of(form_of_one(choices, asks_text)))
        return given.get("text") or given.get("answer", "")

    async def goal(
        self,
        goal: Union[None, str, dict, list] = None,
        pose: Optional[Pose2D] = None,
        timeout: Optional[float] = None,
        text: str = "",
        watch: Optional[Callable[[float], None]] = None,
        every: float = 1.0,
        initial_state: Sequence[bool] = (),
        switches: Sequence[int] = (),
    ) -> GoalOutcome:
        """Send the robot a goal and wait for its result, at most `timeout` seconds (0: no limit; None:
        `goal_timeout`).

        `goal` is sent as YAML to robots of 2019. `pose` is a waypoint, which is also sent in the form of 2015.
        Without both, the robot only gets the command to execute. `text` describes the goal to the referee. `watch` is
        called every `every` seconds while the robot executes, with the seconds since the command; it must store
        its data in `self.kept`.
        """
        if goal is None and pose is not None:
            goal = [float(part) for part in pose]
        limit = self.goal_timeout if timeout is None else timeout
        text_of_goal = "" if goal is None else goal if isinstance(goal, str) else _yaml(goal)
        asked = Request(
            0, RequestKind.GOAL, text, goal=text_of_goal, pose=None if pose is None else tuple(map(float, pose)),
            initial_state=tuple(initial_state), switches=tuple(switches), timeout=float(limit),
        )
        outcome = await Ask(asked, None if watch is None else GoalWatch(watch, every))
        if watch is not None:
            self.kept = await self.note(lambda: self.kept)  # replayed after a restart
        return GoalOutcome(
            outcome.kind is OutcomeKind.TIMED_OUT, outcome.result, outcome.executing_s, outcome.ended_utc
        )

    async def switches(self, text: str) -> RequestOutcome:
        """HOMF: ask the referee which switches `changed` and how many were `damaged`."""
        return await Ask(Request(0, RequestKind.SWITCHES, text))

    async def note(self, measure: Callable[[], Any]) -> Any:
        """Record the return value of `measure()` (JSON, no tuples). After a restart, return the recorded value."""
        return await Ask(Request(0, RequestKind.NOTE), measure=measure)

    # -- measuring ----------------------------------------------------------------------------------

    async def pose(self, subject: str, may_skip: bool = False, base: str = "") -> Optional[Pose3]:
        """The present pose of a subject, in the frame of the subject `base`, or else in that of the test bed.

        While motion capture does not see it, the referee is asked to solve the problem. Without motion capture, the
        referee enters it, or it is None (`Source`). Otherwise it is None only if `may_skip` is set and the referee
        skips it.
        """
        if self.source is Source.NONE:
            return None
        if self.source is Source.REFEREE:
            return await self._entered_pose(subject, may_skip, base)
        origin = await self.pose(base) if base else None
        while True:
            found = await self.note(lambda: self._measure(subject, None))
            if "pose" in found:
                pose = Pose3(*found["pose"])
                return pose if origin is None else seen_from(origin, pose)
            choices = (TRY_AGAIN, SKIP) if may_skip else (TRY_AGAIN,)
            if await self.referee(f"{found['problem']}. Solve the problem, then try again", choices) == SKIP:
                return None

    async def pose_at(self, subject: str, utc: float) -> Optional[Pose3]:
        """The pose of a subject at a past time (UTC seconds); None, with a warning, if it is unknown.

        Without motion capture, like `pose`. The referee may skip it.
        """
        if self.source is not Source.MOTION_CAPTURE:
            return await self.pose(subject, may_skip=True)
        found = await self.note(lambda: self._measure(subject, utc))
        if "pose" in found:
            return Pose3(*found["pose"])
        self.warn(found["problem"])
        return None

    async def _entered_pose(self, subject: str, may_skip: bool, base: str) -> Optional[Pose3]:
        """The pose that the referee measures and enters; None if the referee skips it."""
        where = f"from the {base}'s corner" if base else "in the test bed"
        skip = ". Leave it empty to skip it" if may_skip else ""
        given = await self.ask(
            f"Measure the pose of the {subject} {where}. Enter x, y and its direction, in metres and degrees: "
            f"1.25 0.40 90{skip}", TypedPose("pose", POSE, required=not may_skip))
        if given["pose"] is None:
            return None
        x, y, theta = given["pose"]
        return Pose3(x, y, 0.0, normalised(theta))

    def peek(self, subject: str) -> Optional[Pose3]:
        """The present pose of a subject, for a watch: not recorded; None if it is not available."""
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

    def record(self, outcome: GoalOutcome, shape: Dict[str, Kind]) -> Optional[SimpleNamespace]:
        """The result as a record with these keys (see `results.Kind`); None without a readable result.

        An unreadable result causes a warning. Python keywords get an underscore: `class_`.
        """
        if outcome.timed_out:
            return None
        try:
            return read_record(outcome.result, shape)
        except BadResult as problem:
            self.warn(str(problem))
            return None

    def referee_score(self, group: str, desc: str) -> int:
        """The referee's present score of an item; KeyError if the benchmarks file does not have the item."""
        for known in self.run.sheet:
            for item, value in known.items:
                if (item.group, item.desc) == (group, desc):
                    return value
        raise KeyError(f"no scoring item '{desc}' in group '{group}'")

    def warn(self, text: str) -> None:
        """Warn the referee of a problem."""
        if text not in self.warnings:
            self.warnings.append(text)


def _yaml(goal: Any) -> str:
    return yaml.safe_dump(goal, default_flow_style=None, allow_unicode=True, width=1000).strip()
