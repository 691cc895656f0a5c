"""Lists for the terminal: all runs, their bags, and the organisers' checklist before publication."""

import os
from types import MappingProxyType
from typing import Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.runs import run_state_text, signature_of, taken_text
from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan
from roah_rsbb.scoring.counting import AttemptsKey, Ruling, Why, attempts_key, by_attempts, result_of
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING, date_time


def aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Return rows as lines with aligned columns."""
    template = "  ".join(f"{{:<{max(map(len, column))}}}" for column in zip(*rows))
    for row in rows:
        yield template.format(*row).rstrip()


def list_lines(
    records: Sequence[RunRecord], in_utc: bool, counts: Mapping[str, str] = MappingProxyType({})
) -> Iterator[str]:
    """List all runs, one per line, below a line of headings. `counts`: whether they count (`RunResult.counts`), by
    identity."""
    rows = [("No.", "Connected", "Zone", "Benchmark", "Team", "Round", "Run", "Time", "Sheet", "State")]
    rows += [_row(number, record, in_utc, counts.get(record.identity, "")) for number, record in enumerate(records, 1)]
    return aligned(rows)


def _row(number: int, record: RunRecord, in_utc: bool, counts: str) -> Tuple[str, ...]:
    return (
        str(number), date_time(record.opened_utc, in_utc), one_line(record.zone), one_line(record.benchmark),
        one_line(record.team), str(record.round), str(record.run), taken_text(record),
        sheets.sheet_state(record.closed_utc, record.sign_off), one_line(run_state_text(record, counts)),
    )


# -- bags -------------------------------------------------------------------------------------------


def bag_lines(reader: JournalReader) -> Iterator[str]:
    """Return a line for each robot in a run. A bag is where the journal says, or in the folder of the journal."""
    numbers = {identity: number for number, identity in enumerate(reader.identities(), 1)}
    rows: List[Tuple[str, ...]] = [("No.", "Run", "Port", "Robot", "Size", "Bag")]
    found = 0
    members = [(numbers.get(member.identity, 0), member) for member in reader.all_members()]
    for number, member in sorted(members):
        path = _bag_at(member.log_file, os.path.dirname(reader.path))
        found += bool(path)
        size = (f"{os.path.getsize(path) / 1e6:.1f} MB" if path else NOTHING if not member.log_file else
                "missing" if reader.is_over(member.identity) else "not over")
        rows.append((str(number), one_line(member.identity), str(member.port),
                     one_line(f"{member.robot} of team {member.team}"), size, one_line(path or member.log_file)))
    yield from aligned(rows)
    missing = len(members) - found
    yield f"{found} of {len(members)} bags found" + (
        "; results bags --make makes those of runs that are over, results bag RUN FILE any of them" if missing else "")


def _bag_at(log_file: str, folder: str) -> str:
    """Return the path of a bag that exists; empty: none."""
    beside = os.path.join(folder, os.path.basename(log_file))
    return next((path for path in (log_file, beside) if log_file and os.path.isfile(path)), "")


# -- the checklist ----------------------------------------------------------------------------------

NO_RUN = "no run"


class CheckLine(NamedTuple):
    """An event, or a run that is not in the schedule."""

    zone: str
    name: str
    scheduled: float  # UTC seconds
    number: Optional[int]  # of its run in the list of all runs; None: no run was started
    state: str
    sheet: str
    is_final: bool  # it has a result that is signed off


class _Found(NamedTuple):
    """A run that stands for an event, and whether the event's result is final."""

    ruling: Ruling
    is_final: bool


def checklist(plans: Sequence[ZonePlan], ruled: Sequence[Ruling], in_utc: bool) -> List[CheckLine]:
    """Return a line for each event, in the order of the scheduled times. It has the run that counts; of several, one
    that is not signed off. Runs follow of events that the schedule does not have, or has for another team or benchmark.

    `ruled`: which of the runs count, in the order of connecting.
    """
    numbers = {ruling.record.identity: number for number, ruling in enumerate(ruled, 1)}
    events = sorted(((event.scheduled, plan.name, event) for plan in plans for event in plan.events),
                    key=lambda line: line[:2])
    found = _found(ruled)
    lines = []
    for _, zone, event in events:
        run = found.pop((event.benchmark.code, event.team, event.id), None)
        lines.append(_line(zone, event, run, numbers, in_utc))
    return lines + [_line(run.ruling.record.zone, None, run, numbers, in_utc) for run in found.values()]


def _found(ruled: Sequence[Ruling]) -> Dict[AttemptsKey, _Found]:
    """Return the run that stands for the attempts of each team at each event."""
    found: Dict[AttemptsKey, _Found] = {}
    for ruling in ruled:  # first the runs that are not over
        if ruling.why is Why.NOT_OVER and ruling.record.started_utc:
            found[attempts_key(ruling.record)] = _Found(ruling, False)
    for result in filter(None, map(result_of, by_attempts(ruled))):
        unsigned = [ruling for ruling in result.runs if ruling.record.sign_off is None]
        found[attempts_key(result.shown.record)] = _Found((unsigned or [result.shown])[-1], result.signed)
    return found


def _line(
    zone: str, event: Optional[ScheduledEvent], run: Optional[_Found], numbers: Dict[str, int], in_utc: bool
) -> CheckLine:
    """`event`: None if the schedule does not have that of the run."""
    if run is None:
        return CheckLine(zone, _name(event), event.scheduled, None, NO_RUN, "", False)
    record = run.ruling.record
    sheet = signature_of(record, in_utc) if record.closed_utc else sheets.OPEN
    name, scheduled = (_name(event), event.scheduled) if event is not None else (
        sheets.run_name(record.benchmark, record.team, record.round, record.run), record.scheduled)
    if record.open_objections:
        sheet = f"{sheet}; objections to answer: {record.open_objections}"
    return CheckLine(zone, name, scheduled, numbers[record.identity], run_state_text(record, run.ruling.why.value),
                     sheet, run.is_final and not record.open_objections)


def _name(event: ScheduledEvent) -> str:
    return sheets.run_name(event.benchmark.code, event.team, event.round, event.run)


def check_lines(lines: Sequence[CheckLine], in_utc: bool, only_missing: bool = False) -> Iterator[str]:
    """Return the lines for the terminal, of all events or of those without a final result, which are marked. The last
    line counts all events."""
    shown = [line for line in lines if not (only_missing and line.is_final)]
    rows = [("", "Scheduled", "Zone", "Event", "Run", "State", "Sheet")]
    rows += [
        ("✔" if line.is_final else "✘", date_time(line.scheduled, in_utc), one_line(line.zone), one_line(line.name),
         "" if line.number is None else str(line.number), one_line(line.state), one_line(line.sheet))
        for line in shown
    ]
    yield from aligned(rows)
    yield (f"{len(shown)} of {len(lines)} listed; " if only_missing else "") + summary(lines)


def summary(lines: Sequence[CheckLine]) -> str:
    """Return how many events have a final result, and what the others lack."""
    final = sum(line.is_final for line in lines)
    unsigned = sum(line.number is not None and not line.is_final for line in lines)
    without = sum(line.number is None for line in lines)
    return f"{final} of {len(lines)} signed off, {unsigned} not signed off, {without} without a run"
