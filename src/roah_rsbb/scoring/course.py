"""The history of a score sheet as the course of its run, of which the rules make points."""

import functools
from decimal import Decimal
from fractions import Fraction
from typing import Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.records import ItemRecord, ScoreEntry
from roah_rsbb.model.rules import Item, Measure, Sheet
from roah_rsbb.model.scoring import INCIDENTS, MAX_INCIDENTS, Key, ScoreKind, ScoringItem
from roah_rsbb.scoring.earlier import id_of
from roah_rsbb.scoring.tree import Course, Happened, SheetMark, VoidMark, void_marks

NOTHING: Mapping[int, VoidMark] = {}
MAX_ROUNDS = 9  # one for each time that what does not count decides about what follows: rarely more than two
# A course is made again after each mark, mostly of the same numbers: reading one takes longer than all else.
_read = functools.lru_cache(maxsize=4096)(Fraction)


class History(NamedTuple):
    """A course, and the entries of which its marks were made."""

    course: Course
    numbers: Tuple[int, ...]  # of the entry of each mark


def voided(
    sheet: Sheet, rows: Mapping[Key, ScoringItem], entries: Sequence[ScoreEntry]
) -> Tuple[Course, Dict[int, str]]:
    """Return what happened, and the entries that do not count although nobody withdrew them, by number, and why."""
    history = course_of(sheet, rows, entries)
    void: Dict[int, VoidMark] = {}
    # What does not count decides whether a later entry takes something away, and so whether that one counts.
    for _ in range(MAX_ROUNDS if sheet.incidents or sheet.limit_s is not None else 0):
        found = {history.numbers[index]: why for index, why in void_marks(sheet, history.course).items()}
        if found == void:
            break
        void = found
        history = course_of(sheet, rows, entries, void)
    return history.course, {number: found.why for number, found in void.items()}


def course_of(
    sheet: Sheet, rows: Mapping[Key, ScoringItem], entries: Iterable[ScoreEntry], void: Mapping[int, VoidMark] = NOTHING
) -> History:
    """Return what happened, without the results of juries. `void`: entries that do not count, if that is known."""
    marks: List[Tuple[SheetMark, int]] = []
    incidents: Dict[str, List[Happened]] = {}
    kinds = {item.id: item for item in sheet.items}
    standing: Dict[str, Fraction] = {}  # of items, until something makes marks void
    counting: Dict[str, List[ScoreEntry]] = {}  # entries of items that counted when they were made
    turns = sorted({each.since for each in void.values()}, reverse=True)
    entries = tuple(entries)
    for order, (entry, at_s) in enumerate(zip(entries, _moments(sheet, entries))):
        row = rows.get((entry.group, entry.desc))
        if entry.withdrawn_utc or row is None or entry.judge:
            continue
        if row.group == INCIDENTS:
            name = row.id or row.desc
            _happened(incidents.setdefault(name, []), entry, Happened(name, at_s, order=order))
            continue
        item_id, moment = id_of(row), (at_s or Fraction(0), order)
        while turns and turns[-1] <= moment:
            turns.pop()
            standing.clear()
        own = counting.setdefault(item_id, [])
        before = standing[item_id] if item_id in standing else _standing(row, [
            each for each in own if each.number not in void or void[each.number].since > moment])
        after = _number(entry, row, before)
        corrects = _takes_away(row, before, after)
        is_late = sheet.limit_s is not None and at_s is not None and at_s > sheet.limit_s and not (
            entry.in_time or corrects)
        standing[item_id] = before
        if not is_late and (entry.number not in void or void[entry.number].since > moment):
            standing[item_id] = _standing(row, [entry], before)
            own.append(entry)
        marks += [(mark._replace(at_s=at_s, in_time=entry.in_time, corrects=corrects, order=order), entry.number)
                  for mark in _marks(kinds[item_id], entry, before, after)]
    return History(Course(
        tuple(mark for mark, _ in marks), tuple(each for found in incidents.values() for each in found), True),
        tuple(number for _, number in marks))


def with_ratings(course: Course, rows: Mapping[Key, ScoringItem], records: Iterable[ItemRecord]) -> Course:
    """Return a course with the results of juries."""
    last = max((mark.order for mark in course.marks), default=0) + 1
    ratings = [SheetMark(id_of(rows[record.key]), Fraction(record.text), sets=True, order=last) for record in records
               if record.text and record.key in rows and rows[record.key].kind is ScoreKind.RATING]
    return course._replace(marks=(*course.marks, *ratings)) if ratings else course


def _moments(sheet: Sheet, entries: Sequence[ScoreEntry]) -> List[Optional[Fraction]]:
    """Return when entries were made. One without a time has that of the one before it, unless no entry has one: an
    earlier version began the run. The clock goes back where the box was away and leaves that time out: what was entered
    after that is not earlier than what was entered before."""
    found: List[Optional[Fraction]] = []
    before = Fraction(0)  # of the newest entry within the time limit
    for entry in entries:
        at_s = before if entry.clock_s is None else max(before, _read(str(entry.clock_s)))
        found.append(at_s)
        if sheet.limit_s is None or at_s <= sheet.limit_s:
            before = at_s
    return [None] * len(found) if all(entry.clock_s is None for entry in entries) else found


def _number(entry: ScoreEntry, row: ScoringItem, before: Fraction) -> Fraction:
    """Return the number that an item has after an entry."""
    if entry.added:
        return before + _read(entry.added)
    if entry.not_attempted:
        return Fraction(0)
    return _read(entry.text) if entry.text and not row.choices else _read(entry.value)


def _standing(row: ScoringItem, entries: Iterable[ScoreEntry], number: Fraction = Fraction(0)) -> Fraction:
    """Return the number that an item has after entries: nobody takes more than there is."""
    for entry in entries:
        number = _number(entry, row, number)
        number = max(Fraction(0), number) if row.kind is ScoreKind.UINT else number
    return number


def _takes_away(row: ScoringItem, before: Fraction, after: Fraction) -> bool:
    """Whether an item has less than before, or nothing. Of choices, what counts is their points."""
    if not row.choices or not after:
        return after <= before
    points = {number: choice.points for number, choice in enumerate(row.choices, 1)}
    was, now = points.get(int(before)), points.get(int(after))
    return was is not None and now is not None and now <= was


def _marks(item: Item, entry: ScoreEntry, before: Fraction, after: Fraction) -> List[SheetMark]:
    if item.amount is Measure.CHOICE:
        return [SheetMark(item.id, text=entry.text, sets=True)]
    if item.amount is not Measure.PERCENT:
        return [SheetMark(item.id, after - before) if entry.added else SheetMark(item.id, after, sets=True)]
    # Whole times, and the part of one that is left. More percent than before are another time, if there can be one.
    if entry.added and after > before and item.times != 1:
        return _times(item.id, after - before)
    again = _times(item.id, after) or [SheetMark(item.id, Fraction(0))]
    return [again[0]._replace(sets=True), *again[1:]]


def _times(item_id: str, percent: Fraction) -> List[SheetMark]:
    full, part = divmod(percent, 100)
    found = [SheetMark(item_id, Fraction(full))] if full else []
    return found + ([SheetMark(item_id, share=part / 100)] if part else [])


def _happened(found: List[Happened], entry: ScoreEntry, happened: Happened) -> None:
    """Enter how often an incident happened."""
    number = min(len(found) + int(Decimal(entry.added)) if entry.added else entry.value, MAX_INCIDENTS)
    del found[max(0, number):]
    found += [happened] * (number - len(found))
