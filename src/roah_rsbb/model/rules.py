"""The rules by which a run, a test and a competition are worth points, as data (docs/rules.md).

A sheet is a tree of items. It is kept as a list in the order of the sheet, where each item names the one it hangs
under, because lists are what records, journals and faces hold. Numbers are exact decimals, never floats.
"""

import enum
from dataclasses import dataclass, field
from decimal import Decimal
from typing import NamedTuple, Optional, Tuple

Number = Optional[Decimal]


class JuryResult(enum.Enum):
    """How the ratings of several judges become one."""

    MEAN = "mean"
    MEDIAN = "median"
    WITHOUT_EXTREMES = "without extremes"  # the mean without the lowest and the highest; with two ratings, their mean


@dataclass(frozen=True)
class ItemChoice:
    """One of the answers of an item that is a choice."""

    name: str
    points: Number = None  # None: the item gives no points


class Measure(enum.Enum):
    """What a mark of an item says."""

    SECTION = "section"  # it is a heading: it has no marks
    YES = "yes or no"
    COUNT = "count"
    NUMBER = "number"  # also with decimals, and below zero
    WHOLE = "whole number"  # also below zero
    PERCENT = "percent"  # how much of it; several marks are several times, each with its percentage
    POINTS = "points"  # the points themselves
    CHOICE = "choice"
    CLOCK = "clock"  # nobody marks it: the time that was left, see `Item.seconds`
    RATING = "rating"  # by judges


@dataclass(frozen=True)
class Condition:
    """Another item must have been given: `least` times, or with the choice `text`. Of an incident: a fact about it."""

    item: str  # its id; or the name of the fact
    least: Number = None  # None: at all
    text: str = ""
    since: int = 1  # from this count on; the counts before need nothing
    after: bool = False  # ... and it must have been given before them, where the times are known
    each: bool = False  # each count needs one of the other item; of `Item.unless`: each one takes one count away

    def __str__(self) -> str:
        """Return it as a list of changes shows it."""
        return "".join((
            self.item, f": {self.text}" if self.text else "", "" if self.least is None else f" ≥ {self.least}",
            f", from count {self.since} on" if self.since > 1 else "", ", before it" if self.after else "",
            ", for each" if self.each else ""))


@dataclass(frozen=True)
class Item:
    """A node of a score sheet.

    It is worth `points` (or a `percent` of what the items before it left) for each time that it counts, and what the
    items under it are worth, together not less than `least` and not more than `most`.
    """

    id: str  # identifies it, whatever it is called
    name: str
    under: str = ""  # id of the item under which it hangs; empty: the sheet itself
    amount: Measure = Measure.COUNT
    points: Number = None
    percent: Number = None  # of what the items before it left, instead of points
    decimals: Optional[int] = None  # its own points are rounded to so many, half away from 0; None: they are exact
    compounding: bool = False  # each time of a percentage applies to what the time before it left
    times: Optional[int] = None  # counts at most so often
    least: Number = None  # limits of the points of it and of all that hangs under it
    most: Number = None
    each: bool = False  # each time has limits and modifiers of its own
    share_of_all: bool = False  # the percentage of such a time is of what the items under it left, too
    low: Number = None  # limits of a number or a rating that can be entered
    high: Number = None
    seconds: Decimal = Decimal(1)  # of `Measure.CLOCK`: so many full seconds are one time
    choices: Tuple[ItemChoice, ...] = ()
    judges: Tuple[str, ...] = ()
    jury: JuryResult = JuryResult.MEAN
    needs: Tuple[Condition, ...] = ()  # it counts only if all of these are given
    unless: Tuple[Condition, ...] = ()  # it does not count if one of these is given
    withholds: Tuple[str, ...] = ()  # ids of items that do not count if it is given
    for_team: bool = False  # the team gets its points whichever attempt counts: they are not part of the sheet's
    total: Number = None  # the most points that it can give, as the rule book states them
    tags: Tuple[str, ...] = ()
    help: str = ""  # when to mark it, for referees
    decided: Tuple[str, ...] = field(default=(), compare=False)  # what the competition decided: choice and reading

    @property
    def has_points(self) -> bool:
        """Whether marks of it can give points."""
        return self.amount is not Measure.CLOCK and (
            self.points is not None or self.percent is not None
            or any(choice.points is not None for choice in self.choices))


class Voids(enum.Enum):
    """Which marks an incident makes void."""

    NOTHING = "nothing"
    EARLIER = "earlier"
    EARLIER_POINTS = "earlier points"  # penalties stay
    LATER = "later"
    ALL = "all"
    EARLIER_RUNS = "earlier runs"  # the attempts before this one


@dataclass(frozen=True)
class Incident:
    """Something that may happen in a run, and what follows from it.

    An incident that is not allowed (too often, too late, a fact that is missing) has no effect, and what it would mark
    does not count, either.
    """

    name: str
    times: Optional[int] = None  # allowed so often
    below: Number = None  # allowed while the points so far are below this
    net: bool = False  # penalties count in `below`
    when: Tuple[Condition, ...] = ()  # it has an effect only with these facts
    unless: Tuple[Condition, ...] = ()  # it has no effect with one of these facts
    voids: Voids = Voids.NOTHING
    marks: str = ""  # id of the item that it marks
    scored_after: bool = False  # it marks the item only if points were scored afterwards
    ends: Tuple[str, ...] = ()  # incidents that end it: until then earlier marks are void, or the clock is paused
    pauses: bool = False  # the counted clock is paused until the incident `ends`
    of: str = ""  # it also comes by itself, `after` seconds after this incident, unless one that `ends` it comes
    after: Number = None  # seconds
    longer_by: str = ""  # the incident that extends this time, by its fact `seconds`
    longer: Number = None  # seconds that one extension may have at most
    requests: Optional[int] = None  # how many extensions are allowed
    at_end: Tuple[str, ...] = ()  # it also comes when a run ends in one of these ways: the team was missing or withdrew
    help: str = ""  # as of an item
    decided: Tuple[str, ...] = field(default=(), compare=False)

    @property
    def title(self) -> str:
        """Its name, as people read it."""
        return self.name[:1].upper() + self.name[1:]


class Attempts(enum.Enum):
    """How several attempts become one number."""

    BEST = "best"
    LAST = "last"
    FIRST = "first"
    SUM = "sum"
    MEAN = "mean"
    MEDIAN = "median"


@dataclass(frozen=True)
class AttemptsRule:
    """Which attempts count, and how they become one number: of all attempts, or of the best `of_best`."""

    how: Attempts = Attempts.BEST
    of_best: Optional[int] = None

    def __str__(self) -> str:
        """As files have it."""
        return self.how.value if self.of_best is None else f"{self.how.value} of the best {self.of_best}"


@dataclass(frozen=True)
class Sheet:
    """The rules of a score sheet and of its runs."""

    items: Tuple[Item, ...] = ()
    incidents: Tuple[Incident, ...] = ()
    limit_s: Number = None  # counted seconds; marks after it are late and do not count. None: no limit
    clock_s: Optional[float] = None  # seconds of the run, for the time left; None: `limit_s`


NO_SHEET = Sheet()


class Scale(enum.Enum):
    """How numbers of several tests become comparable."""

    BEST = "best"  # divided by that of the best team
    FINALIST = "best finalist"  # divided by that of the best of the teams of this stage
    MAXIMUM = "maximum"  # divided by a fixed maximum
    RANGE = "worst to best"  # 0 for the worst of the teams of this stage, 1 for the best
    RANK = "rank"  # the place among the teams of this stage: see `places_count`
    NO = "no"


@dataclass(frozen=True)
class StageColumn:
    """A test or an earlier stage in a stage."""

    test: str = ""  # its code
    stage: str = ""  # or the name of an earlier stage
    weight: Decimal = Decimal(1)
    attempts: Optional[AttemptsRule] = None  # None: that of the test
    normalised: Optional[Scale] = None  # None: that of the stage
    maximum: Number = None  # for `Scale.MAXIMUM`
    rounds: Tuple[int, ...] = ()  # only events of these rounds; empty: all
    events: Tuple[str, ...] = ()  # only these events, by id; empty: all
    day: str = ""  # only events that are scheduled on this day of the venue, in files without stages; empty: all

    @property
    def subject(self) -> str:
        """The test or stage."""
        return self.test or self.stage

    @property
    def name(self) -> str:
        """What a standing calls it."""
        which = ", ".join([*(f"round {number}" for number in self.rounds), *self.events, *filter(None, [self.day])])
        return f"{self.subject} ({which})" if which else self.subject

    def has(self, number: int, event: str, day: str) -> bool:
        """Return whether an event belongs to it: of this round, with this id, on this day."""
        return ((not self.rounds or number in self.rounds) and (not self.events or event in self.events)
                and self.day in ("", day))


class Others(enum.Enum):
    """Where teams are ranked that did not advance to a stage."""

    BELOW = "below"  # all who advanced, in the order of the stage from which they did not
    ZERO = "zero"  # among them, with 0 in what only those who advanced have run


class Disqualified(enum.Enum):
    """Where a team is ranked that was disqualified for the competition."""

    LAST = "last"
    OUT = "out of the list"  # others move up
    GAP = "its place stays free"  # nobody moves up


@dataclass(frozen=True)
class Adjustment:
    """What a team gets or loses outside any run, by name."""

    name: str
    points: Number = None  # None: whoever enters it says how many
    low: Number = None  # limits of the points that can be entered
    high: Number = None
    times: Optional[int] = None  # it counts at most so often for a team
    disqualified: Optional[Disqualified] = None  # it is no points: the team is disqualified, in all stages


@dataclass(frozen=True)
class Adjusted:
    """An adjustment that a team was given."""

    team: str
    stage: str
    name: str
    points: Decimal = Decimal(0)
    reason: str = ""

    def __str__(self) -> str:
        """As people read it."""
        points = f" {self.points:+}" if self.points else ""
        return f"{self.team}, {self.stage}: {self.name}{points}{f' ({self.reason})' if self.reason else ''}"


class Advance(NamedTuple):
    """How many teams advance."""

    teams: int  # from so many teams on
    advance: int

    def __str__(self) -> str:
        """As people read it."""
        return f"from {self.teams} teams on {self.advance}"


@dataclass(frozen=True)
class Stage:
    """A ranking of teams by several tests or earlier stages."""

    name: str
    of: Tuple[StageColumn, ...]
    teams: str = ""  # name of the stage from which teams advanced; empty: all teams
    normalised: Scale = Scale.NO
    adjustments: Tuple[Adjustment, ...] = ()
    advance: Tuple[Advance, ...] = ()  # empty: all
    others: Others = Others.BELOW
    ties: Tuple[str, ...] = ()  # tests or earlier stages that decide where teams tie, the first one first
    asks: bool = False  # where nothing decides who advances, a person does; else all who tie advance
    least: Number = None  # of the sum
    chosen: Tuple[str, ...] = ()  # teams that a person let advance

    @property
    def places_count(self) -> bool:
        """Whether it adds up places, so that less is better. Beside other numbers, a place counts as the share of teams
        that are not before it."""
        return bool(self.of) and all((column.normalised or self.normalised) is Scale.RANK for column in self.of)


@dataclass(frozen=True)
class Decision:
    """A choice that the rule book leaves to people."""

    name: str
    readings: Tuple[str, ...]  # the first one is the default
    chosen: str
