"""The points of a score sheet: of each item, of each group, and in total (docs/organiser.md, "Points").

The points of an item and a jury's result are rounded to `MAX_DECIMALS`, so that the numbers on the sheet are those
that count. All sums are exact.
"""

from decimal import ROUND_DOWN, ROUND_FLOOR, ROUND_HALF_UP, Context, Decimal, InvalidOperation
from typing import Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.model.records import GroupPoints, ItemRecord, SheetPoints
from roah_rsbb.model.rules import JuryResult
from roah_rsbb.model.scoring import MAX_DECIMALS, MAX_VALUE, TIME_LEFT, WHOLE, Key, ScoreKind, ScoringItem, SheetForm

# More digits than any sum of values within the limits can have.
_EXACT = Context(prec=80)
_LAST_DECIMAL = Decimal(1).scaleb(-MAX_DECIMALS)
ZERO = Decimal(0)


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
    mean = _EXACT.divide(_sum(numbers), Decimal(len(numbers)))
    return text_of(_rounded(mean))


def counted(form: SheetForm, items: Sequence[ItemRecord], elapsed_s: float, end_reason: str) -> CountedSheet:
    """Return the items and the sheet with their points.

    `elapsed_s`: counted seconds until the end; `end_reason`: why the run ended, empty if it did not.
    """
    if not form.has_points:
        return CountedSheet(tuple(items), None)
    known = {item.key: item for item in form.items}
    records = {item.key: item for item in items}
    given = _given(known, records)
    points: Dict[Key, Decimal] = {
        key: _points(known[key], record) if given.issuperset(known[key].needs) else ZERO
        for key, record in records.items() if key in known and known[key].has_points
    }
    groups: Dict[str, List[Decimal]] = {}
    for (group, _desc), number in points.items():
        groups.setdefault(group, []).append(number)
    limits = {group.name: group for group in form.rules.groups}
    sums = {
        name: _limited(_sum(numbers), *((limits[name].least, limits[name].most) if name in limits else (None, None)))
        for name, numbers in groups.items()
    }
    if form.rules.time_left is not None:
        sums[TIME_LEFT] = _time_left(form, given, elapsed_s, end_reason)
    total = _limited(_sum(sums.values()), form.rules.least, form.rules.most)
    return CountedSheet(
        tuple(i._replace(points=text_of(points[i.key])) if i.key in points else i for i in items),
        SheetPoints(text_of(total), tuple(GroupPoints(name, text_of(number)) for name, number in sums.items())),
    )


def _rounded(number: Decimal) -> Decimal:
    return number.quantize(_LAST_DECIMAL, ROUND_HALF_UP, _EXACT)


def _sum(numbers: Iterable[Decimal]) -> Decimal:
    total = ZERO
    for number in numbers:
        total = _EXACT.add(total, number)
    return total


def _limited(number: Decimal, least: Optional[Decimal], most: Optional[Decimal]) -> Decimal:
    if most is not None and number > most:
        number = most
    return least if least is not None and number < least else number


def _points(item: ScoringItem, record: ItemRecord) -> Decimal:
    """Return the points of an item whose needed items are all given."""
    if record.not_attempted:
        return ZERO
    if item.kind is ScoreKind.CHOICE:
        return next((choice.points or ZERO for choice in item.choices if choice.name == record.text), ZERO)
    return _rounded(_EXACT.multiply(_amount(item, record), item.points or ZERO))


def _amount(item: ScoringItem, record: ItemRecord) -> Decimal:
    return Decimal(record.value) if item.kind in WHOLE else number_of(record.text) or ZERO


def _is_given(item: ScoringItem, record: ItemRecord) -> bool:
    """Whether the robot earned the item at all. A choice without points is not given if another choice has points."""
    if record.not_attempted:
        return False
    if item.kind is not ScoreKind.CHOICE:
        return _amount(item, record) != 0
    return bool(record.text) and (not item.has_points or _points(item, record) != 0)


def _given(known: Mapping[Key, ScoringItem], records: Mapping[Key, ItemRecord]) -> Set[Key]:
    """Return the items that are given and for which all needed items are given, too."""
    own = {key for key, record in records.items() if key in known and _is_given(known[key], record)}
    while True:
        kept = {key for key in own if own.issuperset(known[key].needs)}
        if kept == own:
            return own
        own = kept


def _time_left(form: SheetForm, given: Set[Key], elapsed_s: float, end_reason: str) -> Decimal:
    bonus = form.rules.time_left
    assert bonus is not None, "the caller checks it"
    is_due = given.issuperset(bonus.needs) if bonus.needs else end_reason == "completed"
    if not end_reason or not is_due:
        return ZERO
    # The clock counts milliseconds at best. A float's last digits must not cost a full second.
    left = max(ZERO, Decimal(repr(round(form.time_limit - elapsed_s, 3))))
    full = _EXACT.divide(left, bonus.seconds).to_integral_value(ROUND_FLOOR)
    return _limited(_EXACT.multiply(full, bonus.points), None, bonus.most)
