"""What a journal contains, as far as a start needs it: rows of runs and the places of their records, states, sessions.

It follows the records, and a segment's summary is its text. Memory has places, not contents: the records of 10,000 runs
stay in their segments.
"""

import functools
import itertools
import json
import time
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal import records
from roah_rsbb.journal.log import (
    HEAD_BYTES,
    Frame,
    Hole,
    Scan,
    Segment,
    frames,
    payloads_at,
    read,
    read_chain,
    scan,
    scan_at,
)
from roah_rsbb.journal.records import ChangesReader, Top, line_of, top_of

_ENCODER = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))
# Fields of a run's row, and those of its record from which a lost row can be made.
ROW = ("identity", "zone", "benchmark", "team", "round", "run", "scheduled", "opened_utc")


# -- whether another box took over ------------------------------------------------------------------

FIRST = 1

# Keys of an entry's value: a takeover has "epoch", the end of a superseded box "superseded_by".
_EPOCH, _SUPERSEDED_BY, _CUT, _BY = "epoch", "superseded_by", "cut", "by"


class BoxEpoch(NamedTuple):
    """What a journal says about its box."""

    epoch: int = FIRST
    superseded_by: int = 0  # the epoch of the box that took over from this one; 0: none
    cut: int = 0  # number of the last record that both journals have
    by: str = ""  # address of the box that took over

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over from this one."""
        return self.superseded_by > 0

    @property
    def next_epoch(self) -> int:
        """The epoch of a box that takes over now."""
        return max(self.epoch, self.superseded_by) + 1


def takeover_value(epoch: int, cut: int) -> dict:
    """Return the value of the entry of a box that takes over."""
    return {_EPOCH: epoch, _CUT: cut}


def superseded_value(epoch: int, cut: int, by: str) -> dict:
    """Return the value of the entry of a box that was superseded."""
    return {_SUPERSEDED_BY: epoch, _CUT: cut, _BY: by}


def standing_after(standing: BoxEpoch, value: Any) -> BoxEpoch:
    """Return what a journal says after the next entry of kind `epoch`."""
    try:
        epoch, superseded_by = int(value.get(_EPOCH, 0)), int(value.get(_SUPERSEDED_BY, 0))
        if epoch > max(standing.epoch, standing.superseded_by):
            return BoxEpoch(epoch, cut=int(value.get(_CUT, 0)))
        if superseded_by >= standing.epoch and superseded_by > standing.superseded_by:
            return standing._replace(superseded_by=superseded_by, cut=int(value.get(_CUT, 0)),
                                     by=str(value.get(_BY, "")))
    except (ValueError, TypeError, AttributeError):  # nobody writes this
        pass
    return standing


# -- the contents -----------------------------------------------------------------------------------


class RunEntry:
    """A run, and where it is found."""

    __slots__ = ("at", "closed", "members", "row", "segment", "segments", "text")

    def __init__(self, row: Sequence[Any], closed: Optional[float] = None, members: Sequence[Sequence[Any]] = (),
                 segment: int = 0, at: int = 0, segments: Sequence[int] = ()) -> None:
        # Python's garbage collection leaves tuples alone: there are many runs.
        self.row = tuple(row)  # see `ROW`
        self.closed = closed  # UTC seconds; None: still connected
        self.members = tuple(map(tuple, members))  # of port, identity, team, robot, log_file
        self.segment = segment  # number of the segment with its newest record; 0: none
        self.at = at  # bytes from the beginning of that segment
        self.segments = tuple(segments)  # numbers of the segments that have something of it
        self.text: Optional[bytes] = None  # of `as_text`; None: it changed

    def as_text(self) -> bytes:
        """Return the run as JSON."""
        text = self.text
        if text is None:
            text = self.text = _bytes([self.row, self.closed, self.members, self.segment, self.at, self.segments])
        return text


class Contents:
    """What a journal contains as of a record."""

    def __init__(self) -> None:
        self.competition: Any = None
        self.sessions: List[List[Any]] = []  # [utc, mono, boot_id, pid, box_uuid, launch]
        self.runs: Dict[str, RunEntry] = {}  # by identity
        self.run_of: Dict[int, str] = {}  # identity by port
        self.states: Dict[str, ChangesReader] = {}  # by name
        self.standing = BoxEpoch()
        self.entry = 0  # number of the newest entry
        self.utc = 0.0  # UTC seconds of the newest record that has a time
        self.times = [0.0, 0.0, 0.0]  # UTC seconds: the latest start, the newest entry, the newest link sample
        self.stated = 0  # the newest session that wrote states: their monotonic times are of its boot
        self.last = (0.0, 0.0)  # monotonic and UTC time of the last thing of that session; without states, of its start

    # -- as text --------------------------------------------------------------------------------------

    def summary(self) -> bytes:
        """Return a summary as of now."""
        values = {"competition": self.competition, "sessions": self.sessions, "standing": self.standing,
                  "entry": self.entry, "utc": self.utc, "times": self.times, "stated": self.stated, "last": self.last}
        states = {name: (state.number, state.state) for name, state in self.states.items() if state.state is not None}
        runs = b",".join([run.as_text() for run in self.runs.values()])
        return b"".join((_bytes(values), b"\n", _bytes(states), b"\n[", runs, b"]"))

    @classmethod
    def of_summary(cls, payload: bytes) -> "Contents":
        """Read a summary. Raises ValueError."""
        text, states, runs = payload[HEAD_BYTES:].decode("utf-8").split("\n")
        found, values = cls(), json.loads(text)
        found.competition, found.sessions = values["competition"], values["sessions"]
        found.standing = BoxEpoch(*values["standing"])
        found.entry, found.utc, found.times = values["entry"], values["utc"], values["times"]
        found.stated, found.last = values["stated"], tuple(values["last"])
        found.states = {name: ChangesReader(*state) for name, state in json.loads(states).items()}
        found.runs = {run[0][0]: RunEntry(*run) for run in json.loads(runs)}
        found.run_of = {member[0]: identity for identity, run in found.runs.items() for member in run.members}
        return found

    # -- following the records --------------------------------------------------------------------------

    def take(self, top: Top, line: Callable[[str], Any]) -> None:
        """Take the next record. `line` returns its lines. Raises ValueError."""
        self.entry = max(self.entry, top.entry)
        for letter in top.letters:
            taker = _TAKERS.get(letter)
            if taker is not None:
                taker(self, line(letter), line)
        if records.STATES in top.letters and self.stated < top.session <= len(self.sessions):
            # A core that ended before it resumed has a session, but the states are those of an earlier one.
            self.stated, self.last = top.session, tuple(self.sessions[top.session - 1][1::-1])
        if top.letters.strip(_WITHOUT_TIME):
            self.utc = self.times[2 if records.LINKS in top.letters else 1] = top.utc
            if top.session == self.stated:
                self.last = max(self.last, (top.mono, top.utc))

    def place(self, payload: bytes, segment: int, at: int) -> None:
        """A record that was taken is found in this segment, so many bytes from its beginning."""
        top = top_of(payload)
        if not top.identities:
            return
        placed = line_of(payload, records.CLOSED) if records.OUTCOMES in top.letters else ()
        for identity in top.identities:
            run = self.runs.get(identity)
            if run is None:
                continue
            if identity in placed:
                run.segment, run.at, run.text = segment, at, None
            if run.segments[-1:] != (segment,):
                run.segments, run.text = (*(n for n in run.segments if n != segment), segment), None

    def _session(self, session: List[Any], _line: object) -> None:
        self.sessions.append(session)
        self.utc = session[0]
        if not self.stated:
            self.last = session[1], session[0]
        self.times[0] = max(self.times[0], session[0])

    def _competition(self, competition: Any, _line: object) -> None:
        self.competition = competition

    def _runs(self, rows: List[Sequence[Any]], _line: object) -> None:
        for row in rows:
            run = self._run(row[0])
            if not run.row[1]:
                run.row = tuple(row)

    def _members(self, rows: List[Sequence[Any]], _line: object) -> None:
        for row in rows:
            if row[0] not in self.run_of:
                self.run_of[row[0]] = row[1]
                self._run(row[1]).members += ((*row, ""),)

    def _log_files(self, paths: List[Sequence[Any]], _line: object) -> None:
        for port, path in paths:
            if port in self.run_of:
                run = self._run(self.run_of[port])
                run.members = tuple((*member[:4], path) if member[0] == port else member for member in run.members)

    def _closed(self, closed: Dict[str, Optional[float]], line: Callable[[str], Any]) -> None:
        for identity, utc in closed.items():
            run = self._run(identity)
            run.closed = utc
            if not run.row[1]:  # its row is damaged
                record = line(records.OUTCOMES)[identity]
                run.row = tuple(record.get(name, default) for name, default in zip(ROW, run.row))

    def _run(self, identity: str) -> RunEntry:
        run = self.runs.get(identity)
        if run is None:
            run = self.runs[identity] = RunEntry((identity, "", "", "", 0, 0, 0.0, 0.0))
        run.text = None
        return run

    def _states(self, states: Dict[str, Any], _line: object) -> None:
        for name, change in states.items():
            self.states.setdefault(name, ChangesReader()).take(change)

    def _epochs(self, entries: List[List[Any]], _line: object) -> None:
        for entry in entries:
            self.standing = standing_after(self.standing, entry[-1])


def _bytes(value: Any) -> bytes:
    return _ENCODER.encode(value).encode("utf-8", errors="replace")


_TAKERS: Dict[str, Callable[..., None]] = {
    records.SESSION: Contents._session, records.COMPETITION: Contents._competition, records.RUNS: Contents._runs,
    records.MEMBERS: Contents._members, records.LOG_FILES: Contents._log_files, records.CLOSED: Contents._closed,
    records.STATES: Contents._states, records.EPOCHS: Contents._epochs,
}
# Records with only these lines have no time of their own.
_WITHOUT_TIME = "".join((records.RUNS, records.MEMBERS, records.LOG_FILES, records.OUTCOMES, records.CLOSED,
                         records.STATES, records.SESSION, records.COMPETITION))


DAMAGED = object()


class Opened(NamedTuple):
    """A journal as a start reads it: not all of it."""

    segments: List[Segment]  # oldest first
    newest: Optional[Scan]  # of the last segment; None: there is no segment
    contents: Contents
    problems: List[str]  # segments and summaries that are damaged or missing, in words
    holes: List[str]  # the same of records, as far as they were read
    torn: str  # what is known of an incomplete end; empty: it is complete
    unread: int = 0  # how many of the oldest segments were not read

    def damage_before(self) -> Iterator[str]:
        """Return what is damaged or missing in the segments that were not read, a text for each of them. This reads
        them."""
        for place in range(self.unread):
            try:
                holes = holes_of(scan_at(self.segments, place))
            except OSError as error:
                holes = [f"{self.segments[place].name} cannot be read: {error.strerror}"]
            if holes:
                yield "; ".join(holes)

    def segment(self, number: int) -> Optional[Segment]:
        """Return the segment with this number; None: it is missing."""
        return next((each for each in self.segments if each.name.number == number), None)

    def outcomes(self, runs: Iterable[RunEntry]) -> Iterator[Tuple[RunEntry, Any]]:
        """Return these runs, with their newest records (None: there is none, `DAMAGED`: it cannot be read), in the
        order in which they are in the journal."""
        by_segment = itertools.groupby(sorted(runs, key=lambda run: (run.segment, run.at)), lambda run: run.segment)
        for number, group in by_segment:
            segment = self.segment(number)
            if segment is None:
                yield from ((run, DAMAGED if number else None) for run in group)
                continue
            # Many runs may have ended in one event, whose record is read once.
            by_place = [(at, list(those)) for at, those in itertools.groupby(group, lambda run: run.at)]
            payloads = payloads_at(segment.path, segment.head.salt, [at for at, _ in by_place])
            for (_, those), payload in zip(by_place, payloads):
                lines = None if payload is None else line_of(payload, records.OUTCOMES)
                for run in those:
                    yield run, DAMAGED if lines is None else lines.get(run.row[0], DAMAGED)

    def earlier_outcome(self, identity: str) -> Any:
        """Return the newest intact record of a run; None: there is none. Raises OSError."""
        found = None
        for number in self.contents.runs[identity].segments:
            segment = self.segment(number)
            for frame in () if segment is None else frames_of(read(segment.path), segment.head.salt, identity):
                if records.OUTCOMES in top_of(frame.payload).letters:
                    found = line_of(frame.payload, records.OUTCOMES).get(identity, found)
        return found


def no_journal(problems: Sequence[str] = ()) -> Opened:
    """Return what is in a folder without a journal."""
    return Opened([], None, Contents(), list(problems), [], "")


def open_journal(folder: str) -> Opened:
    """Read the newest summary of a journal and the records after it. Raises OSError and `NewerFormat`."""
    chain = read_chain(folder)
    segments, problems = chain.segments, list(chain.problems)
    if not segments:
        return no_journal(problems)
    part: List[Tuple[Segment, Scan]] = []
    for segment in reversed(segments):  # usually, the newest one is enough
        after = part[0][0].head if part else None
        part.insert(0, (segment, scan(read(segment.path), segment.head, after, segment.certain)))
        if part[0][1].summary is not None:
            break
    contents = Contents() if part[0][1].summary is None else Contents.of_summary(part[0][1].summary.payload)
    holes: List[str] = []
    done = 0 if part[0][1].summary is None else part[0][1].summary.number
    for segment, found in part:
        if found.summary is None:
            problems.append(f"the summary of {segment.name} is damaged")
        for frame in found.records:
            if frame.number > done:
                follow(contents, segment, frame)
        holes += holes_of(found)
    epoch = segments[-1].head.epoch
    if epoch > contents.standing.epoch:
        contents.standing = BoxEpoch(epoch, cut=segments[-1].head.first - 1)
    newest = part[-1][1]
    torn = (f"the end of {segments[-1].name} is torn or damaged: what happened after record {newest.last}, "
            f"{utc_text(contents.utc)}, may be missing") if newest.torn else ""
    return Opened(segments, newest, contents, problems, holes, torn, len(segments) - len(part))


def follow(contents: Contents, segment: Segment, frame: Frame) -> None:
    """Take the next record of a segment."""
    contents.take(top_of(frame.payload), functools.partial(line_of, frame.payload))
    contents.place(frame.payload, segment.name.number, frame.at)


def frames_of(content: bytes, salt: int, identity: str) -> Iterator[Frame]:
    """Return the intact records of a segment that belong to a run, also those that do not count."""
    searched = b"\t" + identity.encode("utf-8") + b"\t"
    for frame in frames(content, salt):
        if not frame.is_summary and searched in frame.payload[:frame.payload.find(b"\n")]:
            yield frame


def holes_of(found: Scan) -> List[str]:
    """Return the damaged and missing records of a segment in words, with their period."""
    times = {frame.number: top_of(frame.payload).utc for frame in found.records} if found.holes else {}
    return [hole_text(hole, times.get(hole.first - 1), times.get(hole.last + 1)) for hole in found.holes]


def hole_text(hole: Hole, begin: Optional[float], end: Optional[float]) -> str:
    """Describe records that are damaged or missing. `begin`, `end`: UTC seconds of their neighbours; None: unknown."""
    which = f"record {hole.first}" if hole.first == hole.last else f"records {hole.first} to {hole.last}"
    first = "the beginning" if hole.first == 1 else "the end of the segment before"
    return (f"{which} damaged or missing, between {first if begin is None else utc_text(begin)} and "
            f"{'the end' if end is None else utc_text(end)}")


def utc_text(utc: float) -> str:
    """Return a time of day for a line of text."""
    return time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(utc))
