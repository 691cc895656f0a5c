"""The runs that are over, as plain values: what the public may be shown of them, and of them alone.

A run is over when it was started at least once and is then left (*disconnect*): before that it may be started
again and its score may change.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.core.benchmarks import Event
from roah_rsbb.core.clock import Now
from roah_rsbb.core.functionality import FunctionalityRun
from roah_rsbb.core.module_messages import ScoreValue
from roah_rsbb.core.run import EndReason
from roah_rsbb.core.scoring import ScoreGroup
from roah_rsbb.core.zone_run import ZoneRun

# More than a day of any competition.
MAX_KEPT = 100


class FinishedRun(NamedTuple):
    """A run that is over."""

    zone: str
    event: Event
    end_reason: EndReason
    disconnected_utc: float  # UTC seconds of *disconnect*
    scoring: Tuple[ScoreGroup, ...]  # the referee's score sheet
    module_scores: Tuple[ScoreValue, ...]  # what a benchmarking module scored


def finished_run(now: Now, zone: str, run: ZoneRun) -> Optional[FinishedRun]:
    """What remains of a run that was closed just now; None: it was never started."""
    if run.end_reason is None:
        return None
    module_scores = run.scores if isinstance(run, FunctionalityRun) else ()
    return FinishedRun(zone, run.event, run.end_reason, now.utc, tuple(run.sheet.groups()), module_scores)


class FinishedRuns:
    """The newest runs that are over, one for each event of a zone: a run that is repeated replaces the one before."""

    def __init__(self) -> None:
        self._runs: Dict[Tuple[str, Event], FinishedRun] = {}  # the oldest first

    def add(self, run: FinishedRun) -> None:
        """Keep a run; the oldest one goes where there are too many."""
        self._runs.pop((run.zone, run.event), None)
        self._runs[run.zone, run.event] = run
        while len(self._runs) > MAX_KEPT:
            del self._runs[next(iter(self._runs))]

    def newest(self, count: int = MAX_KEPT) -> Tuple[FinishedRun, ...]:
        """So many of them, the one that was added last first."""
        return tuple(self._runs.values())[::-1][:count]
