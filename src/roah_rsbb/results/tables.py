"""Results for spreadsheets: CSV, one row for each scoring item and each value of a benchmarking module.

A cell that begins like a formula and came from somebody (a robot's name, a referee's note) gets an apostrophe in
front: spreadsheet programs would carry it out. Numbers are left as they are.
"""

import csv
import json
from typing import Dict, Iterable, Iterator, List, Optional, TextIO, Tuple, Union

from roah_rsbb.core.scoring.records import RunRecord, ScoreEntry
from roah_rsbb.results.standing import Standing
from roah_rsbb.wording import result_texts
from roah_rsbb.wording.result_texts import iso, visible

Cell = Union[str, int, float, None]

# What a spreadsheet program takes for the beginning of a formula.
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "|", "%", "＝", "＋", "－", "＠")

# Of each run.
_RUN_COLUMNS = (
    "run_id", "zone", "benchmark", "team", "round", "run", "robots", "scheduled", "connected", "started",
    "disconnected", "end_reason", "elapsed_s", "signed_off", "signed_off_by",
)
# Of each row.
_ROW_COLUMNS = (
    "kind", "group", "name", "value", "unit", "not_attempted", "corrected", "changed", "changed_by", "note",
)
RESULT_COLUMNS = _RUN_COLUMNS + _ROW_COLUMNS

STANDING_COLUMNS = (
    "benchmark", "of_runs", "rank", "tied", "team", "disqualified", "criterion", "better", "number", "runs", "run_ids",
)


def safe(cell: Cell) -> Union[str, int, float]:
    """A cell as it may stand in a spreadsheet."""
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if not isinstance(cell, str):
        return cell
    text = visible(cell)
    return f"'{text}" if text.lstrip(" ").startswith(_FORMULA) else text


def write_table(file: TextIO, columns: Tuple[str, ...], rows: Iterable[Dict[str, Cell]]) -> None:
    """Write rows under a line of their columns' names; what a row lacks is empty."""
    writer = csv.writer(file)
    writer.writerow(columns)
    for row in rows:
        writer.writerow([safe(row.get(column)) for column in columns])


def result_rows(records: Iterable[RunRecord], in_utc: bool) -> Iterator[Dict[str, Cell]]:
    """All rows of all runs; a run with neither items nor values has one of kind "none"."""
    for record in records:
        of_run = _of_run(record, in_utc)
        rows = [*_item_rows(record, in_utc), *_module_rows(record)]
        for row in rows or [{"kind": "none"}]:
            yield {**of_run, **row}


def _of_run(record: RunRecord, in_utc: bool) -> Dict[str, Cell]:
    def at(utc: float) -> Optional[str]:
        return iso(utc, in_utc) if utc else None

    sign_off = record.sign_off
    return dict(zip(_RUN_COLUMNS, (
        record.identity, record.zone, record.benchmark, record.team, record.round, record.run,
        ", ".join(record.robots), at(record.scheduled), at(record.opened_utc), at(record.started_utc),
        at(record.closed_utc), record.end_reason, round(record.elapsed_s, 3) if record.started_utc else None,
        at(sign_off.utc) if sign_off else None, sign_off.who if sign_off else None,
    )))


def _item_rows(record: RunRecord, in_utc: bool) -> Iterator[Dict[str, Cell]]:
    last: Dict[Tuple[str, str], ScoreEntry] = {}
    for entry in record.history:
        if not entry.withdrawn_utc:
            last[entry.group, entry.desc] = entry
    for item in record.items:
        entry = last.get((item.group, item.desc))
        row: Dict[str, Cell] = {
            "kind": "item", "group": item.group, "name": item.desc, "value": item.value,
            "not_attempted": item.not_attempted, "corrected": item.corrected,
        }
        if entry is not None:
            row.update(changed=iso(entry.utc, in_utc), changed_by=entry.who, note=entry.note)
        yield row


def _module_rows(record: RunRecord) -> Iterator[Dict[str, Cell]]:
    for score in record.module_scores:
        yield {
            "kind": "module", "group": score.group, "name": score.name, "value": _module_cell(score.value),
            "unit": score.unit, "note": score.desc,
        }


def _module_cell(text: str) -> Cell:
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return value if value is None or isinstance(value, (bool, int, float, str)) else result_texts.plain(value)


def standing_rows(standings: Iterable[Standing]) -> Iterator[Dict[str, Cell]]:
    """One row for each benchmark, team and criterion."""
    for standing in standings:
        for team in standing.lines:
            identities: List[str] = [run.record.identity for run in team.runs]
            for criterion, number in zip(standing.criteria, team.numbers):
                yield dict(zip(STANDING_COLUMNS, (
                    standing.benchmark, standing.of_runs.value, team.rank, team.tied, team.team, team.disqualified,
                    criterion.name, "more" if criterion.more_is_better else "less", number, len(identities),
                    " ".join(identities),
                )))
