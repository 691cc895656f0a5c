"""The benchmark codes that the box knows, and the types that make up a configuration.

The programs define which codes exist and how a run of each one is driven (docs/benchmarks.md, "The table"). The
configuration files define the name of each benchmark, its timeouts and its scoring items.
"""

import enum
from dataclasses import dataclass, field
from typing import Dict, Tuple


class BenchmarkKind(enum.Enum):
    """Who drives a run of the benchmark."""

    TASK = "task"  # scored by the referee
    FUNCTIONALITY = "functionality"  # driven by a benchmarking module: goals, manual operations, score
    REFEREE_ONLY = "referee only"  # all active robots at once; they receive the state and nothing else


KINDS: Dict[str, BenchmarkKind] = {
    "HGTKMH": BenchmarkKind.TASK,
    "HWV": BenchmarkKind.TASK,
    "HCFGAC": BenchmarkKind.TASK,
    "HOPF": BenchmarkKind.FUNCTIONALITY,
    "HNF": BenchmarkKind.FUNCTIONALITY,
    "HSUF": BenchmarkKind.REFEREE_ONLY,
    "HPPF": BenchmarkKind.FUNCTIONALITY,
    "HPFF": BenchmarkKind.FUNCTIONALITY,
    "HGMF": BenchmarkKind.FUNCTIONALITY,
    "HOMF": BenchmarkKind.FUNCTIONALITY,
    "STB": BenchmarkKind.FUNCTIONALITY,
}

# In the schedule this means every active robot. No team may have this name.
ALL_TEAMS = "ALL"


class ScoreKind(enum.IntEnum):
    """Kind of a scoring item, numbered as in `ZoneScoreGroup` (docs/ros_interface.md, "Topics of the core")."""

    BOOL = 0
    UINT = 1


@dataclass(frozen=True)
class ScoringItem:
    """One line of the referee's score sheet; `group` and `desc` together are its identity."""

    group: str
    desc: str
    kind: ScoreKind


@dataclass(frozen=True)
class Benchmark:
    """One benchmark of the benchmarks file.

    `total_timeout` (s) ends the run and counts from *start*. Panels show `timeout` (s). Unless the file says
    otherwise, both are the same. In a functionality benchmark, `timeout` is the time for one goal; the module's
    parameter `goal_timeout` ends the goal.
    """

    code: str
    name: str
    desc: str
    timeout: float
    total_timeout: float
    scoring: Tuple[ScoringItem, ...]

    @property
    def kind(self) -> BenchmarkKind:
        """Who drives a run of this benchmark."""
        return KINDS[self.code]


@dataclass(frozen=True)
class ScheduledEvent:
    """One line of a zone's schedule. `team` is `ALL_TEAMS` for a referee-only benchmark."""

    benchmark: Benchmark
    team: str
    round: int
    run: int
    scheduled: float  # UTC, seconds since 1970


@dataclass(frozen=True)
class ZonePlan:
    """A zone and its events in the order of their scheduled times; equal times keep the file's order."""

    name: str
    events: Tuple[ScheduledEvent, ...]


@dataclass(frozen=True)
class Config:
    """The contents of the three configuration files. Its `repr` omits the passwords."""

    benchmarks: Dict[str, Benchmark]  # by code
    passwords: Dict[str, str] = field(repr=False)  # by team
    zones: Tuple[ZonePlan, ...]
