"""The book of a run (score sheet, starts, ends, reasons of stops), and the books of finished runs.

A run is finished when it was started at least once, or ended as a no-show or by a withdrawal, and was then left
(*disconnect*). Before that, it can be started again, and its score can change. The referee may correct a finished run
until it is signed off; each such change is a correction.
"""

import itertools
import re
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.model.records import (
    ANNULLED,
    MOVED,
    NO_MARKS,
    NOT_RUN,
    REOPENED,
    By,
    CaptainSign,
    EndReason,
    ItemRecord,
    JudgingRecord,
    Occurred,
    Outage,
    Proposal,
    PublicationRecord,
    RunChange,
    RunRecord,
    ScoreEntry,
    SheetVersion,
    SignOff,
    Slot,
    StopRecord,
    TimelineEntry,
)
from roah_rsbb.model.scoring import INCIDENTS, ScoreKind, ScoringItem, SheetForm
from roah_rsbb.rulebook.benchmarks import Benchmark, EventRules
from roah_rsbb.rulebook.standing_rules import StandingRules
from roah_rsbb.scoring.earlier import id_of, modern, sheet_of
from roah_rsbb.scoring.judges import ItemVerdict, Judges, JudgesState
from roah_rsbb.scoring.points import CountedSheet, counted
from roah_rsbb.scoring.publication import Publication, PublicationState
from roah_rsbb.scoring.sheet import Mark, ScoreSheet, SheetState, score_text, value_text
from roah_rsbb.scoring.tree import Course
from roah_rsbb.wording import sheets, times

# No referee stops a run more often. After more stops, the oldest one without a typed reason is dropped.
MAX_STOPS = 100
NO_RANKING = StandingRules()
# The newest runs can be corrected and signed off. Of earlier ones, the box keeps only what decides what counts.
MAX_KEPT = 400

# Notes of a run, and other entries of its timeline.
MAX_NOTES, MAX_HAPPENED = 100, 200
# Signatures of the captain that are kept, and the lines of one.
MAX_SIGNS = 5
_DRAWING = re.compile(r"(?:M\d{1,3} \d{1,3}(?:L\d{1,3} \d{1,3})*)*")
# Marks that arrived after the sign-off.
MAX_PROPOSALS = 100
NOTE = Occurred.NOTE.name.lower()
# What waited for so long (ms) had no link to the box: its own moment counts. Two messages of a device take times to
# arrive that differ by less than this (s).
WAITED_MS, UNSURE_S = 1000, 2.0
# Entries of the timeline from which on the run's clock counts, and those from which on it does not.
_PAUSES = (Occurred.PAUSE.name.lower(),)
_CLOCK = (*_PAUSES, *(each.name.lower() for each in (Occurred.START, Occurred.CONTINUE, Occurred.RESUME)))

_NOT_RUN = tuple(reason.name.lower() for reason in NOT_RUN)
_NO_JUDGING, _NO_PUBLICATION = JudgingRecord(), PublicationRecord()
_KINDS = {kind.word: kind for kind in ScoreKind}


@dataclass
class BookState:
    """The content of a run's book."""

    sheet: SheetState = field(default_factory=SheetState)
    stops: List[StopRecord] = field(default_factory=list)
    started_utc: float = 0.0  # UTC seconds of the last start; 0.0: never started
    elapsed_s: float = 0.0  # counted seconds from the last start to its end; 0.0: not ended
    judging: JudgesState = field(default_factory=JudgesState)
    publication: PublicationState = field(default_factory=PublicationState)
    outages: List[Outage] = field(default_factory=list)
    timeline: List[TimelineEntry] = field(default_factory=list)
    proposals: List[Proposal] = field(default_factory=list)


class Note(NamedTuple):
    """A note of a moment."""

    text: str = ""
    number: int = 0  # of the note whose text is entered; 0: a new one, or that of `id`
    id: str = ""  # identity of the note; empty: it has none
    role: str = ""  # of who notes it
    device: str = ""  # from which it was sent
    ago_ms: int = 0  # it was made so long before it arrived


class MadeAt(NamedTuple):
    """When a mark or a note was made."""

    now: Now
    clock_s: Optional[float]  # counted seconds of the run; None: it was not started
    arrived_utc: float = 0.0  # UTC seconds, if it had waited; 0.0: it had not


class Marked(NamedTuple):
    """The result of a change of the score sheet."""

    item: Optional[ItemRecord]  # after the change; None: no longer in the benchmarks file
    text: str  # for the referee; empty: nothing changed, because the mark was applied before


class RunBook:
    """The book of one run."""

    def __init__(
        self, form: SheetForm, state: Optional[BookState] = None, over: bool = False
    ) -> None:
        """`over`: the run is over, so changes are corrections."""
        self.state = state or BookState()
        self.form = form
        self.rules = sheet_of(form)
        self.sheet = ScoreSheet(form.items, self.state.sheet, self.rules)
        self.judges = Judges(form, self.state.judging)
        self.publication = Publication(form, self.state.publication)
        self._over = over
        self._counted: Optional[Tuple[Tuple[ItemRecord, ...], float, str, CountedSheet]] = None

    # -- starts and ends ----------------------------------------------------------------------------

    def started(self, now: Now) -> None:
        """Note a start or restart of the run."""
        self.state.started_utc, self.state.elapsed_s = now.utc, 0.0

    def ended(self, now: Now, end_reason: str, desc: str, by: By, elapsed_s: float) -> None:
        """Note that the run ended, after `elapsed_s` counted seconds."""
        self.state.elapsed_s = elapsed_s
        reason_by = by.who if by.reason else ""
        stops = self.state.stops
        stops.append(StopRecord(now.utc, by.who, end_reason, desc, by.reason, reason_by, round(elapsed_s, 3)))
        for row, incident in ((row, incident) for row in self.form.items for incident in self.rules.incidents):
            if (row.group, row.id) == (INCIDENTS, incident.name) and end_reason in incident.at_end:
                self.sheet.set(now, by.who, Mark(*row.key, added="1"), self._over, elapsed_s)
        if len(stops) > MAX_STOPS:
            del stops[next((i for i, stop in enumerate(stops) if not stop.reason), 0)]

    def give_reason(self, number: int, by: By) -> str:
        """Set why the run was stopped. `number` counts its ends from 1; 0 is the last one.

        The new reason replaces an earlier one. Returns a text for the referee. Raises `Refused`.
        """
        stops = self.state.stops
        if not stops:
            raise Refused([say("the run was not stopped yet, so it cannot have a reason")])
        if not 0 <= number <= len(stops):
            raise Refused([say("the run has no stop {number}: choose from 1 to {count}, or 0 for the last one")(
                number=number, count=len(stops))])
        index = (number or len(stops)) - 1
        stop = stops[index]
        stops[index] = stop._replace(reason=by.reason, reason_by=by.who)
        return f"{stop.desc}: {by.reason or 'no reason'}"

    # -- timeline -----------------------------------------------------------------------------------

    def happened(self, now: Now, what: Occurred, clock_s: Optional[float], who: str = "", text: str = "") -> None:
        """Note what happened, besides marks and ends. Of too many, the oldest that is no note is dropped."""
        found = self.state.timeline
        found.append(TimelineEntry(self._next_number(), what.name.lower(), now.utc, _rounded(clock_s), who, text))
        if sum(entry.kind != NOTE for entry in found) > MAX_HAPPENED:
            del found[next(place for place, entry in enumerate(found) if entry.kind != NOTE)]

    def made(self, now: Now, ago_ms: int, device: str, opened_utc: float, clock_s: Optional[float]) -> MadeAt:
        """Return when something was made that arrives now, `ago_ms` later. `clock_s`: counted seconds of the run in
        progress; None: it is not.

        A moment that cannot be true, before the run or before what its device made earlier, is not believed.
        """
        counted_s = self._clock_s(now) if clock_s is None else clock_s
        utc = now.utc - ago_ms / 1000
        earlier = [(each.utc, each.device) for each in self.sheet.history]
        earlier += [(each.utc, each.device) for each in self.state.timeline]
        since = max([opened_utc, *(utc for utc, of in earlier if device and of == device)])
        if ago_ms < WAITED_MS or utc < since - UNSURE_S:
            return MadeAt(now, counted_s)
        utc = max(utc, since)
        return MadeAt(now._replace(utc=utc), self._counted_at(utc, counted_s), now.utc)

    def _counted_at(self, utc: float, now_s: float) -> float:
        """Return the counted seconds of the run at an earlier moment; `now_s`: those of now."""
        known = sorted([
            *((each.utc, each.clock_s or 0.0, each.kind not in _PAUSES) for each in self.state.timeline
              if each.kind in _CLOCK), *((stop.utc, stop.clock_s or 0.0, False) for stop in self.state.stops)])
        before = [each for each in known if each[0] <= utc]
        if not before:
            return 0.0 if known else now_s
        since, seconds, is_counting = before[-1]
        if self.state.elapsed_s and since == self.state.stops[-1].utc:
            return min(now_s, self._clock_s(Now(0.0, utc)))  # which may be late
        seconds += utc - since if is_counting else 0.0
        return min([now_s, seconds, *(each[1] for each in known if each[0] > utc)])

    def note(self, now: Now, who: str, note: Note, clock_s: Optional[float] = None, opened_utc: float = 0.0) -> str:
        """Note a moment, or enter the text of a note that was made before. See `mark`. Returns a text for the referee;
        empty: nothing changed. Raises `Refused`."""
        place = self._place_of(note)
        if place is None:
            if sum(entry.kind == NOTE for entry in self.state.timeline) >= MAX_NOTES:
                raise Refused([say("the run has {most} notes, which is the most")(most=MAX_NOTES)])
            made = self.made(now, note.ago_ms, note.device, opened_utc, clock_s)
            counted_s = _rounded(made.clock_s) if self.state.started_utc else None
            self.state.timeline.append(TimelineEntry(
                self._next_number(), NOTE, made.now.utc, counted_s, who, note.text, note.role, note.device, note.id,
                arrived_utc=made.arrived_utc))
            return f"Note: {note.text}" if note.text else "Noted this moment"
        before = self.state.timeline[place]
        # The note itself may arrive again after its text.
        if note.text == before.text or not (note.text or note.number):
            return ""
        self.state.timeline[place] = before._replace(text=note.text, changed_utc=now.utc, changed_by=who)
        return f"Note {before.number}: {note.text}"

    def is_noted(self, note: Note) -> bool:
        """Whether a note changes nothing, because it was made before."""
        place = self._place_of(note)
        return place is not None and self.state.timeline[place].text == note.text

    def _place_of(self, note: Note) -> Optional[int]:
        """Return the place of the note that is meant; None: a new one. Raises `Refused`."""
        for place, entry in enumerate(self.state.timeline):
            if entry.kind == NOTE and (entry.number == note.number if note.number else note.id and entry.id == note.id):
                return place
        if note.number:
            raise Refused([say("the run has no note {number}")(number=note.number)])
        return None

    def _next_number(self) -> int:
        return 1 + max((entry.number for entry in self.state.timeline), default=0)

    # -- scores -------------------------------------------------------------------------------------

    def mark(
        self, now: Now, who: str, mark: Mark, clock_s: Optional[float] = None, opened_utc: float = 0.0,
        end_reason: str = "", closed_utc: float = 0.0,
    ) -> Marked:
        """See `ScoreSheet.set`. `clock_s`: counted seconds of the run in progress; None: it is not. `opened_utc`: of
        *connect*. `end_reason`: name of an `EndReason`; empty: the run has not ended. `closed_utc`: of *disconnect*,
        from which on marks are corrections."""
        if self.sheet.is_applied(mark):
            return Marked(None, "")
        self._check_not_judged()
        points, made = self._total(end_reason), self.made(now, mark.ago_ms, mark.device, opened_utc, clock_s)
        before = self.sheet.set(
            made.now, who, mark, self._over and made.now.utc >= closed_utc, made.clock_s, made.arrived_utc)
        self.sheet.give(self._total(end_reason) - points)
        return self._marked(before, self.sheet.item(mark.group, mark.desc), mark.note)

    def propose(self, now: Now, who: str, mark: Mark, opened_utc: float) -> Marked:
        """Keep a mark that was made before the sign-off and arrives after it. Raises `Refused`."""
        self._check_not_judged()
        checked, made = self.sheet.check(mark), self.made(now, mark.ago_ms, mark.device, opened_utc, None)
        if len(self.state.proposals) >= MAX_PROPOSALS:
            raise Refused([say("{most} marks that came after the sign-off are proposed, which is the most")(
                most=MAX_PROPOSALS)])
        before = self.sheet.item(mark.group, mark.desc)
        entry = ScoreEntry(
            0, made.now.utc, who, mark.group, mark.desc, before.value, checked.value, checked.not_attempted,
            checked.note, before.not_attempted, old_text=before.text, text=checked.text, judge=checked.judge,
            added=checked.added, role=checked.role, device=checked.device, clock_s=_rounded(made.clock_s),
            arrived_utc=now.utc)
        self.state.proposals.append(Proposal(len(self.state.proposals) + 1, entry, mark.id))
        return Marked(before, f"Proposed after the sign-off: {mark.group}: {mark.desc}")

    def propose_taking_back(self, now: Now, by: By, mark_id: str, ago_ms: int) -> str:
        """Keep that a mark was taken back before the sign-off, which arrives after it. One that is only proposed is
        dropped. Returns a text for the referee; empty: it was taken back before. Raises `Refused`."""
        for each in self.state.proposals:
            if each.mark_id == mark_id:
                return "" if each.decided_utc else self.decide(
                    now, by._replace(reason="taken back"), each.number, False, "")
        found = replace(self.state.sheet, history=list(self.sheet.history))
        entry = ScoreSheet(self.form.items, found, self.rules).take_back(now, by.who, mark_id)  # whether it could be
        if entry is None or any(each.takes_back == entry.number for each in self.state.proposals):
            return ""
        undone = entry._replace(
            number=0, utc=now.utc - ago_ms / 1000, who=by.who, old=entry.value, value=entry.old, old_text=entry.text,
            text=entry.old_text, old_not_attempted=entry.not_attempted, not_attempted=entry.old_not_attempted,
            points="", note=by.reason, arrived_utc=now.utc, clock_s=None, in_time=False, in_time_by="", void="",
            withdrawn_utc=0.0, withdrawn_by="", withdrawn_note="", withdrawal_corrects=False)
        self.state.proposals.append(Proposal(len(self.state.proposals) + 1, undone, "", takes_back=entry.number))
        return f"Proposed after the sign-off: to take entry {entry.number} back: {entry.group}: {entry.desc}"

    def is_proposed(self, mark_id: str) -> bool:
        """Whether a mark arrived after the sign-off."""
        return any(each.mark_id == mark_id for each in self.state.proposals)

    def decide(self, now: Now, by: By, number: int, accept: bool, end_reason: str) -> str:
        """Accept or drop a mark that arrived after the sign-off. Returns a text for the referee. Raises `Refused`."""
        if not 1 <= number <= len(self.state.proposals):
            raise Refused([say("the run has no proposed mark {number}")(number=number)])
        found = self.state.proposals[number - 1]
        if found.decided_utc:
            raise Refused([say("{who} has decided on the proposed mark {number} already")(
                who=sheets.person(found.decided_by) or "somebody", number=number)])
        entry, text = found.entry, "dropped"
        if accept and found.takes_back:
            self.withdraw(now, By(entry.who, entry.note), found.takes_back)
            text = "accepted"
        elif accept:
            mark = Mark(**{name: getattr(entry, name) for name in Mark._fields if name in entry._fields},
                        id=found.mark_id)
            points = self._total(end_reason)
            self.sheet.set(now._replace(utc=entry.utc), entry.who, mark._replace(value=0 if mark.added else mark.value),
                           True, entry.clock_s, entry.arrived_utc)
            self.sheet.give(self._total(end_reason) - points)
            text = "accepted"
        self.state.proposals[number - 1] = found._replace(
            decided_utc=now.utc, decided_by=by.who, accepted=accept, reason=by.reason)
        return f"Proposed mark {number} {text}: {entry.group}: {entry.desc}" + (f" ({by.reason})" if by.reason else "")

    def _total(self, end_reason: str) -> Decimal:
        points = self.counted(end_reason).points
        return Decimal(0) if points is None else Decimal(points.total)

    def _clock_s(self, now: Now) -> float:
        """Return the counted seconds of an entry of a run that is not in progress. After the time limit they continue
        with the time of day: such an entry is late."""
        state, limit = self.state, self.rules.limit_s
        if limit is None or not state.stops or state.elapsed_s < limit:
            return state.elapsed_s
        return state.elapsed_s + max(0.001, now.utc - state.stops[-1].utc)

    def say_in_time(self, who: str, number: int, in_time: bool) -> Marked:
        """See `ScoreSheet.say_in_time`."""
        self._check_not_judged()
        standing = self._items_by_name()
        entry = self.sheet.say_in_time(who, number, in_time)
        return self._entry_changed(standing, entry, f"entry {entry.number} was {'in time' if in_time else 'late'}")

    def withdraw(self, now: Now, by: By, number: int) -> Marked:
        """See `ScoreSheet.withdraw`."""
        self._check_not_judged()
        standing = self._items_by_name()
        return self._withdrawn(standing, self.sheet.withdraw(now, by.who, number, by.reason, self._over), by)

    def take_back(self, now: Now, by: By, mark_id: str) -> Marked:
        """See `ScoreSheet.take_back`."""
        self._check_not_judged()
        standing = self._items_by_name()
        entry = self.sheet.take_back(now, by.who, mark_id, by.reason, self._over)
        return Marked(None, "") if entry is None else self._withdrawn(standing, entry, by)

    def _items_by_name(self) -> Dict[Tuple[str, str], ItemRecord]:
        return {(item.group, item.desc): item for item in self.sheet.items()}

    def _withdrawn(self, standing: Dict[Tuple[str, str], ItemRecord], entry: ScoreEntry, by: By) -> Marked:
        """Return the result of a withdrawal. `standing`: the items before it."""
        return self._entry_changed(
            standing, entry, f"entry {entry.number} withdrawn{', ' if by.reason else ''}{by.reason}")

    def _entry_changed(self, standing: Dict[Tuple[str, str], ItemRecord], entry: ScoreEntry, note: str) -> Marked:
        before = standing.get((entry.group, entry.desc))
        if before is None:
            return Marked(None, f"Score: {entry.group}: {entry.desc} ({note})")
        return self._marked(before, self.sheet.item(entry.group, entry.desc), note)

    def _check_not_judged(self) -> None:
        if self.judges.rule is not None:
            raise Refused([say("{count} judges score this benchmark, each on a sheet of their own: enter the score "
                               "as a judge, or settle the item with a reason as the head referee")(
                count=self.judges.rule.count)])

    def take_verdicts(self, now: Now) -> None:
        """Take the values on which the judges agree, and those that are settled, into the sheet."""
        for verdict in self.judges.verdicts():
            for mark in _marks_of(verdict):
                if not self.sheet.has(mark):
                    self.sheet.set(now, verdict.who, mark if self.sheet.can_note else mark._replace(note=""))

    def _marked(self, before: ItemRecord, after: ItemRecord, note: str) -> Marked:
        text = score_text(after.group, after.desc, value_text(before), value_text(after))
        return Marked(after, ("Correction: " if self._over else "") + text + (f" ({note})" if note else ""))

    def counted(self, end_reason: str) -> CountedSheet:
        """Return the items with their points. `end_reason`: name of an `EndReason`; empty: the run has not ended."""
        items, elapsed_s = self.sheet.items(), self.state.elapsed_s if end_reason else 0.0
        last = self._counted
        if last is None or last[0] is not items or last[1:3] != (elapsed_s, end_reason):
            course = self.sheet.course(elapsed_s, end_reason) if self.form.has_points else Course()
            last = self._counted = (items, elapsed_s, end_reason, counted(self.form, items, course))
        return last[3]

    # -- the record ---------------------------------------------------------------------------------

    def into(self, record: RunRecord) -> RunRecord:
        """Return the record with the content of this book."""
        items, points = self.counted(record.end_reason)
        return record._replace(
            items=items, points=points, form=None if self.form.is_plain else self.form, history=self.sheet.history,
            stops=tuple(self.state.stops), started_utc=self.state.started_utc, elapsed_s=self.state.elapsed_s,
            marks=self.sheet.marks, judging=self.judges.record(), publication=self.publication.record(),
            outages=tuple(self.state.outages), timeline=tuple(self.state.timeline),
            proposals=tuple(self.state.proposals),
        )


def _rounded(clock_s: Optional[float]) -> Optional[float]:
    return None if clock_s is None else round(clock_s, 3)


def _marks_of(verdict: ItemVerdict) -> List[Mark]:
    """Return the marks that enter a verdict into the run's sheet."""
    mark = Mark(*verdict.item.key, note=verdict.reason, role=verdict.role)
    if verdict.value is None:
        return []
    if verdict.value.not_attempted:
        return [mark._replace(not_attempted=True)]
    if verdict.item.kind is ScoreKind.RATING:
        return [mark._replace(judge=judge, text=text) for judge, text in verdict.ratings]
    return [mark._replace(value=verdict.value.value, text=verdict.value.text)]


def form_of(record: RunRecord) -> SheetForm:
    """Return the items of a run's score sheet, and their rules."""
    return modern(record.form) if record.form is not None else SheetForm(tuple(
        ScoringItem(item.group, item.desc, _KINDS.get(item.kind, ScoreKind.UINT)) for item in record.items))


def _renamed(record: RunRecord, form: SheetForm) -> RunRecord:
    """Return a record with the names that its rows have on another sheet: they are known by their ids. What was marked
    in a row whose name another row has now gets the id to its name, so it counts nowhere."""
    now, names = {_known_by(row): row.key for row in form.items}, {row.key: _known_by(row) for row in form.items}
    before = {_known_by(row): row for row in form_of(record).items}
    keys = {row.key: now[each] for each, row in before.items() if each in now}
    keys.update({row.key: (row.group, f"{row.desc} ({row.id})") for each, row in before.items()
                 if each not in now and row.key in names
                 and (row.id not in ("", row.desc) or names[row.key] in before)})

    def named(each: Any) -> Any:
        group, desc = keys.get((each.group, each.desc), (each.group, each.desc))
        return each._replace(group=group, desc=desc)

    judging = record.judging
    own = (sheet._replace(history=tuple(map(named, sheet.history)), items=tuple(map(named, sheet.items)))
           for sheet in judging.sheets)
    return record._replace(history=tuple(map(named, record.history)), judging=judging._replace(
        sheets=tuple(own), settlements=tuple(map(named, judging.settlements))))


def _known_by(row: ScoringItem) -> Tuple[bool, str]:
    """Return what a row is known by, whatever it is called: an incident and an item may have one name."""
    is_incident = row.group == INCIDENTS
    return is_incident, (row.id or row.desc) if is_incident else id_of(row)


class FinishedRun:
    """A finished run. Its score sheet keeps its items even if the benchmarks file has changed."""

    def __init__(self, record: RunRecord, benchmark: Benchmark) -> None:
        self.record = record
        self.benchmark = benchmark
        self._book = RunBook(form_of(record), _state_of(record), over=True)
        if record.end_reason in _NOT_RUN:
            self._book.judges.rule = None  # there was nothing to see

    def mark(self, now: Now, who: str, mark: Mark) -> str:
        """Correct a scoring item. Returns a text for the referee, as all corrections do. Raises `Refused`.

        The text is empty if the mark was applied before. This is no error, also after the sign-off.
        """
        record, book = self.record, self._book
        if book.sheet.is_applied(mark) or (mark.id and book.is_proposed(mark.id)):
            return ""
        if mark.id and self._was_before_sign_off(now, mark.ago_ms):
            return self._changed(book.propose(now, who, mark, record.opened_utc).text)
        self._check_open()
        return self._changed(self._book.mark(
            now, who, mark, None, record.opened_utc, record.end_reason, record.closed_utc).text)

    def _was_before_sign_off(self, now: Now, ago_ms: int) -> bool:
        """Whether what arrives now, after the sign-off, has waited and was made before it. A moment before the run is
        not believed: the clock was set back."""
        signed, made = self.record.sign_off, now.utc - ago_ms / 1000
        return signed is not None and ago_ms > 0 and self.record.opened_utc - UNSURE_S <= made < signed.utc

    def take_captain(self, sign: CaptainSign) -> str:
        """Take the captain's signature, also after the sign-off: it changes nothing else. The last one holds. Raises
        `Refused`."""
        if not sign.name:
            raise Refused([say("enter the name of the captain")])
        if sign.refused and not sign.comment:
            raise Refused([say("enter why the captain refuses to sign")])
        if not _DRAWING.fullmatch(sign.drawing):
            raise Refused([say("the signature is not made of lines such as M10 20L30 40")])
        self.record = self.record._replace(captain=(*self.record.captain, sign)[-MAX_SIGNS:])
        return f"{'Refused' if sign.refused else 'Signed'} by the captain, {sign.name}" + (
            f": {sign.comment}" if sign.comment else "")

    def decide(self, now: Now, by: By, number: int, accept: bool) -> str:
        """Accept or drop a mark that arrived after the sign-off. One that is accepted makes a new version of the sheet,
        which is signed by who accepts it. Raises `Refused`."""
        before = self.record
        check_named(by.who)
        text = self._changed(self._book.decide(now, by, number, accept, before.end_reason))
        if accept:
            self.record = _with_version(before, self.record, now.utc, text, SignOff(now.utc, by.who))
        return text

    # -- a wrong run --------------------------------------------------------------------------------

    def annul(self, now: Now, by: By) -> str:
        """Let the run count nothing, and give its attempt back. Raises `Refused`, as the next ones."""
        if self.record.is_annulled:
            raise Refused([say("the run is annulled already")])
        return self._put_right(now, by, RunChange(now.utc, ANNULLED, by.who, by.reason), "Annulled")

    def move(self, now: Now, by: By, slot: Slot) -> str:
        """Let the run belong to another event of its benchmark."""
        change = RunChange(now.utc, MOVED, by.who, by.reason, self.record.slot, slot)
        return self._put_right(now, by, change, f"Moved to team {slot.team}, {sheets.turn(slot.round, slot.run)}")

    def reopen(self, now: Now, by: By) -> str:
        """Let the signed sheet be corrected. It stays as a version; the next sign-off makes a new one."""
        if self.record.sign_off is None:
            raise Refused([say("the score sheet is not signed off: correct it")])
        return self._put_right(now, by, RunChange(now.utc, REOPENED, by.who, by.reason), "Reopened")

    def undo(self, now: Now, by: By) -> str:
        """Take the last of these changes back."""
        record = self.record
        place = max((place for place, change in enumerate(record.changes) if _holds(change, record)), default=None)
        if place is None:
            raise Refused([say("nothing was annulled, moved or reopened that could be taken back")])
        change = record.changes[place]
        undone = change._replace(undone_utc=now.utc, undone_by=by.who, undone_reason=by.reason)
        signed = record.versions[-1] if change.what == REOPENED else None
        if signed is not None and (signed.items, signed.points) != (record.items, record.points):
            raise Refused([say("the score sheet was changed since it was reopened: withdraw the changes, or sign it "
                               "off again")])
        text = self._put_right(now, by, undone, f"Not {change.what} any more", place)
        if signed is not None:
            self.record = self.record._replace(sign_off=signed.sign_off, versions=record.versions[:-1])
        return text

    def _put_right(self, now: Now, by: By, change: RunChange, text: str, place: Optional[int] = None) -> str:
        """Enter a change, or that the one at `place` was taken back. A signed sheet gets a new version, signed by who
        does it."""
        check_named(by.who)
        if not by.reason:
            raise Refused([say("enter why: the reason is kept with the score sheet")])
        before, slot = self.record, change.before if change.undone_utc else change.after
        changes = list(before.changes) if place is None else [*before.changes[:place], *before.changes[place + 1:]]
        changes.insert(len(changes) if place is None else place, change)
        after = before._replace(changes=tuple(changes), **({} if slot is None else slot._asdict()))
        signed = None if change.what == REOPENED else SignOff(now.utc, by.who)
        self.record = _with_version(before, after, now.utc, f"{text}: {by.reason}", signed)
        return f"{text}: {by.reason}"

    def note(self, now: Now, who: str, note: Note) -> str:
        """See `RunBook.note`. Raises `Refused`."""
        if self._book.is_noted(note):
            return ""
        if note.number or not self._was_before_sign_off(now, note.ago_ms):
            self._check_open()
        return self._changed(self._book.note(now, who, note, None, self.record.opened_utc))

    @property
    def sheet(self) -> ScoreSheet:
        """Its score sheet."""
        return self._book.sheet

    @property
    def book(self) -> RunBook:
        """Its book."""
        return self._book

    def object(self, now: Now, who: str, by: str, text: str, second: int) -> str:
        """Enter an objection, also after the sign-off. Raises `Refused`."""
        signed = self.record.sign_off
        return self._changed(self._book.publication.object(
            now, who, by, text, second, 0.0 if signed is None else signed.utc))

    def answer(self, now: Now, by: By, number: int, upheld: bool) -> str:
        """Answer an objection. A signed sheet is reopened for one that is upheld. Raises `Refused`."""
        is_reopened = upheld and self.record.sign_off is not None
        if is_reopened:
            check_named(by.who)
        text = self._changed(self._book.publication.answer(now, by, number, upheld))
        return self.reopen(now, By(by.who, text)) if is_reopened else text

    def change_book(self, now: Now, change: Callable[[RunBook], str]) -> str:
        """Apply judges' marks or a publication to the book, and enter what the judges agree on. Raises `Refused`."""
        self._check_open()
        text = change(self._book)
        self._book.take_verdicts(now)
        return self._changed(text)

    def withdraw_score(self, now: Now, by: By, number: int) -> str:
        """Withdraw an entry of the score sheet. Raises `Refused`."""
        self._check_open()
        return self._changed(self._book.withdraw(now, by, number).text)

    def say_in_time(self, _now: Now, by: By, number: int, in_time: bool) -> str:
        """See `ScoreSheet.say_in_time`. Raises `Refused`."""
        self._check_open()
        return self._changed(self._book.say_in_time(by.who, number, in_time).text)

    def take_back(self, now: Now, by: By, mark_id: str, ago_ms: int = 0) -> str:
        """Take back a mark; the text is empty if it was taken back before. Raises `Refused`."""
        if self._book.sheet.is_taken_back(mark_id):
            return ""
        if self._was_before_sign_off(now, ago_ms):
            return self._changed(self._book.propose_taking_back(now, by, mark_id, ago_ms))
        self._check_open()
        return self._changed(self._book.take_back(now, by, mark_id).text)

    def give_stop_reason(self, _now: Now, by: By, number: int) -> str:
        """See `RunBook.give_reason`. Raises `Refused`."""
        self._check_open()
        return self._changed(self._book.give_reason(number, by))

    def sign_off(self, now: Now, who: str) -> str:
        """Make the score sheet final. Raises `Refused` if it already is, if `who` names nobody, or if sheets of judges
        or answers to objections are missing."""
        self._check_open()
        check_named(who)
        reasons = self._book.judges.not_ready() + self._book.publication.not_ready(now)
        if reasons:
            raise Refused(reasons)
        self.record = self.record._replace(sign_off=SignOff(now.utc, who))
        return f"Score sheet signed off by {who}"

    def _check_open(self) -> None:
        signed = self.record.sign_off
        if signed is not None:
            raise Refused([
                say("the score sheet of run {run} was signed off by {who} at {time}: it is final. To correct it, "
                    "reopen it in Results, with the reason")(
                    run=self.record.identity, who=sheets.person(signed.who) or "somebody",
                    time=times.at_venue(signed.utc))
            ])

    def _changed(self, text: str) -> str:
        self.record = self._book.into(self.record)
        return text


def _with_version(
    before: RunRecord, after: RunRecord, utc: float, why: str, signed: Optional[SignOff]
) -> RunRecord:
    """Return a run after a correction. A signed sheet stays as a version, and the new one is signed by who decided it;
    None: it is open."""
    if before.sign_off is None:
        return after
    version = SheetVersion(utc, why, before.sign_off, before.items, before.points, before.form)
    return after._replace(sign_off=signed, versions=(*before.versions, version))


def _holds(change: RunChange, record: RunRecord) -> bool:
    """Whether a change can be taken back. A sheet that was reopened and signed again is a new version."""
    return not change.undone_utc and (change.what != REOPENED or record.sign_off is None)


def can_undo(record: RunRecord) -> bool:
    """Whether a run was annulled, moved or reopened, and that can be taken back."""
    return any(_holds(change, record) for change in record.changes)


def check_named(who: str) -> None:
    """Check that somebody is named. Raises `Refused`."""
    if sheets.person(who) in ("", sheets.NO_NAME):
        raise Refused([say("a sign-off needs the name of the referee: enter it, in the terminal with --by")])


def is_scored_alike(one: SheetForm, other: SheetForm) -> bool:
    """Whether two sheets have the same items and rules, whatever their help and the time for objections is."""
    first, second = (replace(modern(form), objection_time=0.0, protest_time=0.0, judges=None) for form in (one, other))
    return first == second or _without_help(first) == _without_help(second)


def _without_help(form: SheetForm) -> SheetForm:
    sheet = form.sheet
    return form if sheet is None else replace(form, sheet=replace(
        sheet, items=tuple(replace(item, help="") for item in sheet.items),
        incidents=tuple(replace(incident, help="") for incident in sheet.incidents)))


class Rescored(NamedTuple):
    """A run before and after its sheet is scored by other rules: the same marks on another sheet."""

    before: RunRecord
    after: RunRecord

    @property
    def has_other_points(self) -> bool:
        """Whether the team gets other points for it."""
        one, other = ((each.total, each.for_team) if each is not None else None
                      for each in (self.before.points, self.after.points))
        return one != other

    def signed(self, decided: SignOff, why: str) -> RunRecord:
        """Return the run afterwards. A signed sheet stays as a version, and the new one is signed by who decided it."""
        return _with_version(self.before, self.after, decided.utc, why, decided)

    def __str__(self) -> str:
        run, points = self.before, (self.before.points, self.after.points)
        totals = ["no points" if each is None else each.total for each in points]
        signed = ", signed off: it gets a new version" if run.sign_off is not None else ""
        name = f"{run.benchmark}, team {run.team}, {sheets.turn(run.round, run.run)}"
        return f"{name} ({run.identity}): {totals[0]}, now {totals[1]}{signed}"


def rescored(records: Iterable[RunRecord], benchmarks: Mapping[str, Benchmark]) -> List[Rescored]:
    """Return the runs whose sheets other benchmarks would score in another way. Hundreds of runs take a second, so this
    is not for the loop's thread; it needs only their records."""
    found = []
    for record in records:
        benchmark = benchmarks.get(record.benchmark)
        if benchmark is not None and not is_scored_alike(form_of(record), benchmark.form):
            renamed = _renamed(record, benchmark.form)
            found.append(Rescored(record, RunBook(benchmark.form, _state_of(renamed), over=True).into(renamed)))
    return found


def _state_of(record: RunRecord) -> BookState:
    """Return the book of a finished run."""
    return BookState(
        SheetState(list(record.history), record.marks), list(record.stops), record.started_utc, record.elapsed_s,
        JudgesState.of(record.judging), PublicationState.of(record.publication), list(record.outages),
        list(record.timeline), list(record.proposals))


def left_behind(record: RunRecord, utc: float) -> RunRecord:
    """Return the record of a run that was in progress when the core ended, at `utc`, and that does not continue."""
    record = record._replace(closed_utc=utc)
    if not record.started_utc or record.end_reason:
        return record
    stop = StopRecord(utc, "", EndReason.STOPPED.name.lower(), "The run did not continue after a restart of the core")
    return record._replace(end_reason=stop.end_reason, stops=(*record.stops, stop))


class FinishedRuns:
    """The runs that are over. All of them decide what counts. The newest `MAX_KEPT` can be corrected."""

    def __init__(self, benchmarks: Dict[str, Benchmark], ranking: StandingRules = NO_RANKING) -> None:
        """`benchmarks`: the configured benchmarks by code; `ranking`: how runs compare."""
        self.benchmarks = benchmarks
        self.ranking = ranking
        self._runs: Dict[str, FinishedRun] = {}  # by identity, the oldest first
        self._earlier: List[RunRecord] = []  # see `_decisive`, the oldest first
        self._items: Dict[Tuple[ItemRecord, ...], Tuple[ItemRecord, ...]] = {}  # of `_earlier`, where many are alike

    def use(self, benchmarks: Dict[str, Benchmark], ranking: StandingRules) -> None:
        """Use other benchmarks for the runs that follow, and another ranking. The runs that are over keep theirs."""
        self.benchmarks = benchmarks
        self.ranking = ranking

    def add(self, record: RunRecord) -> None:
        """Keep a run that was just left. The oldest one is final if there are too many.

        One that never ended is only kept if something was entered for it: its start may be what a power failure took.
        """
        if not (record.end_reason or record.history or record.marks != NO_MARKS or record.judging.sheets):
            return
        benchmark = self.benchmarks.get(record.benchmark)
        if benchmark is None:  # the configuration was changed since this record
            benchmark = Benchmark(record.benchmark, record.benchmark, "", 0.0, 0.0, ())
        self._runs.pop(record.identity, None)
        self._runs[record.identity] = FinishedRun(record, benchmark)
        while len(self._runs) > MAX_KEPT:
            oldest = self._runs.pop(next(iter(self._runs)))
            self._earlier.append(self._decisive(oldest.record))

    def _decisive(self, record: RunRecord) -> RunRecord:
        """Return the part of a record that decides what counts. The journal has the whole record."""
        return record._replace(
            items=self._items.setdefault(record.items, record.items), history=(), stops=(), phases=(), form=None,
            marks=NO_MARKS, judging=_NO_JUDGING, publication=_NO_PUBLICATION, timeline=(),
            proposals=(), captain=())

    def restore(self, records: Iterable[RunRecord]) -> None:
        """Take records from before a restart, in any order. Only those of runs that were left are kept."""
        for record in sorted(records, key=lambda record: record.closed_utc):
            if record.closed_utc:
                self.add(record)

    def __contains__(self, identity: str) -> bool:
        """Whether it has the run of that identity."""
        return identity in self._runs

    def find(self, identity: str) -> FinishedRun:
        """Return the run of that identity. Raises `Refused`."""
        run = self._runs.get(identity)
        if run is None:
            raise Refused([
                say("'{run}' is not one of the newest {most} runs that are over: the program 'results' shows it")(
                    run=identity, most=MAX_KEPT)
            ])
        return run

    def records(self) -> List[RunRecord]:
        """Return the records of all runs, the most recently left first: those of `newest_runs`, then what decides what
        counts of earlier ones."""
        return [run.record for run in self.newest_runs()] + self._earlier[::-1]

    def newest_runs(self, count: Optional[int] = None) -> List[FinishedRun]:
        """Return the newest runs, the most recently left first; None: all that can be corrected."""
        return list(itertools.islice(reversed(self._runs.values()), count))

    def event_rules(self) -> Dict[str, EventRules]:
        """Return the rules about time and attempts by the benchmarks' codes."""
        return {code: benchmark.rules for code, benchmark in self.benchmarks.items()}

    def titles(self) -> Dict[str, str]:
        """Return what the benchmarks are called, by their codes."""
        return {code: benchmark.title for code, benchmark in self.benchmarks.items()}
