"""A run without a robot: the referee scores by hand, and alone starts and stops the clock.

It is for robots that do not speak with the box, and for teams that do not appear. It has no private channel and no run
log. The journal has its record.
"""

from typing import List, Optional, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.runs.machine import RunEvent
from roah_rsbb.core.runs.run import Run, RunContext, UnrecordedStop, ZoneRun, ZoneRunState, identity_of
from roah_rsbb.core.runs.times import CountdownState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import NOBODY, By, EndReason, Phase
from roah_rsbb.rulebook.benchmarks import ScheduledEvent
from roah_rsbb.scoring.book import BookState

OPENED, STARTED = say("Score sheet opened without a robot"), say("Started by the referee")
BY_HAND = say("Without a robot: only the referee starts and stops the clock")


class HandRun(ZoneRun):
    """See `ZoneRun`."""

    state: ZoneRunState

    def __init__(
        self, now: Now, zone: str, event: ScheduledEvent, context: RunContext, port: int = 0,
        state: Optional[ZoneRunState] = None,
    ) -> None:
        """`port`: a port that no run uses, for the identity. `state`: of a run that continues after a restart."""
        super().__init__(zone, event, context, state or ZoneRunState(
            identity_of(event, port, now), now.utc, Phase.CONNECTED, None, "", CountdownState(), BookState()))

    def open(self, now: Now) -> None:
        """Begin a new run."""
        self._emit(effects.SheetOpened(self.record(now)))
        self.times.connected(now)
        self._describe(now, OPENED)
        self._record_changed(now)

    def members(self) -> Tuple[Run, ...]:
        """See `ZoneRun`: it has no robots."""
        return ()

    def without(self, member: Run) -> "HandRun":
        """See `ZoneRun`."""
        return self

    # -- the referee's commands -----------------------------------------------------------------------

    def start(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self.clock.start(now)
        self._enter(RunEvent.START)
        self._note_start(now, by)
        self._describe(now, STARTED)

    def stop(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self._end(now, EndReason.STOPPED, by)

    def take_stop(self, sent: UnrecordedStop) -> None:
        """See `ZoneRun`."""
        self._end(sent.at, sent.reason, sent.by)

    def close(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self._note_close(now, by)

    def _end(self, now: Now, reason: EndReason, by: By = NOBODY) -> None:
        self._enter(RunEvent.END, reason)
        self.clock.stop(now)
        self._note_end(now, reason.value, by)
        self._describe(now, reason.value)

    # -- time -----------------------------------------------------------------------------------------

    def deadline(self) -> Optional[float]:
        """See `ZoneRun`."""
        found = (self.times.deadline(), self.clock.deadline() if self.phase is Phase.RUNNING else None)
        return min((t for t in found if t is not None), default=None)

    def tick(self, now: Now) -> None:
        """See `ZoneRun`."""
        self._tick_times(now)
        if self.phase is Phase.RUNNING and self.clock.is_over(now):
            self._end(now, EndReason.TIMEOUT)
            self._emit(effects.TimeoutRung(self.zone))

    # -- for the referee ------------------------------------------------------------------------------

    def start_off(self, now: Now) -> List[str]:
        """See `ZoneRun`."""
        return []

    def warnings(self, now: Now) -> List[str]:
        """See `ZoneRun`."""
        return []

    def status_lines(self, now: Now) -> List[str]:
        """See `ZoneRun`."""
        return [BY_HAND]

    def _robot_names(self) -> Tuple[str, ...]:
        return ()
