"""The list of all runs, for the terminal. It loads little, because a list of thousands of runs shall appear at once."""

from typing import Iterator, Sequence, Tuple, Union

from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.results.runs import RunHead, run_state_text
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line as line
from roah_rsbb.wording.times import NOTHING, date_time, elapsed


def list_lines(records: Sequence[Union[RunHead, RunRecord]], in_utc: bool) -> Iterator[str]:
    """List all runs, one per line, below a line of headings."""
    rows = [("No.", "Connected", "Zone", "Benchmark", "Team", "Round", "Run", "Time", "Sheet", "State")]
    rows += [_row(number, record, in_utc) for number, record in enumerate(records, 1)]
    template = "  ".join(f"{{:<{max(map(len, column))}}}" for column in zip(*rows))
    for row in rows:
        yield template.format(*row).rstrip()


def _row(number: int, record: Union[RunHead, RunRecord], in_utc: bool) -> Tuple[str, ...]:
    return (
        str(number), date_time(record.opened_utc, in_utc), line(record.zone), line(record.benchmark), line(record.team),
        str(record.round), str(record.run),
        elapsed(record.elapsed_s) if record.started_utc else NOTHING,
        sheets.sheet_state(record.closed_utc, record.sign_off), line(run_state_text(record)),
    )
