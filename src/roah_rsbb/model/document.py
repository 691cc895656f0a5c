"""Everything that the faces show of a box, in sections. `document/` writes it as JSON, and sends what changes.

Times in `_utc_s` are UTC seconds since 1970. Moments are on the box's monotonic clock, in seconds.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.model.judging import Judging
from roah_rsbb.model.public import Public, PublicResult, PublicRun
from roah_rsbb.model.reason import Said
from roah_rsbb.model.results import RunLine, UnsavedParts
from roah_rsbb.model.schedule import EventSeen
from roah_rsbb.model.zone import ZoneSeen

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
