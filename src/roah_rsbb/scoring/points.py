"""The points of a score sheet as records and faces have them (docs/rules.md)."""

from decimal import ROUND_DOWN, ROUND_HALF_UP, Context, Decimal, InvalidOperation
from fractions import Fraction
from typing import List, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.model.records import GroupPoints, ItemRecord, SheetPoints
from roah_rsbb.model.rules import JuryResult, Measure, Sheet
from roah_rsbb.model.scoring import INCIDENTS, MAX_DECIMALS, MAX_VALUE, NO_SECTION, ScoringItem, SheetForm
from roah_rsbb.scoring.earlier import id_of, sheet_of
from roah_rsbb.scoring.tree import Course, Worth, count

# More digits than any sum of values within the limits can have.
_EXACT = Context(prec=80)
_LAST_DECIMAL = Decimal(1).scaleb(-MAX_DECIMALS)


class CountedSheet(NamedTuple):
    """A score sheet with its points."""

    items: Tuple[ItemRecord, ...]
    points: Optional[SheetPoints]


def number_of(text: str) -> Optional[Decimal]:
    """Read a decimal number; None if the text is not one."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        return None
    return number if number.is_finite() else None


def text_of(number: Decimal) -> str:
    """Return a number as text, without an exponent and without trailing zeros."""
    text = f"{number:f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text in ("-0", "") else text


def whole_part(text: str) -> int:
    """Return the whole part of a number, limited to the range of an int32; 0 if the text is not a number."""
    number = number_of(text)
    if number is None:
        return 0
    return int(max(Decimal(-MAX_VALUE), min(Decimal(MAX_VALUE), number.to_integral_value(ROUND_DOWN))))


def jury_text(item: ScoringItem, ratings: Sequence[str]) -> str:
    """Return the result of several ratings, rounded half up; empty: nobody gave one."""
    numbers = sorted(number for number in map(number_of, ratings) if number is not None)
    if not numbers:
        return ""
    if item.jury is JuryResult.MEDIAN:
        numbers = numbers[(len(numbers) - 1) // 2:len(numbers) // 2 + 1]
    elif item.jury is JuryResult.WITHOUT_EXTREMES and len(numbers) > 2:
        numbers = numbers[1:-1]
    mean = _EXACT.divide(sum(numbers, Decimal(0)), Decimal(len(numbers)))
    return text_of(mean.quantize(_LAST_DECIMAL, ROUND_HALF_UP, _EXACT))


def exact_text(number: Fraction) -> str:
    """Return an exact number as text. On a sheet all numbers are decimals, so their sums and products are, too."""
    return text_of(_EXACT.divide(Decimal(number.numerator), Decimal(number.denominator)))


def counted(form: SheetForm, items: Sequence[ItemRecord], course: Course) -> CountedSheet:
    """Return the items and the sheet with their points."""
    if not form.has_points:
        return CountedSheet(tuple(items), None)
    sheet = sheet_of(form)
    worth = count(sheet, course)
    marked = {(INCIDENTS, incident.title): incident.marks for incident in sheet.incidents}
    rows = {row.key: marked.get(row.key) or id_of(row) for row in form.items if row.has_points}
    return CountedSheet(
        tuple(record._replace(points=exact_text(worth.own.get(rows[record.key], Fraction(0))))
              if record.key in rows else record for record in items),
        SheetPoints(exact_text(worth.total), tuple(_groups(sheet, worth)), worth.steps,
                    exact_text(worth.charged) if worth.charged else "", worth.replaces, _inner(sheet)))


def _groups(sheet: Sheet, worth: Worth) -> List[GroupPoints]:
    """Return the points of the sections that have items with points, of the items in no section, and of the time left.
    """
    scored = _scored(sheet)
    found = [GroupPoints(item.name, exact_text(worth.points.get(item.id, Fraction(0)))) for item in sheet.items
             if item.id in scored or item.amount is Measure.CLOCK]
    alone = [worth.points.get(item.id, Fraction(0)) for item in sheet.items
             if not item.under and not item.for_team and item.has_points]
    return [*found, GroupPoints(NO_SECTION, exact_text(sum(alone, Fraction(0))))] if alone else found


def _scored(sheet: Sheet) -> Set[str]:
    """Return the ids of the sections that have items with points."""
    sections = {item.id for item in sheet.items if item.amount is Measure.SECTION}
    return {item.under for item in sheet.items if item.under in sections and item.has_points}


def _inner(sheet: Sheet) -> Tuple[str, ...]:
    """Return the names of the groups whose points are part of those of another group."""
    scored, found = _scored(sheet), []
    within: Set[str] = set()  # ids of what is in such a group
    for item in sheet.items:  # each comes after the one under which it hangs
        if item.under in scored or item.under in within or (not item.under and item.has_points):
            within.add(item.id)
            if item.id in scored or item.amount is Measure.CLOCK:
                found.append(item.name)
    return tuple(found)
