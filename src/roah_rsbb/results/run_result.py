"""A run with all that the journal holds of it."""

from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.link.record import LinkSample
from roah_rsbb.core.restart.saved import BadState, thaw
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal.reader import JournalEntry, JournalReader, JournalRun


class LinkSecond(NamedTuple):
    """One sample of a link, and when it was taken."""

    utc: float  # UTC seconds
    sample: LinkSample


class RobotPart(NamedTuple):
    """A robot's part in a run."""

    port: int
    team: str
    robot: str
    log_file: str  # path of the run log, where the box was
    link: Tuple[LinkSecond, ...]


class RunResult(NamedTuple):
    """A run."""

    number: int  # in the order of connecting, from 1
    record: RunRecord
    robots: Tuple[RobotPart, ...]
    entries: Tuple[JournalEntry, ...]  # all that happened, in order

    def robot_at(self, port: Optional[int]) -> str:
        """The name of the robot with this port, where the run has several; else nothing needs to be said."""
        if len(self.robots) < 2:
            return ""
        return next((f"{r.robot} of team {r.team}" for r in self.robots if r.port == port), "")


class NoSuchRun(Exception):
    """There is no such run; the text says which there are."""


def records(reader: JournalReader, warn: Callable[[str], None]) -> List[RunRecord]:
    """The records of all runs, in the order of connecting; `warn` is told what cannot be read."""
    return [_record(run, warn) for run in reader.runs()]


def run_result(reader: JournalReader, number: int, record: RunRecord, warn: Callable[[str], None]) -> RunResult:
    """All of a run."""
    robots = tuple(
        RobotPart(m.port, m.team, m.robot, m.log_file, _link(reader, m.port, warn))
        for m in reader.members(record.identity)
    )
    return RunResult(number, record, robots, tuple(reader.entries(record.identity)))


def find(known: List[RunRecord], word: str) -> int:
    """The place in the list of the run that is meant: by its number (from 1), its identity, or the beginning of
    that. Raises `NoSuchRun`."""
    by_identity: Dict[str, int] = {record.identity: i for i, record in enumerate(known)}
    if word in by_identity:
        return by_identity[word]
    if word.isdecimal() and 1 <= int(word) <= len(known):
        return int(word) - 1
    begin = [i for identity, i in by_identity.items() if identity.startswith(word)] if word else []
    if len(begin) == 1:
        return begin[0]
    if begin:
        names = ", ".join(known[i].identity for i in begin[:5])
        raise NoSuchRun(f"'{word}' may be any of {len(begin)} runs ({names} …): name one of them")
    numbers = f"there are 1 to {len(known)}" if known else "there are none yet"
    raise NoSuchRun(f"there is no run '{word}': {numbers}; 'results list' shows all runs with their names")


def _record(run: JournalRun, warn: Callable[[str], None]) -> RunRecord:
    if run.outcome:
        try:
            return thaw(RunRecord, run.outcome)
        except BadState as error:
            warn(f"the record of run {run.identity} cannot be read ({error}): only what its row says is shown")
    return RunRecord(*run[:8], closed_utc=run.closed_utc or 0.0)


def _link(reader: JournalReader, port: int, warn: Callable[[str], None]) -> Tuple[LinkSecond, ...]:
    try:
        return tuple(LinkSecond(link.utc, thaw(LinkSample, link.sample)) for link in reader.links(port))
    except BadState as error:
        warn(f"the link record of port {port} cannot be read ({error}): it is left out")
        return ()
