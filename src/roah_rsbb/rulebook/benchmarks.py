"""The types that make up a configuration: benchmarks, schedule, passwords."""

import enum
import math
from dataclasses import dataclass, field
from typing import Dict, FrozenSet, List, Optional, Tuple

from roah_rsbb.model.rules import NO_SHEET, Decision, Sheet
from roah_rsbb.model.scoring import JudgesRule, ScoringItem, SheetForm
from roah_rsbb.rulebook.errors import Place
from roah_rsbb.rulebook.registry import PROFILES, STRINGS, BenchmarkKind, Profile, profile_of
from roah_rsbb.rulebook.standing_rules import StandingRules

# In the schedule this means every active robot. No team may have this name.
ALL_TEAMS = "ALL"


# As a limit of a run, goal or phase: only the robot or the referee ends it.
NO_LIMIT = math.inf


class CountingAttempt(enum.Enum):
    """Which of the attempts at an event counts."""

    LAST = "last"
    BEST = "best"
    ALL = "all"


class Restarts(enum.Enum):
    """Whether a stopped run may be started again, and what its clock does in between."""

    CLOCK_RUNS = "clock runs"
    CLOCK_STOPS = "clock stops"
    NOT_ALLOWED = "not allowed"


@dataclass(frozen=True)
class PhaseRule:
    """A phase of a task benchmark. The referee moves the run to the next one."""

    name: str
    limit: float = NO_LIMIT  # seconds; when it is over, the referee is warned


@dataclass(frozen=True)
class EventRules:
    """The rules about time and attempts. The defaults are those of all benchmarks that do not have such rules."""

    setup_time: float = 0.0  # seconds from *connect* until the run should start; 0.0: no such rule
    attempts: int = 0  # at one event; 0: any number
    counting: CountingAttempt = CountingAttempt.LAST
    restarts: Restarts = Restarts.CLOCK_RUNS
    pause: bool = False  # whether the referee may pause the clock
    phases: Tuple[PhaseRule, ...] = ()
    absent: Tuple[str, ...] = ()  # ends of runs that were not held, but count: an incident of the sheet comes with them


NO_RULES = EventRules()


@dataclass(frozen=True)
class Benchmark:
    """One benchmark of the benchmarks file.

    `total_timeout` (s) ends the run and counts from *start*. In a functionality benchmark `timeout` (s) ends a goal,
    unless the module's parameters say otherwise. In the others it is not used. Unless the file says otherwise, both
    are the same. Either may be `NO_LIMIT`.
    """

    code: str
    name: str
    desc: str
    timeout: float
    total_timeout: float
    scoring: Tuple[ScoringItem, ...]  # what the referee marks: the rows of `sheet`
    own: Optional[Profile] = None  # None: that of the registry
    rules: EventRules = NO_RULES
    about: Tuple[Tuple[str, str], ...] = ()  # what spectators read of it: languages and texts
    judges: Optional[JudgesRule] = None  # None: the referee scores
    objection_time: float = 0.0  # seconds after the result is published; 0.0: no such rule
    sheet: Sheet = NO_SHEET  # its score sheet, and what may happen in its runs; `NO_SHEET`: it has no rules
    protest_time: float = 0.0  # seconds after the sign-off; 0.0: no such rule

    @property
    def form(self) -> SheetForm:
        """The score sheet before it is filled in."""
        return SheetForm(self.scoring, judges=self.judges, objection_time=self.objection_time,
                         protest_time=self.protest_time,
                         sheet=None if self.sheet is NO_SHEET else self.sheet)

    @property
    def title(self) -> str:
        """What people call it."""
        return self.desc or self.name

    @property
    def profile(self) -> Profile:
        """What the programs know of this benchmark."""
        return self.own or profile_of(self.code)

    @property
    def unused_strings(self) -> FrozenSet[str]:
        """The strings of `STRINGS` that a robot should not send. None in a benchmark of this package whose file has no
        `uses` of its own: robots have always sent strings anywhere."""
        known = PROFILES.get(self.code)
        is_default = known is not None and known.uses == self.profile.uses
        return frozenset() if is_default else frozenset(STRINGS) - self.profile.uses

    @property
    def limit(self) -> float:
        """Seconds that the referee sees as the limit: of a goal in a functionality benchmark, else of the run."""
        return self.timeout if self.kind is BenchmarkKind.FUNCTIONALITY else self.total_timeout

    @property
    def kind(self) -> BenchmarkKind:
        """Who drives a run of this benchmark."""
        return self.profile.kind


@dataclass(frozen=True)
class ScheduledEvent:
    """One line of a zone's schedule. `team` is `ALL_TEAMS` in a benchmark of all robots."""

    benchmark: Benchmark
    team: str
    round: int
    run: int
    scheduled: float  # UTC, seconds since 1970
    id: str = ""  # what it is known by, whatever else changes (`event_ids`); empty: not from a file
    id_goes: Optional[Place] = field(default=None, compare=False, repr=False)  # where it is missing; None: it is not


@dataclass(frozen=True)
class ZonePlan:
    """A zone and its events in the order of their scheduled times; equal times keep the file's order."""

    name: str
    events: Tuple[ScheduledEvent, ...]


class Durable(enum.Enum):
    """Where an entry must be before it is confirmed."""

    ONE = "one"  # on the disk of the box
    TWO = "two"  # on the disk of the standby, too


@dataclass(frozen=True)
class Config:
    """The contents of the configuration files. Its `repr` omits the passwords."""

    benchmarks: Dict[str, Benchmark]  # by code
    passwords: Dict[str, str] = field(repr=False)  # by team
    zones: Tuple[ZonePlan, ...]
    ranking: StandingRules = field(default_factory=StandingRules)  # how runs compare
    durable: Durable = Durable.ONE
    time_zone: str = ""  # of the venue: `wording.times.zone_of`; empty: that of each computer
    decisions: Tuple[Decision, ...] = ()  # what the rules leave to people
    durable_at: Optional[Place] = field(default=None, compare=False)  # where the schedule says so; None: nowhere


def teams_of(config: Config) -> List[str]:
    """Return all teams: first those of the schedule, in order, then those that only have a password."""
    scheduled = [event.team for zone in config.zones for event in zone.events if event.team != ALL_TEAMS]
    return list(dict.fromkeys([*scheduled, *config.passwords]))
