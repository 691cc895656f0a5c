"""What the public may see of a box: nothing but what stands here, and of that only what the organisers allow.

Times in `_utc_s` are UTC seconds since 1970.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import ScoreValue, SheetPoints
from roah_rsbb.model.zone import NOTHING, RUNNING, Count


class PublicEvent(NamedTuple):
    """An event of the schedule."""

    zone: str
    benchmark: str  # its full name
    team: str  # ALL: all robots at once
    round: int
    run: int
    scheduled_utc_s: float


class RobotText(NamedTuple):
    """What a robot said."""

    robot: str  # empty: there is only one
    kind: str  # notifications, activation_event, visitor or final_command
    text: str
    utc_s: float


class PublicRun(NamedTuple):
    """The run in a zone, with what explains it to spectators."""

    event: PublicEvent
    teams: Tuple[str, ...]  # the teams of all robots in it
    phase: str  # connected, running or ended
    kind: str  # of the benchmark: task, functionality or all robots
    doing: str  # what happens now: waiting, preparing, executing, referee, between, by_hand or ended
    end_reason: str = ""  # name of an `EndReason`, in lower case; empty: it has not ended, or this is not public
    limit: float = 0.0  # seconds; 0: none
    elapsed: Count = NOTHING  # without pauses
    activity: Said = ""  # the current phase of the task; empty: none
    about: Dict[str, str] = {}  # what the benchmark is about, by language
    phases: Tuple[str, ...] = ()  # of the task
    phase_number: int = 0  # of the current phase of the task; 0: none
    are_waypoints: bool = False  # the goals
    goals: int = 0  # that have begun
    goals_ended: int = 0
    goals_completed: Optional[int] = None  # None: this is not public
    said: Tuple[RobotText, ...] = ()  # the newest last; empty unless the organisers allow it

    @property
    def is_paused(self) -> bool:
        """Whether it is in progress while its clock stands."""
        return self.phase == RUNNING and not self.elapsed.counting

    def shown_s(self, mono: float) -> float:
        """Return the seconds that displays show at a moment: those that are left or, without a limit, counted."""
        elapsed_s = self.elapsed.at(mono)
        return self.limit - elapsed_s if self.limit else elapsed_s


class PublicItem(NamedTuple):
    """An item of a score sheet."""

    name: str
    kind: str  # bool or count
    value: int


class PublicGroup(NamedTuple):
    """A group of a score sheet."""

    name: str
    items: Tuple[PublicItem, ...]
    not_attempted: int  # how many items the robot did not try


class PublicResult(NamedTuple):
    """A run that is over."""

    event: PublicEvent
    end_reason: str  # name of an `EndReason`, in lower case
    disconnected_utc_s: float
    signed: bool  # its score sheet is signed off; otherwise, the result is provisional
    groups: Tuple[PublicGroup, ...] = ()
    module_scores: Tuple[ScoreValue, ...] = ()  # of the whole run
    points: Optional[SheetPoints] = None  # None: the sheet gives none, or they are not public


class PublicRank(NamedTuple):
    """A team in a standing."""

    rank: str
    team: str
    numbers: Tuple[str, ...]  # for each criterion; empty: none


class PublicStanding(NamedTuple):
    """The standing of a benchmark, of the runs that are signed off."""

    benchmark: str  # its full name
    criteria: Tuple[str, ...]
    ranks: Tuple[PublicRank, ...]
    notes: Tuple[Said, ...] = ()  # what a reader must know of it


class Public(NamedTuple):
    """What the public may see besides runs and results."""

    results: str = "none"  # what the organisers allow of results: none, outcomes or scores
    following: Tuple[PublicEvent, ...] = ()  # the events that have not begun, the soonest first
    standings: Tuple[PublicStanding, ...] = ()
    time_zone: str = ""  # of the venue: `wording.times.zone_of`; empty: none
