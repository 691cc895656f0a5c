"""What the public may see of the box at one moment, as plain values.

It contains only what the organisers allow. Everything else stays in the core.
"""

import enum
from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.scoring.book import FinishedResult
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.rulebook.benchmarks import ScheduledEvent

# No screen has space for more.
MAX_FOLLOWING = 40
MAX_FINISHED = 40


class PublicResults(enum.Enum):
    """What the organisers show the public of ended runs."""

    NONE = "none"
    OUTCOMES = "outcomes"  # how each run ended
    SCORES = "scores"  # also its scores


class PublicRun(NamedTuple):
    """The run in a zone."""

    zone: str
    event: ScheduledEvent
    phase: Phase
    end_reason: Optional[EndReason]  # None: it has not ended, or the public may not see this
    teams: Tuple[str, ...]  # the teams of all robots in it
    counting: bool  # its clock is running
    left: float  # seconds left; may be `NO_LIMIT`
    elapsed: float = 0.0  # seconds counted
    activity: str = ""  # the current phase of the task; empty: none


class Following(NamedTuple):
    """An event that has not begun."""

    zone: str
    event: ScheduledEvent


class PublicView(NamedTuple):
    """Everything that the public may see."""

    results: PublicResults
    runs: Tuple[PublicRun, ...]  # in the order of the zones
    following: Tuple[Following, ...]  # the soonest first
    finished: Tuple[FinishedResult, ...]  # whose score sheet is signed off, the newest first
    provisional: Tuple[FinishedResult, ...]  # whose score sheet is not, if the organisers show them; the newest first

    def without_time(self) -> "PublicView":
        """Return the view without its times. It only changes when something happens."""
        return self._replace(runs=tuple(run._replace(left=0.0, elapsed=0.0) for run in self.runs))


def public_view(box: Box, now: Now, results: PublicResults, provisional: bool = False) -> PublicView:
    """Return what the public may see now. `provisional`: also results whose score sheet is not signed off."""
    following = [line for zone in box.zones.values() for line in _following(box, zone)]
    following.sort(key=lambda line: line.event.scheduled)
    signed, unsigned = ([], []) if results is PublicResults.NONE else _results(box, now)
    return PublicView(
        results,
        tuple(_run(zone.name, zone.run, now, results) for zone in box.zones.values() if zone.run is not None),
        tuple(following[:MAX_FOLLOWING]),
        _allowed(signed, results),
        _allowed(unsigned if provisional else [], results),
    )


def _results(box: Box, now: Now) -> Tuple[List[FinishedResult], List[FinishedResult]]:
    """Return the results that are signed off, and the others: the runs that count, or of an event without any the last
    one; the newest first."""
    shown = {ruling.record.identity for result in box.scores.event_results(now) for ruling in result.runs}
    found = [run.result for run in box.finished.newest_runs() if run.record.identity in shown]
    return [run for run in found if run.signed], [run for run in found if not run.signed]


def _run(zone: str, run: ZoneRun, now: Now, results: PublicResults) -> PublicRun:
    return PublicRun(
        zone, run.event, run.phase,
        end_reason=None if results is PublicResults.NONE else run.end_reason,
        teams=tuple(dict.fromkeys(member.robot.team for member in run.members())) or (run.event.team,),
        counting=run.phase is Phase.RUNNING and not run.clock.paused,
        left=run.clock.left(now),
        elapsed=run.clock.elapsed(now),
        activity=run.times.phase_name(),
    )


def _following(box: Box, zone: Zone) -> List[Following]:
    """Return a zone's coming events. Events whose run is connected or was completed, or whose team withdrew or did not
    appear, are not among them."""
    over = box.scores.events_over()
    first = zone.index + (zone.run is not None)
    return [Following(zone.name, zone.events[place]) for place in range(first, len(zone.events))
            if (zone.name, place) not in over]


def _allowed(runs: List[FinishedResult], results: PublicResults) -> Tuple[FinishedResult, ...]:
    """Return the newest runs, without scores if the public may not see them."""
    if results is PublicResults.SCORES:
        return tuple(runs[:MAX_FINISHED])
    return tuple(run._replace(items=(), module_scores=(), points=None) for run in runs[:MAX_FINISHED])
