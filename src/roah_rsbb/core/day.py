"""What the edits of the day need of the box: which events may still be changed, and teams that withdraw."""

from typing import Collection, List, NamedTuple, Sequence, Set

from roah_rsbb.core.connections import Connections
from roah_rsbb.core.desks import CommandRecord
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.timers import Timers
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName, checked_who, cut_note
from roah_rsbb.model.records import By, Phase
from roah_rsbb.rulebook.day import NO_EVENT
from roah_rsbb.rulebook.event_ids import key_of
from roah_rsbb.scoring.book import FinishedRuns


class OpenEvents(NamedTuple):
    """The ids of events."""

    open: Set[str]  # not over, and no run of them is in progress
    to_come: Set[str]  # of these, the ones that their zone has not passed


class WithdrawnRun(NamedTuple):
    """The run that says that a team withdrew from an event."""

    zone: str
    identity: str
    event: str  # id


class DayDesk:
    """See above."""

    def __init__(
        self, timers: Timers, zones: Zones, finished: FinishedRuns, connections: Connections, record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        self._timers, self._zones, self._finished = timers, zones, finished
        self._connections, self._record, self._outbox = connections, record, outbox

    def events(self) -> OpenEvents:
        """Return the events that may be changed."""
        over, found = self._zones.over(self._finished.records()), OpenEvents(set(), set())
        for zone in self._zones.values():
            for place, event in enumerate(zone.events):
                has_begun = place == zone.index and zone.run is not None and zone.run.phase is not Phase.CONNECTED
                if (zone.name, place) not in over and not has_begun:
                    found.open.add(event.id)
                    if place >= zone.index:
                        found.to_come.add(event.id)
        return found

    def withdraw(self, now: Now, events: Sequence[str], team: str, who: str, reason: str) -> List[WithdrawnRun]:
        """Record that a team withdrew from events. Zones go past them. Raises `Refused`."""
        self._timers.tick(now)
        zones = {event.id: zone for zone in self._zones.values() for event in zone.events}
        found: List[WithdrawnRun] = []
        with self._record.of(RunName(""), who, "withdraw_team", team=team, events=" ".join(events), reason=reason):
            if not zones.keys() >= set(events):
                raise Refused([NO_EVENT])
            reasons = self._connections.off([])
            if reasons:
                raise Refused(reasons)
            for event in sorted(events, key=lambda event: event == zones[event].event.id):  # zones go past the others
                place = zones[event].place_of_id(event)
                assert place is not None, "it is in this zone"
                identity = self._connections.withdraw(now, zones[event], place, By(checked_who(who), cut_note(reason)))
                found.append(WithdrawnRun(zones[event].name, identity, event))
        return found

    def go_back(self, now: Now, events: Collection[str]) -> None:
        """Let zones go back to the first of these events that they have passed and that is not over."""
        passed = {zone.name: [key_of(event) for event in zone.events if event.id in events]
                  for zone in self._zones.values()}
        for zone in self._zones.go_back(passed, self._finished.records()):
            self._outbox.mark_changed(zone.name)
