"""A zone: a group of scheduled events, the current one, and its run (docs/organiser.md, "schedule.yaml")."""

from typing import NamedTuple, Optional

from roah_rsbb.core.runs.phases import EndReason
from roah_rsbb.core.runs.zone_run import ZoneRun
from roah_rsbb.rulebook.benchmarks import Event, ZonePlan


class LastRun(NamedTuple):
    """What a zone still shows of the run that was left last."""

    end_reason: Optional[EndReason]  # None: it was never started
    log: str
    online_data: str


class Zone:
    """One zone. Its schedule is in the order of the scheduled times."""

    def __init__(self, plan: ZonePlan) -> None:
        self.name = plan.name
        self.events = plan.events
        self.index = 0
        self.run: Optional[ZoneRun] = None
        self.last_run: Optional[LastRun] = None  # until the zone shows another event

    @property
    def event(self) -> Event:
        """The event that the zone is at."""
        return self.events[self.index]

    @property
    def at_first(self) -> bool:
        """Whether there is no previous event."""
        return self.index == 0

    @property
    def at_last(self) -> bool:
        """Whether there is no next event."""
        return self.index == len(self.events) - 1

    def move(self, by: int) -> None:
        """Go to another event of the schedule; the log of the last run is that of another event then."""
        self.index += by
        self.last_run = None

    def leave(self, auto_next: bool) -> None:
        """The run is over and disconnected; after one that was completed the next event follows."""
        run, self.run = self.run, None
        assert run is not None, "there is a run to leave"
        self.last_run = LastRun(run.end_reason, run.log.text, run.online_data.text)
        if auto_next and run.end_reason is EndReason.COMPLETED and not self.at_last:
            self.move(1)
