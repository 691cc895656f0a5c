"""A zone's runs: connect and disconnect, runs without a robot, the clock, and the event that the zone shows."""

from typing import Any, Dict, List, Tuple

from roah_rsbb.core.actions.base import Given, ZoneAction
from roah_rsbb.core.runs.machine import RunEvent, is_possible
from roah_rsbb.core.zones import NO_EVENT, NO_RUN, NOTHING_TO_STOP, Zone
from roah_rsbb.model.actions import UNSIGNED
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import Choice, Field
from roah_rsbb.model.reason import RunName, say
from roah_rsbb.model.records import By, EndReason, Phase
from roah_rsbb.rulebook.benchmarks import Restarts
from roah_rsbb.rulebook.registry import BenchmarkKind

DISCONNECT_FIRST = say("A run is connected: disconnect it first")
STOP_FIRST = say("A run is running: stop it first")
RUN_STOP_FIRST = say("run {run} is running: stop it first")
NOT_CONNECTED = say("No run is connected")
FOR_ALL = say("{code} is for all robots at once: connect without a robot")
APPEARED = say("The run was started, so its team appeared")
SIGNED_OFF = say("This event is signed off: go to the next one, unless another attempt is due")
NOT_RUNNING = say("No run is running")
STARTED = say("Already started")
NO_RESTART = say("The rules of this benchmark do not allow a restart: disconnect, and connect for a new run")
TIMED_OUT = say("The run ended by timeout: disconnect, and connect for a new run")
TIME_UP = say("The run's time is up (the clock kept running after the stop): disconnect, and connect for a new run")
NOT_STARTED = say("The run is not started: disconnect to leave it")
NO_ANSWER = say("The run is over, but the robot did not answer STOP: stop it by hand")
OVER = say("The run is over: disconnect to leave it")
NO_PAUSE = say("The rules of this benchmark do not allow a pause")
NO_DOUBT = say("The run is not in doubt after a restart")
PAUSED, NOT_PAUSED = say("The clock is paused"), say("The clock is not paused")
NO_PHASES = say("This benchmark has no phases")
FIRST_PHASE, LAST_PHASE = say("This is the first phase"), say("This is the last phase")
FIRST_EVENT, LAST_EVENT = say("This is the zone's first event"), say("This is the zone's last event")
OTHER_TEAM = say("The event is of team {team} now: choose it again")


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


class Start(ZoneAction):
    """Start the run, or continue it after a stop."""

    name = "start"
    off_without_run = NO_RUN

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        run = zone.run
        if run is None:
            return [NO_RUN]
        if not is_possible(run.phase, RunEvent.START):
            return [STARTED]
        if run.phase is Phase.ENDED and run.times.rules.restarts is Restarts.NOT_ALLOWED:
            return [NO_RESTART]
        reasons: List[str] = []
        if run.end_reason is EndReason.TIMEOUT:
            reasons.append(TIMED_OUT)
        elif run.clock.is_over(now):
            reasons.append(TIME_UP)
        return reasons + run.start_off(now)

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.start(now, by)


class StopRun(ZoneAction):
    """Stop the run. A call that names the run has a way of its own (`ScoreDesk.stop`)."""

    name = "stop"
    off_without_run = NOTHING_TO_STOP

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if zone.run is None:
            return [NOTHING_TO_STOP]
        if is_possible(zone.run.phase, RunEvent.END):
            return []
        if zone.run.phase is Phase.CONNECTED:
            return [NOT_STARTED]
        return [NO_ANSWER] if zone.run.ignores_stop(now) else [OVER]

    def refused(self, now: Now, zone: Zone, target: RunName, given: Given) -> List[str]:
        """Nothing to stop is no error where a run is connected: scripts for the original box rely on it."""
        return [] if zone.run is not None else self.off(now, zone, given)

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        if zone.run is not None and is_possible(zone.run.phase, RunEvent.END):
            zone.run.stop(now, by)


class Continue(ZoneAction):
    """Continue a run of which the box cannot know, after a restart, whether it was stopped."""

    name = "continue"
    off_without_run, shown_without_run = NO_DOUBT, False

    def shown(self, zone: Zone) -> bool:
        """See `ZoneAction`."""
        return zone.run is not None and zone.run.is_doubted

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return [] if zone.run is not None and zone.run.doubt(now) else [NO_DOUBT]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.continue_run(now, by)


class Pause(ZoneAction):
    """Pause the clock of the run, if its rules allow it."""

    name = "pause"

    def shown(self, zone: Zone) -> bool:
        """See `ZoneAction`."""
        return zone.event.benchmark.rules.pause and not _is_paused(zone)

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        if not zone.event.benchmark.rules.pause:
            return [NO_PAUSE]
        if zone.run is None or zone.run.phase is not Phase.RUNNING:
            return [NOT_RUNNING]
        return [PAUSED] if _is_paused(zone) else []

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.pause(now, True, by)


class ResumeClock(ZoneAction):
    """Let the clock of the run continue."""

    name = "resume"
    off_without_run, shown_without_run = NOT_PAUSED, False

    def shown(self, zone: Zone) -> bool:
        """See `ZoneAction`."""
        return _is_paused(zone)

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return [] if _is_paused(zone) else [NOT_PAUSED]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.pause(now, False, by)


class NextPhase(ZoneAction):
    """Go to the next phase of a task."""

    name = "next_phase"
    by = 1

    def shown(self, zone: Zone) -> bool:
        """See `ZoneAction`."""
        return bool(zone.event.benchmark.rules.phases)

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        phases = zone.event.benchmark.rules.phases
        if not phases:
            return [NO_PHASES]
        if zone.run is None or zone.run.phase is not Phase.RUNNING:
            return [NOT_RUNNING]
        if 1 <= zone.run.times.state.phase + self.by <= len(phases):
            return []
        return [LAST_PHASE] if self.by > 0 else [FIRST_PHASE]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.go_to_phase(now, zone.run.times.state.phase + self.by, by)


class PreviousPhase(NextPhase):
    """Go back to the phase before."""

    name = "previous_phase"
    by = -1


def _is_paused(zone: Zone) -> bool:
    return zone.run is not None and zone.run.times.state.paused


class Previous(ZoneAction):
    """Go to the event before."""

    name = "previous"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return _connected(zone) + ([FIRST_EVENT] if zone.at_first else [])

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        zone.move(-1)


class Next(ZoneAction):
    """Go to the next event."""

    name = "next"

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return _connected(zone) + ([LAST_EVENT] if zone.at_last else [])

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
