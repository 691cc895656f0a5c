"""The organisers' list before publication: whether the result of each event is signed off, or what is missing."""

from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence

from roah_rsbb.results.runs import run_state_text, signature_of
from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan
from roah_rsbb.scoring.counting import AttemptsKey, Ruling, Why, attempts_key, event_results
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import date_time

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
    for result in event_results(ruled):
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
    return CheckLine(zone, name, scheduled, numbers[record.identity], run_state_text(record, run.ruling.why.value),
                     sheet, run.is_final)


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
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    yield (f"{len(shown)} of {len(lines)} listed; " if only_missing else "") + summary(lines)


def summary(lines: Sequence[CheckLine]) -> str:
    """Return how many events have a final result, and what the others lack."""
    final = sum(line.is_final for line in lines)
    unsigned = sum(line.number is not None and not line.is_final for line in lines)
    without = sum(line.number is None for line in lines)
    return f"{final} of {len(lines)} signed off, {unsigned} not signed off, {without} without a run"
