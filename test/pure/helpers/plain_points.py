"""Counts a score sheet a second time, plainly: mark by mark (docs/rules.md)."""

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

from roah_rsbb.model.rules import Condition, Measure, Sheet


def value(item, mark):
    """What a mark is worth alone."""
    if item.amount is Measure.CHOICE:
        return next(each.points for each in item.choices if each.name == mark.text)
    return Fraction((item.points or 0) if item.percent is None else item.percent) * mark.number


def gross(sheet, live, refused=()):
    """What marks are worth without penalties."""
    kept = [mark for mark in live if mark.number > 0]
    items = tuple(replace(item, points=Decimal(0), percent=None)
                  if (item.points or 0) < 0 or (item.percent or 0) < 0 else item for item in sheet.items)
    return plain_points(Sheet(items), kept, {}, refused)


def plain_points(sheet, live, shown, taken_away=()):
    """What marks that count are worth, with how often incidents mark a row. `taken_away`: marks that must not count."""
    items = {item.id: item for item in sheet.items}

    def units(name):
        """Each single time of a row: its part, and when; before conditions."""
        found = []
        for mark in live:
            if mark.item == name:
                if items[name].amount in (Measure.YES, Measure.CHOICE):
                    found = []
                found += [(mark.share, mark.at_s)] * abs(int(mark.number))
        return [(Fraction(1), None)] * shown[name] if name in shown else found

    def barred(item):
        for need in item.needs:
            if need.since == 1 and not need.each and not met(need):
                return True
        return any(met(need) for need in item.unless if not need.each) or any(
            met(Condition(other.id)) for other in sheet.items if item.id in other.withholds)

    def met(need):
        item = items[need.item]
        if item.amount is Measure.CHOICE and need.least is None:
            return choice(item) > 0
        if item.amount is Measure.POINTS:
            total = 0 if barred(item) else sum(mark.number for mark in live if mark.item == item.id)
            return total != 0 if need.least is None else total >= need.least
        total = sum(part for part, _ in given(item))
        return total != 0 if need.least is None else total >= need.least

    def given(item):
        found = [] if barred(item) else units(item.id)
        found = found if item.times is None else found[:item.times]
        for need in item.unless:
            if need.each:
                taken = len(given(items[need.item]))
                refused = sum(int(m.number) for m in taken_away if m.item == item.id)
                found = found[:max(0, len(found) - max(0, taken - refused))]
        for need in item.needs:
            if need.each:
                found = found[:len(given(items[need.item]))]
            elif need.since == 2 and not met(need):
                found = found[:1]
            elif need.after:
                begin = min((mark.at_s or 0 for mark in live if mark.item == need.item), default=0)
                moments = [mark.at_s for mark in live if mark.item == item.id for _ in range(abs(int(mark.number)))]
                early = sum(at is not None and at < begin for at in moments[1:])
                found = found[:max(1, len(found) - early)]
        return found

    def choice(item):
        text = next((mark.text for mark in reversed(live) if mark.item == item.id), "")
        found = next((int(each.points) for each in item.choices if each.name == text), 0)
        return 0 if barred(item) else found

    def limited(item, points):
        points = points if item.most is None else min(points, Fraction(item.most))
        return points if item.least is None else max(points, Fraction(item.least))

    def change(child, parts, base):
        if child.percent is None:
            return sum(parts, Fraction(0)) * Fraction(child.points or 0)
        left = base
        for part in parts:
            left += (left if child.compounding else base) * part * Fraction(child.percent) / 100
        return left - base

    def points(item):
        children = [child for child in sheet.items if child.under == item.id]
        if item.each:
            return each_time(item, children)
        if item.amount is Measure.POINTS:
            own = 0 if barred(item) else sum((mark.number for mark in live if mark.item == item.id), Fraction(0))
        elif item.amount is Measure.CHOICE:
            own = choice(item)
        else:
            own = sum((part for part, _ in given(item)), Fraction(0)) * Fraction(item.points or 0)
        total = Fraction(0) if item.amount is Measure.SECTION else Fraction(own)
        for child in () if barred(item) else children:
            total += (points(child) if child.percent is None else
                      change(child, [part for part, _ in given(child)], total))
        return limited(item, total)

    def each_time(item, children):
        times = [(part, {}) for part, _ in given(item)]
        seen, left = 0, {child.id: [part for part, _ in given(child)] for child in children}
        for mark in live:
            for _ in range(abs(int(mark.number))):
                if mark.item == item.id:
                    seen = min(seen + 1, len(times))
                elif left.get(mark.item) and times:
                    before = times[:seen] or times[:1]
                    free = [own for _, own in before if mark.item not in own]
                    (free[-1] if free else before[-1][1]).setdefault(mark.item, []).append(left[mark.item].pop(0))
        total = Fraction(0)
        for part, own in times:
            worth = Fraction(item.points or 0) * (1 if item.share_of_all else part)
            for child in children:
                worth += change(child, own.get(child.id, []), worth)
            total += limited(item, worth * part if item.share_of_all else worth)
        return total

    total = Fraction(0)
    for item in sheet.items:
        if not item.under:
            total += points(item)
    return total
