"""The list of all runs, for the terminal. It loads little, because a list of thousands of runs shall appear at once."""

from types import MappingProxyType
from typing import Iterator, Mapping, Sequence, Tuple, Union

from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.runs import RunHead, run_state_text, taken_text
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line as line
from roah_rsbb.wording.times import date_time


def list_lines(
    records: Sequence[Union[RunHead, RunRecord]], in_utc: bool, counts: Mapping[str, str] = MappingProxyType({})
) -> Iterator[str]:
    """List all runs, one per line, below a line of headings. `counts`: whether they
    count (`RunResult.counts`), by identity."""
    rows = [("No.", "Connected", "Zone", "Benchmark", "Team", "Round", "Run", "Time", "Sheet", "State")]
    rows += [_row(number, record, in_utc, counts.get(record.identity, "")) for number, record in enumerate(records, 1)]
    template = "  ".join(f"{{:<{max(map(len, column))}}}" for column in zip(*rows))
    for row in rows:
        yield template.format(*row).rstrip()


def _row(number: int, record: Union[RunHead, RunRecord], in_utc: bool, counts: str) -> Tuple[str, ...]:
    return (
        str(number), date_time(record.opened_utc, in_utc), line(record.zone), line(record.benchmark), line(record.team),
        str(record.round), str(record.run),
        taken_text(record),
        sheets.sheet_state(record.closed_utc, record.sign_off), line(run_state_text(record, counts)),
    )
