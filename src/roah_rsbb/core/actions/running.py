"""The clock of a run: start, stop, pause, phases."""

from typing import List

from roah_rsbb.core.actions.base import Given, ZoneAction
from roah_rsbb.core.runs.phases import RunEvent, is_possible
from roah_rsbb.core.zones import NO_RUN, NOTHING_TO_STOP, Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import RunName, say
from roah_rsbb.model.records import By, EndReason, Phase
from roah_rsbb.rulebook.benchmarks import Restarts

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
FIRST, LAST = say("This is the first phase"), say("This is the last phase")


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
        zone.run.start(now)


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
        zone.run.continue_run(now)


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
        zone.run.pause(now, True)


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
        zone.run.pause(now, False)


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
        return [LAST] if self.by > 0 else [FIRST]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        assert zone.run is not None, "it was checked before"
        zone.run.go_to_phase(now, zone.run.times.state.phase + self.by)


class PreviousPhase(NextPhase):
    """Go back to the phase before."""

    name = "previous_phase"
    by = -1


def _is_paused(zone: Zone) -> bool:
    return zone.run is not None and zone.run.times.state.paused
