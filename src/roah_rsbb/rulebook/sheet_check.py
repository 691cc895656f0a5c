"""Finds what a score sheet says in vain: rows that never change the points, conditions that nothing can meet, incidents
from which nothing follows, and totals that differ from what the rule book states (docs/rules.md, "Check").

Each row has a span: the least and the most points that it can give, whatever is marked. Conditions are not part of it,
except those that nothing can meet.
"""

from decimal import Decimal
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.model.rules import Condition, Incident, Item, Measure, Sheet, Voids
from roah_rsbb.rulebook.errors import listing, quote

ZERO, MANY = Decimal(0), Decimal("Infinity")


class _Span(NamedTuple):
    """The least and the most of something."""

    least: Decimal = ZERO
    most: Decimal = ZERO

    def __add__(self, other: object) -> "_Span":
        assert isinstance(other, _Span)
        return _Span(self.least + other.least, self.most + other.most)

    def times(self, low: Decimal, high: Decimal) -> "_Span":
        """Return what a factor from `low` to `high` makes of it."""
        ends = [_product(one, other) for one in self for other in (low, high)]
        return _Span(min(ends), max(ends))

    def limited(self, least: Optional[Decimal], most: Optional[Decimal]) -> "_Span":
        """Return it within limits; the lower one wins."""
        ends = [number if most is None else min(number, most) for number in self]
        return _Span(*(number if least is None else max(number, least) for number in ends))


def _product(one: Decimal, other: Decimal) -> Decimal:
    return one * other if one and other else ZERO  # also of nothing and infinity


def _text(number: Decimal) -> str:
    return f"{number.normalize():f}"


def findings(sheet: Sheet) -> List[str]:
    """Return what is in vain in a sheet, in words."""
    return [*_Rows(sheet).findings(), *(text for incident in sheet.incidents for text in _of_incident(sheet, incident))]


class _Rows:
    """The rows, with what they can give."""

    def __init__(self, sheet: Sheet) -> None:
        self._sheet = sheet
        self._items = {item.id: item for item in sheet.items}
        self._under: Dict[str, List[Item]] = {}
        for item in sheet.items:
            self._under.setdefault(item.under, []).append(item)
        self._never = {item.id: self._why_never(item) for item in sheet.items}
        self._found: List[str] = []

    def findings(self) -> List[str]:
        """Return what is in vain, in the order of the rows."""
        self._sum(_Span(), self._under.get("", ()))
        asked = {each.item for item in self._items.values() for each in (*item.needs, *item.unless)}
        asked |= {item.id for item in self._items.values() if item.withholds}
        asked |= {fact.item for each in self._sheet.incidents for fact in (*each.when, *each.unless)}
        has_points = any(item.points is not None or item.percent is not None for item in self._items.values())
        for item in self._items.values():
            name = quote(item.name)
            if self._never[item.id]:
                self._found.append(f"{name} never counts: {self._never[item.id]}")
            elif item.amount is Measure.SECTION:
                if item.id not in self._under:
                    self._found.append(f"{name} is a section without items")
            elif has_points and item.id not in {*asked, *self._under} and not item.has_points and (
                    item.amount is not Measure.CLOCK):
                self._found.append(f"{name} gives no points, and no other row depends on it: write "
                                   f"'{_recorded(item)}' if it is only recorded")
            for condition in item.needs:
                if item.times is not None and condition.since > item.times:
                    self._found.append(f"{name} needs {self._name(condition)} from count {condition.since} on, and "
                                       f"counts at most {item.times} times")
        return self._found

    def _name(self, condition: Condition) -> str:
        return quote(self._items[condition.item].name)

    # -- what rows can give -------------------------------------------------------------------------

    def _sum(self, base: _Span, items: Sequence[Item]) -> _Span:
        """Return what is reached with these rows."""
        for item in items:
            span = self._span(item, base)
            if item.for_team:
                continue  # not of the sheet
            if item.percent is None or self._never[item.id]:
                base += span
            else:  # of whatever is reached before: not the most of one and the least of the other
                low, high = self._factors(item)
                base = base.times(1 + low, 1 + high)
        return base

    def _span(self, item: Item, base: _Span) -> _Span:
        """Return what a row can give with all that hangs under it. `base`: what is reached without it."""
        own = self._own(item, base)
        found = self._sum(own, self._under.get(item.id, ()))
        times = Decimal(1) if not item.each else MANY if item.times is None else Decimal(item.times)
        least, most = (None if limit is None else _product(limit, times) for limit in (item.least, item.most))
        limited = found.limited(least, most)
        if found.least != found.most and limited.least == limited.most:
            self._found.append(f"{quote(item.name)} is always {_text(limited.least)} points: its limits leave nothing "
                               "else")
        if item.percent and base.least == base.most == ZERO:
            self._found.append(f"{quote(item.name)} is a percentage of nothing: no row before it gives points")
        if item.total is not None and item.total != limited.most:
            most_text = "any number of" if limited.most == MANY else f"at most {_text(limited.most)}"
            self._found.append(f"{quote(item.name)} has the total {_text(item.total)}, and its rows give {most_text} "
                               "points")
        return _Span() if self._never[item.id] else limited

    def _own(self, item: Item, base: _Span) -> _Span:
        if item.amount is Measure.CHOICE:
            worths = [choice.points or ZERO for choice in item.choices]
            return _Span(min(ZERO, *worths), max(ZERO, *worths))
        if item.percent is not None:
            return base.times(*self._factors(item))
        points = item.points or ZERO
        return _Span(points, points).times(*self._amounts(item))

    def _amounts(self, item: Item) -> _Span:
        """Return how often a row may count."""
        if item.amount is Measure.CLOCK:
            return _Span(ZERO, (self._sheet.limit_s or Decimal(str(self._sheet.clock_s or 0))) // item.seconds)
        if item.amount in (Measure.NUMBER, Measure.WHOLE, Measure.POINTS, Measure.RATING):
            return _Span(-MANY if item.low is None else min(ZERO, item.low), MANY if item.high is None else item.high)
        return _Span(ZERO, MANY if item.times is None else Decimal(item.times))

    def _factors(self, item: Item) -> _Span:
        """Return which part of what is reached before a percentage can add."""
        rate, (low, high) = (item.percent or ZERO) / 100, self._amounts(item)
        if item.compounding and high != MANY:
            return _Span(*sorted((ZERO, (1 + rate) ** int(high) - 1)))
        if item.compounding and rate < 0:
            return _Span(-Decimal(1), ZERO)  # each time leaves something
        return _Span(*sorted((_product(rate, low), _product(rate, high))))

    # -- conditions ---------------------------------------------------------------------------------

    def _why_never(self, item: Item) -> str:
        """Return why a row can never count; empty: it can."""
        needed: Set[Tuple[str, str]] = set()  # rows that must count, and with which choice
        for condition in self._needed(item, needed):
            other = self._items[condition.item]
            most = other.times if other.high is None else other.high
            if condition.least is not None and most is not None and condition.least > most:
                return f"it needs {self._name(condition)} ≥ {_text(condition.least)}, which is at most {most}"
        chosen: Dict[str, str] = {}
        for row_id, text in sorted(needed):
            if text and chosen.setdefault(row_id, text) != text:
                return f"it needs {quote(self._items[row_id].name)} to be {chosen[row_id]} and {text}"
        ids = {row_id for row_id, _ in needed}
        for row_id in sorted(ids):
            row = self._items[row_id]
            for condition in row.unless:
                is_plain = not condition.each and condition.least is None
                if is_plain and condition.item in ids and chosen.get(condition.item, "") == condition.text:
                    return f"it needs {self._name(condition)}, with which {quote(row.name)} does not count"
            for other_id in row.withholds:
                if other_id in ids:
                    return f"it needs {quote(row.name)}, which withholds {quote(self._items[other_id].name)}"
        return ""

    def _needed(self, item: Item, needed: Set[Tuple[str, str]]) -> Iterator[Condition]:
        """Yield the conditions of a row and of those that it needs, and note the rows."""
        above: Optional[Item] = item
        while above is not None:
            needed.add((above.id, ""))
            for condition in above.needs:
                if condition.since <= 1:
                    yield condition
                    if (condition.item, condition.text) not in needed:
                        needed.add((condition.item, condition.text))
                        yield from self._needed(self._items[condition.item], needed)
            above = self._items.get(above.under)


def _recorded(item: Item) -> str:
    """Return what a row has in the file that gives no points on purpose."""
    if item.amount is not Measure.CHOICE:
        return "points: 0"
    return f"choices: {{{', '.join(f'{choice.name}: 0' for choice in item.choices)}}}"


def _of_incident(sheet: Sheet, incident: Incident) -> Iterator[str]:
    """Yield what is in vain in an incident."""
    name = quote(incident.name)
    both = [fact.item for fact in incident.when if fact in incident.unless]
    if both:
        yield f"{name} has never an effect: it needs {listing(map(quote, both))}, and must not have it"
    if incident.below is not None and incident.below <= 0 and not incident.net:
        yield f"{name} is never allowed: no points are less than {incident.below}"
    named = {other for each in sheet.incidents for other in (*each.ends, each.longer_by, each.of)}
    if incident.voids is Voids.NOTHING and not incident.marks and not incident.pauses and (
            incident.name not in named and not incident.at_end):
        yield f"nothing follows from {name}"
