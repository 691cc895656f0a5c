"""The box: it joins the parts of the core, each of which takes the events of its subject.

Every method of a part that takes an event also takes `now`, and leaves its effects in the outbox. A command of the
referee that is not possible now raises `Refused` and changes nothing.
"""

from typing import Any, Callable, List, Mapping, Optional

from roah_rsbb.core.actions.table import NOTHING, Actions, Entries, Target
from roah_rsbb.core.arrivals import Arrivals
from roah_rsbb.core.authority import Authority
from roah_rsbb.core.connections import Candidates, Connections
from roah_rsbb.core.continuing import Reload, Restart
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.day import DayDesk
from roah_rsbb.core.desks import CommandRecord, JudgeDesk, ModuleDesk, ScoreDesk
from roah_rsbb.core.devices import ReportedDevices
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.link.freshness import Heard
from roah_rsbb.core.modules import Modules
from roah_rsbb.core.robots import ActiveRobots
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.tablet import Tablet
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.watches import Watches
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon
from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.rulebook.registry import DEVICES, TABLET
from roah_rsbb.scoring.book import FinishedRuns


class Box:
    """The referee, scoring and benchmarking box, without its sockets, clocks and files."""

    def __init__(
        self,
        config: Config,
        settings: Settings,
        beacon_size: Callable[[Beacon], int],
        last_port: Optional[int] = None,
        version: int = 0,
    ) -> None:
        """`beacon_size`: bytes of the datagram that carries a beacon. `last_port`: the highest private port that this
        competition has used, from the journal; None: no port was used yet. `version`: of the configuration."""
        self.settings = settings
        self.outbox = outbox = Outbox()
        # Runs: in zones, and finished.
        self.zones = zones = Zones(config.zones)
        self.finished = finished = FinishedRuns(config.benchmarks, config.ranking)
        # Robots, tablet and warnings.
        self.robots = robots = ActiveRobots(
            settings.robot_timeout, config.passwords, lambda: {run.robot for run in zones.members()},
            settings.allowed_skew)
        self.tablet = tablet = Tablet()
        self.watches = watches = Watches(settings.listen_duration, outbox)
        self.copies = copies = Copies(outbox)
        copies.use(config)
        self.heard = heard = Heard(settings.allowed_skew)
        self.authority = authority = Authority(watches, copies, outbox)
        # Time.
        self.timers = timers = Timers(zones, robots, watches, authority)
        self.devices = ReportedDevices(timers, zones, watches, outbox)
        # What changes runs.
        modules = Modules()
        self.connections = connections = Connections(
            settings, zones, robots, modules, tablet, watches, finished, heard, copies, outbox, beacon_size, last_port)
        connections.version = version
        self.reload = Reload(timers, zones, robots, finished, connections, copies, authority, outbox, config.time_zone)
        self.restart = Restart(
            timers, zones, finished, connections, self.devices, tablet, heard, watches, authority, outbox)
        self.candidates = Candidates(settings, zones, robots, watches, connections, finished)
        record = CommandRecord(zones, authority, outbox)
        self.scores = ScoreDesk(timers.tick, zones, finished, record, outbox)
        self.actions = Actions(self.candidates, connections, self.scores, zones, record, authority, outbox)
        self.judges = JudgeDesk(self.scores, outbox)
        self.modules = ModuleDesk(timers.tick, zones, modules, authority)
        self.day = DayDesk(timers, zones, finished, connections, record, outbox)
        self.entries = Entries(zones, self.scores, self.judges, record)
        self.arrivals = Arrivals(settings, timers, zones, robots, heard, tablet, watches, connections, outbox)
        timers.parts = (self.modules, connections)

    def act(self, now: Now, target: Target, action: str, who: str = "", given: Mapping[str, Any] = NOTHING) -> None:
        """Do one of `model.actions.EVERY`; see `Actions.do`. Raises `Refused`."""
        self.timers.tick(now)
        (self.entries if action in ENTRIES else self.actions).do(now, target, action, who, given)

    @property
    def happenings(self) -> int:
        """A number that rises with all that happens. Time that passes, robots that repeat what they said, and beacons
        of known robots do not raise it."""
        return self.timers.ticks + self.outbox.emitted + self.outbox.revision + self.robots.changes

    def beacon(self) -> Beacon:
        """Return the current content of the beacon."""
        return Beacon(self.connections.listed(), self.devices.state, self.tablet.state)

    def warnings(self, now: Now) -> List[str]:
        """Return the current warnings for every referee."""
        if self.authority.closed:
            return [self.authority.closed]
        uses = frozenset().union(*(zone.event.benchmark.profile.uses for zone in self.zones.values()))
        devices = self.devices.warnings if DEVICES in uses else []
        tablet = self.tablet.warnings(now, TABLET in uses)
        return [*self.watches.warnings(now), *self.copies.warnings(now), *devices, *tablet,
                *self.connections.warnings()]

    def warnings_of(self, now: Now, zone_name: str) -> List[str]:
        """Return the current warnings for the referee of a zone. Some faces show the first one only: those of a robot
        that may still be moving come first."""
        if self.authority.is_superseded:
            return []
        zone = self.zones[zone_name]
        of_run = [] if zone.run is None else zone.run.warnings(now) + zone.run.times.warnings()
        return of_run + self.candidates.outsiders(now, zone)
