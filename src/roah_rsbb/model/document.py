"""Everything that the faces show of a box, in sections. `document/` writes it as JSON, and sends what changes.

Times in `_utc_s` are UTC seconds since 1970. Moments are on the box's monotonic clock, in seconds. What the public may
see comes first: nothing but what stands there, and of that only what the organisers allow.
"""

import json
from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.model.as_json import schema
from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import ScoreValue, SheetPoints
from roah_rsbb.model.results import EventSeen, Judging, RunLine, RunTimeline, UnsavedParts
from roah_rsbb.model.zone import NOTHING, RUNNING, Count, ZoneSeen


class PublicEvent(NamedTuple):
    """An event of the schedule."""

    zone: str
    benchmark: str  # its full name
    team: str  # ALL: all robots at once
    round: int
    run: int
    scheduled_utc_s: float
    begins_utc_s: float = 0.0  # the estimated time of one that has not begun; 0: not known


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


# The identity of a box that shows an earlier run begins with it.
REPLAY = "REPLAY "


class TabletSeen(NamedTuple):
    """What the box knows of the tablet."""

    heard: bool = False  # whether it ever was
    silent_since: Optional[float] = None  # the moment of its last message, once that is some time ago
    display_map: bool = False  # true: map, false: call button
    call_utc_s: float = 0.0
    position_utc_s: float = 0.0
    position_x: float = 0.0  # metres
    position_y: float = 0.0  # metres


class BoxSeen(NamedTuple):
    """The box itself."""

    uuid: str  # identity of this start of the core
    host: str  # broadcast address in use
    port: int  # public UDP port in use
    status: Said = "OK"  # OK, or what the box is doing or complaining of
    warnings: Tuple[Said, ...] = ()  # for every referee
    zones: Tuple[str, ...] = ()  # in the order of the schedule
    tablet: TabletSeen = TabletSeen()
    superseded_by: str = ""  # address of the box that took over; empty: none did
    unsaved: Tuple[UnsavedParts, ...] = ()  # what the core could not write to the disk yet

    @property
    def own_status(self) -> Said:
        """The status; empty if it only repeats the warnings in one line."""
        return "" if self.warnings and self.status == "; ".join(self.warnings) else self.status

    @property
    def is_replay(self) -> bool:
        """Whether it shows an earlier run again."""
        return self.uuid.startswith(REPLAY)


class RobotSeen(NamedTuple):
    """An active robot."""

    team: str
    robot: str
    skew: float  # seconds, robot's clock minus the box's, in steps; positive: it is ahead
    silent_since: Optional[float] = None  # the moment of its last message, once that is some time ago


class Document(NamedTuple):
    """What the faces show of a box."""

    box: BoxSeen
    robots: Dict[str, RobotSeen]  # by "<robot> of team <team>"
    zones: Dict[str, ZoneSeen]  # by their names
    schedule: Dict[str, EventSeen]  # by their ids; see `events`
    results: Dict[str, RunLine]  # by their identities; see `runs`
    judging: Dict[str, Judging]  # of the runs that are not signed off, by their identities
    public: Public = Public()
    public_runs: Dict[str, PublicRun] = {}  # by their zones
    public_results: Dict[str, PublicResult] = {}  # by the identities of the runs
    timelines: Dict[str, RunTimeline] = {}  # of the runs in the zones, by their zones

    def events(self) -> Tuple[EventSeen, ...]:
        """Return the events of all zones by their scheduled times."""
        order = {zone: place for place, zone in enumerate(self.box.zones)}
        return tuple(sorted(self.schedule.values(), key=lambda event: (
            event.scheduled_utc_s, order.get(event.zone, len(order)), event.number)))

    def runs(self) -> Tuple[RunLine, ...]:
        """Return the connected runs in the order of the zones, then those that are over, the latest first."""
        order = {zone: place for place, zone in enumerate(self.box.zones)}
        return tuple(sorted(self.results.values(), key=lambda run: (
            run.closed_utc_s is not None, -(run.closed_utc_s or 0.0), order.get(run.zone, len(order)))))

    def zone_of(self, robot: str) -> str:
        """Return the zone of the run that a robot takes part in, which is named as in `robots`; empty: none."""
        seen = self.robots[robot]
        for zone in self.zones.values():
            one, several = zone.robot, zone.all_robots
            is_alone_in_it = one is not None and (zone.event.team, one.robot) == (seen.team, seen.robot)
            # If all robots run at once, each has a line.
            if is_alone_in_it or (several is not None and any(
                    line.startswith(f"{robot}: ") for line in several.robots)):
                return zone.zone
        return ""

    def runs_shown(self) -> Tuple[PublicRun, ...]:
        """Return the runs that the public may see, in the order of the zones."""
        return tuple(self.public_runs[zone] for zone in self.box.zones if zone in self.public_runs)

    def results_shown(self, signed: bool) -> Tuple[PublicResult, ...]:
        """Return the results that the public may see, the newest first: those that are signed off, or the others."""
        return tuple(sorted((result for result in self.public_results.values() if result.signed is signed),
                            key=lambda result: -result.disconnected_utc_s))


if __name__ == "__main__":
    print(json.dumps(schema(Document), indent=1))  # docs/door.md
