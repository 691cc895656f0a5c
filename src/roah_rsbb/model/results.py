"""Runs as a referee sees them after the run: in a line, and with their score sheet, history and ends.

Times are UTC seconds since 1970; None: not yet, or never.
"""

from typing import NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import ScoreValue, SheetPoints
from roah_rsbb.model.zone import SheetItem


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
    counts: str = ""  # whether it counts, and why or why not: a word of `wording.counting`


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


class RunEnd(NamedTuple):
    """One end of a run."""

    number: int  # from 1
    utc_s: float
    who: str  # who stopped it; empty: it ended by itself
    end_reason: str
    desc: str  # the text for the referee
    reason: str  # typed by the referee
    reason_by: str = ""


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


class UnsavedParts(NamedTuple):
    """The parts of a run's record that are not on the disk yet."""

    identity: str
    zone: str
    entries: Tuple[int, ...] = ()  # numbers of entries of the history that are new, or were withdrawn
    stops: Tuple[int, ...] = ()  # numbers of ends, from 1, that are new or whose reason changed
    sign_off: bool = False
