"""The organisers' list before publication: whether the result of each event is signed off, or what is missing."""

from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.results.runs import run_state_text, signature_of
from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import date_time

NO_RUN = "no run"

_Key = Tuple[str, str, str, int, int, float]


class CheckLine(NamedTuple):
    """An event, or a run that is not in the schedule."""

    zone: str
    name: str
    scheduled: float  # UTC seconds
    number: Optional[int]  # of its last run in the list of all runs; None: no run was started
    state: str
    sheet: str
    is_final: bool  # it has a result that is signed off


def checklist(plans: Sequence[ZonePlan], records: Sequence[RunRecord], in_utc: bool) -> List[CheckLine]:
    """Return a line for each event, in the order of the scheduled times. Of an event that was repeated, the last run
    counts. An event whose time was changed since its run keeps that run. Runs that the schedule does not have follow.
    """
    last: Dict[_Key, Tuple[int, RunRecord]] = {}
    for number, record in enumerate(records, 1):
        if record.started_utc or record.end_reason:
            key = (record.zone, record.benchmark, record.team, record.round, record.run, record.scheduled)
            last[key] = (number, record)
    events = sorted(((event.scheduled, plan.name, event) for plan in plans for event in plan.events),
                    key=lambda line: line[:2])
    exact = {_key_of(zone, event) for _, zone, event in events}
    moved = {key[:-1]: key for key in last if key not in exact}
    lines = []
    for _, zone, event in events:
        key = _key_of(zone, event)
        run = last.pop(key, None)
        if run is None and key[:-1] in moved:
            run = last.pop(moved.pop(key[:-1]))
        lines.append(_of_event(zone, event, run, in_utc))
    return lines + [_of_run(number, record, in_utc) for number, record in last.values()]


def _key_of(zone: str, event: ScheduledEvent) -> _Key:
    return (zone, event.benchmark.code, event.team, event.round, event.run, event.scheduled)


def _of_event(zone: str, event: ScheduledEvent, run: Optional[Tuple[int, RunRecord]], in_utc: bool) -> CheckLine:
    if run is not None:
        return _of_run(*run, in_utc)
    name = sheets.run_name(event.benchmark.code, event.team, event.round, event.run)
    return CheckLine(zone, name, event.scheduled, None, NO_RUN, "", False)


def _of_run(number: int, record: RunRecord, in_utc: bool) -> CheckLine:
    name = sheets.run_name(record.benchmark, record.team, record.round, record.run)
    sheet = signature_of(record, in_utc) if record.closed_utc else sheets.OPEN
    return CheckLine(
        record.zone, name, record.scheduled, number, run_state_text(record), sheet, record.sign_off is not None
    )


def check_lines(lines: Sequence[CheckLine], in_utc: bool) -> Iterator[str]:
    """Return the lines for the terminal. What is missing is marked."""
    rows = [("", "Scheduled", "Zone", "Event", "Run", "State", "Sheet")]
    rows += [
        ("✔" if line.is_final else "✘", date_time(line.scheduled, in_utc), one_line(line.zone), one_line(line.name),
         "" if line.number is None else str(line.number), one_line(line.state), one_line(line.sheet))
        for line in lines
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    yield summary(lines)


def summary(lines: Sequence[CheckLine]) -> str:
    """Return how many events have a final result, and what the others lack."""
    final = sum(line.is_final for line in lines)
    unsigned = sum(line.number is not None and not line.is_final for line in lines)
    without = sum(line.number is None for line in lines)
    return f"{final} of {len(lines)} signed off, {unsigned} not signed off, {without} without a run"
