"""The event that a zone shows: previous, next, and any other one."""

from typing import Any, Dict, List

from roah_rsbb.core.actions.base import Given, ZoneAction
from roah_rsbb.core.actions.connecting import DISCONNECT_FIRST, STOP_FIRST
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import RunName, say
from roah_rsbb.model.records import By, Phase

FIRST, LAST = say("This is the zone's first event"), say("This is the zone's last event")
NO_EVENT = say("zone '{zone}' has no event '{event}' any more: choose it again")
OTHER_TEAM = say("The event is of team {team} now: choose it again")
UNSIGNED = say("The run of {code}, team {team}, round {round}, run {run} is not signed off: confirm to leave it")


class Previous(ZoneAction):
    """Go to the event before."""

    name = "previous"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return _connected(zone) + ([FIRST] if zone.at_first else [])

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        zone.move(-1)


class Next(ZoneAction):
    """Go to the next event."""

    name = "next"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return _connected(zone) + ([LAST] if zone.at_last else [])

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        zone.move(1)


class ChooseEvent(ZoneAction):
    """Make an event of the schedule the zone's current one. A run that has ended is left.

    `team`: whose event the caller means; empty: whoever's. `unsigned`: the caller confirmed to leave a run whose score
    sheet is not signed off. It can still be signed off later.
    """

    name = "choose_event"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is not None and zone.run.phase is Phase.CONNECTED:
            return [DISCONNECT_FIRST]
        if zone.run is not None and zone.run.phase is Phase.RUNNING:
            return [STOP_FIRST]
        return []

    def refused(self, now: Now, zone: Zone, target: RunName, given: Given) -> List[str]:
        """See `ZoneAction`."""
        place = zone.place_named(given["event"])
        if place is None:
            return [NO_EVENT(zone=zone.name, event=given["event"])]
        if given["team"] and zone.events[place].team != given["team"]:
            return [OTHER_TEAM(team=zone.events[place].team)]
        if place == zone.index and zone.run is None:
            return []
        return self.off(now, zone, given) or self._unsigned(now, zone, given)

    def _unsigned(self, now: Now, zone: Zone, given: Given) -> List[str]:
        if given["unsigned"] or not self._candidates.is_unsigned(zone):
            return []
        event = zone.event
        moving = [] if zone.run is None else zone.run.ignores_stop(now)
        return moving + [UNSIGNED(code=event.benchmark.code, team=event.team, round=event.round, run=event.run)]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        if zone.run is not None:
            self._connections.leave(now, zone, by)
        place = zone.place_named(given["event"])  # the event of the run may have been removed with it
        if place is not None and place != zone.index:
            zone.move(place - zone.index)

    def recorded(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """Also what the event is, for the eye."""
        place, recorded = zone.place_named(given["event"]), super().recorded(zone, given)
        if place is None:
            return recorded
        event = zone.events[place]
        return {**recorded, "event": f"{event.benchmark.code} {event.team} {event.round} {event.run}"}


def _connected(zone: Zone) -> List[str]:
    return [] if zone.run is None else [DISCONNECT_FIRST]
