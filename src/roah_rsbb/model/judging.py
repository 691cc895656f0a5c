"""Several judges of a run, and how its result becomes final. Times are UTC seconds since 1970; None: not yet."""

from typing import NamedTuple, Optional, Tuple

from roah_rsbb.model.zone import SheetItem

# What became of an item: the judges agree, they differ and the head referee must settle it, it is settled, or no judge
# submitted a sheet.
AGREED, DIFFER, SETTLED, NOT_JUDGED = "agreed", "differs", "settled", "not_judged"


class JudgeLine(NamedTuple):
    """One of the judges, without any values."""

    judge: str
    submitted_utc_s: Optional[float]
    again: str  # why the sheet was handed back; empty: it was not


class Judging(NamedTuple):
    """The progress of a run's judges and of its result, without any values."""

    zone: str
    identity: str
    revision: int = 0  # changes whenever its `JudgedRun` changes; 0: neither judges nor a published result
    # Judges that the benchmark asks for; 0: the referee scores.
    count: int = 0  # type: ignore[assignment] # it hides tuple.count, which nobody calls
    rule: str = ""
    missing: int = 0
    complete: bool = False  # no more sheets are expected
    judges: Tuple[JudgeLine, ...] = ()
    waiver: str = ""  # why missing judges are not waited for; empty: they are
    differences: int = 0
    published_utc_s: Optional[float] = None
    objections_until_utc_s: Optional[float] = None
    open_objections: int = 0


class Given(NamedTuple):
    """What a judge gave an item."""

    judge: str
    value: int
    text: str  # of a type that is not a whole number
    not_attempted: bool


class JudgedItem(NamedTuple):
    """An item of the run's sheet, as it counts now, with what each judge submitted."""

    item: SheetItem
    outcome: str  # one of the words above
    given: Tuple[Given, ...]
    who: str = ""  # who settled it; empty: nobody
    reason: str = ""


class ObjectionLine(NamedTuple):
    """An objection to a provisional result."""

    number: int
    utc_s: float
    by: str  # who objects, such as a team
    text: str
    who: str  # who entered it
    answered_utc_s: Optional[float]
    answered_by: str
    upheld: bool
    answer: str


class JudgedRun(NamedTuple):
    """What a judge or the head referee may see of a run."""

    judging: Judging
    items: Tuple[SheetItem, ...]  # of the run's sheet, as they count now
    judged: Tuple[JudgedItem, ...] = ()  # empty: more sheets are expected
    objections: Tuple[ObjectionLine, ...] = ()
    own: Tuple[SheetItem, ...] = ()  # the sheet of the judge who asks; empty: it was not a judge
    submitted: bool = False  # that sheet is locked
    again: str = ""  # why that sheet was handed back; empty: it was not
