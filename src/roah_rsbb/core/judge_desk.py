"""Takes what judges and the head referee enter for a run with several judges, and objections to its result."""

from typing import Callable, List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.score_desk import (
    NAME_THE_RUN,
    STILL_CONNECTED,
    MarkOutcome,
    ScoreDesk,
    check_mark_id,
)
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName, checked_note, checked_who
from roah_rsbb.model.records import By, ItemRecord, JudgeSheet, RunRecord
from roah_rsbb.model.scoring import SheetForm
from roah_rsbb.scoring.book import FinishedRun, RunBook
from roah_rsbb.scoring.judges import ItemVerdict
from roah_rsbb.scoring.sheet import Mark


class RunJudging(NamedTuple):
    """What a judge or the head referee may see of a run's judges now."""

    record: RunRecord  # has the sheets of all judges: show those of others only if `is_complete`
    # Judges that the benchmark asks for; 0: it has no judges with sheets of their own.
    count: int  # type: ignore[assignment] # it hides tuple.count, which nobody calls
    agreement: str
    missing: int
    is_complete: bool
    verdicts: Tuple[ItemVerdict, ...]  # empty: not complete
    active: Tuple[JudgeSheet, ...]  # the sheets that were not withdrawn, by the judges' names
    own: Optional[JudgeSheet]
    own_items: Tuple[ItemRecord, ...]
    own_form: Optional[SheetForm]  # of these items


class JudgeDesk:
    """Takes what judges and the head referee enter. Each run is named by its identity. `Entries` checks and records it
    first."""

    def __init__(self, scores: ScoreDesk, outbox: Outbox) -> None:
        self._scores = scores
        self._outbox = outbox

    # -- looking ------------------------------------------------------------------------------------

    def judging(self, now: Now, name: RunName, judge: str = "") -> RunJudging:
        """Return the judging of a run, with the sheet of `judge` (empty: of nobody). Raises `Refused`."""
        return self._judging(now, self._scores.named(name), checked_who(judge))

    def unsigned(self, now: Now) -> List[RunJudging]:
        """Return the judging of all runs with judges, or with a published result, that are not signed off."""
        return [self._judging(now, run) for run in self._scores.unsigned()
                if run.book.judges.rule is not None or run.book.publication.state.published is not None]

    def _judging(self, now: Now, run: Union[ZoneRun, FinishedRun], judge: str = "") -> RunJudging:
        judges = run.book.judges
        rule = judges.rule
        has_own = rule is not None and bool(judge)
        return RunJudging(
            run.record if isinstance(run, FinishedRun) else run.record(now), 0 if rule is None else rule.count,
            "" if rule is None else rule.agreement.value, judges.missing(), judges.is_complete(), judges.verdicts(),
            judges.active(), judges.own_sheet(judge) if has_own else None, judges.own_items(judge) if has_own else (),
            judges.own_form(judge) if has_own else None,
        )

    # -- judges -------------------------------------------------------------------------------------

    def mark(self, now: Now, name: RunName, mark: Mark, judge: str) -> None:
        """Mark an item on a judge's own sheet, unless this mark was applied before. Raises `Refused`."""
        check_mark_id(mark.id)
        judge, note = checked_who(judge), checked_note(mark.note)
        marked = mark._replace(note=note, device=checked_who(mark.device), role="judge")
        if not self.is_applied(name, mark, judge):
            self._change(now, name, lambda book: _silent(book.judges.mark(now, judge, marked)))

    def is_applied(self, name: RunName, mark: Mark, judge: str) -> bool:
        """Whether a mark was applied before, which is no error even after the sign-off. Raises `Refused`."""
        return bool(name.identity) and self._scores.named(name).book.judges.is_applied(checked_who(judge), mark)

    def outcome(self, name: RunName, mark: Mark, judge: str) -> MarkOutcome:
        """Return the result of a mark that was applied. Raises `Refused`."""
        return MarkOutcome(*self._scores.named(name).book.judges.outcome(checked_who(judge), mark))

    def submit(self, now: Now, name: RunName, judge: str, device: str = "") -> None:
        """Submit a judge's sheet. Raises `Refused`."""
        named, device = checked_who(judge), checked_who(device)
        if not self._named(name).book.judges.is_submitted(named):
            self._change(now, name, lambda book: book.judges.submit(now, named, device))

    # -- the head referee ---------------------------------------------------------------------------

    def hand_back(self, now: Now, name: RunName, judge: str, reason: str, who: str = "") -> None:
        """Hand a judge's sheet back, so that the judge looks again. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.hand_back(now, by, checked_who(judge)))

    def withdraw(self, now: Now, name: RunName, judge: str, reason: str, who: str = "") -> None:
        """Withdraw a judge's sheet. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.withdraw(now, by, checked_who(judge)))

    def waive(self, now: Now, name: RunName, reason: str, who: str = "") -> None:
        """Do not wait for missing judges. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.waive(now, by))

    def settle(self, now: Now, name: RunName, mark: Mark, reason: str, who: str = "") -> None:
        """Settle an item with a value and a reason. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.settle(now, by, mark))

    # -- publication --------------------------------------------------------------------------------

    def publish(self, now: Now, name: RunName, seconds: float = -1.0, who: str = "") -> None:
        """Publish the result of a finished run as provisional. `seconds`: as in `Publication`. Raises `Refused`."""
        by = By(checked_who(who))
        self._check_over(name)
        self._change(now, name, lambda book: book.publication.publish(now, by, seconds))

    def object(self, now: Now, name: RunName, by: str, text: str, who: str = "") -> None:
        """Enter an objection. Raises `Refused`."""
        objector, objection = checked_who(by), checked_note(text)
        self._check_over(name)
        self._change(
            now, name, lambda book: book.publication.object(now, checked_who(who), objector, objection))

    def answer(self, now: Now, name: RunName, number: int, upheld: bool, text: str, who: str = "") -> None:
        """Answer an objection. Raises `Refused`."""
        by = By(checked_who(who), checked_note(text))
        self._check_over(name)
        self._change(now, name, lambda book: book.publication.answer(now, by, number, upheld))

    # -- inside -------------------------------------------------------------------------------------

    def _check_over(self, name: RunName) -> None:
        if not isinstance(self._named(name), FinishedRun):
            raise Refused([STILL_CONNECTED(run=name.identity)])

    def _named(self, name: RunName) -> Union[ZoneRun, FinishedRun]:
        if not name.identity:
            raise Refused([NAME_THE_RUN])
        return self._scores.named(name)

    def _change(self, now: Now, name: RunName, change: Callable[[RunBook], str]) -> None:
        run = self._named(name)
        text = run.change_book(now, change)
        if isinstance(run, FinishedRun):
            if text:
                self._scores.report_correction(run, text)
            else:
                self._outbox.emit(effects.RecordChanged(run.record))


def _silent(_item: ItemRecord) -> str:
    """Return no text for the log, because others must not read what a judge marks."""
    return ""
