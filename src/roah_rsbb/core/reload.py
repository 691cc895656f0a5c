"""Takes another configuration while the box runs (docs/organiser.md, "Changes during the competition").

Theory of operation. Each configuration has a *version*, a rising number. A run keeps the event, and so the benchmark,
of the version with which it was connected, and its channel keeps that version's password. Its zone saves the version,
so that the run also keeps them after a restart of the core. When the run is left, its zone takes the present schedule.

Results belong to their runs, not to the schedule, so they stay whatever happens to their events. The list of changes
says what becomes of them.
"""

from typing import List, Sequence

from roah_rsbb.core import effects
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.robots import ActiveRobots
from roah_rsbb.core.zones import Zones, key_of_record
from roah_rsbb.model.reason import Refused, checked_who, say
from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.rulebook.event_ids import EventKey, key_of
from roah_rsbb.scoring.book import FinishedRuns
from roah_rsbb.wording import times

# The journal records at most this many changes of a reload.
MAX_RECORDED = 500

CONNECTED = say("zone '{zone}' is no longer in the schedule, but a run of {code} is connected in it: disconnect it "
                "first")


class Reload:
    """Puts another configuration into force."""

    def __init__(
        self, zones: Zones, robots: ActiveRobots, finished: FinishedRuns, connections: Connections, copies: Copies,
        outbox: Outbox, time_zone: str
    ) -> None:
        self._zones = zones
        self._robots = robots
        self._finished = finished
        self._connections = connections
        self._copies = copies
        self._outbox = outbox
        self._use_zone(time_zone)

    def _use_zone(self, name: str) -> None:
        self.time_zone = name
        times.use_zone(name)

    def off(self, config: Config) -> List[str]:
        """Return why a configuration cannot be taken now; empty: it can."""
        names = {zone.name for zone in config.zones}
        why = self._copies.why_not(config)
        return ([why] if why else []) + [
            CONNECTED(zone=zone.name, code=zone.event.benchmark.code)
            for zone in self._zones.values() if zone.run is not None and zone.name not in names
        ]

    def ran(self) -> List[EventKey]:
        """Return the events of all runs, also of those in the zones, as they were when the runs were connected."""
        return [key_of_record(record) for record in self._finished.records()] + [
            key_of(run.event) for run in self._zones.runs()]

    def take(self, config: Config, version: int, changes: Sequence[str], who: str) -> None:
        """Put a configuration into force. `changes` lists what it changes. Raises `Refused`."""
        reasons = self.off(config)
        if reasons:
            raise Refused(reasons)
        recorded = list(changes[:MAX_RECORDED])
        if len(changes) > MAX_RECORDED:
            recorded.append(f"… and {len(changes) - MAX_RECORDED} more")
        value = {"version": version, "changes": recorded}
        self._outbox.emit(effects.Recorded("", "", None, "reload", value, checked_who(who)))
        self._robots.use_teams(config.passwords)
        self._finished.use(config.benchmarks, config.ranking)
        self._copies.use(config)
        self._use_zone(config.time_zone)
        self._connections.version = version
        self._zones.reschedule(config.zones, self._finished.records())
        self._outbox.emit(effects.ModuleRunsChanged())  # a module may be needed from now on
        for zone in self._zones.values():
            self._outbox.mark_changed(zone.name)
            if zone.run is not None and zone.event not in zone.planned:
                self._outbox.notice(Level.INFO, "The configuration was changed. This run keeps what it began with",
                                    zone.name)
        self._outbox.notice(Level.INFO, f"The configuration was changed ({len(changes)} changes)")
