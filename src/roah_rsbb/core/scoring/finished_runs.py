"""The runs that are over: their records, which the referee may still correct until they are signed off.

A run is over when it was started at least once and is then left (*disconnect*): before that it may be started
again and its score may change.
"""

from typing import Dict, Iterable, List, NamedTuple, Tuple

from roah_rsbb.core.clock import Now, clock_text
from roah_rsbb.core.referee import Refused
from roah_rsbb.core.runs.phases import EndReason
from roah_rsbb.core.runs.run_book import BookState, RunBook
from roah_rsbb.core.scoring.records import By, ItemRecord, RunRecord, ScoreValue, SignOff, StopRecord
from roah_rsbb.core.scoring.sheet import Mark, SheetState
from roah_rsbb.rulebook.benchmarks import Benchmark, Event, ScoreKind, ScoringItem

# More than a day of any competition.
MAX_KEPT = 100

_KINDS = {kind.name.lower(): kind for kind in ScoreKind}


class Result(NamedTuple):
    """What the public may be shown of a run that is over, and of those alone."""

    zone: str
    event: Event
    end_reason: str  # name of an `EndReason`, in lower case
    disconnected_utc: float  # UTC seconds of *disconnect*
    items: Tuple[ItemRecord, ...]  # the referee's score sheet
    module_scores: Tuple[ScoreValue, ...]  # what a benchmarking module scored


class FinishedRun:
    """A run that is over. Its score sheet has the items that it had then, whatever the benchmarks file says since."""

    def __init__(self, record: RunRecord, benchmark: Benchmark) -> None:
        self.record = record
        self._benchmark = benchmark
        self._book = RunBook(tuple(
            ScoringItem(item.group, item.desc, _KINDS.get(item.kind, ScoreKind.UINT)) for item in record.items
        ), over=True)
        self._book.restore(BookState(
            SheetState(record.history), record.stops, record.started_utc, record.elapsed_s
        ))
        self.result = self._result()

    def mark(self, now: Now, who: str, mark: Mark) -> str:
        """Correct a scoring item. Returns a text for the referee, as all corrections do; raises `Refused`."""
        self._check_open()
        return self._changed(self._book.mark(now, who, mark).text)

    def withdraw_score(self, now: Now, by: By, number: int) -> str:
        """An entry of the score sheet counts no more; raises `Refused`."""
        self._check_open()
        return self._changed(self._book.withdraw(now, by, number).text)

    def give_stop_reason(self, _now: Now, by: By, number: int) -> str:
        """See `RunBook.give_reason`; raises `Refused`."""
        self._check_open()
        return self._changed(self._book.give_reason(number, by))

    def sign_off(self, now: Now, who: str) -> str:
        """The score sheet is final from now on; raises `Refused` if it was already."""
        self._check_open()
        self.record = self.record._replace(sign_off=SignOff(now.utc, who))
        return f"Score sheet signed off by {who}"

    def _check_open(self) -> None:
        signed = self.record.sign_off
        if signed is not None:
            raise Refused([
                f"the score sheet of run {self.record.identity} was signed off by {signed.who or 'somebody'} at "
                f"{clock_text(signed.utc)}: it is final, an objection goes to the technical committee"
            ])

    def _changed(self, text: str) -> str:
        self.record = self._book.into(self.record)
        self.result = self._result()
        return text

    def _result(self) -> Result:
        record = self.record
        event = Event(self._benchmark, record.team, record.round, record.run, record.scheduled)
        return Result(
            record.zone, event, record.end_reason, record.closed_utc, record.items, record.module_scores
        )


def left_behind(record: RunRecord, utc: float) -> RunRecord:
    """The record of a run that was going on when the core ended, at `utc`, and does not go on after that."""
    record = record._replace(closed_utc=utc)
    if not record.started_utc or record.end_reason:
        return record
    stop = StopRecord(utc, "", EndReason.STOPPED.name.lower(), "The run did not go on after a restart of the core")
    return record._replace(end_reason=stop.end_reason, stops=(*record.stops, stop))


class FinishedRuns:
    """The newest runs that are over."""

    def __init__(self, benchmarks: Dict[str, Benchmark]) -> None:
        """`benchmarks`: what is known of each, by its code."""
        self._benchmarks = benchmarks
        self._runs: Dict[str, FinishedRun] = {}  # by identity, the oldest first

    def add(self, record: RunRecord) -> None:
        """Keep a run that was left just now, unless it was never started; the oldest one goes if need be."""
        if not record.end_reason:
            return
        benchmark = self._benchmarks.get(record.benchmark)
        if benchmark is None:  # a record of a competition whose configuration was changed since
            benchmark = Benchmark(record.benchmark, record.benchmark, "", 0.0, 0.0, ())
        self._runs.pop(record.identity, None)
        self._runs[record.identity] = FinishedRun(record, benchmark)
        while len(self._runs) > MAX_KEPT:
            del self._runs[next(iter(self._runs))]

    def restore(self, records: Iterable[RunRecord]) -> None:
        """After a restart: the records of all runs that were left, in any order."""
        for record in sorted(records, key=lambda record: record.closed_utc):
            if record.closed_utc:
                self.add(record)

    def find(self, identity: str) -> FinishedRun:
        """The run of that identity; raises `Refused`."""
        run = self._runs.get(identity)
        if run is None:
            raise Refused([
                f"no run '{identity}' was started and is over, or it is not one of the newest {MAX_KEPT}: see 'rosrun "
                "roah_rsbb results'"
            ])
        return run

    def records(self) -> List[RunRecord]:
        """The records of all runs kept, the one that was left last first."""
        return [run.record for run in reversed(self._runs.values())]

    def newest(self, count: int = MAX_KEPT) -> Tuple[Result, ...]:
        """So many results, the one that was left last first; of a run that was repeated, the last one alone."""
        results: Dict[Tuple[str, Event], Result] = {}
        for run in reversed(self._runs.values()):
            results.setdefault((run.result.zone, run.result.event), run.result)
        return tuple(results.values())[:count]
