"""What a score sheet is worth: its marks and incidents, counted by its rules (docs/rules.md).

Theory of operation. `count` goes through what happened in the order in which it happened. Incidents make marks void;
what is left gives each item an amount. Then the tree is added up from its leaves: an item has its own points, each
item under it adds to them or takes a percentage of what is left, and limits apply at the end. All numbers are exact
fractions. Every step that a reader could doubt is said in words.
"""

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.reason import Reason, say
from roah_rsbb.model.rules import Condition, Incident, Item, ItemChoice, Measure, Sheet, Voids
from roah_rsbb.wording.times import elapsed

ZERO, ONE = Fraction(0), Fraction(1)
# Times of an item that are counted one by one. No robot does anything more often in a run.
MAX_EACH = 1000

LATE = say("{item} at {time}: after the limit of {limit}, so it does not count")
VOID = say("{item}{time}: void because of: {incident}")
REFUSED = say("{item}{time}: must not count: {why}")
TOO_OFTEN = say("{incident}{time}: time {number}, {times} allowed: it has no effect")
TOO_LATE = say("{incident}{time}: {points} points, allowed below {below}: it has no effect")
NO_EFFECT = say("{incident}{time}: it has no effect ({why})")
LACKING = say("no {fact}")
BY_ITSELF = say("{incident} at {time}, by itself")
TIMES = say("{item}: {number} × {each} = {points}")
SUM = say("{item}: {sum} = {points}")
TOTAL = say("Total: {points}")
TOTAL_OF = say("Total: {sum} = {points}")
AT_LEAST = say("{item}: {sum}, at least {limit}: {points}")
AT_MOST = say("{item}: {sum}, at most {limit}: {points}")
CAPPED = say("{item}: {number} ×, only {times} × count")
LACKS = say("{item}: does not count without {needs}")
BARRED = say("{item}: does not count with {other}")
FOR_TEAM = say("{item}: {points} for the team, whichever attempt counts")
NOT_COMPLETED = say("{item}: 0 of {points}, because the robot did not complete the run")
NOT_GIVEN = say("{why}: 0 of {points}")
MORE_THAN = say("{item}: {number} ×, but {other} only {times} ×")


# Steps that say what does not count or has no effect, and which incident came by itself.
RULINGS = (LATE, VOID, REFUSED, TOO_OFTEN, TOO_LATE, NO_EFFECT, BY_ITSELF)


class SheetMark(NamedTuple):
    """An entry of a sheet. What was withdrawn is not among the marks."""

    item: str  # id
    number: Fraction = ONE  # how often, or the number itself; of points and choices see `Item`
    share: Fraction = ONE  # of each time, for `Measure.PERCENT`
    text: str = ""  # of a choice
    sets: bool = False  # it replaces the marks before instead of adding to them
    at_s: Optional[Fraction] = None  # seconds since the start; None: not known, after everything
    in_time: bool = False  # the referee said so: it is not late
    corrects: bool = False  # it takes something away: it is never too late
    refused: str = ""  # why it must not count
    name: str = ""  # what a row that was made at the event is called
    order: int = 0  # what has the same time came in this order


class Happened(NamedTuple):
    """An incident that happened."""

    incident: str
    at_s: Optional[Fraction] = None
    facts: Mapping[str, object] = {}
    since: Optional[Fraction] = None  # it comes by itself, unless something has ended what began then
    order: int = 0  # see `SheetMark.order`


class Course(NamedTuple):
    """What happened in a run, as far as points depend on it."""

    marks: Tuple[SheetMark, ...] = ()
    incidents: Tuple[Happened, ...] = ()
    clock_counts: bool = False  # times are of the counted clock, which pauses have stopped already
    ended: bool = False
    completed: bool = False  # the robot completed the run
    elapsed_s: Fraction = ZERO  # counted seconds until the end; 0: not known


class Worth(NamedTuple):
    """What a sheet is worth."""

    total: Fraction
    points: Mapping[str, Fraction]  # of each item with all that hangs under it, by id
    own: Mapping[str, Fraction]  # of each item alone, before limits, by id
    steps: Tuple[str, ...]
    replaces: bool  # the attempts before this one do not count
    charged: Fraction = ZERO  # points that the team gets whichever attempt counts; not in the total


def count(sheet: Sheet, course: Course) -> Worth:
    """Return what a sheet is worth. Marks of unknown items raise KeyError: their sender was asked before."""
    run = _Run(sheet, course)
    steps, void = run.go_through()
    tree = _Tree(sheet, run.left(void), run.decided, course)
    total = tree.total()
    return Worth(total, tree.points, tree.own, (*steps, *tree.steps), run.replaces, tree.charged)


def is_late(why: str) -> bool:
    """Whether a mark does not count because it came after the time limit."""
    return isinstance(why, Reason) and why.template == LATE


class VoidMark(NamedTuple):
    """A mark that does not count."""

    why: str
    since: Tuple[Fraction, int]  # moment of what made it void: until then, it counted; see `_moment`


def void_marks(sheet: Sheet, course: Course) -> Mapping[int, VoidMark]:
    """Return the marks that do not count, by their place in the course."""
    return _Run(sheet, course).go_through()[1]


def moments(sheet: Sheet, course: Course) -> Tuple[Fraction, ...]:
    """Return when incidents come by themselves, unless what leads to them is ended before."""
    return tuple(each.at_s or ZERO for each in _Run(sheet, course._replace(ended=True)).by_themselves())


# -- what happened ----------------------------------------------------------------------------------


class _Run:
    """The course of a run: which incidents have an effect, and which marks they make void."""

    def __init__(self, sheet: Sheet, course: Course) -> None:
        self.sheet = sheet
        self.course = course
        self.rules = {incident.name: incident for incident in sheet.incidents}
        self.names = {item.id: item.name for item in sheet.items}
        self.decided: Dict[str, Tuple[int, str]] = {}  # item that incidents mark -> how often, and with which choice
        self.replaces = False
        self._items = {item.id: item for item in sheet.items}
        self._marks = course.marks
        self._held: Dict[str, List[Optional[Fraction]]] = {}  # incident -> when it had an effect
        self._costs_later: List[Tuple[str, Happened]] = []  # items, if points are scored after these incidents
        self._pauses = [] if course.clock_counts else self._find_pauses()
        # Facts about incidents that are on the sheet.
        self._facts: Dict[str, object] = {mark.item: mark.text or mark.number for mark in course.marks}
        self._void: Dict[int, VoidMark] = {}
        self._steps: List[str] = []

    def go_through(self) -> Tuple[List[str], Dict[int, VoidMark]]:
        """Return what was decided, in words, and the marks that do not count."""
        self._drop_late()
        for happened in sorted([*self.course.incidents, *self.by_themselves()], key=_when):
            rule = self.rules.get(happened.incident, Incident(happened.incident))
            if not self._is_over(rule, happened):
                self._take(rule, happened)
        for item, happened in self._costs_later:
            if self._scored_after(happened):
                self._decide(item)
        return self._steps, self._void

    def left(self, void: Mapping[int, VoidMark]) -> List[SheetMark]:
        """Return the marks that are not void, in the order in which they were made."""
        return sorted((mark for index, mark in enumerate(self._marks) if index not in void), key=_made)

    def _drop_late(self) -> None:
        limit = None if self.sheet.limit_s is None else Fraction(self.sheet.limit_s)
        for index, mark in enumerate(self._marks):
            at_s = self._counted(mark.at_s)
            if mark.refused:
                self._drop(index, REFUSED(item=self._name(mark), time=_at(at_s), why=mark.refused), mark)
            elif limit is not None and at_s is not None and at_s > limit and not (mark.in_time or mark.corrects):
                self._drop(index, LATE(item=self._name(mark), time=_clock(at_s), limit=_clock(limit)), mark)

    def _drop(self, index: int, why: str, by: object) -> None:
        if index not in self._void:
            self._void[index] = VoidMark(why, _moment(by))
            self._steps.append(why)

    def _name(self, mark: SheetMark) -> str:
        return mark.name or self.names[mark.item]

    def _find_pauses(self) -> List[Tuple[Fraction, Optional[Fraction]]]:
        """Return when the counted clock was paused, in order: from when, until when."""
        found = []
        for rule in self.sheet.incidents:
            begun = sorted((each for each in self.course.incidents if each.incident == rule.name), key=_when)
            for start in begun[:rule.times] if rule.pauses else ():
                if start.at_s is not None:
                    end = self._end_of(rule, start)
                    found.append((start.at_s, None if end is None else end.at_s))
        return sorted(found, key=lambda pause: pause[0])

    def _counted(self, wall_s: Optional[Fraction]) -> Optional[Fraction]:
        """Return the counted time of a wall time: without the pauses before it."""
        if wall_s is None:
            return None
        paused = done = ZERO
        for begin, until in self._pauses:
            if begin < wall_s:
                end = wall_s if until is None else min(wall_s, until)
                paused += max(ZERO, end - max(begin, done))
                done = max(done, end)
        return wall_s - paused

    def _after(self, wall_s: Fraction, seconds: Fraction) -> Optional[Fraction]:
        """Return when so many counted seconds are over; None: never, because a pause does not end."""
        due, done = wall_s + seconds, wall_s
        for begin, until in self._pauses:
            if begin < due and (until is None or until > done):
                if until is None:
                    return None
                due += until - max(begin, done)
                done = until
        return due

    def _end_of(self, rule: Incident, start: Happened) -> Optional[Happened]:
        """Return what ended an incident; None: nothing did."""
        return min((each for each in self.course.incidents if each.incident in rule.ends and each.at_s is not None
                    and start.at_s is not None and _moment(each) >= _moment(start)), key=_moment, default=None)

    def by_themselves(self) -> List[Happened]:
        """Return the incidents that follow from others because a time is over, unless something ends these before, or
        the run ended before."""
        found = []
        times = [*(mark.at_s for mark in self._marks), *(each.at_s for each in self.course.incidents)]
        now = max((at_s for at_s in times if at_s is not None), default=ZERO)  # as far as is known
        limits = [None if self.sheet.limit_s is None else Fraction(self.sheet.limit_s),
                  max(self.course.elapsed_s, now) if self.course.ended and self.course.elapsed_s else None]
        end = min((limit for limit in limits if limit is not None), default=None)
        last = max((each.order for each in self.course.incidents), default=0) + 1
        for rule in self.sheet.incidents:
            for start in self.course.incidents if rule.of else ():
                if start.incident != rule.of or start.at_s is None or rule.after is None:
                    continue
                due = self._after(start.at_s, Fraction(rule.after))
                for longer in self._extensions(rule):
                    if due is not None and longer.at_s is not None and longer.at_s <= due:
                        extended = self._after(longer.at_s, self._seconds(rule, longer))
                        due = None if extended is None else max(due, extended)
                if due is not None and (end is None or (self._counted(due) or ZERO) <= end) and (
                        self.course.ended or due <= now):
                    found.append(Happened(rule.name, due, since=start.at_s, order=last))
        return found

    def _extensions(self, rule: Incident) -> List[Happened]:
        asked = [each for each in self.course.incidents if each.incident == rule.longer_by and rule.longer_by]
        return sorted(asked, key=_when)[:rule.requests]

    def _seconds(self, rule: Incident, longer: Happened) -> Fraction:
        # Who does not say how long asks for all that is allowed.
        asked = _number_of(longer.facts.get("seconds"))
        asked = Fraction(rule.longer or 0) if asked is None else max(ZERO, asked)
        return asked if rule.longer is None else min(asked, Fraction(rule.longer))

    def _is_over(self, rule: Incident, happened: Happened) -> bool:
        """Whether what would lead to an incident by itself was ended before, or the incident came before."""
        since = happened.since
        return since is not None and any(at_s is not None and at_s >= since for name in (*rule.ends, rule.name)
                   for at_s in self._held.get(name, ()))

    # -- one incident -------------------------------------------------------------------------------

    def _take(self, rule: Incident, happened: Happened) -> None:
        """Apply what follows from an incident, or say why nothing does."""
        at_s = happened.at_s
        if happened.since is not None:
            self._steps.append(BY_ITSELF(incident=rule.title, time=_clock(self._counted(at_s) or ZERO)))
        if rule.marks:
            self.decided.setdefault(rule.marks, (0, ""))
        why = self._why_not(rule, happened)
        if why:
            self._steps.append(why)
            return
        self._held.setdefault(rule.name, []).append(at_s)
        until = self._end_of(rule, happened)
        for index, mark in enumerate(self._marks if rule.voids is not Voids.NOTHING else ()):
            if index not in self._void and self._is_hit(rule, mark, happened, until or happened):
                time = _at(self._counted(mark.at_s))
                self._drop(index, VOID(item=self._name(mark), time=time, incident=rule.title), happened)
        if rule.marks and not rule.scored_after:
            words = {str(fact) for fact in happened.facts.values()}
            choices = (choice.name for choice in self._items[rule.marks].choices)
            self._decide(rule.marks, next((name for name in choices if name in words), ""))
        elif rule.marks:
            self._costs_later.append((rule.marks, happened))
        self.replaces = self.replaces or rule.voids is Voids.EARLIER_RUNS

    def _decide(self, item: str, choice: str = "") -> None:
        self.decided[item] = self.decided[item][0] + 1, choice

    def _why_not(self, rule: Incident, happened: Happened) -> str:
        """Return why an incident has no effect; empty: it has."""
        at_s, held = self._counted(happened.at_s), len(self._held.get(rule.name, ()))
        if rule.times is not None and held >= rule.times:
            return TOO_OFTEN(incident=rule.title, time=_at(at_s), number=held + 1, times=rule.times)
        facts = {**self._facts, **happened.facts}
        lacking = [LACKING(fact=self.names.get(fact.item, fact.item)) for fact in rule.when if not _holds(fact, facts)]
        barring = [self.names.get(fact.item, fact.item) for fact in rule.unless if _holds(fact, facts)]
        for why in (*lacking, *barring):
            return NO_EFFECT(incident=rule.title, time=_at(at_s), why=why)
        if rule.below is not None:
            points = self._so_far(happened, rule.net)
            if points >= Fraction(rule.below):
                return TOO_LATE(incident=rule.title, time=_at(at_s), points=number_text(points),
                                below=number_text(Fraction(rule.below)))
        return ""

    def _so_far(self, happened: Happened, net: bool) -> Fraction:
        """Return the points until an incident: without penalties, unless they count."""
        marks = [mark for index, mark in enumerate(self._marks) if index not in self._void
                 and (net or not self._costs(mark) or _is_penalty(self._items[mark.item]))
                 and (happened.at_s is None or (mark.at_s is not None and _moment(mark) <= _moment(happened)))]
        sheet = self.sheet if net else replace(self.sheet, items=tuple(map(_without_penalty, self.sheet.items)))
        # What the end gives, the time that was left, comes later than any incident.
        return _Tree(sheet, sorted(marks, key=_made), {}, self.course._replace(ended=False)).total()

    def _is_hit(self, rule: Incident, mark: SheetMark, happened: Happened, until: Happened) -> bool:
        """Whether an incident makes a mark void."""
        if rule.voids is Voids.ALL:
            return True
        if happened.at_s is None or mark.at_s is None:
            return False
        if rule.voids is Voids.LATER:
            return mark.at_s > happened.at_s and not mark.corrects
        if rule.voids is Voids.EARLIER_POINTS and self._costs(mark):
            return False
        return rule.voids in (Voids.EARLIER, Voids.EARLIER_POINTS) and _moment(mark) <= _moment(until)

    def _costs(self, mark: SheetMark) -> bool:
        """Whether a mark is a penalty. What corrects a count belongs to its row."""
        item = self._items[mark.item]
        if item.amount in (Measure.COUNT, Measure.YES, Measure.PERCENT):
            return _is_penalty(item)
        return _worth(item, mark) < 0

    def _scored_after(self, happened: Happened) -> bool:
        """Whether points were scored after an incident: a row gives more than it did then, or than what was taken away
        since has left."""
        worth: Dict[str, Fraction] = {}
        least: Dict[str, Fraction] = {}  # since the incident, or at it
        for mark in self.left(self._void):
            item = self._items[mark.item]
            before = ZERO if mark.sets or item.amount in (Measure.YES, Measure.CHOICE) else worth.get(item.id, ZERO)
            now = ZERO if _is_penalty(item) else max(ZERO, before + _worth(item, mark))
            is_after = mark.at_s is None or _moment(mark) > _moment(happened)
            worth[item.id], least[item.id] = now, min(least.get(item.id, ZERO), now) if is_after else now
        return happened.at_s is not None and any(now > least[item] for item, now in worth.items())


def _moment(each: object) -> Tuple[Fraction, int]:
    """Order by time, and by the order in which what has the same time came. Of times that are known."""
    return each.at_s or ZERO, each.order  # type: ignore[attr-defined]


def _when(each: object) -> Tuple[bool, Tuple[Fraction, int]]:
    """Order by time; what has none comes last."""
    return each.at_s is None, _moment(each)  # type: ignore[attr-defined]


def _made(mark: SheetMark) -> Tuple[int, Tuple[bool, Tuple[Fraction, int]]]:
    """Order marks as a history has them, whose clock may have gone back; else by time."""
    return mark.order, _when(mark)


def _number_of(fact: object) -> Optional[Fraction]:
    """Return a fact that is a number; None: it is none."""
    return Fraction(str(fact)) if isinstance(fact, (int, float, Decimal, Fraction)) and not isinstance(
        fact, bool) else None


def _at(at_s: Optional[Fraction]) -> str:
    return "" if at_s is None else f" ({_clock(at_s)})"


def _clock(seconds: Fraction) -> str:
    return elapsed(float(seconds))


def _holds(fact: Condition, facts: Mapping[str, object]) -> bool:
    """Whether a fact about an incident is as a condition asks."""
    value = facts.get(fact.item)
    if fact.text:
        return value == fact.text
    if value is None or fact.least is None:
        return bool(value)
    number = _number_of(value)
    return number is not None and number >= Fraction(fact.least)


def _worth(item: Item, mark: SheetMark) -> Fraction:
    """Return what a mark is worth alone: less than 0 is a penalty."""
    if item.amount is Measure.CHOICE:
        return Fraction(next((choice.points or 0 for choice in item.choices if choice.name == mark.text), 0))
    return Fraction((item.points if item.percent is None else item.percent) or 0) * mark.number * mark.share


def _is_penalty(item: Item) -> bool:
    return (item.points or ZERO) < 0 or (item.percent or ZERO) < 0


def _without_penalty(item: Item) -> Item:
    """Return an item as it counts gross: without what takes points, and without a lower limit."""
    if not _is_penalty(item):
        return item
    return replace(item, points=Decimal(0), percent=None)


# -- the tree ---------------------------------------------------------------------------------------


class _Times(NamedTuple):
    """Marks of an item, as one time after the other: how much of a time each is worth, and how often."""

    shares: Tuple[Tuple[Fraction, Fraction], ...] = ()  # number, share

    def total(self) -> Fraction:
        return sum((number * share for number, share in self.shares), ZERO)

    def numbers(self) -> Fraction:
        return sum((number for number, _ in self.shares), ZERO)

    def at_most(self, times: Fraction) -> "_Times":
        """Return the first ones of these times."""
        left, kept = times, []
        for number, share in self.shares:
            number = min(number, left)
            left -= number
            kept.append((number, share))
        return _Times(tuple(each for each in kept if each[0]))

    def singly(self) -> List[Fraction]:
        """Return the share of each time, of `MAX_EACH` at most."""
        return [share for number, share in self.shares for _ in range(min(int(number), MAX_EACH))][:MAX_EACH]


class _Tree:
    """The items with their amounts, added up."""

    def __init__(
        self, sheet: Sheet, marks: Sequence[SheetMark], decided: Mapping[str, Tuple[int, str]], course: Course
    ) -> None:
        self._sheet = sheet
        self._course = course
        self._items = {item.id: item for item in sheet.items}
        self._under: Dict[str, List[Item]] = {}
        for item in sheet.items:
            self._under.setdefault(item.under, []).append(item)
        self._times: Dict[str, _Times] = {}
        self._texts: Dict[str, str] = {}
        for mark in marks:
            self._enter(mark)
        for item_id, (number, text) in decided.items():
            self._times[item_id] = _Times(((Fraction(number), ONE),) if number else ())
            self._texts[item_id] = text
        self._order = [(mark.item, mark.number, mark.at_s) for mark in marks]
        # What the referee has taken away already.
        self._refused = {item_id: sum((mark.number for mark in course.marks if mark.refused and mark.item == item_id),
                                      ZERO) for item_id in {mark.item for mark in course.marks if mark.refused}}
        self._withholding = [item for item in sheet.items if item.withholds]
        # Conditions ask again and again: without what is known, twice as often with each row.
        self._bars: Dict[str, str] = {}
        self._counts: Dict[str, _Times] = {}
        self.points: Dict[str, Fraction] = {}
        self.own: Dict[str, Fraction] = {}
        self.charged = ZERO
        self.steps: List[str] = []

    def total(self) -> Fraction:
        """Return the points of the sheet."""
        terms: List[Fraction] = []
        for item in self._under.get("", ()):
            terms.append(self._term(item, sum(terms, ZERO)))
        total, shown = sum(terms, ZERO), [term for term in terms if term]
        self.steps.append(TOTAL(points=number_text(total)) if len(shown) < 2 else
                          TOTAL_OF(sum=_sum_text(shown), points=number_text(total)))
        return total

    def _enter(self, mark: SheetMark) -> None:
        item, before = self._items[mark.item], self._times.get(mark.item, _Times())
        self._texts[item.id] = mark.text
        new = ((mark.number, mark.share),)
        if mark.sets or item.amount in (Measure.YES, Measure.CHOICE):
            self._times[item.id] = _Times(new)
        elif item.amount is Measure.PERCENT:
            self._times[item.id] = _Times((*before.shares, *new))
        else:
            total = before.total() + mark.number * mark.share
            # What is taken away may have been made void since.
            total = max(ZERO, total) if item.amount is Measure.COUNT else total
            self._times[item.id] = _Times(((total, ONE),))

    # -- conditions ---------------------------------------------------------------------------------

    def _is_given(self, item: Item) -> bool:
        """Whether an item, or one under it, was given and counts. The reader of the rules refuses circles."""
        if item.amount is not Measure.SECTION:
            if item.amount is Measure.CHOICE:
                chosen = self._chosen(item)
                has_points = any(choice.points is not None for choice in item.choices)
                return chosen is not None and (not has_points or bool(chosen.points)) and not self._barred(item)
            return self._counting(item).total() != 0
        return any(map(self._is_given, self._under.get(item.id, ())))

    def _chosen(self, item: Item) -> Optional[ItemChoice]:
        return next((choice for choice in item.choices if choice.name == self._texts.get(item.id)), None)

    def _met(self, condition: Condition) -> bool:
        item = self._items[condition.item]
        if condition.text:
            return self._texts.get(item.id) == condition.text and not self._barred(item)
        if condition.least is None:
            return self._is_given(item)
        return self._counting(item).total() >= Fraction(condition.least)

    def _barred(self, item: Item) -> str:
        """Return why an item does not count at all; empty: it counts."""
        if item.id not in self._bars:
            self._bars[item.id] = self._why_barred(item)
        return self._bars[item.id]

    def _why_barred(self, item: Item) -> str:
        for by in self._withholding:
            if item.id in by.withholds and self._is_given(by):
                return BARRED(item=item.name, other=by.name)
        for condition in item.needs:
            if condition.since <= 1 and not condition.each and not self._met(condition):
                return LACKS(item=item.name, needs=self._named(condition))
        for condition in item.unless:
            if not condition.each and self._met(condition):
                return BARRED(item=item.name, other=self._named(condition))
        return ""

    def _named(self, condition: Condition) -> str:
        name = self._items[condition.item].name
        if condition.text:
            return f"{name}: {condition.text}"
        return name if condition.least is None else f"{name} ≥ {number_text(Fraction(condition.least))}"

    def _counting(self, item: Item) -> _Times:
        """Return the times of an item that count."""
        if item.id not in self._counts:
            self._counts[item.id] = self._find_counting(item)
        return self._counts[item.id]

    def _find_counting(self, item: Item) -> _Times:
        times = self._times.get(item.id, _Times())
        if not times.shares or self._barred(item):
            return _Times()
        if item.times is not None:
            times = times.at_most(Fraction(item.times))
        for condition in item.unless:
            if condition.each:
                taken = self._counting(self._items[condition.item]).numbers() - self._refused.get(item.id, ZERO)
                times = times.at_most(max(ZERO, times.numbers() - max(ZERO, taken)))
        for condition in item.needs:
            if condition.each:
                times = times.at_most(self._counting(self._items[condition.item]).numbers())
            elif condition.since > 1:
                early = times.numbers() if not self._met(condition) else self._before(item, condition)
                times = times.at_most(max(Fraction(condition.since - 1), times.numbers() - early))
        return times

    def _before(self, item: Item, condition: Condition) -> Fraction:
        """Return how many counts of an item were made before what they need, from the count on that needs it."""
        if not condition.after:
            return ZERO
        needed = self._giving(condition.item)
        begin = min((at_s or ZERO for item_id, _, at_s in self._order if item_id in needed), default=ZERO)
        early, before = ZERO, ZERO
        for item_id, number, at_s in self._order:
            if item_id == item.id:
                since = max(before, Fraction(condition.since - 1))
                before += number
                if at_s is not None and at_s < begin:
                    early += max(ZERO, before - since)
        return early

    def _giving(self, item_id: str) -> List[str]:
        """Return the ids of the rows by which an item is given: its own, or those of a section; see `_is_given`."""
        if self._items[item_id].amount is not Measure.SECTION:
            return [item_id]
        return [each for child in self._under.get(item_id, ()) for each in self._giving(child.id)]

    # -- points -------------------------------------------------------------------------------------

    def _points(self, item: Item) -> Fraction:
        """Return the points of an item with all that hangs under it."""
        times = self._counting(item)
        self._say_what_is_missing(item, times)
        self._say_what_is_too_often(item, times)
        if item.each:
            points = self._of_each(item, times)
        else:
            terms = [] if item.amount is Measure.SECTION else [self._own(item, times)]
            self.own[item.id] = sum(terms, ZERO)
            if times.total() not in (ZERO, ONE) and item.points and item.amount not in (
                    Measure.POINTS, Measure.CLOCK):
                self.steps.append(TIMES(item=item.name, number=number_text(times.total()),
                                        each=number_text(Fraction(item.points)), points=number_text(terms[0])))
            for child in () if self._barred(item) else self._under.get(item.id, ()):
                terms.append(self._term(child, sum(terms, ZERO)))
            points = self._limited(item, terms)
        self.points[item.id] = points
        return points

    def _term(self, item: Item, base: Fraction) -> Fraction:
        """Return what an item adds to what the items before it left."""
        points = self._points(item) if item.percent is None else self._share_of(item, base)
        if not item.for_team:
            return points
        self.charged += points
        if points:
            self.steps.append(FOR_TEAM(item=item.name, points=number_text(points)))
        return ZERO

    def _own(self, item: Item, times: _Times) -> Fraction:
        if item.amount is Measure.CHOICE:
            chosen = self._chosen(item)
            return ZERO if chosen is None or self._barred(item) else Fraction(chosen.points or 0)
        if item.amount is Measure.CLOCK:
            return self._clock_points(item)
        return self._round(item, Fraction(item.points or 0) * times.total())

    @staticmethod
    def _round(item: Item, points: Fraction) -> Fraction:
        return points if item.decimals is None else rounded(points, item.decimals)

    def _clock_points(self, item: Item) -> Fraction:
        """Return the points for the time left: if what it needs is given, or else if the robot completed the run."""
        course, limit = self._course, self._sheet.limit_s if self._sheet.clock_s is None else self._sheet.clock_s
        if not course.ended or limit is None:
            return ZERO
        full = max(ZERO, Fraction(str(limit)) - course.elapsed_s) // Fraction(item.seconds)
        points, why = Fraction(item.points or 0) * full, self._barred(item)
        if points and why:
            self.steps.append(NOT_GIVEN(why=why, points=number_text(points)))
        elif points and not item.needs and not course.completed:
            self.steps.append(NOT_COMPLETED(item=item.name, points=number_text(points)))
        return points if not why and (item.needs or course.completed) else ZERO

    def _share_of(self, item: Item, base: Fraction) -> Fraction:
        """Return the points of an item that is a percentage of what the items before it left."""
        times = self._counting(item)
        self._say_what_is_missing(item, times)
        self.points[item.id] = self.own[item.id] = self._round(item, self._percentage(item, times, base))
        return self.points[item.id]

    def _percentage(self, item: Item, times: _Times, base: Fraction) -> Fraction:
        """Return what a percentage adds to what the items before it left."""
        rate = Fraction(item.percent or 0) / 100
        if item.compounding:
            left = base
            for number, share in times.shares:
                left *= (1 + rate * share) ** min(int(number), MAX_EACH)
            return left - base
        return base * rate * times.total()

    def _of_each(self, item: Item, times: _Times) -> Fraction:
        """Return the points of an item whose times are counted one by one, each with its modifiers."""
        singles = times.singly()
        modifiers = self._by_time(item, len(singles))
        points = ZERO
        for share, modifying in zip(singles, modifiers):
            terms = [self._round(item, Fraction(item.points or 0) * (ONE if item.share_of_all else share))]
            self._add_own(item, terms[0])
            for child in self._under.get(item.id, ()):
                worth = _Times(tuple((ONE, each) for each in modifying.get(child.id, ())))
                if worth.shares:
                    terms.append(self._round(child, Fraction(child.points or 0) * worth.total() if child.percent is None
                                             else self._percentage(child, worth, sum(terms, ZERO))))
                    self._add_own(child, terms[-1])
            if item.share_of_all:
                terms.append(self._round(item, sum(terms, ZERO) * share) - sum(terms, ZERO))
                self._add_own(item, terms[-1])
            points += self._limited(item, terms)
        return points

    def _add_own(self, item: Item, points: Fraction) -> None:
        self.own[item.id] = self.points[item.id] = self.own.get(item.id, ZERO) + points

    def _by_time(self, item: Item, count: int) -> List[Dict[str, List[Fraction]]]:
        """Return the modifiers of each time of an item: a modifier belongs to the last time before it that has none of
        its kind yet. If all have one, it belongs to the last time."""
        found: List[Dict[str, List[Fraction]]] = [{} for _ in range(count)]
        left = {child.id: self._counting(child).singly() for child in self._under.get(item.id, ())}
        seen = 0
        for item_id, number, _ in self._order:
            if item_id == item.id:
                seen = min(seen + max(1, int(number)), count)
            for _ in range(max(1, int(number)) if count and item_id != item.id else 0):
                if not left.get(item_id):
                    break
                free = [own for own in found[:seen] or found[:1] if item_id not in own]
                (free or found[:seen] or found[:1])[-1].setdefault(item_id, []).append(left[item_id].pop(0))
        return found

    def _limited(self, item: Item, terms: Sequence[Fraction]) -> Fraction:
        """Return a sum within the limits of an item, and say it."""
        total = sum(terms, ZERO)
        points, said, limit = total, SUM, None
        if item.most is not None and points > Fraction(item.most):
            points, said, limit = Fraction(item.most), AT_MOST, item.most
        if item.least is not None and points < Fraction(item.least):
            points, said, limit = Fraction(item.least), AT_LEAST, item.least
        shown = [term for term in terms if term]
        if len(shown) > 1 or limit is not None:
            self.steps.append(said(item=item.name, sum=_sum_text(shown), points=number_text(points),
                                   **({} if limit is None else {"limit": number_text(Fraction(limit))})))
        return points

    def _say_what_is_missing(self, item: Item, times: _Times) -> None:
        """Say why marks of an item do not count, or count less often."""
        given = self._times.get(item.id, _Times())
        if not given.total():
            return
        barred = self._barred(item)
        if barred:
            self.steps.append(barred)
        elif times.numbers() < given.numbers():
            self.steps.append(CAPPED(item=item.name, number=number_text(given.numbers()),
                                     times=number_text(times.numbers())))

    def _say_what_is_too_often(self, item: Item, times: _Times) -> None:
        """Say where something that changes an item was marked more often than the item."""
        for child in self._under.get(item.id, ()) if item.amount in (Measure.COUNT, Measure.YES) else ():
            changes = self._counting(child).numbers()
            if child.amount in (Measure.COUNT, Measure.YES) and (child.points or 0) > 0 and changes > times.numbers():
                self.steps.append(MORE_THAN(item=child.name, number=number_text(changes), other=item.name,
                                            times=number_text(times.numbers())))


def rounded(number: Fraction, decimals: int) -> Fraction:
    """Round half up, away from zero."""
    scaled = abs(number) * 10**decimals
    whole = (2 * scaled + 1) // 2
    return Fraction(whole if number >= 0 else -whole, 10**decimals)


def _sum_text(terms: Sequence[Fraction]) -> str:
    """Return a sum as one writes it: 80 − 90 − 20."""
    text = number_text(terms[0]) if terms else "0"
    return text + "".join(f" {'−' if term < 0 else '+'} {number_text(abs(term))}" for term in terms[1:])


def rounded_text(number: Fraction) -> str:
    """Return a number for people: exact if it has at most three decimals, else rounded to them, half up."""
    thousandths = int(rounded(number, 3) * 1000)
    text = f"{abs(thousandths) // 1000}.{abs(thousandths) % 1000:03}".rstrip("0").rstrip(".")
    return f"-{text}" if thousandths < 0 else text


def number_text(number: Fraction) -> str:
    """Return a number in a step: see `rounded_text`, with the minus of sums."""
    return rounded_text(number).replace("-", "−")
