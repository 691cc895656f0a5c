"""Reads the journal of the present or a past competition, or a copy of one. It never changes the journal.

It shows the journal as it was when it was opened, also while the box runs.
"""

import contextlib
import os
import time
from typing import Any, Callable, Collection, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.ground import linux
from roah_rsbb.journal import records
from roah_rsbb.journal.contents import DAMAGED, BoxEpoch, Opened, RunEntry, holes_of, open_journal, utc_text
from roah_rsbb.journal.log import Frame, NewerFormat, Scan, Segment, scan_at, scans
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.records import Kind, LinkRow, Top, line_of, top_of

# A running box may write a record, or begin a segment, while the folder is read.
# Seconds between two looks then: on a busy computer, its write may wait for the processor.
ATTEMPTS, PAUSE_S = 4, 0.05
# A larger journal is checked only where it is read, unless the caller wants all of it (docs/journal.md, "Damage").
SMALL_BYTES = 4_000_000
# Segments whose records are in memory.
_MOST_LOADED = 2


def journal_in(log_dir: str) -> str:
    """Return the path of the journal in a log_dir."""
    return os.path.join(log_dir, JOURNAL)


class JournalError(Exception):
    """The journal cannot be read. The text names the file and the remedy."""


class JournalSession(NamedTuple):
    """One start of the core."""

    number: int
    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock
    boot_id: str  # identifies the computer's start, and so its monotonic clock
    pid: int
    box_uuid: str
    launch: str


class JournalRun(NamedTuple):
    """A run since *connect*."""

    identity: str
    zone: str
    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    opened_utc: float  # UTC seconds of *connect*
    closed_utc: Optional[float]  # UTC seconds of *disconnect*; None: still connected
    outcome: Dict[str, Any]  # the core's RunRecord, without fields that have their default; empty: no record yet


class JournalMember(NamedTuple):
    """A robot's part in a run."""

    port: int  # UDP port of its private channel, which is unique among all runs
    identity: str
    team: str
    robot: str
    log_file: str  # path of its run log on the box's computer; empty if none


class JournalEntry(NamedTuple):
    """An entry of the journal."""

    number: int  # rising, in order
    session: int
    utc: float  # UTC seconds
    mono: float  # seconds on the session's monotonic clock
    zone: str
    identity: str  # of the run; empty if it belongs to no run
    port: Optional[int]  # of the robot; None if it belongs to no robot
    who: str  # the originator; empty: the box
    kind: str
    value: Any  # JSON's value


class JournalSegment(NamedTuple):
    """A segment of the journal."""

    number: int
    name: str
    bytes: int
    count: int  # of intact records
    utc: float  # UTC seconds of the first one; 0.0: there is none
    damage: List[str]  # what is damaged or missing, and the periods


class _Loaded:
    """The records of a segment."""

    def __init__(self, frames: List[Frame]) -> None:
        self.records: List[Tuple[Top, Frame]] = [(top_of(frame.payload), frame) for frame in frames]
        self.of: Dict[str, List[Tuple[Top, Frame]]] = {}  # by the identities of runs
        for record in self.records:
            for identity in record[0].identities:
                self.of.setdefault(identity, []).append(record)


class JournalReader:
    """One journal as it was when it was opened. Use it in a `with`, or call `close`.

    All methods raise `JournalError`. After a fork, both processes can use it.
    """

    def __init__(
        self, path: str, checks_all: bool = True, on_damage: Callable[[str], None] = lambda text: None,
    ) -> None:
        """`path`: the folder of the journal. `checks_all`: check all of a large
        journal, which takes seconds. A small one is always checked. Otherwise `on_damage` is called with each damaged
        record of a run that is read."""
        self._on_damage = on_damage
        self.path = path.rstrip(os.sep) or path
        self._loaded: Dict[int, _Loaded] = {}  # the latest last
        self._opened = self._open()
        self._contents = self._opened.contents
        self._last = 0 if self._opened.newest is None else self._opened.newest.last
        self._checks_all = checks_all or self._is_small()

    # -- contents -----------------------------------------------------------------------------------

    def sessions(self) -> List[JournalSession]:
        """All starts of the core, in order."""
        return [JournalSession(number, *session) for number, session in enumerate(self._contents.sessions, 1)]

    def runs(self) -> List[JournalRun]:
        """All runs, in the order in which they were connected."""
        outcomes = self._outcomes()
        return [JournalRun(*run.row, run.closed, outcomes[run.row[0]] or {}) for run in self._ordered()]

    def identities(self) -> List[str]:
        """The identities of all runs, in the same order."""
        return [run.row[0] for run in self._ordered()]

    def run(self, identity: str) -> Optional[JournalRun]:
        """A run; None if it does not exist."""
        run = self._contents.runs.get(identity)
        return None if run is None else JournalRun(*run.row, run.closed, self._outcome(run) or {})

    def members(self, identity: str) -> List[JournalMember]:
        """The robots of a run."""
        run = self._contents.runs.get(identity)
        return [] if run is None else [JournalMember(*member) for member in sorted(run.members)]

    def all_members(self) -> List[JournalMember]:
        """The robots of all runs, in the order of their ports."""
        return sorted(JournalMember(*member) for run in self._contents.runs.values() for member in run.members)

    def as_of(self) -> float:
        """The UTC seconds of the last thing in the journal; 0.0: there is none."""
        return max(self._contents.times)

    def entries(self, identity: str) -> List[JournalEntry]:
        """All entries of a run (empty: of no run), in order, except its states."""
        return [entry for entry in self._entries(self._of(identity), (records.ENTRIES,)) if entry.identity == identity]

    def entries_of(self, identities: Collection[str]) -> Iterator[JournalEntry]:
        """All entries of these runs, in order for each run, except its states. Each segment is read once."""
        numbers = {number for identity in identities for number in self._contents.runs[identity].segments}
        for place, segment in enumerate(self._opened.segments):
            if segment.name.number in numbers:
                found = self._load(place).of
                for identity in identities:
                    logged = (each for each in found.get(identity, ()) if records.ENTRIES in each[0].letters)
                    yield from (e for e in self._entries(logged, (records.ENTRIES,)) if e.identity == identity)

    def is_over(self, identity: str) -> bool:
        """Whether a run was disconnected."""
        return self._contents.runs[identity].closed is not None

    def states(self, identity: str) -> List[JournalEntry]:
        """The states of a run, in order, for `ChangesReader`."""
        return [entry for entry in self._entries(self._of(identity), (records.STATES_OF_RUNS,))
                if entry.identity == identity]

    def commands(self, zone: str) -> List[JournalEntry]:
        """The referees' commands to a zone, including refused ones, in order."""
        return [entry for entry in self._entries(self._all(), (records.ENTRIES,), b'"command"')
                if entry.zone == zone and entry.kind == Kind.COMMAND]

    def links(self, port: int) -> List[LinkRow]:
        """The link record of a robot, in order."""
        identity = self._contents.run_of.get(port)
        return [] if identity is None else [
            LinkRow(*link) for top, frame in self._of(identity) if records.LINKS in top.letters
            for link in line_of(frame.payload, records.LINKS) if link[0] == port]

    def dump(self, identity: str = "") -> Iterator[str]:
        """Return lines of text for all records, or those of a run."""
        for top, frame in self._of(identity):
            yield f"{frame.number} {utc_text(top.utc)}, start {top.session}"
            for line in frame.payload.decode("utf-8", errors="replace").split("\n")[1:]:
                yield f"  {records.NAMES.get(line[:1], line[:1])}: {line[1:]}"

    # -- damage -------------------------------------------------------------------------------------

    @property
    def damage(self) -> List[str]:
        """Return what is damaged or missing in the journal, and the periods. The rest can be read.

        Of a journal that is not checked completely, this is what is after the newest summary; `damage_of` checks a run.
        """
        found = self._opened.problems + ([self._opened.torn] if self._opened.torn else [])
        if self._checks_all:
            return found + [text for segment in self.segments() for text in segment.damage]
        return found + self._opened.holes

    def damage_of(self, identity: str) -> List[str]:
        """Return what is damaged or missing in the segments that have something of a run, also of others, if `damage`
        did not check them."""
        run = self._contents.runs.get(identity)
        if self._checks_all or run is None:
            return []
        segments = self._opened.segments
        places = [place for place, segment in enumerate(segments) if segment.name.number in run.segments]
        return [text for place in places for text in holes_of(self._scan(place)) if text not in self._opened.holes]

    def segments(self) -> List[JournalSegment]:
        """All segments, in order. This reads all of the journal."""
        return [JournalSegment(
            segment.name.number, str(segment.name), os.path.getsize(segment.path), len(found.records),
            top_of(found.records[0].payload).utc if found.records else 0.0, holes_of(found),
        ) for segment, found in self._scans()]

    def standing(self) -> BoxEpoch:
        """Whether the box of this journal was superseded, and where the journals fork."""
        return self._contents.standing

    def only_here(self) -> List[Tuple[str, int]]:
        """The runs with entries that the box which took over does not have, and how many."""
        standing, found = self.standing(), {}
        if standing.is_superseded:
            for _, frame in self._all():
                if frame.number > standing.cut:
                    for _, _, _, _, identity, *_ in records.entries_in(frame.payload, records.OF_ENTRIES):
                        found[identity] = found.get(identity, 0) + bool(identity)
        return [(identity, count) for identity, count in found.items() if count]

    # -- records ------------------------------------------------------------------------------------

    def _ordered(self) -> List[RunEntry]:
        return sorted(self._contents.runs.values(), key=lambda run: (run.row[-1], run.row[0]))

    def _outcomes(self) -> Dict[str, Any]:
        """Return the records of all runs, by their identities."""
        with self._reading():
            return {run.row[0]: self._earlier(run) if outcome is DAMAGED else outcome
                    for run, outcome in self._opened.outcomes(self._contents.runs.values())}

    def _outcome(self, run: RunEntry) -> Any:
        with self._reading():
            (_, found), = self._opened.outcomes([run])
            return self._earlier(run) if found is DAMAGED else found

    def _earlier(self, run: RunEntry) -> Any:
        """Return the record of a run whose newest one is damaged."""
        if not self._checks_all:
            self._on_damage(f"the newest record of the run {run.row[0]}: an earlier one is shown")
        return self._opened.earlier_outcome(run.row[0])

    def _entries(self, found: Iterator[Tuple[Top, Frame]], letters: Sequence[str],
                 text: bytes = b"") -> Iterator[JournalEntry]:
        for top, frame in found:
            if text in frame.payload:
                for number, *entry in records.entries_in(frame.payload, letters):
                    yield JournalEntry(number, top.session, *entry)

    def _of(self, identity: str) -> Iterator[Tuple[Top, Frame]]:
        """Return the records of a run; of none: all records."""
        if not identity:
            yield from self._all()
            return
        run = self._contents.runs.get(identity)
        for number, segment in enumerate(self._opened.segments):
            if run is not None and segment.name.number in run.segments:
                yield from self._load(number).of.get(identity, ())

    def _all(self) -> Iterator[Tuple[Top, Frame]]:
        for number in range(len(self._opened.segments)):
            yield from self._load(number).records

    def _load(self, number: int) -> _Loaded:
        """Return a segment's records; the latest ones stay in memory."""
        found = self._loaded.get(number)
        if found is None:
            found = _Loaded([frame for frame in self._scan(number).records if frame.number <= self._last])
            self._loaded[number] = found
            if len(self._loaded) > _MOST_LOADED:
                del self._loaded[next(iter(self._loaded))]
        return found

    def _scan(self, place: int) -> Scan:
        """Read a single segment."""
        with self._reading():
            return scan_at(self._opened.segments, place)

    def _scans(self) -> Iterator[Tuple[Segment, Scan]]:
        with self._reading():
            yield from scans(self._opened.segments)

    @contextlib.contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise self._unreadable(error) from None

    def _is_small(self) -> bool:
        with contextlib.suppress(OSError):
            return sum(os.path.getsize(segment.path) for segment in self._opened.segments) <= SMALL_BYTES
        return True

    # -- opening ------------------------------------------------------------------------------------

    def _open(self) -> Opened:
        if not os.path.exists(self.path):
            raise JournalError(
                f"{self.path}: the journal is missing. A box creates its journal in its log_dir at its first start: "
                "name it with --journal FOLDER"
            )
        if not os.path.isdir(self.path):
            raise JournalError(f"{self.path}: this is a file, and a journal is a folder: name the folder {JOURNAL} "
                               "of a box's log_dir, or another copy of it")
        try:
            for _ in range(ATTEMPTS):
                found = open_journal(self.path)
                if not (found.problems or found.holes or found.torn):
                    break
                if linux.is_locked(f"{self.path}.lock"):  # a box writes it
                    time.sleep(PAUSE_S)
        except NewerFormat as error:
            raise JournalError(f"{self.path}: {error}: read it with that version") from None
        except OSError as error:
            raise self._unreadable(error) from None
        if not found.segments:
            raise JournalError(f"{self.path}: this folder has no journal that can be read "
                               f"({'; '.join(found.problems) or 'it has no segments'}). Name the folder {JOURNAL} of "
                               "a box's log_dir, or another copy of it")
        return found

    def _unreadable(self, error: OSError) -> JournalError:
        return JournalError(
            f"{error.filename or self.path}: cannot be read: {error.strerror}. Its owner can make it readable")
