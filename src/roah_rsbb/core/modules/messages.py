"""What the core and the benchmarking modules say to each other, as plain values.

Theory of operation. The core owns the run: its state, its clocks, what the referee and the robot said. A
module owns the rules: it asks for one thing after the other (a *request*), and the core answers each with
an *outcome*; both together are a *step*. Requests are numbered 1, 2, … within an *attempt* (one start of a run). Both
sides always repeat all that they know: the core sends a `RunForModule` for each run, with all steps of the attempt,
and the module a `Progress`, with its latest request. So a message that comes twice, late or in another order changes
nothing, and a message about another run or attempt is recognised by its identity. A restarted module gets all steps
back, goes through its rules with the outcomes that are already there, and so arrives where it was.
"""

import enum
from typing import NamedTuple, Optional, Tuple

from roah_rsbb.core.scoring.records import ScoreValue
from roah_rsbb.core.scoring.sheet import ScoreGroup


class RequestKind(enum.IntEnum):
    """What a module asks for; the numbers are those of ModuleRequest.msg."""

    REFEREE = 1  # a manual operation
    GOAL = 2  # a goal for the robot
    SWITCHES = 3  # HOMF: the referee enters which switches changed and how many were damaged
    NOTE = 4  # nothing to do, but to be remembered: a pose that was measured, say


class Request(NamedTuple):
    """One thing that a module asks for."""

    number: int
    kind: RequestKind
    text: str = ""  # REFEREE, SWITCHES: what the referee should do. GOAL: what it is about, for the referee
    choices: Tuple[str, ...] = ()  # REFEREE: the answers to choose from, the usual one first
    asks_text: bool = False  # REFEREE: an answer may be typed
    goal: str = ""  # GOAL: YAML, as robots of 2019 read it; empty: no explicit goal
    pose: Optional[Tuple[float, float, float]] = None  # GOAL: as robots of 2015 read it; metres, radians
    initial_state: Tuple[bool, ...] = ()  # GOAL: HOMF, of the switches
    switches: Tuple[int, ...] = ()  # GOAL: HOMF, to toggle, in this order
    timeout: float = 0.0  # GOAL: seconds; 0: only the run's own timeout ends it
    note: str = ""  # NOTE: JSON

    @property
    def explicit_goal(self) -> bool:
        """Whether the robot is sent a goal. Otherwise it only executes."""
        return bool(self.goal or self.pose is not None or self.initial_state or self.switches)


class OutcomeKind(enum.IntEnum):
    """How a request ended; the numbers are those of ModuleOutcome.msg."""

    DONE = 1
    TIMED_OUT = 2  # GOAL: its timeout ended it


class Outcome(NamedTuple):
    """The answer to a request."""

    kind: OutcomeKind
    answer: str = ""  # REFEREE: chosen or typed
    result: str = ""  # GOAL: YAML, as robots of 2019 write it; from the other form where only that came
    executing_s: float = 0.0  # GOAL: seconds from telling the robot to execute to its result, or to the timeout
    ended_utc: float = 0.0  # UTC seconds
    changed: Tuple[int, ...] = ()  # SWITCHES: the switches that changed, in order, as often as they did
    damaged: int = 0  # SWITCHES: how many were damaged


class Step(NamedTuple):
    """A request and, once there is one, its outcome."""

    request: Request
    outcome: Optional[Outcome] = None


class RunForModule(NamedTuple):
    """All that a module needs to know of a run."""

    run: str  # identity: no other run of this or another competition has it
    attempt: int  # 1 from the first start on, one more with each start; 0: not started yet
    zone: str
    benchmark: str  # code
    team: str
    round: int
    number: int  # of the run in its round
    running: bool  # whether the attempt is under way
    end_reason: str = ""  # why it is over, as in ZoneDetails
    elapsed_s: float = 0.0  # seconds that count of the attempt, when it ended
    goal_timeout: float = 0.0  # seconds, from the benchmarks file
    total_timeout: float = 0.0  # seconds, from the benchmarks file
    told_utc: float = 0.0  # UTC seconds when the robot was first asked to execute the present goal; 0: not yet
    sheet: Tuple[ScoreGroup, ...] = ()  # the referee's own scores
    steps: Tuple[Step, ...] = ()
    kept: str = ""  # JSON that the module asked to keep


class Progress(NamedTuple):
    """Where a module is in an attempt."""

    run: str
    attempt: int
    request: Optional[Request] = None  # the latest
    scores: Tuple[ScoreValue, ...] = ()
    status: str = ""  # for the referee, in a line
    warnings: Tuple[str, ...] = ()
    kept: str = ""  # JSON to get back after a restart
    finished: bool = False  # the rules are through
    failed: str = ""  # why the module cannot continue


class ModuleInfo(NamedTuple):
    """A benchmark that a node of modules drives."""

    benchmark: str  # code
    problems: Tuple[str, ...] = ()  # why no run can be started: wrong parameters
    warnings: Tuple[str, ...] = ()


class ModulesState(NamedTuple):
    """What a node of modules says, on change and twice a second."""

    node: str  # identity of the process
    modules: Tuple[ModuleInfo, ...] = ()
    progress: Tuple[Progress, ...] = ()
