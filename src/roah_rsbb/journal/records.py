"""What the journal records: what one event adds, as a batch of values and as the payload of a frame.

The first line of a record has tab-separated what readers choose records by: UTC and monotonic seconds, number of the
session, number of the newest entry, the letters of the other lines, and the identities of the runs that it belongs to.
Each other line is a letter and JSON. Readers only parse the lines that they need.

Large states change little, so an entry has only how a state changed (`document/difference.py`).
"""

import json
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.document.difference import SAME, changed, difference


class Kind:
    """Kinds of entries that are not topics of a run log (those are in `model/run_log.py`)."""

    COMMAND = "command"  # a referee's command, even if refused
    JUDGE_MARK = "judge_mark"  # a judge's mark on the judge's own sheet, which others must not see
    JUDGING = "judging"  # a judge submits, or the head referee decides, even if refused
    PUBLICATION = "publication"  # a provisional result, an objection or its answer, even if refused
    RELOAD = "reload"  # an organiser changed the configuration
    NOTICE = "notice"  # a warning or an error that the referee saw
    ADDRESS = "address"  # a robot's address
    TIMEOUT = "timeout"  # a run timed out
    STATE = "state"  # of a zone with a run, with the times of the run: how it changed (`ChangesReader`)
    EPOCH = "epoch"  # a standby took over: here, or from the box of this journal (`journal/epochs.py`)


# -- a batch ----------------------------------------------------------------------------------------

# Its values are those of JSON: no tuples in what changes.


class NewEntry(NamedTuple):
    """An entry to be written."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of the session
    zone: str
    identity: str  # of the run; empty if it belongs to no run
    port: Optional[int]  # of the robot's private channel; None if it belongs to no robot
    who: str  # the originator: a referee's node or a robot's address; empty: the box
    kind: str
    value: Any  # JSON's value


class RunRow(NamedTuple):
    """A run to be written."""

    identity: str
    zone: str
    benchmark: str
    team: str
    round: int
    run: int
    scheduled: float
    opened_utc: float


class OutcomeRow(NamedTuple):
    """The present record of a run."""

    closed_utc: Optional[float]  # None: still connected
    outcome: Any  # JSON's value


class Member(NamedTuple):
    """A robot that takes part in a run."""

    port: int
    identity: str
    team: str
    robot: str


class LinkRow(NamedTuple):
    """One second of a robot's link record."""

    port: int
    utc: float
    mono: float
    sample: Any  # JSON's value


@dataclass
class Batch:
    """The changes of one event."""

    entries: List[NewEntry] = field(default_factory=list)
    runs: List[RunRow] = field(default_factory=list)
    members: List[Member] = field(default_factory=list)
    log_files: Dict[int, str] = field(default_factory=dict)  # path of the run log by port
    outcomes: Dict[str, OutcomeRow] = field(default_factory=dict)  # by the run's identity
    states: Dict[str, Any] = field(default_factory=dict)  # JSON's value of the state for a restart by its name
    links: List[LinkRow] = field(default_factory=list)

    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not any(vars(self).values())


# -- a record ---------------------------------------------------------------------------------------


ENTRIES = "e"  # [[number, utc, mono, zone, identity, port, who, kind, value] …]
STATES_OF_RUNS = "t"  # the same: entries of kind `state`
EPOCHS = "x"  # the same: entries of kind `epoch`
OF_ENTRIES = (ENTRIES, STATES_OF_RUNS, EPOCHS)
LINKS = "l"  # [[port, utc, mono, sample] …]
RUNS = "r"  # [[identity, zone, benchmark, team, round, run, scheduled, opened_utc] …]
MEMBERS = "m"  # [[port, identity, team, robot] …]
LOG_FILES = "f"  # [[port, path] …]
OUTCOMES = "o"  # {identity: record}
CLOSED = "d"  # {identity: closed_utc or null}, of the same runs
STATES = "z"  # {name: {"number", "change"}}, see `ChangesReader`
SESSION = "s"  # [utc, mono, boot_id, pid, box_uuid, launch]
COMPETITION = "c"  # [[zone, benchmark, team, round, run, scheduled] …]

# For people.
NAMES = {
    ENTRIES: "entries", STATES_OF_RUNS: "states of runs", EPOCHS: "epochs", LINKS: "links", RUNS: "runs",
    MEMBERS: "robots", LOG_FILES: "log files", OUTCOMES: "records of runs", CLOSED: "disconnected", STATES: "states",
    SESSION: "start", COMPETITION: "competition",
}

Lines = Dict[str, Any]
_LETTERS = {Kind.STATE: STATES_OF_RUNS, Kind.EPOCH: EPOCHS}
_ENCODER = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))


class Top(NamedTuple):
    """The first line of a record."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of the session
    session: int  # number; 0: no core wrote it
    entry: int  # number of the newest entry so far
    letters: str  # of the lines
    identities: Tuple[str, ...]


# What ends a part of the first line. Whoever names a run that is not there may write anything into its name.
_ENDS = dict.fromkeys(map(ord, "\t\n"), "�")


def encode(top: Top, lines: Lines) -> bytes:
    """Return the payload of a record. Raises TypeError or ValueError for values that JSON does not have."""
    found = ["\t".join((repr(top.utc), repr(top.mono), str(top.session), str(top.entry), top.letters,
                        *(identity.translate(_ENDS) for identity in top.identities), ""))]
    found += [letter + _ENCODER.encode(value) for letter, value in lines.items()]
    return "\n".join(found).encode("utf-8", errors="replace")


def top_of(payload: bytes) -> Top:
    """Read the first line of a record. Raises ValueError."""
    end = payload.find(b"\n")
    utc, mono, session, entry, letters, *identities = payload[:len(payload) if end < 0 else end].split(b"\t")
    return Top(float(utc), float(mono), int(session), int(entry), letters.decode("ascii"),
               tuple([identity.decode("utf-8") for identity in identities[:-1]]))


def line_of(payload: bytes, letter: str) -> Any:
    """Read a line of a record; None: it has no such line. Raises ValueError."""
    begin = payload.find(b"\n" + letter.encode("ascii"))
    if begin < 0:
        return None
    end = payload.find(b"\n", begin + 1)
    return json.loads(payload[begin + 2:len(payload) if end < 0 else end].decode("utf-8"))


def lines_of(batch: Batch, entry: int) -> Lines:
    """Return the lines of a batch, without its states. `entry`: number of the newest entry before it."""
    lines: Lines = {}
    if batch.runs:
        lines[RUNS] = batch.runs
    if batch.members:
        lines[MEMBERS] = batch.members
    if batch.log_files:
        lines[LOG_FILES] = list(batch.log_files.items())
    for number, new in enumerate(batch.entries, entry + 1):
        lines.setdefault(_LETTERS.get(new.kind, ENTRIES), []).append((number, *new))
    if batch.outcomes:
        lines[OUTCOMES] = {identity: row.outcome for identity, row in batch.outcomes.items()}
        lines[CLOSED] = {identity: row.closed_utc for identity, row in batch.outcomes.items()}
    if batch.links:
        lines[LINKS] = batch.links
    return lines


def identities_of(lines: Lines, run_of: Callable[[int], Optional[str]]) -> Tuple[str, ...]:
    """Return the runs to which lines belong. `run_of` returns the run of a port."""
    found: Dict[str, None] = {}
    for identity, *_ in lines.get(RUNS, ()):
        found[identity] = None
    own = {port: identity for port, identity, *_ in lines.get(MEMBERS, ())}
    for letter in OF_ENTRIES:
        for entry in lines.get(letter, ()):
            found[entry[4]] = None
    ports = [*own, *(port for port, *_ in lines.get(LOG_FILES, ())), *(port for port, *_ in lines.get(LINKS, ()))]
    for port in ports:
        found[own.get(port) or run_of(port) or ""] = None
    for identity in lines.get(OUTCOMES, ()):
        found[identity] = None
    return tuple([identity for identity in found if identity])


def time_of(lines: Lines) -> Optional[Tuple[float, float]]:
    """Return UTC and monotonic time of the last thing in the lines; None: nothing in them has a time."""
    if SESSION in lines:
        return lines[SESSION][:2]
    for letter in (*OF_ENTRIES, LINKS):
        if letter in lines:
            return lines[letter][-1][1:3]
    return None


def entries_in(payload: bytes, letters: Iterable[str]) -> List[List[Any]]:
    """Return the entries in these lines of a record, in order. Raises ValueError."""
    found = [entry for letter in letters for entry in line_of(payload, letter) or ()]
    return sorted(found, key=lambda entry: entry[0])


# -- changes of a state -----------------------------------------------------------------------------

# A complete state follows after this many differences, so that a damaged entry hides no more than these.
COMPLETE_EVERY = 200


class ChangesWriter:
    """Makes the entries of one run's states: a complete state, then differences (docs/journal.md, "entries")."""

    def __init__(self) -> None:
        self._number = 0
        self._last: Any = None

    def entry(self, state: Any) -> Optional[Dict[str, Any]]:
        """Return the value of the next entry; None: the state is the same as in the last one."""
        change = [state] if self._number % COMPLETE_EVERY == 0 else difference(self._last, state)
        if change is SAME:
            return None
        self._number += 1
        self._last = state
        return {"number": self._number, "change": change}


class ChangesReader:
    """Follows the states of one run. After a damaged or missing entry, it waits for the next complete state."""

    def __init__(self, number: int = 0, state: Any = None) -> None:
        self.number = number  # of the last entry
        self.state = state  # None: not known

    def take(self, value: Any) -> Any:
        """Take the value of the next entry; returns the state; None: it is not known."""
        try:
            number, change = value["number"], value["change"]
            is_complete = isinstance(change, list) and len(change) == 1
            is_next = number == self.number + 1 and self.state is not None
            self.state = changed(self.state, change) if is_next or is_complete else None
            self.number = number
        except (TypeError, KeyError, ValueError):
            self.state = None
        return self.state
