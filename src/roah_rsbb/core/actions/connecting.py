"""Runs and their robots: connect, disconnect; and runs without a robot."""

from typing import Any, Dict, List, Tuple

from roah_rsbb.core.actions.base import Given, ZoneAction
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import Choice, Field
from roah_rsbb.model.reason import RunName, say
from roah_rsbb.model.records import By, EndReason, Phase
from roah_rsbb.rulebook.registry import BenchmarkKind

DISCONNECT_FIRST = say("A run is connected: disconnect it first")
STOP_FIRST = say("A run is running: stop it first")
RUN_STOP_FIRST = say("run {run} is running: stop it first")
NOT_CONNECTED = say("No run is connected")
FOR_ALL = say("{code} is for all robots at once: connect without a robot")
APPEARED = say("The run was started, so its team appeared")

SIGNED_OFF = say("This event is signed off: go to the next one, unless another attempt is due")


class Begin(ZoneAction):
    """Whatever begins a run, which may replace the result of the event."""

    def question(self, now: Now, zone: Zone) -> str:
        """See `ZoneAction`."""
        return SIGNED_OFF if zone.run is None and self._scores.is_signed_off(now, zone) else ""


class Connect(Begin):
    """Connect the robot of the event's team, or all robots. `robot`: which of several."""

    name = "connect"

    def form(self, now: Now, zone: Zone) -> Tuple[Field, ...]:
        """The robots to choose from, if there are several."""
        robot, again = self.action.fields
        robots = self._candidates.to_choose(now, zone)
        return (Choice(robot.name, robot.label, robot.required, robots), again) if robots else self.action.fields

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return self._candidates.off(now, zone, given["robot"])

    def refused(self, now: Now, zone: Zone, target: RunName, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if given["robot"] and zone.event.benchmark.kind is BenchmarkKind.ALL_ROBOTS:
            return [FOR_ALL(code=zone.event.benchmark.code)]
        return self.off(now, zone, given)

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        self._connections.connect(now, zone, self._candidates.to_connect(now, zone, given["robot"]))


class Disconnect(ZoneAction):
    """Leave the run. `running`: the caller knows that it may be in progress, and ends with it."""

    name = "disconnect"
    off_without_run = NOT_CONNECTED

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return [] if zone.run is not None else [NOT_CONNECTED]

    def refused(self, now: Now, zone: Zone, target: RunName, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is not None and zone.run.phase is Phase.RUNNING and not given["running"]:
            return [RUN_STOP_FIRST(run=zone.run.identity)]
        return self.off(now, zone, given)

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        self._connections.leave(now, zone, by)

    def recorded(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """Whether the run was in progress is in its record."""
        return {}


class OpenSheet(Begin):
    """Begin a run without a robot."""

    name = "open_sheet"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is not None:
            return [DISCONNECT_FIRST]
        return self._candidates.attempts_off(zone) + self._connections.off([])

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        self._connections.open_sheet(now, zone)


class GiveUp(Begin):
    """End the zone's event without a score, and leave it."""

    reason: EndReason

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        run = zone.run or self._connections.open_sheet(now, zone)
        run.give_up(now, self.reason, by)
        self._connections.leave(now, zone, by)


class RecordNoShow(GiveUp):
    """The team did not appear."""

    name = "no_show"
    reason = EndReason.NO_SHOW

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
            return [APPEARED]
        return list(self._connections.off([])) if zone.run is None else []


class Withdrawn(GiveUp):
    """The team withdrew."""

    name = "withdrawn"
    reason = EndReason.WITHDRAWN

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is not None and zone.run.phase is Phase.RUNNING:
            return [STOP_FIRST]
        return list(self._connections.off([])) if zone.run is None else []
