"""What is written down of a run, as it is now: its score sheet, its starts and ends, and why it was stopped.

A run in progress has such a book, and so has one that is over (`roah_rsbb.core.scoring.finished_runs`): then each
change of it is a correction.
"""

from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.core.clock import Now
from roah_rsbb.core.referee import Refused
from roah_rsbb.core.scoring.records import By, ItemRecord, RunRecord, StopRecord
from roah_rsbb.core.scoring.sheet import Mark, ScoreSheet, SheetState, score_text, standing_text
from roah_rsbb.rulebook.benchmarks import ScoringItem

# More stops than that are none of a referee; then the oldest one goes that has no reason typed.
MAX_STOPS = 100


class BookState(NamedTuple):
    """The saved state of a book; see its attributes."""

    sheet: SheetState = SheetState()
    stops: Tuple[StopRecord, ...] = ()
    started_utc: float = 0.0
    elapsed_s: float = 0.0


class Marked(NamedTuple):
    """What came of a change of the score sheet."""

    item: Optional[ItemRecord]  # as it stands now; None: the benchmarks file has it no more
    text: str  # for the referee


class RunBook:
    """The book of one run."""

    def __init__(self, items: Tuple[ScoringItem, ...], over: bool = False) -> None:
        """`over`: the run is over, changes are corrections."""
        self.sheet = ScoreSheet(items)
        self.stops: List[StopRecord] = []
        self.started_utc = 0.0  # UTC seconds of the last start; 0.0: there was none
        self.elapsed_s = 0.0  # seconds that counted from the last start to its end; 0.0: not ended
        self._over = over

    def saved(self) -> BookState:
        """The state for the journal."""
        return BookState(self.sheet.saved(), tuple(self.stops), self.started_utc, self.elapsed_s)

    def restore(self, state: BookState) -> None:
        """Take back what was saved."""
        self.sheet.restore(state.sheet)
        self.stops = list(state.stops)
        self.started_utc, self.elapsed_s = state.started_utc, state.elapsed_s

    # -- starts and ends ----------------------------------------------------------------------------

    def started(self, now: Now) -> None:
        """The run was started, perhaps again."""
        self.started_utc, self.elapsed_s = now.utc, 0.0

    def ended(self, now: Now, end_reason: str, desc: str, by: By, elapsed_s: float) -> None:
        """The run ended, `elapsed_s` seconds that count after its start."""
        self.elapsed_s = elapsed_s
        reason_by = by.who if by.reason else ""
        self.stops.append(StopRecord(now.utc, by.who, end_reason, desc, by.reason, reason_by))
        if len(self.stops) > MAX_STOPS:
            del self.stops[next((i for i, stop in enumerate(self.stops) if not stop.reason), 0)]

    def give_reason(self, number: int, by: By) -> str:
        """Say why the run was stopped: `number` counts its ends from 1, 0 is the last one.

        A reason that was typed before is replaced. Returns a text for the referee; raises `Refused`.
        """
        if not self.stops:
            raise Refused(["the run was not stopped yet: there is nothing to give a reason for"])
        if not 0 <= number <= len(self.stops):
            raise Refused([f"the run has no stop {number}: there is 1 to {len(self.stops)}, or 0 for the last one"])
        index = (number or len(self.stops)) - 1
        stop = self.stops[index]
        self.stops[index] = stop._replace(reason=by.reason, reason_by=by.who)
        return f"{stop.desc}: {by.reason or 'no reason'}"

    # -- scores -------------------------------------------------------------------------------------

    def mark(self, now: Now, who: str, mark: Mark) -> Marked:
        """See `ScoreSheet.set`."""
        before = self.sheet.set(now, who, mark, self._over)
        return self._marked(before, self.sheet.item(mark.group, mark.desc), mark.note)

    def withdraw(self, now: Now, by: By, number: int) -> Marked:
        """See `ScoreSheet.withdraw`."""
        standing = {(item.group, item.desc): item for item in self.sheet.items()}
        entry = self.sheet.withdraw(now, by.who, number, by.reason, self._over)
        note = f"entry {number} withdrawn{', ' if by.reason else ''}{by.reason}"
        before = standing.get((entry.group, entry.desc))
        if before is None:
            return Marked(None, f"Score: {entry.group}: {entry.desc} ({note})")
        return self._marked(before, self.sheet.item(entry.group, entry.desc), note)

    def _marked(self, before: ItemRecord, after: ItemRecord, note: str) -> Marked:
        texts = [standing_text(item.value, item.not_attempted) for item in (before, after)]
        text = score_text(after.group, after.desc, *texts)
        return Marked(after, ("Correction: " if self._over else "") + text + (f" ({note})" if note else ""))

    # -- the record ---------------------------------------------------------------------------------

    def into(self, record: RunRecord) -> RunRecord:
        """The record with what stands in this book."""
        return record._replace(
            items=self.sheet.items(), history=self.sheet.history, stops=tuple(self.stops),
            started_utc=self.started_utc, elapsed_s=self.elapsed_s,
        )
