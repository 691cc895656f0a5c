"""What a score sheet consists of: its items, their types, and the rules by which they give points.

Points are exact decimals, never floats, so that every page shows the same sum (docs/organiser.md, "Points").
"""

import enum
import functools
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.rules import Incident, Item, ItemChoice, JuryResult, Measure, Number, Sheet

# The largest number of points for one, the largest limit, and the largest value of an item that has a limit.
MAX_NUMBER = 1_000_000
# Decimals that a file or a referee can give.
MAX_DECIMALS = 3
# `int32` on the ROS interface.
MAX_VALUE = 2**31 - 1
# Of sheets before 2026-12: the name of the bonus for the time left, which is listed as if it were a group, and of what
# has the limits of the whole sheet.
TIME_LEFT, WHOLE_SHEET = "Time left", "Score sheet"

Key = Tuple[str, str]  # group and description, which identify an item


def earlier_id(key: Key) -> str:
    """Return what the rules call an item of a sheet before 2026-12, which has no id."""
    return ": ".join(key)


class ScoreKind(enum.IntEnum):
    """Type of a scoring item (docs/ros_interface.md, "Topics of the core"). `ZoneScoreGroup` has the first two."""

    BOOL = 0
    UINT = 1
    INT = 2
    DECIMAL = 3
    CHOICE = 4
    RATING = 5

    @property
    def word(self) -> str:
        """The type as files write it."""
        return self.name.lower()


# Types whose value is a whole number. Other values are texts, such as "1.5".
WHOLE = frozenset((ScoreKind.BOOL, ScoreKind.UINT, ScoreKind.INT))
# Types whose values can be added.
NUMBERS = frozenset((ScoreKind.UINT, ScoreKind.INT, ScoreKind.DECIMAL))


class Agreement(enum.Enum):
    """How the sheets of several judges become one (docs/organiser.md, "Judges and objections")."""

    ALL_AGREE = "all agree"
    MAJORITY = "majority"
    MEAN = "mean"
    MEDIAN = "median"
    WITHOUT_EXTREMES = "without extremes"  # as the jury's result of that name


class Entered(NamedTuple):
    """What a referee entered for an item."""

    value: int = 0
    text: str = ""  # of a decimal, a choice or a rating
    judge: str = ""
    not_attempted: bool = False
    note: str = ""
    added: str = ""  # a number to add to the item, instead of a value


@dataclass(frozen=True)
class JudgesRule:
    """The runs of a benchmark are scored by several judges, each on a sheet of their own."""

    count: int
    agreement: Agreement = Agreement.ALL_AGREE

    def __str__(self) -> str:
        return f"{self.count}, {self.agreement.value}"


@dataclass(frozen=True)
class ScoringItem:
    """One line of the referee's score sheet; `group` and `desc` together are its identity."""

    group: str
    desc: str
    kind: ScoreKind
    points: Optional[Decimal] = None  # for a yes, for each one of a number, for each one of a jury's result
    least: Optional[Decimal] = None  # limits of a value; None: those of its type
    most: Optional[Decimal] = None
    choices: Tuple[ItemChoice, ...] = ()
    judges: Tuple[str, ...] = ()
    jury: JuryResult = JuryResult.MEAN
    needs: Tuple[Key, ...] = ()  # the item counts only if all of these are given
    id: str = ""  # what the rules call it, as an item or, in the group `INCIDENTS`, an incident; empty: as it is here
    percent: Number = None  # of what the items before it left, instead of points
    unit: str = ""  # of its value

    @property
    def key(self) -> Key:
        """Its identity."""
        return self.group, self.desc

    def with_jury(self, jury: JuryResult) -> "ScoringItem":
        """Return the item with another rule for several numbers."""
        return replace(self, jury=jury)

    def rated_by(self, judge: str) -> "ScoringItem":
        """Return the item as it is on the sheet of one judge."""
        return replace(self, judges=(judge,), jury=JuryResult.MEAN) if self.kind is ScoreKind.RATING else self

    @property
    def has_points(self) -> bool:
        """Whether the item can give points."""
        return (self.points is not None or self.percent is not None
                or any(choice.points is not None for choice in self.choices))

    @property
    def is_plain(self) -> bool:
        """Whether it is an item without rules: a yes or a count."""
        return self.kind in (ScoreKind.BOOL, ScoreKind.UINT) and replace(self, id="") == ScoringItem(
            self.group, self.desc, self.kind)


@dataclass(frozen=True)
class GroupLimits:
    """The least and most points of a group of items."""

    name: str
    least: Optional[Decimal] = None
    most: Optional[Decimal] = None


@dataclass(frozen=True)
class TimeLeft:
    """The bonus for the time left: `points` for each full `seconds`.

    With `needs`, it counts if all of these items are given, however the run ended. Without, it counts if the robot
    completed the run.
    """

    points: Decimal
    seconds: Decimal = Decimal(1)
    most: Optional[Decimal] = None  # points
    needs: Tuple[Key, ...] = ()


@dataclass(frozen=True)
class SheetRules:
    """The rules of a score sheet that are not those of one item."""

    groups: Tuple[GroupLimits, ...] = ()
    least: Optional[Decimal] = None  # of the total
    most: Optional[Decimal] = None
    time_left: Optional[TimeLeft] = None


NO_SHEET_RULES = SheetRules()


@dataclass(frozen=True)
class SheetForm:
    """A score sheet before it is filled in.

    `rules` and `time_limit` (seconds of the run) are those of files and journals before 2026-12, whose sheets are no
    trees.
    """

    items: Tuple[ScoringItem, ...] = ()
    rules: SheetRules = NO_SHEET_RULES
    time_limit: float = 0.0
    judges: Optional[JudgesRule] = None  # None: the referee scores
    objection_time: float = 0.0  # seconds after the result is published; 0.0: no such rule
    sheet: Optional[Sheet] = None  # None: see `rules`
    protest_time: float = 0.0  # seconds after the sign-off; 0.0: no such rule

    @property
    def has_points(self) -> bool:
        """Whether the sheet gives points."""
        if self.sheet is not None and any(item.amount is Measure.CLOCK for item in self.sheet.items):
            return True
        return self.rules.time_left is not None or any(item.has_points for item in self.items)

    @functools.cached_property
    def is_plain(self) -> bool:
        """Whether it has only items without rules. It is asked for each record of a run."""
        has_rules = (self.rules != NO_SHEET_RULES or self.judges is not None or self.objection_time > 0
                     or self.protest_time > 0 or self.sheet is not None)
        return not has_rules and all(item.is_plain for item in self.items)


class ScoreGroup(NamedTuple):
    """A group as the panels show it: its items and their values, in the file's order."""

    name: str
    items: Tuple[Tuple[ScoringItem, int], ...]


# The group of items in no section, because each face names an item by its group, too.
NO_SECTION = "Score sheet"
# The group of a sheet's incidents: each is an item that counts how often it happened.
INCIDENTS = "Incidents"
MAX_INCIDENTS = 100  # of one kind: each is counted by itself
_KINDS = {
    Measure.YES: ScoreKind.BOOL, Measure.COUNT: ScoreKind.UINT, Measure.WHOLE: ScoreKind.INT,
    Measure.NUMBER: ScoreKind.DECIMAL,
    Measure.PERCENT: ScoreKind.DECIMAL, Measure.POINTS: ScoreKind.DECIMAL, Measure.CHOICE: ScoreKind.CHOICE,
    Measure.RATING: ScoreKind.RATING,
}


def rows(sheet: Sheet) -> Tuple[ScoringItem, ...]:
    """Return what referees mark on a sheet: its items, by the section in which they are, and its incidents.

    An item that an incident marks is not among them, and the incident has its points. Items of one name in one section
    get a number: referees must see which is which.
    """
    incidents, items = marked_incidents(sheet), {item.id: item for item in sheet.items}
    marking = [incident.marks for incident in incidents if incident.marks]
    keys: Dict[str, Key] = {}  # by the ids of the items
    sections: Dict[str, str] = {}  # id of an item -> name of the section in which it is
    seen: Dict[Key, int] = {}
    for item in sheet.items:
        sections[item.id] = item.name if item.amount is Measure.SECTION else sections.get(item.under, NO_SECTION)
        if item.amount in _KINDS and item.id not in marking:
            key = sections[item.id], item.name
            seen[key] = seen.get(key, 0) + 1
            keys[item.id] = key if seen[key] == 1 else (key[0], f"{item.name} ({seen[key]})")
    found = [_row(item, keys) for item in sheet.items if item.id in keys]
    for incident in incidents:
        row = ScoringItem(INCIDENTS, incident.title, ScoreKind.UINT, id=incident.name)
        if marking.count(incident.marks) == 1:  # else nobody can say which of several incidents gave the points
            row = replace(row, points=items[incident.marks].points, percent=items[incident.marks].percent)
        found.append(row)
    return tuple(found)


def marked_incidents(sheet: Sheet) -> List[Incident]:
    """Return the incidents that referees mark: not pauses, which the run's clock knows, nor what a choice says."""
    choices = {item.id for item in sheet.items if item.amount is Measure.CHOICE}
    pauses = {name for incident in sheet.incidents if incident.pauses for name in (incident.name, *incident.ends)}
    return [incident for incident in sheet.incidents
            if incident.name not in pauses and incident.marks not in choices]


def _row(item: Item, keys: Dict[str, Key]) -> ScoringItem:
    """Return what referees mark of an item."""
    is_percent = item.amount is Measure.PERCENT
    least, most = item.low, item.high
    if is_percent:
        least, most = Decimal(0), None if item.times is None else Decimal(100 * item.times)
    elif item.amount is Measure.COUNT and most is None and item.times is not None:
        most = Decimal(item.times)
    needs = tuple(keys[each.item] for each in item.needs if each.item in keys)
    return ScoringItem(*keys[item.id], _KINDS[item.amount], item.points, least, most, item.choices, item.judges,
                       item.jury, needs, item.id, item.percent, "%" if is_percent else "")
