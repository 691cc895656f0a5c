"""The benchmark codes that the programs know, and the rules for other codes (docs/benchmarks.md, "The table").

This is the only place with the codes of benchmarks. A competition's `benchmarks.yaml` may change matters of the
rules, and define other codes. Robots cannot read that file. They know another code only as `OTHER`. This module needs
only Python, because teams without ROS have it, too.
"""

import enum
import re
from dataclasses import dataclass, replace
from typing import Dict, FrozenSet, Iterable, List


class BenchmarkKind(enum.Enum):
    """Who drives a run of the benchmark."""

    TASK = "task"  # scored by the referee
    FUNCTIONALITY = "functionality"  # driven by a benchmarking module: goals, manual operations, score
    ALL_ROBOTS = "all robots"  # all active robots at once; they receive the state and nothing else


class GoalForm(enum.Enum):
    """How a goal is described to the robot. In the box's messages it is also a text, except for switches."""

    NONE = "none"  # the robot is only asked to execute
    WAYPOINT = "waypoint"  # a pose
    PLACEMENT = "placement"  # an object, and the position where to put it
    SWITCHES = "switches"  # the initial states of switches, and the switches to toggle
    STRING = "string"  # a text, on the robot's topic `goal`
    TEXT = "text"  # a text, on the robot's topic `goal/text` only


class ResultForm(enum.Enum):
    """What the robot returns when it has completed a goal."""

    NONE = "none"
    OBJECT = "object"  # class, instance and pose
    PERSON = "person"  # name and pose
    ANY = "any"  # any text; its content does not matter
    TEXT = "text"  # a text, such as YAML or JSON


STRINGS = ("notifications", "activation_event", "visitor", "final_command")
DEVICES, TABLET, BELL = "devices", "tablet", "bell"
# What a robot may use in a benchmark: strings of online data, home devices, the tablet, and visitors at the doorbell.
USES = (*STRINGS, DEVICES, TABLET, BELL)

# The number of all benchmarks without their own number, in the robot's topic `benchmark`.
OTHER_NUMBER = 255


@dataclass(frozen=True)
class Profile:
    """What the programs know of a benchmark besides its titles, times and scoring items."""

    kind: BenchmarkKind
    number: int = OTHER_NUMBER  # in the message `Benchmark`
    goal: GoalForm = GoalForm.NONE
    result: ResultForm = ResultForm.NONE
    uses: FrozenSet[str] = frozenset()  # of USES
    # A robot that executes until the goal's timeout has completed the goal.
    runs_until_timeout: bool = False
    # PREPARE during execution means that the goal timed out.
    prepare_ends_goal: bool = False
    offline_data: bool = True  # the robot must record offline data
    beacon: bool = True  # a run needs a robot that the box hears; without it, the referee starts the robot


def _task(number: int, uses: Iterable[str] = ()) -> Profile:
    return Profile(BenchmarkKind.TASK, number, uses=frozenset(uses))


def _functionality(
    number: int, goal: GoalForm = GoalForm.NONE, result: ResultForm = ResultForm.NONE, uses: Iterable[str] = (),
    runs_until_timeout: bool = False, prepare_ends_goal: bool = False,
) -> Profile:
    return Profile(BenchmarkKind.FUNCTIONALITY, number, goal, result, frozenset(uses), runs_until_timeout,
                   prepare_ends_goal)


# The order is that of tables and lists. HOMF has no constant in the message Benchmark.
PROFILES: Dict[str, Profile] = {
    "HGTKMH": _task(1),
    "HWV": _task(2, ["notifications", "activation_event", "visitor", BELL]),
    "HCFGAC": _task(3, ["final_command", DEVICES, TABLET]),
    "HOPF": _functionality(4, result=ResultForm.OBJECT),
    "HNF": _functionality(5, GoalForm.WAYPOINT, uses=["notifications"], prepare_ends_goal=True),
    "HSUF": Profile(BenchmarkKind.ALL_ROBOTS, 6),
    "HPPF": _functionality(8, result=ResultForm.PERSON),
    "HPFF": _functionality(9, runs_until_timeout=True),
    "HGMF": _functionality(10, GoalForm.PLACEMENT),
    "HOMF": _functionality(11, GoalForm.SWITCHES, uses=["notifications"]),
    "STB": _functionality(7, GoalForm.STRING, ResultForm.ANY),
}

# What a robot knows of any other benchmark: it may have goals, and the box decides what may be used.
OTHER = Profile(
    BenchmarkKind.TASK, goal=GoalForm.TEXT, result=ResultForm.TEXT, uses=frozenset(USES), prepare_ends_goal=True,
)


# A code is part of file names and of runs' identities.
CODE = re.compile("[A-Za-z][A-Za-z0-9_]{0,31}")


def new_profile(kind: BenchmarkKind) -> Profile:
    """What the box knows of a code that a competition defines: robots know it as `OTHER`."""
    return replace(OTHER, kind=kind, uses=frozenset())


def in_order(codes: Iterable[str]) -> List[str]:
    """Return codes, each once: in the order of the table, others last."""
    found = set(codes)
    return [code for code in PROFILES if code in found] + sorted(found.difference(PROFILES))


def profile_of(code: str) -> Profile:
    """Return what the programs know of a code."""
    return PROFILES.get(code, OTHER)
