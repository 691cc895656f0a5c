"""The messages between the core and the benchmarking modules, as plain values.

Theory of operation. The core owns the run: its state, its clocks, the robot's messages and the referee's entries. A
module owns the rules. It makes one *request* after the other, and the core answers each with an *outcome*; both
together are a *step*. Requests are numbered 1, 2, … within an *attempt* (one start of a run).

Both sides always repeat everything. The core sends a `RunForModule` for each run, with all steps of the attempt; the
module sends a `Progress` with its latest request. A message that arrives twice, late or in another order therefore
changes nothing, and the identity shows messages about another run or attempt. A restarted module gets all steps back.
It runs its rules with the known outcomes, until it reaches the current step.
"""

import enum
import json
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.fields import Choice, Field, TypedText, form_of, form_text
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.scoring import ScoreGroup

# Characters of a typed answer.
MAX_ANSWER = 1000
ANSWER, ANOTHER = ACTIONS["operation"].fields[1].label, say("Another answer")


class RequestKind(enum.IntEnum):
    """The kind of a module's request. The numbers are those of ModuleRequest.msg."""

    REFEREE = 1  # a manual operation, with a form for the referee
    GOAL = 2  # a goal for the robot
    SWITCHES = 3  # the referee enters which switches changed and how many were damaged
    NOTE = 4  # no action; a value to remember, e.g. a measured pose


def form_of_one(choices: Sequence[str], asks_text: bool) -> str:
    """Return the form of one answer: one of `choices`, and a text."""
    fields: List[Field] = [Choice("answer", ANSWER, choices=tuple(choices))] if choices else []
    if asks_text:
        name, label = ("text", ANOTHER) if choices else ("answer", ANSWER)
        fields.append(TypedText(name, label, required=False, characters=MAX_ANSWER))
    return form_text(fields)


class Request(NamedTuple):
    """A request of a module."""

    number: int
    kind: RequestKind
    text: str = ""  # REFEREE, SWITCHES: what the referee should do. GOAL: a description for the referee
    form: str = ""  # REFEREE: the fields to fill in, as JSON (`model.fields.form_text`)
    goal: str = ""  # GOAL: YAML, as robots of 2019 read it; empty: no explicit goal
    pose: Optional[Tuple[float, float, float]] = None  # GOAL: as robots of 2015 read it; metres, radians
    initial_state: Tuple[bool, ...] = ()  # GOAL: initial state of the switches
    switches: Tuple[int, ...] = ()  # GOAL: switches to toggle, in this order
    timeout: float = 0.0  # GOAL: seconds; 0: no limit except the run's timeout
    note: str = ""  # NOTE: JSON

    @property
    def fields(self) -> Tuple[Field, ...]:
        """What the referee fills in."""
        return form_of(self.form)

    @staticmethod
    def upgraded(saved: Dict[str, Any]) -> Dict[str, Any]:
        """Return what was saved before there were forms, with its form."""
        form = form_of_one(saved.get("choices", ()), saved.get("asks_text", False))
        return {**saved, "form": form} if form else saved

    @property
    def explicit_goal(self) -> bool:
        """Whether the robot receives a goal. Otherwise it only executes."""
        return bool(self.goal or self.pose is not None or self.initial_state or self.switches)


class OutcomeKind(enum.IntEnum):
    """How a request ended; the numbers are those of ModuleOutcome.msg."""

    DONE = 1
    TIMED_OUT = 2  # GOAL: its timeout ended it


class RequestOutcome(NamedTuple):
    """The answer to a request."""

    kind: OutcomeKind
    values: str = ""  # REFEREE: JSON, the values of the form by the names of its fields; empty: it has none
    result: str = ""  # GOAL: YAML, as robots of 2019 write it; converted if the robot only sent the other form
    executing_s: float = 0.0  # GOAL: seconds from the request to execute until the result or the timeout
    ended_utc: float = 0.0  # UTC seconds
    changed: Tuple[int, ...] = ()  # SWITCHES: the changes, in order; a switch that changed twice occurs twice
    damaged: int = 0  # SWITCHES: how many were damaged

    @staticmethod
    def upgraded(saved: Dict[str, Any]) -> Dict[str, Any]:
        """Return what was saved before there were forms, with its values."""
        return {**saved, "values": json.dumps({"answer": saved["answer"]})} if "answer" in saved else saved


class Step(NamedTuple):
    """A request and, once there is one, its outcome."""

    request: Request
    outcome: Optional[RequestOutcome] = None


class RunForModule(NamedTuple):
    """Everything that a module needs to know of a run."""

    run: str  # identity, unique among all competitions
    attempt: int  # counts the starts; 0: not started yet
    zone: str
    benchmark: str  # code
    team: str
    round: int
    number: int  # of the run in its round
    running: bool  # whether the attempt is in progress
    end_reason: str = ""  # why the attempt ended, as in `model.zone.Zone`
    elapsed_s: float = 0.0  # counted seconds of the attempt, when it ended
    goal_timeout: float = 0.0  # seconds, from the benchmarks file; 0: no limit
    total_timeout: float = 0.0  # seconds, from the benchmarks file; 0: no limit
    told_utc: float = 0.0  # UTC seconds when the robot was first requested to execute the current goal; 0: not yet
    sheet: Tuple[ScoreGroup, ...] = ()  # the referee's scores
    steps: Tuple[Step, ...] = ()
    kept: str = ""  # JSON that the core keeps for the module


class Progress(NamedTuple):
    """A module's progress in an attempt."""

    run: str
    attempt: int
    request: Optional[Request] = None  # the latest
    scores: Tuple[ScoreValue, ...] = ()
    status: str = ""  # for the referee, in a line
    warnings: Tuple[str, ...] = ()
    kept: str = ""  # JSON that the module gets back after a restart
    finished: bool = False  # the rules are complete
    failed: str = ""  # why the module cannot continue; empty: it can


class ModuleInfo(NamedTuple):
    """A benchmark that a node of modules drives, in all zones or in one.

    What a node reports of a zone replaces what it reports of all zones there.
    """

    benchmark: str  # code
    problems: Tuple[str, ...] = ()  # why no run can be started, e.g. wrong parameters
    warnings: Tuple[str, ...] = ()
    zone: str = ""  # empty: all zones


class ModulesState(NamedTuple):
    """The message of a node of modules, sent on change and twice a second."""

    node: str  # identity of the process
    modules: Tuple[ModuleInfo, ...] = ()
    progress: Tuple[Progress, ...] = ()
