"""A run with everything that the journal recorded about it."""

import re
from functools import partial
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal.reader import JournalEntry, JournalReader, JournalRun
from roah_rsbb.journal.records import ChangesReader
from roah_rsbb.model import run_log
from roah_rsbb.model.as_json import BadData, from_json
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import ItemRecord, RunRecord, Settlement, submitted
from roah_rsbb.wording import sheets
from roah_rsbb.wording.sheets import with_counting
from roah_rsbb.wording.times import NOTHING, clock_time, date_time, elapsed


class LinkSecond(NamedTuple):
    """One sample of a robot's link, and when it was taken."""

    utc: float  # UTC seconds
    sample: LinkSample
    mono: float = 0.0  # seconds on the monotonic clock


class RobotPart(NamedTuple):
    """A robot that took part in a run."""

    port: int
    team: str
    robot: str
    log_file: str  # path of the run log on the box's computer
    link: Tuple[LinkSecond, ...]


class RunResult(NamedTuple):
    """A run as the journal holds it."""

    number: int  # in the order of connecting, from 1
    record: RunRecord
    robots: Tuple[RobotPart, ...]
    entries: Tuple[JournalEntry, ...]  # in order
    counts: str = ""  # whether it counts: a word of `wording.sheets`; empty: nobody asked

    def robot_at(self, port: Optional[int]) -> str:
        """The name of the robot with this port; empty if the run has only one robot."""
        if len(self.robots) < 2:
            return ""
        return next((f"{r.robot} of team {r.team}" for r in self.robots if r.port == port), "")


class RunMoment(NamedTuple):
    """The state of a run after an event, as a restarted core reads it."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of that start of the core
    zone: Dict[str, Any]  # JSON of the core's ZoneState
    clock: Dict[str, Any]  # the times of the run, in seconds; limits that do not exist are missing
    session: int = 0  # number of that start


def run_state_of(moment: RunMoment) -> Dict[str, Any]:
    """Return the state of the run as a whole."""
    zone = moment.zone
    found = zone.get("run") or zone.get("all_robots") or zone.get("by_hand")
    return found if isinstance(found, dict) else {}


class NotPossible(Exception):
    """What was asked for is not possible. The text names the remedy."""


def records(reader: JournalReader, warn: Callable[[str], None]) -> List[RunRecord]:
    """Return the records of all runs in the order of connecting. `warn` is called with what cannot be read."""
    return [_record(run, warn) for run in reader.runs()]


def find_record(reader: JournalReader, word: str, warn: Callable[[str], None]) -> Tuple[int, RunRecord]:
    """Return the number and the record of the run that `find` finds. Raises `NotPossible`."""
    known = reader.identities()
    place = find(known, word)
    return place + 1, _record(reader.run(known[place]), warn)


def run_result(
    reader: JournalReader, number: int, record: RunRecord, warn: Callable[[str], None]
) -> RunResult:
    """Read the rest of a run whose record is known."""
    robots = tuple(
        RobotPart(m.port, m.team, m.robot, m.log_file, _link(reader, m.port, warn))
        for m in reader.members(record.identity)
    )
    return RunResult(number, record, robots, tuple(reader.entries(record.identity)))


def run_moments(reader: JournalReader, identity: str, warn: Callable[[str], None]) -> List[RunMoment]:
    """Return all states of a run, in order. They share what did not change. Journals before 2026-11 have none."""
    changes, found, unreadable = ChangesReader(), [], 0
    for entry in reader.states(identity):
        state = changes.take(entry.value)
        try:
            found.append(RunMoment(entry.utc, entry.mono, state["zone"], state["clock"], entry.session))
        except (TypeError, KeyError):
            unreadable += 1
    if unreadable:
        warn(f"{unreadable} states of run {identity} cannot be read: its replay has gaps")
    return found


def file_name(number: int, record: RunRecord) -> str:
    """Return the name of the files about a run, without a suffix. `number`: in the list of all runs."""
    words = (f"{number:03d}", record.benchmark, record.team, f"round{record.round}", f"run{record.run}")
    return "_".join(re.sub(r"[^A-Za-z0-9-]", "-", word)[:60] for word in words)


def find(known: Sequence[str], word: str) -> int:
    """Return the index of the run with this number (from 1), identity, or unique prefix of an identity. `known`: the
    identities of all runs, in order. Raises `NotPossible`.
    """
    by_identity: Dict[str, int] = {identity: i for i, identity in enumerate(known)}
    if word in by_identity:
        return by_identity[word]
    if word.isdecimal() and 1 <= int(word) <= len(known):
        return int(word) - 1
    begin = [i for identity, i in by_identity.items() if identity.startswith(word)] if word else []
    if len(begin) == 1:
        return begin[0]
    if begin:
        names = ", ".join(known[i] for i in begin[:5])
        raise NotPossible(f"'{word}' matches {len(begin)} runs ({names} …): be more specific")
    numbers = f"there are 1 to {len(known)}" if known else "there are no runs yet"
    raise NotPossible(f"there is no run '{word}': {numbers}. 'results list' lists them")


def taken_s(record: RunRecord) -> Optional[float]:
    """Return the counted seconds that a run took. None: it was never started, or is in progress. The journal has the
    time of its last entry then, and only the box knows the time now."""
    return record.elapsed_s if record.started_utc and record.end_reason else None


def taken_text(record: RunRecord) -> str:
    """Return the time that a run took; `NOTHING`: see `taken_s`."""
    seconds = taken_s(record)
    return NOTHING if seconds is None else elapsed(seconds)


def run_state_text(record: RunRecord, counts: str = "") -> str:
    """Return how a run ended, or how far it is. `counts`: whether it counts, see `RunResult`."""
    return with_counting(sheets.run_state(record.started_utc, record.closed_utc, record.end_reason), counts)


def signature_of(record: RunRecord, in_utc: bool) -> str:
    """Return who signed a run's sheet off, and when."""
    signed = record.sign_off
    return sheets.signature(signed and signed.utc, signed.who if signed else "", partial(date_time, in_utc=in_utc),
                            len(record.versions))


def _record(run: JournalRun, warn: Callable[[str], None]) -> RunRecord:
    if run.outcome:
        try:
            return from_json(RunRecord, run.outcome)
        except BadData as error:
            warn(_unreadable(run.identity, error))
    return RunRecord(*run[:8], closed_utc=run.closed_utc or 0.0)


def _unreadable(identity: str, error: Exception) -> str:
    return f"the record of run {identity} cannot be read ({error}): only its basic data is shown"


def _link(reader: JournalReader, port: int, warn: Callable[[str], None]) -> Tuple[LinkSecond, ...]:
    try:
        return tuple(LinkSecond(link.utc, from_json(LinkSample, link.sample), link.mono) for link in reader.links(port))
    except BadData as error:
        warn(f"the link record of port {port} cannot be read ({error}): it is omitted")
        return ()


# -- a clock that was set ---------------------------------------------------------------------------

# A smaller step of the clock (s) is not noticed: NTP corrects about as much in a long run.
_SET_S = 2.0


def clock_text(result: RunResult) -> str:
    """Return that somebody set the box's clock during a run, and by how much; empty: nobody did."""
    step_s = _offsets(result)[1]
    if abs(step_s) <= _SET_S:
        return ""
    return f"The box's clock was set by {step_s:+.0f} s during the run"


def without_step(result: RunResult, moments: Sequence[RunMoment] = ()) -> Tuple[RunResult, List[RunMoment]]:
    """Return a run with the times as if nobody had set the clock: they rise, and durations are right."""
    offsets, step_s = _offsets(result)

    def steady(session: int, mono: float, utc: float) -> float:
        return mono + offsets[session] if session in offsets else utc - step_s

    def steady_link(mono: float, utc: float) -> float:  # its start of the core is not known
        return min((mono + offset for offset in offsets.values()),
                   key=lambda at: min(abs(at - utc), abs(at - utc + step_s)))

    record = result.record
    return result._replace(
        record=record._replace(closed_utc=record.closed_utc and record.closed_utc - step_s),
        entries=tuple(e._replace(utc=steady(e.session, e.mono, e.utc)) for e in result.entries),
        robots=tuple(robot._replace(link=tuple(
            second._replace(utc=steady_link(second.mono, second.utc)) for second in robot.link))
            for robot in result.robots),
    ), [moment._replace(utc=steady(moment.session, moment.mono, moment.utc)) for moment in moments]


def _offsets(result: RunResult) -> Tuple[Dict[int, float], float]:
    """Return what to add to the monotonic clock of each start of the core, for the UTC as if nobody had set the clock
    during the run; and by how much somebody has, in total, until its end."""
    offsets: Dict[int, float] = {}
    step_s = 0.0
    for entry in result.entries:
        if entry.session not in offsets:
            offsets[entry.session] = entry.utc - step_s - entry.mono
        step_s = entry.utc - (entry.mono + offsets[entry.session])
        if entry.kind == run_log.END:
            break  # what follows are corrections, perhaps of another day
    return offsets, step_s


# -- judges and objections --------------------------------------------------------------------------


class ItemProposals(NamedTuple):
    """An item with what each judge submitted."""

    item: ItemRecord  # as it counts
    proposals: Tuple[str, ...]  # in the order of the judges
    settlement: Optional[Settlement]  # the one that counts; None: the judges agreed, or nobody settled it


def judged_items(record: RunRecord) -> Iterator[ItemProposals]:
    """Return the items of a run with what its judges submitted; none if it has no judges."""
    judges = submitted(record)
    settled = {(s.group, s.desc): s for s in record.judging.settlements}
    if not judges and not settled:
        return
    for item in record.items:
        values = {one.judge: sheets.proposal(each) for one in judges for each in one.items if each.key == item.key}
        settlement = settled.get(item.key)
        counts = settlement is not None and settlement.proposals == tuple(sorted(values.items()))
        yield ItemProposals(item, tuple(values.get(s.judge, "") for s in judges), settlement if counts else None)


def act_lines(record: RunRecord) -> List[Tuple[float, str, str]]:
    """Return what was done with the judges' sheets: UTC seconds, who, what."""
    return [
        (act.utc, act.who, act.act + (f" the sheet of {act.judge}" if act.judge and act.judge != act.who else "")
         + (f": {act.reason}" if act.reason else ""))
        for act in record.judging.acts
    ]


def objection_lines(record: RunRecord) -> List[Tuple[float, str, str]]:
    """Return the publication of a result, the objections and their answers: UTC seconds, who, what."""
    published, lines = record.publication.published, []
    if published is not None:
        seconds = round(published.until_utc - published.utc)
        given = f"{seconds} s" if seconds % 60 else f"{seconds // 60} min"
        lines.append((published.utc, published.who, f"Published as provisional, {given} for objections"))
    for one in record.publication.objections:
        at = f" (at {clock_time(one.second)})" if one.second else ""
        lines.append((one.utc, one.who, f"Objection {one.number} of {one.by}{at}: {one.text}"))
        if one.answered_utc:
            answer = f"Objection {one.number} {'upheld' if one.upheld else 'rejected'}: {one.answer}"
            lines.append((one.answered_utc, one.answered_by, answer))
    return sorted(lines, key=lambda line: line[0])
