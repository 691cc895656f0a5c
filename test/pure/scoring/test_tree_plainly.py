"""Random sheets with random incidents, counted a second time: second by second, and mark by mark."""

import random
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import pytest

from helpers.plain_points import gross, plain_points, value
from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, Measure, Sheet, Voids
from roah_rsbb.scoring.tree import Course, Happened, SheetMark, count

LIMIT_S = 300
MODIFIERS = (Measure.COUNT, Measure.YES, Measure.PERCENT)
CHOICES = ItemChoice("fully", Decimal(30)), ItemChoice("partly", Decimal(10)), ItemChoice("not", Decimal(0))


# -- random rules -----------------------------------------------------------------------------------


def limits(chance):
    least, most = chance.choice([None, None, 0, -20]), chance.choice([None, None, 60, 120])
    return {"least": None if least is None else Decimal(least), "most": None if most is None else Decimal(most)}


def row(chance, name, under, amount):
    worth = {"points": Decimal(chance.choice([-40, -15, 0, 5, 20, 45, 80]))}
    if amount is Measure.CHOICE:
        return Item(name, name, under, amount, choices=CHOICES)
    if amount is Measure.POINTS:
        return Item(name, name, under, amount, Decimal(1))
    if under and chance.random() < 0.25:
        worth = {"percent": Decimal(chance.choice([-50, -5, 10])), "compounding": chance.random() < 0.5}
    times = 1 if amount is Measure.YES else chance.choice([None, 1, 2, 3])
    return Item(name, name, under, amount, times=times, **worth)


def random_sheet(chance):
    items = []
    for number in range(chance.randint(1, 5)):
        above = ""
        if chance.random() < 0.5:
            above = f"section {number}"
            items.append(Item(above, above, amount=Measure.SECTION, **limits(chance)))
        amount = chance.choice([*MODIFIERS, Measure.POINTS, Measure.CHOICE])
        own = row(chance, f"row {number}", above, amount)
        counted = amount in MODIFIERS and chance.random() < 0.6
        earlier = [item.id for item in items if item.amount is not Measure.SECTION and (
            item.amount in MODIFIERS or not counted)]
        conditions = [Condition(chance.choice(earlier), **chance.choice([
            {}, {"least": Decimal(2)}, *([{"each": True}, {"since": 2}, {"since": 2, "after": True}]
                                         if counted else [])]))] if earlier else []
        kind = chance.choice(["needs", "unless", "withholds", ""]) if conditions else ""
        if kind == "needs":
            own = replace(own, needs=tuple(conditions))
        elif kind == "unless" and conditions[0].since == 1:
            own = replace(own, unless=tuple(conditions))
        elif kind == "withholds":
            own = replace(own, withholds=(conditions[0].item,))
        if amount in MODIFIERS and own.percent is None and chance.random() < 0.6:
            each = chance.random() < 0.5
            own = replace(own, **limits(chance), each=each, share_of_all=each and chance.random() < 0.5)
            items.append(own)
            items += [row(chance, f"row {number}.{child}", own.id, chance.choice(MODIFIERS))
                      for child in range(chance.randint(1, 3))]
        else:
            items.append(own)
    items += [Item("cheating", "cheating", points=Decimal(-500), times=1),
              Item("restarted", "restarted", points=Decimal(-50))]
    restart = Incident(
        "restart", times=chance.choice([None, 1]), below=chance.choice([None, Decimal(40)]), net=chance.random() < 0.5,
        voids=chance.choice([Voids.EARLIER, Voids.EARLIER_POINTS, Voids.NOTHING]), ends=("restarted",),
        **({"marks": "restarted", "scored_after": True} if chance.random() < 0.3 else {}))
    return Sheet(tuple(items), (
        restart, Incident("inactive"), Incident("pause", pauses=True, ends=("resume",)),
        Incident("removed", of="inactive", after=Decimal(30), ends=("active again", "restart"), voids=Voids.LATER,
                 longer_by="longer time", longer=Decimal(60), requests=1),
        Incident("disqualified", voids=Voids.ALL), Incident("cheating", voids=Voids.ALL, marks="cheating"),
    ), Decimal(LIMIT_S))


def random_course(chance, sheet):
    """Nothing happens at the same time as anything else."""
    seconds = chance.sample(range(1, 380), 60)
    marks = []
    for item in sheet.items:
        if item.amount is Measure.SECTION or item.id in ("cheating", "restarted"):
            continue
        for place in range(chance.choice([0, 1, 1, 2, 3])):
            number = 1 if item.amount in (Measure.YES, Measure.CHOICE) else chance.choice([1, 1, 2, 3])
            if item.amount is Measure.POINTS:
                number = chance.choice([-30, 10, 25])
            at_s = None if place == 0 and chance.random() < 0.2 else Fraction(seconds.pop())
            marks.append(SheetMark(
                item.id, Fraction(number), at_s=at_s,
                share=Fraction(chance.choice([1, 2, 4]), 4) if item.amount is Measure.PERCENT else Fraction(1),
                text=chance.choice(CHOICES).name if item.amount is Measure.CHOICE else "",
                in_time=chance.random() < 0.1, refused="no" if chance.random() < 0.1 else ""))
    names = ["restart", "restarted", "inactive", "active again", "longer time", "pause", "resume", "removed"]
    if chance.random() < 0.15:
        names += ["disqualified", "cheating"]
    happened = [Happened(chance.choice(names), Fraction(seconds.pop()), {"seconds": chance.choice([20, 90])})
                for _ in range(chance.choice([0, 1, 3, 6]))]
    return Course(tuple(marks), tuple(happened))


# -- a run, second by second ------------------------------------------------------------------------


def plain_total(sheet, course):
    rules = {each.name: each for each in sheet.incidents}
    live, counted, paused, restarting, removed, lost, allowed = [], 0, False, None, False, False, 0
    due, until, shown, restarts_at = None, None, {}, []
    refused = [mark for mark in course.marks if mark.refused]
    for now in range(1, 400):
        counted += 0 if paused else 1
        for mark in course.marks:
            is_now = mark.at_s == now and not mark.refused and (counted <= LIMIT_S or mark.in_time)
            if is_now and not removed and (restarting is None or now > restarting or not voids(rules, sheet, mark)):
                live.append(mark)
        for each in course.incidents:
            if each.at_s != now:
                continue
            name, rule = each.incident, rules.get(each.incident)
            if name == "pause":
                paused = paused or True
            elif name == "resume":
                paused = False
            elif name == "restart":
                is_allowed = (rule.times is None or allowed < rule.times) and (
                    rule.below is None or so_far(sheet, live, rule.net, refused) < rule.below)
                if rule.marks:
                    shown["restarted"] = shown.get("restarted", 0)
                if is_allowed:
                    allowed, due = allowed + 1, None
                    live = [mark for mark in live if not voids(rules, sheet, mark)]
                    later = [one.at_s for one in course.incidents if one.incident == "restarted" and one.at_s > now]
                    restarting = min(later, default=None)
                    restarts_at.append(now)
            elif name == "inactive":
                due = max(counted + 30, until or 0) if due is None else due
            elif name == "active again":
                due = None
            elif name == "longer time" and until is None:
                until = counted + min(60, each.facts["seconds"])
                due = None if due is None else max(due, until)
            elif name == "removed":
                removed = True
            elif name in ("disqualified", "cheating"):
                lost = True
                if name == "cheating":
                    shown["cheating"] = shown.get("cheating", 0) + 1
        removed = removed or (due is not None and LIMIT_S >= counted >= due)
    live += [mark for mark in course.marks if mark.at_s is None and not mark.refused]
    live = [] if lost else live
    if rules["restart"].marks and restarts_at:  # each costs something if points that count were scored after it
        items = {item.id: item for item in sheet.items}
        shown["restarted"] = sum(any(scored_after(item, live, at) for item in items.values()) for at in restarts_at)
    return plain_points(sheet, live, shown, refused)


def so_far(sheet, live, net, refused):
    return plain_points(sheet, live, {}, refused) if net else gross(sheet, live, refused)


def scored_after(item, live, at):
    """Whether a row that gives points gives more at the end than at some moment since."""
    own = [mark for mark in live if mark.item == item.id]
    if (item.points or item.percent or 0) < 0:
        return False
    worths, now = [Fraction(0)], Fraction(0)
    for mark in own:
        is_one = item.amount in (Measure.YES, Measure.CHOICE)
        now = max(Fraction(0), Fraction(value(item, mark)) * mark.share + (0 if is_one else now))
        worths = [*worths, now] if mark.at_s is None or mark.at_s > at else [now]
    return now > min(worths)


def voids(rules, sheet, mark):
    """Whether a restart makes a mark void."""
    item = next(item for item in sheet.items if item.id == mark.item)
    how = rules["restart"].voids
    return how is Voids.EARLIER or (how is Voids.EARLIER_POINTS and value(item, mark) >= 0)


@pytest.mark.parametrize("seed", range(40))
def test_a_random_run_is_worth_what_it_is_worth_plainly(seed):
    chance = random.Random(seed)
    for _ in range(25):
        sheet = random_sheet(chance)
        course = random_course(chance, sheet)
        ordered = Course(tuple(sorted(course.marks, key=lambda mark: mark.at_s or 1000)), course.incidents)
        found = count(sheet, course)
        expected = plain_total(sheet, ordered)
        assert found.total == expected, (sheet, course)
        timed = [mark for mark in course.marks if mark.at_s is not None]
        without_time = [mark for mark in course.marks if mark.at_s is None]  # they count in the order of arrival
        arrived = Course((*chance.sample(timed, len(timed)), *without_time),
                         tuple(chance.sample(course.incidents, len(course.incidents))))
        assert count(sheet, arrived).total == found.total
        for item in sheet.items:
            if not item.each and item.id in found.points:
                assert item.least is None or found.points[item.id] >= item.least
                assert item.most is None or found.points[item.id] <= item.most
        assert count(sheet, Course()).total == 0
