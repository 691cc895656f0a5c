"""Runs as referees see them besides those in the zones: the schedule; what is over, with score sheet, history and ends;
and its judges.

Times are UTC seconds since 1970; None: not yet, or never.
"""

from typing import NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import (
    CaptainSign,
    ItemRecord,
    Objection,
    Outage,
    RunChange,
    ScoreValue,
    SheetPoints,
    TimelineEntry,
)
from roah_rsbb.model.zone import SheetItem


class ObjectionLine(NamedTuple):
    """An objection to a result: a protest, if it is signed off."""

    number: int
    utc_s: float
    by: str  # who objects, such as a team
    text: str
    who: str  # who entered it
    answered_utc_s: Optional[float]
    answered_by: str
    upheld: bool
    answer: str
    second: int = 0  # of the run's clock, which it is about; 0: none in particular


class RunLine(NamedTuple):
    """A run, without its score sheet."""

    identity: str  # unique among all competitions
    revision: int  # changes whenever its `RunSheet` changes
    zone: str
    code: str  # of the benchmark
    team: str  # ALL: all robots at once
    round: int
    run: int
    opened_utc_s: float  # of *connect*
    started_utc_s: Optional[float] = None  # of the last *start*
    closed_utc_s: Optional[float] = None  # of *disconnect*; None: it is still connected
    end_reason: str = ""  # name of an `EndReason`, in lower case
    score: Said = ""  # the points, or the sums of the groups
    corrected: bool = False  # an item has changed since the run ended
    signed_utc_s: Optional[float] = None
    signed_by: str = ""
    counts: str = ""  # whether it counts, and why or why not: a word of `wording.sheets`
    proposals: int = 0  # marks that arrived after the sign-off, and on which nobody has decided
    versions: int = 0  # earlier ones of its signed sheet
    can_undo: bool = False  # that it was annulled, moved or reopened can be taken back
    protests_until_utc_s: Optional[float] = None  # its team may object on its own page; None: not
    objections: Tuple[ObjectionLine, ...] = ()  # oldest first
    incidents: Tuple[Tuple[str, int], ...] = ()  # those that happened, and how often

    @property
    def is_annulled(self) -> bool:
        """Whether somebody annulled it."""
        return self.counts == "annulled"

    @property
    def is_unsigned(self) -> bool:
        """Whether it is over and waits for its sign-off."""
        return self.closed_utc_s is not None and self.signed_utc_s is None and not self.is_annulled


class HistoryEntry(NamedTuple):
    """One change of a score sheet."""

    number: int
    utc_s: float
    who: str
    group: str
    item: str
    type: str  # bool, uint, int, decimal, choice or rating
    old: int
    old_not_attempted: bool
    value: int
    not_attempted: bool
    note: str = ""
    correction: bool = False  # made after the run was over
    withdrawn_utc_s: Optional[float] = None  # None: it counts
    withdrawn_by: str = ""
    withdrawn_note: str = ""
    withdrawal_corrects: bool = False  # withdrawn after the run was over
    old_text: str = ""  # of a type that is not a whole number
    text: str = ""
    judge: str = ""  # who gave the rating; empty: it is not one
    clock_s: Optional[float] = None  # counted seconds of the run when it was made; None: not known
    in_time: bool = False  # a referee said so of an entry that was made after the time limit
    in_time_by: str = ""  # ... who said so last, or that it was late; empty: nobody
    void: Said = ""  # why it does not count although nobody withdrew it; empty: it counts
    unit: str = ""  # of the values, such as %
    points: str = ""  # a decimal number: by how much it changed the sheet's total when it was made; empty: by nothing
    by: str = ""  # who made it, without role and device
    role: str = ""
    late: bool = False  # it does not count, because it came after the time limit
    arrived_utc_s: Optional[float] = None  # when it arrived, if it had waited for a link to the box


class ProposedMark(NamedTuple):
    """A mark that was made before the sign-off and arrived after it."""

    number: int  # 1, 2, … within the run
    entry: HistoryEntry  # which it would make
    decided_utc_s: Optional[float] = None  # None: not yet
    decided_by: str = ""
    accepted: bool = False
    reason: str = ""


class VersionLine(NamedTuple):
    """A signed score sheet that another version replaced."""

    number: int  # from 1
    signed_utc_s: float
    signed_by: str
    replaced_utc_s: float
    replaced_by: str
    why: str
    points: str = ""  # a decimal number; empty: the sheet gives none
    then_points: str = ""  # of the version after it
    changed: Tuple[Tuple[ItemRecord, ItemRecord], ...] = ()  # items before and after it, those that differ


class RunEnd(NamedTuple):
    """One end of a run."""

    number: int  # from 1
    utc_s: float
    who: str  # who stopped it; empty: it ended by itself
    end_reason: str
    desc: str  # the text for the referee
    reason: str  # typed by the referee
    reason_by: str = ""
    clock_s: Optional[float] = None  # counted seconds of the run; None: not known


class RunTimeline(NamedTuple):
    """What happened in a run, the oldest first in each list. `wording.timeline` makes one list of it."""

    identity: str  # of the run
    opened_utc_s: float
    history: Tuple[HistoryEntry, ...] = ()
    ends: Tuple[RunEnd, ...] = ()
    entries: Tuple[TimelineEntry, ...] = ()
    outages: Tuple[Outage, ...] = ()
    closed_utc_s: Optional[float] = None
    signed_utc_s: Optional[float] = None
    signed_by: str = ""
    proposals: Tuple[ProposedMark, ...] = ()
    captain: Tuple[CaptainSign, ...] = ()
    versions: Tuple[VersionLine, ...] = ()
    changes: Tuple[RunChange, ...] = ()
    objections: Tuple[Objection, ...] = ()


class RunSheet(NamedTuple):
    """A run with its score sheet, its history and its ends."""

    run: RunLine
    robots: Tuple[str, ...]
    elapsed_s: float  # counted time until the last end, or until now if the run is in progress
    items: Tuple[SheetItem, ...]  # in the order of the benchmarks file
    history: Tuple[HistoryEntry, ...]  # oldest first
    ends: Tuple[RunEnd, ...]  # oldest first
    module_scores: Tuple[ScoreValue, ...] = ()
    points: Optional[SheetPoints] = None  # None: the sheet gives none
    entries: Tuple[TimelineEntry, ...] = ()  # of its timeline, oldest first
    outages: Tuple[Outage, ...] = ()  # oldest first
    proposals: Tuple[ProposedMark, ...] = ()  # in the order in which they arrived
    captain: Tuple[CaptainSign, ...] = ()  # oldest first; the last one holds
    versions: Tuple[VersionLine, ...] = ()  # oldest first
    changes: Tuple[RunChange, ...] = ()  # oldest first
    objections: Tuple[Objection, ...] = ()  # oldest first

    @property
    def timeline(self) -> RunTimeline:
        """What happened in the run."""
        run = self.run
        return RunTimeline(run.identity, run.opened_utc_s, self.history, self.ends, self.entries, self.outages,
                           run.closed_utc_s, run.signed_utc_s, run.signed_by, self.proposals,
                           self.captain, self.versions, self.changes, self.objections)


class UnsavedParts(NamedTuple):
    """The parts of a run's record that are not on the disk yet."""

    identity: str
    zone: str
    entries: Tuple[int, ...] = ()  # numbers of entries of the history that are new, or were withdrawn
    stops: Tuple[int, ...] = ()  # numbers of ends, from 1, that are new or whose reason changed
    sign_off: bool = False


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
    must_publish: bool = False  # the rules want it to be published before anybody objects


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


class JudgedRun(NamedTuple):
    """What a judge or the head referee may see of a run."""

    judging: Judging
    items: Tuple[SheetItem, ...]  # of the run's sheet, as they count now
    judged: Tuple[JudgedItem, ...] = ()  # empty: more sheets are expected
    objections: Tuple[ObjectionLine, ...] = ()
    own: Tuple[SheetItem, ...] = ()  # the sheet of the judge who asks; empty: it was not a judge
    submitted: bool = False  # that sheet is locked
    again: str = ""  # why that sheet was handed back; empty: it was not


class EventSeen(NamedTuple):
    """An event of the schedule with its state and results. Times are UTC seconds."""

    id: str  # by which it is known, whatever else changes
    number: int  # in the schedule of its zone, from 1
    zone: str
    code: str  # of the benchmark
    benchmark: str  # its full name
    team: str  # ALL: all robots at once
    round: int
    run: int
    scheduled_utc_s: float
    begins_utc_s: float  # when it began, or the estimated time
    state: str  # done, connected, running, ended, next, later or skipped
    current: bool  # its zone is at this event
    identity: str = ""  # of the run that counts; if none does, of the last one that is over; empty: none
    end_reason: str = ""
    score: Said = ""  # of that run; empty also while another attempt is in the zone
    signed_utc_s: Optional[float] = None  # None: not signed off
    signed_by: str = ""
    counts: str = ""  # whether that run counts, see `wording.sheets`

    @property
    def late_s(self) -> float:
        """By how many seconds it began, or will begin, after its scheduled time; at least 0."""
        return max(0.0, self.begins_utc_s - self.scheduled_utc_s)

    @property
    def unsigned(self) -> bool:
        """Whether a run is over, and one that counts is not signed off."""
        return self.state == "ended" or (bool(self.identity) and self.signed_utc_s is None)
