"""Exports results for spreadsheets (CSV), programs (JSON) and ROS 2 (MCAP); docs/results.md has the formats.

The CSV has one row for each scoring item and each value of a benchmarking module. Texts come from robots and
referees; a spreadsheet program would run those that look like formulas.
"""

import contextlib
import csv
import dataclasses
import io
import itertools
import json
import os
import struct
from fractions import Fraction
from types import MappingProxyType
from typing import (
    Any,
    BinaryIO,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    TextIO,
    Tuple,
    Union,
)

from roah_rsbb.ground.durable import USUAL, write_file
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.records import ItemRecord, RunRecord, ScoreEntry, ratings
from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.results.runs import NotPossible, RobotPart, RunResult, file_name, run_state_text, taken_s
from roah_rsbb.scoring.counting import Why
from roah_rsbb.scoring.standings import Standing
from roah_rsbb.wording.sheets import person, ratings_text
from roah_rsbb.wording.texts import value_text, visible
from roah_rsbb.wording.times import iso

Ratings = Tuple[Tuple[str, str], ...]  # judges, and what each gave: a decimal number
Cell = Union[str, int, float, None, Ratings]

# A text that begins with one of these is a formula for a spreadsheet program.
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "|", "%", "＝", "＋", "－", "＠")

# Columns about the run.
RUN_COLUMNS = (
    "run_id", "zone", "benchmark", "team", "round", "run", "robots", "scheduled", "connected", "started",
    "disconnected", "end_reason", "elapsed_s", "signed_off", "signed_off_by", "counts",
)
# Columns about the item or value.
SCORE_COLUMNS = (
    "kind", "group", "name", "value", "unit", "not_attempted", "corrected", "changed", "changed_by", "note", "points",
    "ratings",
)
RESULT_COLUMNS = RUN_COLUMNS + SCORE_COLUMNS

STANDING_COLUMNS = (
    "benchmark", "of_runs", "rank", "tied", "team", "disqualified", "criterion", "better", "number", "runs", "run_ids",
    "title", "unit",
)


def safe(cell: Cell) -> Union[str, int, float]:
    """Make a value safe for a spreadsheet: text that looks like a formula gets an apostrophe in front.

    Text that begins with an apostrophe gets a second one. So the first apostrophe of a cell is never part of the text.
    """
    if cell is None:
        return ""
    if isinstance(cell, tuple):
        cell = ratings_text(cell)
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if not isinstance(cell, str):
        return cell
    text = visible(cell)
    return f"'{text}" if text.lstrip(" ").startswith(_FORMULA) or text.startswith("'") else text


def write_table(
    file: TextIO, columns: Tuple[str, ...], rows: Iterable[Dict[str, Cell]], decimal_comma: bool = False
) -> None:
    """Write a header line and rows. Missing cells are empty. `decimal_comma`: for spreadsheet programs of regions that
    write 1,5 and separate cells with semicolons."""
    write_rows(file, columns, itertools.chain([dict(zip(columns, columns))], rows), decimal_comma)


def write_rows(
    file: TextIO, columns: Tuple[str, ...], rows: Iterable[Dict[str, Cell]], decimal_comma: bool = False
) -> None:
    """Write rows below a header line."""
    writer = csv.writer(file, delimiter=";" if decimal_comma else ",")
    for row in rows:
        writer.writerow([safe(_with_comma(row.get(column)) if decimal_comma else row.get(column))
                         for column in columns])


def _with_comma(cell: Cell) -> Cell:
    """Return the text of a cell that has decimal numbers, with decimal commas; any other cell stays."""
    if isinstance(cell, tuple):
        return "; ".join(f"{judge} {text.replace('.', ',')}" for judge, text in cell if text)
    return str(cell).replace(".", ",") if isinstance(cell, float) else cell


def result_rows(
    records: Iterable[RunRecord], in_utc: bool, why: Mapping[str, Why] = MappingProxyType({})
) -> Iterator[Dict[str, Cell]]:
    """Return the rows of all runs. A run without items and values has one row of kind "none". `why`: whether runs
    count, by their identities."""
    for record in records:
        of_run = run_row(record, in_utc, why[record.identity].value if record.identity in why else "")
        for row in list(score_rows(record, in_utc)) or [{"kind": "none"}]:
            yield {**of_run, **row}


def score_rows(record: RunRecord, in_utc: bool) -> Iterator[Dict[str, Cell]]:
    """Return the rows of a run, without the columns about the run."""
    yield from _item_rows(record, in_utc)
    yield from _points_rows(record)
    yield from _phase_rows(record)
    yield from _module_rows(record)


def run_row(record: RunRecord, in_utc: bool, counts: str = "") -> Dict[str, Cell]:
    """Return the columns about a run. `counts`: whether it counts, see `RunResult`."""
    def at(utc: float) -> Optional[str]:
        return iso(utc, in_utc) if utc else None

    sign_off, taken = record.sign_off, taken_s(record)
    return dict(zip(RUN_COLUMNS, (
        record.identity, record.zone, record.benchmark, record.team, record.round, record.run,
        ", ".join(record.robots), at(record.scheduled), at(record.opened_utc), at(record.started_utc),
        at(record.closed_utc), record.end_reason, None if taken is None else round(taken, 3),
        at(sign_off.utc) if sign_off else None, person(sign_off.who) if sign_off else None, counts,
    )))


def _item_rows(record: RunRecord, in_utc: bool) -> Iterator[Dict[str, Cell]]:
    last: Dict[Tuple[str, str], ScoreEntry] = {}
    for entry in record.history:
        if not entry.withdrawn_utc:
            last[entry.group, entry.desc] = entry
    for item in record.items:
        entry = last.get((item.group, item.desc))
        row: Dict[str, Cell] = {
            "kind": "item", "group": item.group, "name": item.desc,
            "value": _item_cell(item), "unit": item.unit,
            "not_attempted": item.not_attempted, "corrected": item.corrected, "points": _number(item.points),
            "ratings": ratings(record, item),
        }
        if entry is not None:
            row.update(changed=iso(entry.utc, in_utc), changed_by=person(entry.who), note=entry.note)
        yield row


def _item_cell(item: ItemRecord) -> Cell:
    if item.kind == "choice":
        return item.text  # also one that looks like a number, such as "inf"
    return _number(item.text) if item.text else item.value


def _number(text: str) -> Cell:
    """A decimal number as a number of the spreadsheet; other text stays text."""
    try:
        number = float(text)
    except ValueError:
        return text
    return int(number) if number.is_integer() else number


def _points_rows(record: RunRecord) -> Iterator[Dict[str, Cell]]:
    """The points of each group, then in total."""
    if record.points is None:
        return
    for name, points in record.points.groups:
        yield {"kind": "group", "group": name, "points": _number(points)}
    yield {"kind": "total", "points": _number(record.points.total)}
    if record.points.for_team:
        yield {"kind": "for_team", "points": _number(record.points.for_team)}


def _phase_rows(record: RunRecord) -> Iterator[Dict[str, Cell]]:
    for phase in record.phases:
        yield {"kind": "phase", "name": phase.name, "value": round(phase.elapsed_s, 3), "unit": "s"}


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
    return value if value is None or isinstance(value, (bool, int, float, str)) else value_text(value)


def standing_rows(standings: Iterable[Standing]) -> Iterator[Dict[str, Cell]]:
    """Return one row for each benchmark, team and criterion."""
    for standing in standings:
        for team in standing.lines:
            identities: List[str] = [run.record.identity for run in team.runs]
            for criterion, number, unit in zip(standing.criteria, team.numbers, standing.units):
                yield dict(zip(STANDING_COLUMNS, (
                    standing.benchmark, str(standing.attempts), team.rank, team.tied, team.team, team.disqualified,
                    criterion.name, "more" if criterion.more_is_better else "less", _decimal(number), len(identities),
                    " ".join(identities), standing.title, unit,
                )))


def _decimal(number: Optional[Fraction]) -> Optional[float]:
    """Return an exact number as the nearest one that programs can read."""
    return None if number is None else float(number)


# -- JSON -------------------------------------------------------------------------------------------


FORMAT = "roah_rsbb results"
# Incremented when a field changes its meaning or disappears. Version 2 has `as_of` instead of the time of writing, and
# only the name of the journal's file, so that the same journal always gives the same bytes.
VERSION = 2


def exported(
    results: Sequence[RunResult], standings: Sequence[Standing], journal: str, as_of_utc: float
) -> Dict[str, Any]:
    """Return the runs and the standings as JSON values. `as_of_utc`: the last moment in the journal."""
    return {
        **_head(journal, as_of_utc),
        "runs": [_run_value(result) for result in results],
        "standings": [_standing_value(standing) for standing in standings],
    }


def exported_standings(standings: Sequence[Standing], journal: str, as_of_utc: float) -> Dict[str, Any]:
    """Return only the standings as JSON values."""
    return {**_head(journal, as_of_utc), "standings": [_standing_value(standing) for standing in standings]}


def _head(journal: str, as_of_utc: float) -> Dict[str, Any]:
    return {"format": FORMAT, "version": VERSION, "journal": os.path.basename(journal), "as_of_utc": as_of_utc,
            "as_of": iso(as_of_utc, in_utc=True)}


def _run_value(result: RunResult) -> Dict[str, Any]:
    record = result.record
    given = tuple(item._replace(ratings=ratings(record, item)) for item in record.items)
    return {
        **_plain(record._replace(items=given)),
        "state": run_state_text(record),
        "counts": result.counts,
        "robot_parts": [
            {"port": r.port, "team": r.team, "robot": r.robot, "log_file": r.log_file,
             "link": [{"utc": second.utc, **_plain(second.sample)} for second in r.link]}
            for r in result.robots
        ],
        "entries": [
            {"number": e.number, "utc": e.utc, "port": e.port, "who": e.who, "kind": e.kind, "value": e.value}
            for e in result.entries
        ],
    }


def _standing_value(standing: Standing) -> Dict[str, Any]:
    return {
        "benchmark": standing.benchmark, "title": standing.title, "of_runs": str(standing.attempts),
        "criteria": [
            {"name": c.name, "better": "more" if c.more_is_better else "less", "unit": unit}
            for c, unit in zip(standing.criteria, standing.units)
        ],
        "teams": [
            {"rank": t.rank, "tied": t.tied, "team": t.team, "numbers": list(map(_decimal, t.numbers)),
             "disqualified": t.disqualified,
             "runs": [
                 {"identity": r.record.identity, "disqualified": r.disqualified,
                  "numbers": list(map(_decimal, r.numbers)),
                  "signed_off": r.record.sign_off is not None, "counts": i in t.counting}
                 for i, r in enumerate(t.runs)
             ]}
            for t in standing.lines
        ],
        "remarks": list(standing.remarks),
        "steps": list(standing.steps),
    }


def _plain(value: Any) -> Any:
    """A record with all its fields, including those with default values."""
    if hasattr(value, "_fields"):
        return {name: _plain(field) for name, field in zip(value._fields, value)}
    if dataclasses.is_dataclass(value):
        return to_json(value)
    if isinstance(value, (list, tuple)):
        items: List[Any] = [_plain(item) for item in value]
        return items
    return value


# -- MCAP -------------------------------------------------------------------------------------------


class _Type(NamedTuple):
    name: str
    definition: str  # as in the type's .msg file


# `Empty` has no fields. Score is in ros2/roah_rsbb_msgs.
_TYPES: Dict[LogKind, _Type] = {
    LogKind.UINT8: _Type("std_msgs/msg/UInt8", "uint8 data"),
    LogKind.STRING: _Type("std_msgs/msg/String", "string data"),
    LogKind.SCORE: _Type("roah_rsbb_msgs/msg/Score", "string group\nstring desc\nint32 value"),
    LogKind.EMPTY: _Type("std_msgs/msg/Empty", ""),
}
# What the library raises for a value that does not fit into its message.
_UNFIT = (TypeError, ValueError, struct.error)


def write_mcap(result: RunResult, folder: str) -> List[str]:
    """Write the log of each robot of a run into an existing folder. Old files are replaced when the new ones are
    complete. Returns the new files' paths. Raises `NotPossible`, OSError."""
    name = file_name(result.number, result.record)
    several = len(result.robots) > 1
    paths: List[str] = []
    for robot in result.robots:
        path = os.path.join(folder, f"{name}_port{robot.port}.mcap" if several else f"{name}.mcap")
        content = io.BytesIO()
        _write(result, robot, content)
        write_file(path, content.getvalue(), USUAL)
        paths.append(path)
    return paths


def _write(result: RunResult, robot: RobotPart, file: BinaryIO) -> None:
    writer_of, compression = library()
    writer = writer_of(file, compression=compression)
    schemas = {kind: writer.register_msgdef(of.name, of.definition) for kind, of in _TYPES.items()}
    entries = (entry for entry in result.entries if entry.port == robot.port and entry.kind in KINDS)
    for number, entry in enumerate(entries):
        kind = KINDS[entry.kind]
        with contextlib.suppress(*_UNFIT):  # such an entry is in no bag either
            writer.write_message(
                entry.kind, schemas[kind], _message(kind, entry.value), int(entry.utc * 1e9), sequence=number)
    writer.finish()


def _message(kind: LogKind, value: Any) -> Dict[str, Any]:
    if kind is LogKind.EMPTY:
        return {}
    if kind is LogKind.SCORE:
        group, desc, points = value
        return {"group": group, "desc": desc, "value": points}
    return {"data": value}


def library() -> Tuple[Any, Any]:
    """Return the class of the library that writes such files, and its compression. Raises `NotPossible`."""
    try:
        from mcap.writer import CompressionType
        from mcap_ros2.writer import Writer
    except ImportError as error:
        raise NotPossible(
            f"MCAP files need a Python package that is not here ({error}): install it with 'pip install "
            "mcap-ros2-support', or use another computer with it and a copy of the journal"
        ) from None
    return Writer, CompressionType.ZSTD
