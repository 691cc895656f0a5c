"""The record of a run: who scored what, why the run ended, who signed it off.

The core updates it with every change, and the journal keeps it. Results and exports are made from it.
"""

import enum
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import Said, say
from roah_rsbb.model.scoring import Key, SheetForm


class Phase(enum.Enum):
    """The phase of a run, as the referee sees it."""

    CONNECTED = "connected"
    RUNNING = "running"
    ENDED = "ended"


class EndReason(enum.Enum):
    """Why a run ended. The text is shown to the referee."""

    STOPPED = say("Benchmark stopped by the referee")
    COMPLETED = say("Benchmark completed by the robot")
    TIMEOUT = say("Stopped due to timeout")
    GOALS_TIMED_OUT = say("Benchmark over: every goal timed out")
    NO_MESSAGES_SAVED = say("Stopped: the robot saves no offline data (messages saved stays 0)")
    MODULE_FAILED = say("Stopped: the benchmarking module cannot continue")
    NO_SHOW = say("No-show: the team did not appear")
    WITHDRAWN = say("The team withdrew")


# With these ends, the team had no score to earn.
NOT_RUN = (EndReason.NO_SHOW, EndReason.WITHDRAWN)
# With these ends, the event is over, so the zone moves to its next one.
RAN_TO_THE_END = (EndReason.COMPLETED, EndReason.GOALS_TIMED_OUT, *NOT_RUN)


class ScoreValue(NamedTuple):
    """One line of a module's score."""

    group: str  # what it belongs to, such as "waypoint 2"; empty: the whole run
    name: str  # such as distance_error
    value: str  # JSON: a number, true, false, a text, or null if not known
    unit: str  # m, rad, s, or empty
    desc: str = ""  # for the referee


class Rating(NamedTuple):
    """What one judge gave."""

    judge: str
    text: str  # a decimal number


class ItemRecord(NamedTuple):
    """The current state of a scoring item of the referee's sheet."""

    group: str
    desc: str
    kind: str  # name of a `ScoreKind`, in lower case
    # Of a bool, a uint or an int. Of other types: the whole part, for programs that only know whole numbers.
    value: int
    not_attempted: bool = False  # the robot did not try, unlike a 0 that it earned
    corrected: bool = False  # its value has changed since the run ended
    text: str = ""  # of other types: a decimal number, a choice, or the jury's result; empty: none yet
    ratings: Tuple[Rating, ...] = ()  # in the order of the judges; those who gave one
    points: str = ""  # a decimal number; empty: the item gives none
    unit: str = ""  # of the value, such as %

    @property
    def key(self) -> Key:
        """Its identity."""
        return self.group, self.desc


def grouped(items: Iterable[ItemRecord]) -> Dict[str, List[ItemRecord]]:
    """Return the items of a sheet by group, in the sheet's order."""
    groups: Dict[str, List[ItemRecord]] = {}
    for item in items:
        groups.setdefault(item.group, []).append(item)
    return groups


class ScoreEntry(NamedTuple):
    """A change of the score sheet. A withdrawn entry stays in the history, but no longer counts."""

    number: int  # 1, 2, … within the run
    utc: float  # UTC seconds
    who: str
    group: str
    desc: str
    old: int
    value: int
    not_attempted: bool = False
    note: str = ""
    old_not_attempted: bool = False
    correction: bool = False  # made after the run was over
    withdrawn_utc: float = 0.0  # UTC seconds; 0.0: not withdrawn
    withdrawn_by: str = ""
    withdrawn_note: str = ""
    withdrawal_corrects: bool = False  # withdrawn after the run was over
    old_text: str = ""  # values of types that have no whole numbers
    text: str = ""
    judge: str = ""  # whose rating it is; empty: not a rating
    added: str = ""  # a decimal number that it added to the item; empty: it set the item
    role: str = ""  # of `who`, such as referee; empty: not known
    device: str = ""  # from which it was sent; empty: not known
    clock_s: Optional[float] = None  # counted seconds of the run at that time; None: not known
    in_time: bool = False  # a referee said so of an entry that was made after the time limit
    in_time_by: str = ""  # ... who said so last, or that it was late; empty: nobody
    void: Said = ""  # why it does not count although nobody withdrew it; empty: it counts
    points: str = ""  # a decimal number: by how much it changed the sheet's total when it was made; empty: by nothing
    arrived_utc: float = 0.0  # UTC seconds, if it had waited for a link to the box; 0.0: at once


class TakenMarks(NamedTuple):
    """The newest marks of a sheet that have an identity: each is applied once, however often it arrives."""

    entries: Mapping[str, int] = {}  # identity -> number of its entry; 0: it made none
    last: int = 0  # the highest number that an entry had: it is not used again

    @staticmethod
    def upgraded(saved: Any) -> Any:
        """Return what was saved before 2026-12: a line for each mark, and one without identity for the last number."""
        if not isinstance(saved, str):
            return saved
        numbers = {mark: int(number) for number, _, mark in (line.partition(" ") for line in saved.splitlines())}
        return {"entries": {mark: number for mark, number in numbers.items() if mark},
                "last": max(numbers.values(), default=0)}


NO_MARKS = TakenMarks()


class TimelineEntry(NamedTuple):
    """Something that happened in a run, besides marks and ends: a start, a pause, a phase, a goal, a note."""

    number: int  # 1, 2, … within the run
    kind: str  # a name of a `Occurred`, in lower case
    utc: float  # UTC seconds
    clock_s: Optional[float] = None  # counted seconds of the run at that time; None: it was not started
    who: str = ""  # empty: the box
    text: Said = ""  # a note's, the name of the phase or the goal, or why the clock is paused
    role: str = ""  # of `who`, such as referee; empty: not known
    device: str = ""  # from which it was sent; empty: not known
    id: str = ""  # a note's identity, with which it is made once; empty: it has none
    changed_utc: float = 0.0  # UTC seconds: when a note's text was entered, if that was later; 0.0: at once
    changed_by: str = ""
    arrived_utc: float = 0.0  # UTC seconds, if it had waited for a link to the box; 0.0: at once


class Proposal(NamedTuple):
    """A mark that was made before the sign-off and arrived after it, or that one was taken back. It counts if a referee
    accepts it."""

    number: int  # 1, 2, … within the run
    entry: ScoreEntry  # which the mark would make; or the opposite of the one that is taken back
    mark_id: str
    decided_utc: float = 0.0  # UTC seconds; 0.0: not yet
    decided_by: str = ""
    accepted: bool = False
    reason: str = ""  # of the decision
    takes_back: int = 0  # number of the entry of the history that no longer counts; 0: it is a mark


class Occurred(enum.Enum):
    """What a `TimelineEntry` is about."""

    START = enum.auto()  # also again, after a stop
    CONTINUE = enum.auto()  # a referee knew that the run was not stopped
    PAUSE = enum.auto()
    RESUME = enum.auto()
    PHASE = enum.auto()
    GOAL = enum.auto()
    NOTE = enum.auto()


class GroupPoints(NamedTuple):
    """The points of a group of items, or of the time left."""

    name: str
    points: str  # a decimal number


class SheetPoints(NamedTuple):
    """The points of a score sheet."""

    total: str  # a decimal number
    groups: Tuple[GroupPoints, ...]  # those with items that give points, in the sheet's order; then the time left
    steps: Tuple[Said, ...] = ()  # how they came about, where a reader could doubt it
    for_team: str = ""  # a decimal number that the team gets whichever attempt counts, not in the total; empty: none
    replaces: bool = False  # the attempts before this run do not count
    inner: Tuple[str, ...] = ()  # names of the groups that are part of another one of `groups`


class StopRecord(NamedTuple):
    """An end of a run. A run that was started again after a stop has several."""

    utc: float  # UTC seconds
    who: str  # who stopped it; empty: it ended by itself
    end_reason: str  # name of an `EndReason`, in lower case
    desc: str  # the text for the referee
    reason: str = ""  # typed by the referee, with the stop or later
    reason_by: str = ""  # who typed it
    clock_s: Optional[float] = None  # counted seconds of the run; None: not known


class Outage(NamedTuple):
    """The box was away during a run in progress, until it was restarted, or another computer took over."""

    utc: float  # UTC seconds of its last record before
    seconds: float
    goal: int = 0  # number of the goal in progress; 0: none
    left_out_s: float = 0.0  # seconds that do not count: the robot completed the goal, or the task, in them


class PhaseTime(NamedTuple):
    """The time of a phase of a task benchmark."""

    name: str
    began_utc: float  # UTC seconds
    elapsed_s: float  # counted seconds


class SignOff(NamedTuple):
    """The score sheet was signed off: it is final."""

    utc: float  # UTC seconds
    who: str


class CaptainSign(NamedTuple):
    """The captain of the team read the score sheet, and signed it or refused to."""

    utc: float  # UTC seconds
    name: str
    refused: bool = False
    comment: str = ""  # of a refusal, the reason
    drawing: str = ""  # the signature: lines such as M10 20L30 40, on a field of 400 times 150; empty: none
    who: str = ""  # on whose device
    outdated: bool = False  # the sheet was corrected after it; worked out when it is shown, and never kept


class JudgeSheet(NamedTuple):
    """The score sheet of one of several judges. Nobody else sees it before it is submitted."""

    judge: str
    opened_utc: float  # UTC seconds
    device: str = ""  # from which it was sent last; empty: not known
    history: Tuple[ScoreEntry, ...] = ()
    marks: TakenMarks = NO_MARKS
    submitted_utc: float = 0.0  # UTC seconds; 0.0: not submitted
    items: Tuple[ItemRecord, ...] = ()  # as they were submitted
    again: str = ""  # why the judge should look again; empty: not handed back
    withdrawn_utc: float = 0.0  # UTC seconds; 0.0: it counts


class Settlement(NamedTuple):
    """The head referee's value of an item. It holds while the judges' values are those of `proposals`."""

    utc: float  # UTC seconds
    who: str
    group: str
    desc: str
    value: int
    text: str
    not_attempted: bool
    reason: str
    proposals: Tuple[Tuple[str, str], ...]  # each judge with the value in words, by name


class JudgeAct(NamedTuple):
    """What a judge or the head referee did with a judge's sheet."""

    utc: float  # UTC seconds
    who: str
    act: str  # submitted, handed back, withdrawn, waived missing judges, settled
    judge: str = ""  # whose sheet it is
    reason: str = ""


class Waiver(NamedTuple):
    """The head referee does not wait for missing judges."""

    utc: float  # UTC seconds
    who: str
    reason: str


class JudgingRecord(NamedTuple):
    """The sheets of several judges, and what became of them."""

    sheets: Tuple[JudgeSheet, ...] = ()  # in the order in which they were opened
    settlements: Tuple[Settlement, ...] = ()  # oldest first; a later one of an item replaces the earlier ones
    waiver: Optional[Waiver] = None
    acts: Tuple[JudgeAct, ...] = ()  # oldest first


class Published(NamedTuple):
    """The result was published as provisional."""

    utc: float  # UTC seconds
    who: str
    until_utc: float  # UTC seconds: until then, objections are possible


class Objection(NamedTuple):
    """An objection to a result: a protest, if it is signed off."""

    number: int  # 1, 2, … within the run
    utc: float  # UTC seconds
    by: str  # who objects, such as a team
    text: str
    who: str  # who entered it
    answered_utc: float = 0.0  # UTC seconds; 0.0: not answered
    answered_by: str = ""
    upheld: bool = False
    answer: str = ""
    second: int = 0  # of the run's clock, which it is about; 0: none in particular


class SheetVersion(NamedTuple):
    """A signed score sheet that another version replaced. The history of the run has the marks of all versions."""

    replaced_utc: float  # UTC seconds
    why: str
    sign_off: SignOff
    items: Tuple[ItemRecord, ...]
    points: Optional[SheetPoints]
    form: Optional[SheetForm]


class Slot(NamedTuple):
    """The event to which a run belongs, of one benchmark."""

    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    event: str  # its id


class RunChange(NamedTuple):
    """A run that is over was put right. One that was taken back is kept, too."""

    utc: float  # UTC seconds
    what: str  # ANNULLED, MOVED or REOPENED
    who: str
    reason: str
    before: Optional[Slot] = None  # of a run that was moved
    after: Optional[Slot] = None
    undone_utc: float = 0.0  # UTC seconds; 0.0: it holds
    undone_by: str = ""
    undone_reason: str = ""


# It counts nothing, and is no attempt; it belongs to another event; its sheet is not signed any more.
ANNULLED, MOVED, REOPENED = "annulled", "moved", "reopened"


class PublicationRecord(NamedTuple):
    """The publication of a result as provisional, and the objections to it, also after the sign-off."""

    published: Optional[Published] = None
    objections: Tuple[Objection, ...] = ()  # oldest first


class RunRecord(NamedTuple):
    """The complete record of a run."""

    identity: str
    zone: str
    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    opened_utc: float  # UTC seconds of *connect*
    started_utc: float = 0.0  # UTC seconds of the last *start*; 0.0: it was never started
    closed_utc: float = 0.0  # UTC seconds of *disconnect*; 0.0: still connected
    end_reason: str = ""  # name of an `EndReason`, in lower case; empty: never started, or running
    elapsed_s: float = 0.0  # counted seconds until the last end, or until now if it is running
    items: Tuple[ItemRecord, ...] = ()
    history: Tuple[ScoreEntry, ...] = ()
    module_scores: Tuple[ScoreValue, ...] = ()  # of the benchmarking module
    stops: Tuple[StopRecord, ...] = ()
    sign_off: Optional[SignOff] = None
    robots: Tuple[str, ...] = ()  # their names, without the team if all are of one team; empty: scored by hand
    phases: Tuple[PhaseTime, ...] = ()  # those that began after the last start
    points: Optional[SheetPoints] = None  # None: the sheet gives no points
    form: Optional[SheetForm] = None  # None: the sheet only has items without rules
    marks: TakenMarks = NO_MARKS
    judging: JudgingRecord = JudgingRecord()
    publication: PublicationRecord = PublicationRecord()
    event: str = ""  # id of its event in the schedule; empty in journals before 2026-12
    outages: Tuple[Outage, ...] = ()  # oldest first
    versions: Tuple[SheetVersion, ...] = ()  # earlier ones of its signed sheet, oldest first
    captain: Tuple[CaptainSign, ...] = ()  # oldest first; the last one holds
    proposals: Tuple[Proposal, ...] = ()  # in the order in which they arrived
    timeline: Tuple[TimelineEntry, ...] = ()  # oldest first; marks and ends have lists of their own
    changes: Tuple[RunChange, ...] = ()  # oldest first

    @property
    def is_annulled(self) -> bool:
        """Whether it counts nothing, because somebody said so."""
        return any(change.what == ANNULLED and not change.undone_utc for change in self.changes)

    @property
    def open_objections(self) -> int:
        """How many objections are not answered."""
        return sum(not one.answered_utc for one in self.publication.objections)

    @property
    def slot(self) -> Slot:
        """The event to which it belongs."""
        return Slot(self.team, self.round, self.run, self.scheduled, self.event)


def submitted(record: RunRecord) -> Tuple[JudgeSheet, ...]:
    """Return the sheets that count, by the judges' names; none before all who are awaited have submitted."""
    judging, rule = record.judging, None if record.form is None else record.form.judges
    found = sorted((s for s in judging.sheets if s.submitted_utc and not s.withdrawn_utc), key=lambda s: s.judge)
    is_complete = judging.waiver is not None or (rule is not None and len(found) >= rule.count)
    return tuple(found) if is_complete else ()


def ratings(record: RunRecord, item: ItemRecord) -> Tuple[Rating, ...]:
    """Return what each judge gave for an item that judges rate. If they have sheets of their own, what counts in the
    run's sheet may be a settlement instead."""
    if record.form is None or record.form.judges is None:
        return item.ratings
    return tuple(Rating(one.judge, each.text) for one in submitted(record) for each in one.items
                 if each.key == item.key and item.kind == "rating")


class By(NamedTuple):
    """Who gave a command, and the reason if one was given."""

    who: str = ""
    reason: str = ""


# For a run that ended by itself.
NOBODY = By()
