"""Score sheets with incidents, and what their entries are worth by docs/rules.md, counted plainly."""

from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

from helpers.plain_points import gross, plain_points
from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, Measure, Sheet, Voids
from roah_rsbb.model.scoring import INCIDENTS
from roah_rsbb.scoring.tree import SheetMark

# How often referees mark each incident.
INCIDENT_WEIGHTS = {"restart": 6, "inactive": 4, "active again": 2, "longer time": 1, "cheating": 1, "disqualified": 1}
HANDED = ItemChoice("to a person", Decimal(40)), ItemChoice("to the table", Decimal(15))


def drawn_sheet(draw, limit_s):
    """The sheet of a benchmark, for runs of so many seconds."""
    ends = ("active again", "restart")
    incidents = (
        Incident("restart", draw.choice((None, 1)), draw.choice((None, None, Decimal(30), Decimal(60))),
                 draw.random() < 0.5, voids=draw.choice((Voids.EARLIER, Voids.EARLIER, Voids.EARLIER_POINTS))),
        Incident("inactive"), Incident("active again"), Incident("longer time"),
        Incident("removed", of="inactive", after=Decimal(draw.choice((1, 3))), ends=ends, voids=Voids.LATER,
                 longer_by="longer time", longer=Decimal(3), requests=1),
        Incident("cheating", voids=Voids.ALL, marks="cheats"), Incident("disqualified", voids=Voids.ALL))
    least = draw.choice((None, Decimal(0)))
    items = (
        Item("task", "Task", amount=Measure.SECTION, least=least, most=draw.choice((None, Decimal(90)))),
        Item("door", "opens the door", "task", Measure.YES, Decimal(10), times=1),
        Item("objects", "takes objects", "task", points=Decimal(20), times=draw.choice((3, None)), least=least),
        Item("asks", "asks again", "objects", points=Decimal(-15)),
        Item("command", "does the command", "task", Measure.PERCENT, Decimal(50), times=1,
             needs=(Condition("door"),)),
        Item("hands", "hands it over", "task", Measure.CHOICE, choices=HANDED, unless=(
            Condition("objects", least=Decimal(3)),)),
        Item("touches", "touches the tape", "task", percent=Decimal(-10), compounding=draw.random() < 0.5),
        Item("penalties", "Penalties", amount=Measure.SECTION),
        Item("bumps", "bumps", "penalties", points=Decimal(-3)),
        Item("cheats", "cheats", "penalties", Measure.YES, Decimal(-200), times=1))
    counts_late = draw.random() < 0.2
    return Sheet(items, incidents, None if counts_late else Decimal(str(limit_s)), limit_s if counts_late else None)


class Counts(NamedTuple):
    """What counts of the entries of a sheet."""

    values: dict  # of all rows that were marked, by key
    void: set  # places of entries that incidents make void
    late: set  # places of other entries that came too late to count
    total: Fraction = Fraction(0)


def after(before, kept):
    """The value of a row after an entry: nobody takes away more than there is."""
    return max(0, before + int(kept.added)) if kept.added else kept.value


def plain_values(entries):
    """The values of rows by their entries that count."""
    values = {}
    for kept in entries:
        values[kept.key] = after(values.get(kept.key, 0), kept)
    return values


class Plain:
    """Goes through a sheet's entries in the order of their moments: (s, place)."""

    def __init__(self, sheet, rows, entries):
        self._sheet, self._entries = sheet, entries
        self._rules = {rule.name: rule for rule in sheet.incidents}
        self._items = {item.id: item for item in sheet.items}
        self._item_of = {row.key: self._items[row.id] for row in rows if row.group != INCIDENTS}
        self._incident_of = {row.key: row.id for row in rows if row.group == INCIDENTS}
        self._live, self._void, self._late = [], set(), set()  # places
        self._shown = {}  # how often incidents mark a row
        self._held = {name: [] for name in self._rules}  # when each had an effect
        self._removed = None  # since when the robot is
        self._limit = None if sheet.limit_s is None else Fraction(sheet.limit_s)

    def counts(self):
        """What counts."""
        moments, happened, marks = self._moments(), {}, []
        for place, kept in enumerate(self._entries):
            at = moments[place], place
            if kept.is_withdrawn:
                continue
            if kept.key in self._item_of:
                marks.append((*at, kept.key))
                continue
            found = happened.setdefault(self._incident_of[kept.key], [])
            number = after(len(found), kept)
            del found[number:]
            found += [at] * (number - len(found))
        due = [(*at, None) for at in self._dues(happened)]
        incidents = [(*at, name) for name, those in happened.items() for at in those]
        for at, place, what in sorted([*marks, *incidents, *due], key=lambda each: each[:2]):
            if not what:
                self._is_due(at, place)
            elif isinstance(what, tuple):
                self._mark(at, place)
            else:
                self._happens(at, self._rules[what])
        if any(self._held[name] for name in ("cheating", "disqualified")):
            self._void |= set(self._live)
            self._live = []
        values = plain_values([self._entries[place] for place in sorted(self._live)])
        values.update(plain_values(
            kept for kept in self._entries if kept.key in self._incident_of and not kept.is_withdrawn))
        return Counts(values, self._void, self._late, plain_points(self._sheet, self._marks(), self._shown))

    def _moments(self):
        """When each entry was made: the clock leaves out what the box was away for, and never goes back."""
        found, before = [], Fraction(0)
        for kept in self._entries:
            found.append(before if kept.clock_s is None else max(before, Fraction(str(kept.clock_s))))
            if self._limit is None or found[-1] <= self._limit:
                before = found[-1]
        return found

    def _dues(self, happened):
        """When the robot is removed, unless it is active before: with since when it is not, in the place of one."""
        rule, found = self._rules["removed"], []
        for since, _ in happened.get("inactive", ()):
            due = since + Fraction(rule.after)
            for asked, _ in sorted(happened.get("longer time", ()))[:rule.requests]:
                due = max(due, asked + Fraction(rule.longer)) if asked <= due else due
            if self._limit is None or due <= self._limit:
                found.append((due, len(self._entries) + since))  # after all of that moment
        return found

    def _is_due(self, at, place):
        since = place - len(self._entries)
        if not any(moment >= since for name in self._rules["removed"].ends for moment in self._held[name]):
            self._removed = at if self._removed is None else self._removed

    def _mark(self, at, place):
        kept = self._entries[place]
        before = self._values().get(kept.key, 0)
        is_late = self._limit is not None and at > self._limit and not kept.is_in_time
        if self._is_less(kept.key, before, after(before, kept)):
            self._live.append(place)
        elif self._removed is not None and at > self._removed:
            self._void.add(place)
        elif is_late:
            self._late.add(place)
        else:
            self._live.append(place)

    def _is_less(self, key, before, now):
        """Whether something is taken away: that corrects a mark, and is never too late."""
        choices = self._item_of[key].choices
        if not choices or not now:
            return now <= before
        return before > 0 and choices[now - 1].points <= choices[before - 1].points

    def _happens(self, at, rule):
        if rule.marks:
            self._shown.setdefault(rule.marks, 0)
        count = plain_points if rule.net else lambda sheet, live, shown: gross(sheet, live)
        if (rule.times is not None and len(self._held[rule.name]) >= rule.times) or (
                rule.below is not None and count(self._sheet, self._marks(), {}) >= rule.below):
            return
        self._held[rule.name].append(at)
        if rule.marks:
            self._shown[rule.marks] += 1
        if rule.name == "removed" and self._removed is None:
            self._removed = at
        elif rule.voids in (Voids.EARLIER, Voids.EARLIER_POINTS):
            stay = [place for place in self._live if rule.voids is Voids.EARLIER_POINTS and self._is_penalty(place)]
            self._void |= set(self._live) - set(stay)
            self._live = stay

    def _is_penalty(self, place):
        item = self._item_of[self._entries[place].key]
        return (item.points or 0) < 0 or (item.percent or 0) < 0

    def _values(self):
        return plain_values(self._entries[place] for place in sorted(self._live))

    def _marks(self):
        """One mark for each row."""
        found = []
        for key, value in self._values().items():
            item = self._item_of[key]
            if item.amount is Measure.PERCENT and value:
                found.append(SheetMark(item.id, share=Fraction(value, 100)))
            elif item.amount is Measure.CHOICE:
                found.append(SheetMark(item.id, text=item.choices[value - 1].name if value else ""))
            elif value:
                found.append(SheetMark(item.id, Fraction(value)))
        return found
