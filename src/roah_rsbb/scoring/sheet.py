"""The score sheet of a run: the referee's marks for each item, and who changed what and when.

Items, their types and groups come from the benchmarks file (docs/benchmarks.md, "Scoring items of the TBMs").

Theory of operation. The sheet is its history. Entries that are withdrawn do not count. An entry sets an item, or adds
to it. The value of an item is that of its last entry that sets it, or 0, plus all that later entries add. Referees who
count at the same time therefore lose nothing, and one entry can be withdrawn without changing the others. Each judge of
a rating has a value of their own; an entry without a judge marks the whole item as not attempted. A saved history can
be read even if the benchmarks file has changed: entries of items that the file no longer has stay in the history.

A mark with an identity is applied once, however often it arrives. Its identity is part of the state.

The history has a maximum length. Changes of an item by one person within a moment become one entry, because a referee
who counts with the mouse wheel makes ten changes a second. A mark with an identity that sets an item has an entry of
its own, so it can be taken back alone. If there are too many entries, the oldest plain one that was
replaced is dropped, preferably one of the same person. Notes, withdrawals, and the values at the end of the run are
therefore never lost. The run log and the journal have each change in any case.
"""

import re
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import two_numbers, typed_number
from roah_rsbb.model.reason import Refused, joined, say
from roah_rsbb.model.records import NO_MARKS, ItemRecord, Rating, ScoreEntry, TakenMarks
from roah_rsbb.model.rules import Sheet
from roah_rsbb.model.scoring import (
    INCIDENTS,
    MAX_DECIMALS,
    MAX_INCIDENTS,
    MAX_NUMBER,
    MAX_VALUE,
    NUMBERS,
    WHOLE,
    Key,
    ScoreGroup,
    ScoreKind,
    ScoringItem,
)
from roah_rsbb.scoring.course import voided, with_ratings
from roah_rsbb.scoring.points import jury_text, text_of, whole_part
from roah_rsbb.scoring.tree import Course, moments
from roah_rsbb.wording.sheets import item_value
from roah_rsbb.wording.texts import did_you_mean
from roah_rsbb.wording.times import elapsed

# Changes of an item by the same person within this time (s) after an entry belong to that entry.
ONE_ENTRY_S = 1.0
# Maximum number of entries besides two for each item, and how many of these may have a note or be withdrawn.
MAX_ENTRIES = 200
MAX_NOTED = 100
# Identities of marks that are remembered. A device that lost its connection sends few marks again.
MAX_MARKS = 1000

Place = Tuple[str, str, str]  # group and description of an item, and the judge; no judge: the item itself

_NUMBER = re.compile(rf"[+-]?([0-9]{{1,7}}\.?[0-9]{{0,{MAX_DECIMALS}}}|\.[0-9]{{1,{MAX_DECIMALS}}})")


def score_text(group: str, desc: str, old: str, value: str) -> str:
    """Describe an item's change to the referee. Both values are texts."""
    return f"Score: {group}: {desc} {old} -> {value}"


@dataclass
class SheetState:
    """The state of a score sheet is its history. A restart may change the items of the benchmarks file."""

    history: List[ScoreEntry] = field(default_factory=list)
    marks: TakenMarks = NO_MARKS


class Mark(NamedTuple):
    """A change of an item that the referee requests."""

    group: str
    desc: str
    value: int = 0
    not_attempted: bool = False  # the robot did not try; then the value is ignored
    note: str = ""
    text: str = ""  # of a decimal, a choice or a rating, instead of `value`
    judge: str = ""  # who gives a rating
    added: str = ""  # a decimal number to add to the item, instead of `value` and `text`
    id: str = ""  # identity of the mark; empty: it has none, so it is applied each time it arrives
    role: str = ""  # of the person who marks
    device: str = ""  # from which the mark was sent
    ago_ms: int = 0  # it was made so long before it arrived


class _Standing(NamedTuple):
    """What counts of an item, or of a judge's rating of it."""

    value: int
    text: str
    not_attempted: bool


class ScoreSheet:
    """All scoring items of one run with their history. Each begins at 0."""

    def __init__(
        self, items: Tuple[ScoringItem, ...], state: Optional[SheetState] = None, rules: Optional[Sheet] = None
    ) -> None:
        """`rules`: those that make entries void; None: none do."""
        self.state = state or SheetState()
        self._history = self.state.history  # the same list
        # Those of a record say why they did not count then.
        self._history[:] = [entry._replace(void="") if entry.void else entry for entry in self._history]
        self._items: Dict[Key, ScoringItem] = {i.key: i for i in items}
        self._rules = rules or Sheet()
        self._course: Optional[Course] = None  # what the history says; None: not made yet
        self._moments: Tuple[Fraction, ...] = ()  # when incidents come by themselves
        self._void: Dict[int, str] = {}  # number of an entry -> why it does not count although nobody withdrew it
        self._taken = dict(self.state.marks.entries)
        # Numbers are not used again: a late withdrawal must not meet another entry.
        self._last_number = max([self.state.marks.last, *(entry.number for entry in self._history)])
        self._places = sum(1 + len(item.judges) for item in items)
        # The last entry that is not withdrawn, with the value that counts.
        self._standing: Dict[Place, ScoreEntry] = {}
        self._begun: Dict[int, float] = {}  # number of an item's newest entry -> monotonic time (s) of its first change
        self._touched: Optional[int] = None  # number of the entry that the last `set` made or changed; None: of none
        self._groups: Optional[Tuple[ScoreGroup, ...]] = None  # as `groups` has them, until something changes
        self._records: Optional[Tuple[ItemRecord, ...]] = None
        self._stand()

    @property
    def history(self) -> Tuple[ScoreEntry, ...]:
        """All entries, oldest first."""
        if not self._void:
            return tuple(self._history)
        return tuple(entry._replace(void=self._void.get(entry.number, "")) for entry in self._history)

    @property
    def marks(self) -> TakenMarks:
        """See `SheetState`."""
        return self.state.marks

    def taken(self, mark_id: str) -> Optional[int]:
        """Return the number of the entry of a mark that was applied, or 0 if it made none. None: it was not applied."""
        return self._taken.get(mark_id) if mark_id else None

    def is_applied(self, mark: Mark) -> bool:
        """Whether a mark was applied. Raises `Refused` if its identity is that of a mark which changed another item:
        it would be lost in silence."""
        number = self.taken(mark.id)
        for entry in self._history if number else ():
            if entry.number == number and (entry.group, entry.desc) != (mark.group, mark.desc):
                raise Refused([say("the id '{id}' was used for '{item}': give each mark a new UUID")(
                    id=mark.id, item=entry.desc)])
        return number is not None

    def is_taken_back(self, mark_id: str) -> bool:
        """Whether the entry of a mark was withdrawn."""
        number = self.taken(mark_id)
        return any(entry.withdrawn_utc > 0.0 for entry in self._history if entry.number == number)

    def has(self, mark: Mark) -> bool:
        """Whether an item, or a judge's rating of it, has the value of a mark."""
        before = self._standing_of((mark.group, mark.desc), mark.judge)
        if mark.not_attempted or before.not_attempted:
            return mark.not_attempted and before.not_attempted
        return mark.text == before.text if mark.judge else (mark.value, mark.text) == before[:2]

    @property
    def can_note(self) -> bool:
        """Whether one more entry may have a note."""
        return sum(1 for entry in self._history if not _is_plain(entry)) < MAX_NOTED

    # -- changing -----------------------------------------------------------------------------------

    def check(self, mark: Mark) -> Mark:
        """Return the mark as an entry keeps it. Raises `Refused` with the remedy if it cannot be set."""
        item = self._items.get((mark.group, mark.desc))
        if item is None:
            raise Refused([self._unknown(mark.group, mark.desc)])
        if mark.not_attempted:
            return mark._replace(value=0, text="", judge="", added="")
        if mark.judge and item.kind is not ScoreKind.RATING:
            raise Refused([say("'{item}' is not rated by judges: leave out the judge")(item=item.desc)])
        if mark.added:
            mark = self._counted(item, mark)
        if item.kind in WHOLE:
            _check_whole(item, mark)
            return mark
        if item.kind is ScoreKind.CHOICE:
            return mark._replace(value=_chosen(item, mark))
        is_rating = item.kind is ScoreKind.RATING
        text = _rating(item, mark) if is_rating else _decimal(item, mark.text or str(mark.value))
        return mark._replace(text=text, value=whole_part(text))

    def set(
        self, now: Now, who: str, mark: Mark, correction: bool = False, clock_s: Optional[float] = None,
        arrived_utc: float = 0.0,
    ) -> ItemRecord:
        """Set an item, or mark it as not attempted. Returns the item before the change. Raises as `check` does.

        A value removes the mark. A call without a change and without a note makes no entry. A mark that was applied
        changes nothing. `correction`: the run is over; `clock_s`: its counted seconds. `arrived_utc`: it was made at
        `now`, and has waited until then; 0.0: it has not.
        """
        self._touched = None
        if self.is_applied(mark):
            return self.item(mark.group, mark.desc)
        mark = self.check(mark)
        key = (mark.group, mark.desc)
        record, before = self._item(key), self._standing_of(key, mark.judge)
        if not (mark.note or arrived_utc) and (mark.value, mark.text, mark.not_attempted) == before:
            self._take(mark.id, 0)
            return record
        if mark.note:
            self._check_noted(say("set the value without a note"))
        entry = ScoreEntry(
            self._last_number + 1, now.utc, who, mark.group, mark.desc, before.value, mark.value,
            mark.not_attempted, mark.note, before.not_attempted, correction,
            old_text=before.text, text=mark.text, judge=mark.judge, added=mark.added, role=mark.role,
            device=mark.device, clock_s=None if clock_s is None else round(clock_s, 3), arrived_utc=arrived_utc,
        )
        same = None if arrived_utc or (mark.id and not mark.added) else self._same_moment(now, entry)
        if same is None:
            self._make_room()
            self._history.insert(self._place_of(entry), entry)
            self._last_number = entry.number
            if not arrived_utc:
                self._begun[entry.number] = now.mono
            self._touched = entry.number
        else:
            self._touched = self._replace(same, entry) or None
        self._take(mark.id, self._touched or 0)
        self._stand()
        return record

    def _place_of(self, entry: ScoreEntry) -> int:
        """Return where an entry belongs in the history: one that waited, before those that were made later."""
        place = len(self._history)
        while entry.arrived_utc and place and self._history[place - 1].utc > entry.utc:
            place -= 1
        return place

    def give(self, points: Decimal) -> None:
        """Note by how many points the last `set` changed the total."""
        for place in reversed(range(len(self._history))):
            entry = self._history[place]
            if points and entry.number == self._touched:
                self._history[place] = entry._replace(points=_sum(entry.points, text_of(points)))

    def _counted(self, item: ScoringItem, mark: Mark) -> Mark:
        """Return the mark with the value that the item has after it. The caller checks that value."""
        if item.kind not in NUMBERS:
            raise Refused([say("'{item}' cannot be counted: set its value")(item=item.desc)])
        text = typed_number(mark.added)
        if not _NUMBER.fullmatch(text) or not Decimal(text):
            raise Refused([say("'{item}' cannot be changed by '{added}': give a number such as +1 or -1")(
                item=item.desc, added=mark.added)])
        added = Decimal(text)
        if item.kind in WHOLE and added != int(added):
            raise Refused([say("'{item}' is counted in whole numbers, not by '{added}'")(
                item=item.desc, added=mark.added)])
        before = self._standing_of(item.key)
        number = added + Decimal(before.text or before.value)
        return mark._replace(
            added=text_of(added), value=int(number), text="" if item.kind in WHOLE else text_of(number))

    def _take(self, mark_id: str, entry: int) -> None:
        """Remember the identity of a mark that was applied, if it has one."""
        if mark_id:
            self._taken[mark_id] = entry
            if len(self._taken) > MAX_MARKS:
                del self._taken[next(iter(self._taken))]
        self.state.marks = TakenMarks(dict(self._taken), self._last_number)

    def _move_marks(self, number: int, to: int) -> None:
        """The entry of that number is gone: its marks are in another one, or in none."""
        self._taken.update((mark_id, to) for mark_id, entry in list(self._taken.items()) if entry == number)

    def withdraw(self, now: Now, who: str, number: int, note: str = "", correction: bool = False) -> ScoreEntry:
        """Withdraw an entry. The item gets the value that it has without it. Returns the withdrawn entry. Raises
        `Refused`."""
        index = self._index(number)
        entry = self._history[index]
        if entry.withdrawn_utc:
            raise Refused([say("entry {number} was withdrawn already, by {who}")(
                number=number, who=entry.withdrawn_by or "somebody")])
        if _is_plain(entry):
            self._check_noted(say("set the value instead"))
        was_wrong = self._why_wrong(entry)
        self._history[index] = entry._replace(
            withdrawn_utc=now.utc, withdrawn_by=who, withdrawn_note=note, withdrawal_corrects=correction
        )
        self._stand()
        wrong = self._why_wrong(entry)
        if wrong and not was_wrong:
            self._history[index] = entry
            self._stand()
            raise Refused([say("entry {number} cannot be withdrawn, because later entries count from it: without it, "
                               "{wrong}. Withdraw those first, or set the value")(number=number, wrong=wrong)])
        self._begun.pop(number, None)
        return entry

    def take_back(
        self, now: Now, who: str, mark_id: str, note: str = "", correction: bool = False
    ) -> Optional[ScoreEntry]:
        """Withdraw the entry of a mark that set an item; returns it. None: it was withdrawn before.

        Raises `Refused`.
        """
        number = self.taken(mark_id)
        if number is None:
            raise Refused([say("that mark was not applied, so it cannot be taken back")])
        entry = next((entry for entry in self._history if entry.number == number), None)
        if entry is None:
            raise Refused([say("that mark has no entry in the history: set the value instead")])
        if self.is_taken_back(mark_id):
            return None
        if entry.added:
            raise Refused([say("that mark added to its item: add the opposite instead")])
        if list(self._taken.values()).count(number) > 1:
            raise Refused([say("that mark shares an entry of the history with others: set the value instead")])
        return self.withdraw(now, who, number, note, correction)

    def say_in_time(self, who: str, number: int, in_time: bool = True) -> ScoreEntry:
        """Say that what a late entry marks happened before the time limit, or take that back. Returns the entry. Raises
        `Refused`."""
        index = self._index(number)
        entry = self._history[index]
        if not self._is_late(entry):
            limit = self._rules.limit_s
            raise Refused([
                say("entry {number} was not late: no entry of this sheet is")(number=number) if limit is None else
                say("entry {number} was not late: the run had taken {time}, and its time limit is {limit}")(
                    number=number, time=elapsed(entry.clock_s or 0.0), limit=elapsed(float(limit)))])
        self._history[index] = entry._replace(in_time=in_time, in_time_by=who)
        self._stand()
        return self._history[index]

    def _is_late(self, entry: ScoreEntry) -> bool:
        """Whether an entry was made after the time limit."""
        limit = self._rules.limit_s
        return limit is not None and entry.clock_s is not None and entry.clock_s > limit

    def _why_wrong(self, entry: ScoreEntry) -> str:
        """Return why the value of this entry's item is outside the limits; empty: it is not."""
        standing: Optional[ScoreEntry] = None
        for each in self._history:
            same = (each.group, each.desc, each.judge) == (entry.group, entry.desc, entry.judge)
            if same and not each.withdrawn_utc and each.number not in self._void:
                standing = _after(standing, each)
        if standing is None or not standing.added or (entry.group, entry.desc) not in self._items:
            return ""
        try:
            self.check(Mark(entry.group, entry.desc, standing.value, text=standing.text))
        except Refused as refused:
            return joined(refused.reasons)
        return ""

    def _same_moment(self, now: Now, entry: ScoreEntry) -> Optional[int]:
        """Return the index of the item's newest entry if this change belongs to it."""
        for index in reversed(range(len(self._history))):
            last = self._history[index]
            if (last.group, last.desc) == (entry.group, entry.desc):
                begun = self._begun.get(last.number)
                is_same = begun is not None and now.mono - begun <= ONE_ENTRY_S and _is_alike(last, entry)
                is_own = not last.added and last.number in self._taken.values()
                is_one = is_same and not is_own and not self._divided(index, entry)
                return index if is_one else None
        return None

    def _divided(self, index: int, later: ScoreEntry) -> bool:
        """Whether an incident, also one that comes by itself, or the time limit, lies between an entry and a later
        one: the moment of each decides whether it counts."""
        first = self._history[index]
        late = [self._is_late(entry) and not entry.in_time for entry in (first, later)]
        return late[0] is not late[1] or any(
            (first.clock_s or 0.0) <= at_s < (later.clock_s or 0.0) for at_s in self._moments) or any(
            entry.group == INCIDENTS for entry in self._history[index + 1:] if entry.number < later.number)

    def _replace(self, index: int, entry: ScoreEntry) -> int:
        """Join an entry with the first one of its moment. Returns its number; 0: both are gone."""
        first = self._history[index]
        entry = _joined(first, entry)._replace(number=first.number)
        is_undone = (entry.value, entry.text, entry.not_attempted) == (
            first.old, first.old_text, first.old_not_attempted)
        if entry.added == "0" or (is_undone and not entry.added):
            del self._history[index]  # a slip that was undone at once
            del self._begun[first.number]
            self._move_marks(first.number, 0)
            return 0
        self._history[index] = entry
        return first.number

    def _make_room(self) -> None:
        """Drop one entry if there are too many."""
        if len(self._history) < MAX_ENTRIES + 2 * self._places:
            return
        pairs = self._replaced_pairs()
        alike = [pair for pair in pairs if self._history[pair[0]].who == self._history[pair[1]].who]
        for index, later in (alike or pairs)[-1:]:
            gone, kept = self._history[index], self._history[later]
            self._history[later] = _joined(gone, kept)
            del self._history[index]
            self._begun.pop(gone.number, None)
            self._move_marks(gone.number, kept.number)

    def _replaced_pairs(self) -> List[Tuple[int, int]]:
        """Return the indices of plain entries, each with that of the next plain entry of the same item; oldest last.

        If there are too many entries, some are always plain, because the number of others is limited.
        """
        pairs: List[Tuple[int, int]] = []
        newer: Dict[Place, int] = {}  # index of the next entry of the item, by the same judge
        for index in reversed(range(len(self._history))):
            entry = self._history[index]
            place = (entry.group, entry.desc, entry.judge)
            later = newer.get(place)
            newer[place] = index
            if later is not None and _may_replace(self._history[later], entry) and not self._divided(
                    index, self._history[later]):
                pairs.append((index, later))
        return pairs

    def _check_noted(self, instead: str) -> None:
        if not self.can_note:
            raise Refused([say("{most} entries of the score sheet already have a note or are withdrawn: {instead}")(
                most=MAX_NOTED, instead=instead)])

    def _index(self, number: int) -> int:
        """Return where an entry is in the history. Raises `Refused`."""
        index = next((i for i, entry in enumerate(self._history) if entry.number == number), None)
        if index is None:
            raise Refused([say("the score sheet has no entry {number}: {hint}")(number=number, hint=self._numbers())])
        return index

    def _numbers(self) -> str:
        numbers = [str(entry.number) for entry in self._history if not entry.withdrawn_utc]
        return say("choose from {numbers}")(numbers=", ".join(numbers)) if numbers else say("no entry can be withdrawn")

    # -- looking ------------------------------------------------------------------------------------

    def groups(self) -> Tuple[ScoreGroup, ...]:
        """Return all items with their values by group, in the file's order. The same object until one changes."""
        if self._groups is None:
            grouped: Dict[str, List[Tuple[ScoringItem, int]]] = {}
            for item, record in zip(self._items.values(), self.items()):
                grouped.setdefault(item.group, []).append((item, record.value))
            self._groups = tuple(ScoreGroup(name, tuple(items)) for name, items in grouped.items())
        return self._groups

    def items(self) -> Tuple[ItemRecord, ...]:
        """Return all items, in the file's order. The same object until one changes."""
        if self._records is None:
            self._records = tuple(self._item(key) for key in self._items)
        return self._records

    def course(self, elapsed_s: float, end_reason: str) -> Course:
        """Return what happened, as far as points depend on it. `elapsed_s`: counted seconds until the end;
        `end_reason`: why the run ended, empty if it did not."""
        if self._course is None:
            self._course = voided(self._rules, self._items, self._history)[0]
        course = with_ratings(self._course, self._items, self.items())
        # The clock counts milliseconds at best. A float's last digits must not cost a full second.
        return course._replace(
            ended=bool(end_reason), completed=end_reason == "completed",
            elapsed_s=Fraction(repr(round(elapsed_s, 3))))

    def item(self, group: str, desc: str) -> ItemRecord:
        """Return an item. Raises `Refused` if it does not exist."""
        if (group, desc) not in self._items:
            raise Refused([self._unknown(group, desc)])
        return self._item((group, desc))

    def _item(self, key: Key) -> ItemRecord:
        item, own = self._items[key], self._standing_of(key)
        ratings: List[Rating] = []
        for judge in item.judges:
            text = self._standing_of(key, judge).text
            ratings += [Rating(judge, text)] if text else []
        text, value = own.text, own.value
        if item.kind is ScoreKind.RATING:
            text = "" if own.not_attempted else jury_text(item, [rating.text for rating in ratings])
            value = whole_part(text)
        return ItemRecord(
            item.group, item.desc, item.kind.word, value, own.not_attempted,
            any(self._is_corrected((*key, judge)) for judge in ("", *item.judges)), text, tuple(ratings),
            unit=item.unit,
        )

    def _standing_of(self, key: Key, judge: str = "") -> _Standing:
        """Return what counts of an item, or of a judge's rating. A rating after the mark "not attempted" ends it."""
        item, entry = self._items[key], self._standing.get((*key, judge))
        zero = "0" if item.kind is ScoreKind.DECIMAL else ""
        whole = self._standing.get((*key, ""))
        since = max((self._standing[place].number for place in ((*key, each) for each in item.judges)
                     if place in self._standing), default=0)
        not_attempted = whole is not None and whole.not_attempted and whole.number > since
        if entry is None or entry.not_attempted:
            return _Standing(0, "" if not_attempted else zero, not_attempted)
        return _Standing(entry.value, entry.text, not_attempted)

    def _is_corrected(self, place: Place) -> bool:
        """Whether a value differs from the value at the end of the run."""
        entries = [entry for entry in self._history if (entry.group, entry.desc, entry.judge) == place]
        since = max((e.number for e in entries if not e.withdrawn_utc and not e.added), default=0)
        return any(
            not entry.correction and entry.withdrawal_corrects if entry.withdrawn_utc else entry.correction
            for entry in entries if entry.number >= since
        )

    def _stand(self) -> None:
        self._standing = {}
        self._course = None
        if self._rules.incidents or self._rules.limit_s is not None:
            self._course, self._void = voided(self._rules, self._items, self._history)
            self._moments = moments(self._rules, self._course) if any(
                incident.of for incident in self._rules.incidents) else ()
        for entry in self._history:
            if not entry.withdrawn_utc and entry.number not in self._void:
                place = (entry.group, entry.desc, entry.judge)
                after = _after(self._standing.get(place), entry)
                is_below = entry.added and after.value < 0 and self._is_count(place)
                self._standing[place] = after._replace(value=0) if is_below else after
        self._groups = self._records = None

    def _is_count(self, place: Place) -> bool:
        """Whether an item is a count, of which nobody takes more than there is: what was there may not count now."""
        item = self._items.get(place[:2])
        return item is not None and item.kind is ScoreKind.UINT

    def _unknown(self, group: str, desc: str) -> str:
        if not self._items:
            return say("this benchmark has no scoring items for the referee")
        groups = list(dict.fromkeys(i.group for i in self._items.values()))
        if group not in groups:
            return say("no scoring group '{group}'{hint}")(group=group, hint=did_you_mean(group, groups))
        descs = [i.desc for i in self._items.values() if i.group == group]
        return say("no scoring item '{item}' in group '{group}'{hint}")(
            item=desc, group=group, hint=did_you_mean(desc, descs))


def _is_plain(entry: ScoreEntry) -> bool:
    return not (entry.note or entry.withdrawn_utc)


def _is_alike(last: ScoreEntry, entry: ScoreEntry) -> bool:
    """Whether both changes may become one entry. A change to "not attempted" is always an entry of its own."""
    same = (last.who, last.role, last.device, last.correction, last.not_attempted, last.judge, bool(last.added)) == (
        entry.who, entry.role, entry.device, entry.correction, entry.not_attempted, entry.judge, bool(entry.added))
    return same and not last.note and not entry.note


def _may_replace(later: ScoreEntry, entry: ScoreEntry) -> bool:
    return _is_plain(entry) and _is_plain(later) and entry.correction is later.correction


def _after(before: Optional[ScoreEntry], entry: ScoreEntry) -> ScoreEntry:
    """Return an entry with the value that counts after it. `before`: the one before, with its value; None: none."""
    if not entry.added:
        return entry
    number = Decimal(entry.added)
    if before is not None:
        number += Decimal(before.text or before.value)
    return entry._replace(value=int(number), text=text_of(number) if entry.text else "")


def _joined(first: ScoreEntry, later: ScoreEntry) -> ScoreEntry:
    """Return an entry that changes an item as the two entries together do."""
    whole = later._replace(old=first.old, old_text=first.old_text, old_not_attempted=first.old_not_attempted,
                           points=_sum(first.points, later.points))
    if not later.added:
        return whole
    if first.added:
        return whole._replace(added=text_of(Decimal(first.added) + Decimal(later.added)))
    return _after(first, whole)._replace(added="")


def _sum(*points: str) -> str:
    """Return the sum of points; empty: it is 0."""
    found = sum(map(Decimal, filter(None, points)), Decimal(0))
    return text_of(found) if found else ""


# -- values -----------------------------------------------------------------------------------------


def value_text(record: ItemRecord) -> str:
    """Return the value of an item as text for the referee."""
    type_ = "uint" if record.kind == "bool" else record.kind
    return item_value(type_, record.value, record.not_attempted, record.text)


def _check_whole(item: ScoringItem, mark: Mark) -> None:
    if mark.text:
        raise Refused([say("'{item}' takes a whole number, not the text '{text}'")(item=item.desc, text=mark.text)])
    if item.kind is ScoreKind.BOOL:
        if mark.value not in (0, 1):
            raise Refused([say("'{item}' is yes or no: its value must be 0 or 1, not {value}")(
                item=item.desc, value=mark.value)])
        return
    lowest = 0 if item.kind is ScoreKind.UINT else -MAX_VALUE
    least = lowest if item.least is None else int(item.least)
    highest = MAX_INCIDENTS if item.group == INCIDENTS else MAX_VALUE
    most = highest if item.most is None else int(item.most)
    if least <= mark.value <= most:
        return
    what = say("a count") if item.kind is ScoreKind.UINT else say("a whole number")
    has_limits = (least, most) != (0, MAX_VALUE)
    limits = say("from {least} to {most}")(least=least, most=most) if has_limits else say("0 or more")
    raise Refused([say("'{item}' is {what}: its value must be {limits}, not {value}")(
        item=item.desc, what=what, limits=limits, value=mark.value)])


def _chosen(item: ScoringItem, mark: Mark) -> int:
    """Return the number of a choice, from 1; 0: none."""
    names = [choice.name for choice in item.choices]
    if mark.text in names:
        return names.index(mark.text) + 1
    if mark.text or mark.value:
        found = f"'{mark.text}'" if mark.text else say("the number {value}")(value=mark.value)
        raise Refused([say("'{item}' does not take {found}: choose one of {names}")(
            item=item.desc, found=found, names=", ".join(names))])
    return 0


def _rating(item: ScoringItem, mark: Mark) -> str:
    if mark.judge and mark.judge not in item.judges:
        raise Refused([say("'{item}' has no judge '{judge}': choose one of {judges}")(
            item=item.desc, judge=mark.judge, judges=", ".join(item.judges))])
    if not mark.judge and (mark.text or mark.value):
        raise Refused([say("'{item}' is rated by judges: name one of {judges}")(
            item=item.desc, judges=", ".join(item.judges))])
    if mark.value and not mark.text:
        raise Refused([say("'{item}' is a rating: give the number as a text")(item=item.desc)])
    return _decimal(item, mark.text) if mark.text else ""


def _decimal(item: ScoringItem, text: str) -> str:
    least = Decimal(-MAX_NUMBER) if item.least is None else item.least
    most = Decimal(MAX_NUMBER) if item.most is None else item.most
    ends = float(least), float(most)
    number = typed_number(text, *ends)
    if number.startswith("+") or not _NUMBER.fullmatch(number) or not least <= Decimal(number) <= most:
        outside = say("'{item}' takes a number from {least} to {most} with at most {decimals} decimals, not '{text}'")
        raise Refused([two_numbers(item.desc, text, *ends) or outside(
            item=item.desc, least=text_of(least), most=text_of(most), decimals=MAX_DECIMALS, text=text)])
    return text_of(Decimal(number))
