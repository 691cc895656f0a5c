"""The record of a run: who scored what, why it ended, who signed it off. It is what remains of a run.

It is made by the core with every change, kept in the journal, and read by whoever shows or exports results.
"""

import enum
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple


class Phase(enum.Enum):
    """Where a run is, in the referee's eyes."""

    CONNECTED = "connected"
    RUNNING = "running"
    ENDED = "ended"


class EndReason(enum.Enum):
    """Why a run ended; the text is what the referee reads."""

    STOPPED = "Benchmark stopped by the referee"
    COMPLETED = "Benchmark completed by the robot"
    TIMEOUT = "Stopped due to timeout"
    GOALS_TIMED_OUT = "Benchmark over: every goal timed out"
    NO_MESSAGES_SAVED = "Stopped: the robot saves no offline data (messages saved stays 0)"
    MODULE_FAILED = "Stopped: the benchmarking module cannot continue"


# The benchmark ran to its end, so the zone moves on to its next event.
RAN_TO_THE_END = (EndReason.COMPLETED, EndReason.GOALS_TIMED_OUT)


class ScoreValue(NamedTuple):
    """One line of a module's score."""

    group: str  # of what it is one of several, such as "waypoint 2"; empty: of the whole run
    name: str  # such as distance_error
    value: str  # JSON: a number, true, false, a text, or null while there is none
    unit: str  # m, rad, s, or empty
    desc: str = ""  # for the referee


class ItemRecord(NamedTuple):
    """A scoring item of the referee's sheet, as it stands."""

    group: str
    desc: str
    kind: str  # "bool" or "uint"
    value: int
    not_attempted: bool = False  # the robot did not try, which is not the same as a 0 that it earned
    corrected: bool = False  # its value has changed since the run was over


def grouped(items: Iterable[ItemRecord]) -> Dict[str, List[ItemRecord]]:
    """The items of a sheet by their group, in the sheet's order."""
    groups: Dict[str, List[ItemRecord]] = {}
    for item in items:
        groups.setdefault(item.group, []).append(item)
    return groups


class ScoreEntry(NamedTuple):
    """One change of the score sheet. An entry that is withdrawn stays in the history, and counts no more."""

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
    withdrawn_utc: float = 0.0  # UTC seconds; 0.0: it counts
    withdrawn_by: str = ""
    withdrawn_note: str = ""
    withdrawal_corrects: bool = False  # withdrawn after the run was over


class StopRecord(NamedTuple):
    """One end of a run; a run that was started again after a stop has several."""

    utc: float  # UTC seconds
    who: str  # who stopped it; empty: nobody, it ended by itself
    end_reason: str  # name of an `EndReason`, in lower case
    desc: str  # what the referee read
    reason: str = ""  # what the referee typed, then or later
    reason_by: str = ""  # who typed it


class SignOff(NamedTuple):
    """The score sheet was signed off: it is final."""

    utc: float  # UTC seconds
    who: str


class RunRecord(NamedTuple):
    """All that remains of a run."""

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
    end_reason: str = ""  # name of an `EndReason`, in lower case; empty: it was never started, or it runs
    elapsed_s: float = 0.0  # seconds that counted until the last end; of a run that runs, so far
    items: Tuple[ItemRecord, ...] = ()
    history: Tuple[ScoreEntry, ...] = ()
    module_scores: Tuple[ScoreValue, ...] = ()  # of the benchmarking module
    stops: Tuple[StopRecord, ...] = ()
    sign_off: Optional[SignOff] = None
    robots: Tuple[str, ...] = ()  # their names, without the team where it is one


class By(NamedTuple):
    """Who gave a command, and why, if that was said."""

    who: str = ""
    reason: str = ""


# Nobody gave the command: the run ended by itself.
NOBODY = By()
