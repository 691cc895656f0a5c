"""A data set for publication: tidy CSV tables, their dictionary, checksums and a Frictionless `datapackage.json`.

The cells are those of the CSV export (`results/export.py`), with all times in UTC. The same journal and the same
options always give the same bytes (docs/results.md, "Data set").
"""

import contextlib
import hashlib
import hmac
import json
import os
import re
import tempfile
from typing import Any, Callable, Dict, Iterable, Iterator, NamedTuple, Optional, TextIO, Tuple

from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Kind
from roah_rsbb.model import run_log
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import (
    CaptainSign,
    JudgeAct,
    JudgeSheet,
    Objection,
    Proposal,
    Published,
    Rating,
    RunChange,
    RunRecord,
    ScoreEntry,
    ScoreValue,
    Settlement,
    SheetVersion,
    SignOff,
    Slot,
    StopRecord,
    TakenMarks,
    TimelineEntry,
    Waiver,
    submitted,
)
from roah_rsbb.results.events import COMMANDS, goals, sections
from roah_rsbb.results.export import RUN_COLUMNS, SCORE_COLUMNS, Cell, run_row, score_rows, write_rows, write_table
from roah_rsbb.results.runs import RobotPart, RunResult, judged_items
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.wording.sheets import node_of
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import iso

_TITLE = "Results of a competition"
PACKAGE, README, SUMS = "datapackage.json", "README.md", "SHA256SUMS"
_TIME_FORMAT = "%Y-%m-%dT%H:%M:%S.%f+00:00"
# Names that the specification allows for a licence, such as CC-BY-4.0.
_LICENCE_NAME = re.compile(r"[-a-zA-Z0-9._]+")


# -- pseudonyms -------------------------------------------------------------------------------------

# Hexadecimal digits of a pseudonym: two names of a competition never get the same one.
_DIGITS = 12


class Names:
    """Makes the pseudonyms of a journal.

    A pseudonym is a keyed hash (HMAC). The key comes from parts of the journal that are never published: the same
    journal always has the same pseudonyms, but nobody can find a name by trying the names of all teams. Texts of the
    rulebook stay: zones, benchmarks, items, groups, units, states.
    """

    def __init__(self, key: bytes) -> None:
        self._key = key

    def of(self, kind: str, name: str) -> str:
        """Return the pseudonym of a name or text of this kind; empty stays empty."""
        if not name:
            return ""
        digest = hmac.new(self._key, f"{kind}\0{name}".encode("utf-8", "surrogatepass"), hashlib.sha256)
        return f"{kind}-{digest.hexdigest()[:_DIGITS]}"

    def person(self, who: str) -> str:
        """Return the pseudonym of a person, the same one whichever node their calls came from."""
        node = node_of(who)
        return self.of("person", who if node in ("", who) else who[:-len(f" ({node})")])

    def text(self, text: str) -> str:
        """Return the pseudonym of a free text."""
        return self.of("text", text)


def names_of(reader: JournalReader) -> Names:
    """Return the pseudonyms of a journal."""
    secret = json.dumps([session[1:] for session in reader.sessions()])
    return Names(hashlib.sha256(secret.encode()).digest())


def _no_ids(_names: Names, marks: TakenMarks) -> TakenMarks:
    return marks._replace(entries={})


def _nothing(_names: Names, _text: str) -> str:
    return ""


def _team(names: Names, team: str) -> str:
    return team if team == ALL_TEAMS else names.of("team", team)


def _robots(names: Names, robots: Tuple[str, ...]) -> Tuple[str, ...]:
    return tuple(names.of("robot", robot) for robot in robots)


def _proposals(names: Names, proposals: Tuple[Tuple[str, str], ...]) -> Tuple[Tuple[str, str], ...]:
    return tuple(sorted((names.person(judge), value) for judge, value in proposals))


def _module_value(names: Names, text: str) -> str:
    try:
        value = json.loads(text)
    except ValueError:
        value = text
    is_number = value is None or isinstance(value, (bool, int, float))
    return text if is_number else json.dumps(names.text(text))


# What replaces the fields of records that have names or free texts. `Names` replaces the texts that are made from the
# journal's entries.
HIDDEN: Dict[type, Dict[str, Callable[[Names, Any], Any]]] = {
    RunResult: {"entries": lambda _, entries: entries},
    RunRecord: {"team": _team, "robots": _robots, "marks": _no_ids},
    ScoreEntry: {
        "who": Names.person, "note": Names.text, "judge": Names.person, "withdrawn_by": Names.person,
        "in_time_by": Names.person,
        "withdrawn_note": Names.text, "device": lambda names, device: names.of("device", device)},
    Rating: {"judge": Names.person},
    ScoreValue: {"value": _module_value},
    TimelineEntry: {
        "who": Names.person, "changed_by": Names.person, "text": Names.text,
        "device": lambda names, device: names.of("device", device)},
    Proposal: {"decided_by": Names.person, "reason": Names.text},
    CaptainSign: {"name": Names.person, "comment": Names.text, "drawing": Names.text, "who": Names.person},
    StopRecord: {"who": Names.person, "reason": Names.text, "reason_by": Names.person, "desc": Names.text},
    SignOff: {"who": Names.person},
    SheetVersion: {"why": Names.text},
    RunChange: {"who": Names.person, "reason": Names.text, "undone_by": Names.person, "undone_reason": Names.text},
    Slot: {"team": _team},
    JudgeSheet: {"judge": Names.person, "device": _nothing, "marks": _no_ids, "again": Names.text},
    Settlement: {"who": Names.person, "reason": Names.text, "proposals": _proposals},
    Waiver: {"who": Names.person, "reason": Names.text},
    JudgeAct: {"who": Names.person, "judge": Names.person, "reason": Names.text},
    Published: {"who": Names.person},
    Objection: {
        "by": Names.text, "text": Names.text, "who": Names.person, "answered_by": Names.person, "answer": Names.text},
    RobotPart: {"team": _team, "robot": lambda names, robot: names.of("robot", robot), "log_file": _nothing},
    LinkSample: {"host": lambda names, host: names.of("address", host)},
}


def anonymous(value: Any, names: Names) -> Any:
    """Return a run or a record, with all its parts, without names."""
    if not isinstance(value, tuple):
        return value
    if not hasattr(value, "_fields"):
        return tuple(anonymous(part, names) for part in value)
    hidden = HIDDEN.get(value.__class__, {})
    return value._make(hidden[name](names, part) if name in hidden else anonymous(part, names)
                       for name, part in zip(value._fields, value))


# -- the description --------------------------------------------------------------------------------


class Column(NamedTuple):
    """A column, as the data dictionary explains it."""

    name: str
    type: str
    description: str
    required: bool = False


class Table(NamedTuple):
    """A table of the data set."""

    name: str
    description: str
    fields: Tuple[Column, ...]


class DatasetOptions(NamedTuple):
    """What the organisers choose."""

    names: Optional[Names] = None  # pseudonyms; None: real names
    licence: str = ""  # empty: none given
    title: str = ""


_RUN_ID = Column("run_id", "string", "identity of the run: benchmark, private port, UTC of connecting", True)
_ROBOT = Column("robot", "string", "name of the robot; empty: all robots of the run, or none")
_RUN_FIELDS = {
    "run_id": _RUN_ID,
    "zone": Column("zone", "string", "zone of the arena", True),
    "benchmark": Column("benchmark", "string", "code of the benchmark", True),
    "team": Column("team", "string", "team; ALL: all robots at once", True),
    "round": Column("round", "integer", "round of the schedule", True),
    "run": Column("run", "integer", "run within the round", True),
    "robots": Column("robots", "string", "names of the robots, separated by commas; empty: there was none"),
    "scheduled": Column("scheduled", "datetime", "scheduled time"),
    "counts": Column("counts", "string", "counts, counts_as_zero, or why the run does not count"),
    "connected": Column("connected", "datetime", "when the robot was connected"),
    "started": Column("started", "datetime", "last start; empty: never started"),
    "disconnected": Column("disconnected", "datetime", "empty: still connected"),
    "end_reason": Column("end_reason", "string", "why the run ended (docs/results.md, CSV); empty: never started, or "
                                                "still running"),
    "elapsed_s": Column("elapsed_s", "number", "seconds that counted; empty: never started, or still running"),
    "signed_off": Column("signed_off", "datetime", "when the score sheet was signed off; empty: not signed off"),
    "signed_off_by": Column("signed_off_by", "string", "who signed it off"),
}
_SCORE_FIELDS = {
    "kind": Column("kind", "string",
                   "item of the referee's sheet, points of a group, total points, phase of a task, or "
                                    "value of the benchmarking module", True),
    "group": Column("group", "string", "group of the sheet or of the module; empty: the whole run"),
    "name": Column("name", "string", "item, phase or value"),
    "unit": Column("unit", "string", "unit of the value; empty: none"),
    "not_attempted": Column("not_attempted", "boolean", "the robot did not try, unlike a 0 that it earned"),
    "corrected": Column("corrected", "boolean", "changed after the run"),
    "changed": Column("changed", "datetime", "last change that was not withdrawn"),
    "changed_by": Column("changed_by", "string", "who made it"),
    "note": Column("note", "string", "note of that change; for a module's value, its description"),
    "points": Column("points", "number", "points; empty: the sheet gives none"),
    "ratings": Column("ratings", "string", "what each judge gave"),
}
# A table column has one type, so values that are texts have a column of their own.
_VALUE_FIELDS = (
    Column("value", "number", "number; a yes is 1, a no is 0; empty: a text, or not known"),
    Column("text", "string", "value that is a text"),
)
_LINK_UNITS = {
    "seconds": "seconds since the previous sample", "received": "messages that were newer than all before",
    "lost": "messages that did not arrive in order", "skipped_states": "states of the robot that never arrived",
    "duplicates": "messages that arrived twice", "stale": "messages that arrived after a newer one",
    "unreadable": "datagrams that could not be decoded", "gap_s": "longest silence, seconds",
    "late_s": "delay of the latest message behind the fastest, seconds",
    "answers": "reactions of the robot to the box", "unanswered": "datagrams of the box without a reaction",
    "round_trip_s": "shortest round trip with the robot's own delay, seconds", "round_trip_max_s": "longest round trip",
    "skew_s": "clock of the robot minus clock of the box, lower bound, seconds", "skew_max_s": "upper bound",
    "host": "address of the robot",
}

TABLES = (
    Table("runs", "One row for each run.", tuple(_RUN_FIELDS[name] for name in RUN_COLUMNS)),
    Table("scores", "One row for each item of a score sheet, each sum, each phase and each value of a module.", (
        _RUN_ID, *(_SCORE_FIELDS[name] for name in SCORE_COLUMNS if name != "value"), *_VALUE_FIELDS)),
    Table("judges", "One row for each item of each judge who scored on a sheet of their own.", (
        _RUN_ID, Column("judge", "string", "who judged", True), Column("group", "string", "group of the sheet", True),
        Column("name", "string", "item", True), Column("proposal", "string", "value that the judge submitted", True),
        Column("settled", "boolean", "the head referee decided the item", True),
        Column("reason", "string", "reason of the head referee"))),
    Table("goals", "One row for each goal that the box sent to a robot, such as a waypoint.", (
        _RUN_ID, Column("goal", "integer", "number of the goal within the run", True), _ROBOT,
        Column("time", "datetime", "when the goal was sent", True), Column("text", "string", "the goal"),
        Column("timeout_s", "number", "seconds that the robot had"),
        Column("seconds", "number", "seconds that it took; empty: not ended"),
        Column("result", "string", "result as the robot reported it"))),
    Table("events", "One row for each thing that happened in a run, in the order of time.", (
        _RUN_ID, Column("time", "datetime", "when it happened", True), _ROBOT,
        Column("subject", "string", "subject, as on the score sheet", True),
        Column("by", "string", "who did it: a person, or a robot's address; empty: the box"),
        Column("bad", "boolean", "a refused command, or a warning", True), Column("text", "string", "what happened"))),
    Table("link", "One row for each second of a robot's link.", (
        _RUN_ID, _ROBOT, Column("time", "datetime", "end of the second", True),
        *(Column(name, "string" if name == "host" else "number", _LINK_UNITS[name]) for name in LinkSample._fields))),
)

FILES = tuple(sorted((PACKAGE, README, SUMS, *(f"{table.name}.csv" for table in TABLES))))


def write_dataset(folder: str, results: Iterable[RunResult], options: DatasetOptions) -> None:
    """Write the data set into an existing folder. Old files are replaced when the new ones are complete."""
    with contextlib.ExitStack() as files:
        folder_of_drafts = files.enter_context(tempfile.TemporaryDirectory(prefix=".draft_", dir=folder))
        _write_files(folder_of_drafts, results, options)
        for name in FILES:
            os.replace(os.path.join(folder_of_drafts, name), os.path.join(folder, name))


def _write_files(folder: str, results: Iterable[RunResult], options: DatasetOptions) -> None:
    with contextlib.ExitStack() as files:
        writers = []
        for table in TABLES:
            file = files.enter_context(_open(folder, f"{table.name}.csv"))
            columns = tuple(field.name for field in table.fields)
            write_table(file, columns, ())
            writers.append((_ROWS[table.name], file, columns))
        for result in results:
            published = result if options.names is None else anonymous(result, options.names)
            for rows, file, columns in writers:
                write_rows(file, columns, rows(published, options.names))
    with _open(folder, PACKAGE) as file:
        json.dump(_package(folder, options), file, ensure_ascii=False, indent=1)
        file.write("\n")
    with _open(folder, README) as file:
        file.write(_readme(options))
    with _open(folder, SUMS) as file:
        file.writelines(f"{_sha256(os.path.join(folder, name))}  {name}\n" for name in FILES if name != SUMS)


def _open(folder: str, name: str) -> TextIO:
    return open(os.path.join(folder, name), "w", encoding="utf-8", errors="backslashreplace", newline="")


# -- rows -------------------------------------------------------------------------------------------


def _run_rows(result: RunResult, _names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    yield run_row(result.record, in_utc=True, counts=result.counts)


def _score_rows(result: RunResult, _names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    for row in score_rows(result.record, in_utc=True):
        value = row.get("value")
        is_text = isinstance(value, str)
        number = int(value) if isinstance(value, bool) else value
        yield {**row, "run_id": result.record.identity, "value": None if is_text else number,
               "text": value if is_text else None}


def _judge_rows(result: RunResult, _names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    record = result.record
    judges = [sheet.judge for sheet in submitted(record)]
    for each in judged_items(record):
        for judge, proposal in zip(judges, each.proposals):
            yield {
                "run_id": record.identity, "judge": judge, "group": each.item.group, "name": each.item.desc,
                "proposal": proposal, "settled": each.settlement is not None,
                "reason": "" if each.settlement is None else each.settlement.reason,
            }


def _goal_rows(result: RunResult, names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    for goal in goals(result):
        yield {
            "run_id": result.record.identity, "goal": goal.number, "robot": _robot(result, goal.port),
            "time": iso(goal.utc, in_utc=True), "text": _text(names, goal.text), "timeout_s": goal.timeout_s,
            "seconds": None if goal.seconds is None else round(goal.seconds, 3), "result": _text(names, goal.result),
        }


def _event_rows(result: RunResult, names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    # The sections have a fixed order, so events of the same moment do, too.
    events = [(section.title, event) for section in sections(result) for event in section.events]
    for subject, event in sorted(events, key=lambda line: line[1].utc):
        text, who = event.text, event.who
        if names is not None:
            text = _without_names(event.kind, text, event.bad, names)
            is_robot = event.kind in run_log.FROM_ROBOT or event.kind == Kind.ADDRESS
            who = names.of("address", who) if is_robot else names.person(who)
        yield {
            "run_id": result.record.identity, "time": iso(event.utc, in_utc=True), "robot": _robot(result, event.port),
            "subject": subject, "by": who, "bad": event.bad, "text": text,
        }


def _without_names(kind: str, text: str, bad: bool, names: Names) -> str:
    """Return the part of an event's text that the box wrote, or a pseudonym."""
    if kind in _OF_THE_BOX:
        return text
    if kind == run_log.STATE_DESC:
        return ": ".join(text.split(": ")[:2])  # box and state, without the explanation
    if kind in COMMANDS:
        return text.split(";")[0] + ("; REFUSED" if bad else "")
    return names.of("text", text)


_OF_THE_BOX = frozenset((
    run_log.CLIENT_STATE, run_log.END, Kind.TIMEOUT, *(run_log.device_topic(device) for device in run_log.DEVICES)))


def _link_rows(result: RunResult, _names: Optional[Names]) -> Iterator[Dict[str, Cell]]:
    for robot in result.robots:
        for second in robot.link:
            yield {"run_id": result.record.identity, "robot": robot.robot, "time": iso(second.utc, in_utc=True),
                   **second.sample._asdict()}


def _robot(result: RunResult, port: Optional[int]) -> str:
    return next((robot.robot for robot in result.robots if robot.port == port), "")


def _text(names: Optional[Names], text: str) -> str:
    return text if names is None else names.of("text", text)


_Rows = Callable[[RunResult, Optional[Names]], Iterator[Dict[str, Cell]]]
_ROWS: Dict[str, _Rows] = {
    "runs": _run_rows, "scores": _score_rows, "judges": _judge_rows, "goals": _goal_rows, "events": _event_rows,
    "link": _link_rows,
}


# -- package ----------------------------------------------------------------------------------------


def _package(folder: str, options: DatasetOptions) -> Dict[str, Any]:
    package: Dict[str, Any] = {
        "profile": "tabular-data-package",
        "name": "roah-rsbb-results",
        "title": one_line(options.title) or _TITLE,
        "description": _ANONYMOUS if options.names is not None else _WHAT,
    }
    if options.licence:
        is_name = _LICENCE_NAME.fullmatch(options.licence)
        package["licenses"] = [
            {"name": options.licence} if is_name else {"name": "custom", "title": options.licence}]
    package["resources"] = [_resource(folder, table) for table in TABLES]
    return package


def _resource(folder: str, table: Table) -> Dict[str, Any]:
    path = os.path.join(folder, f"{table.name}.csv")
    schema: Dict[str, Any] = {"fields": [_field(field) for field in table.fields], "missingValues": [""]}
    if table.name == "runs":
        schema["primaryKey"] = "run_id"
    else:
        schema["foreignKeys"] = [{"fields": "run_id", "reference": {"resource": "runs", "fields": "run_id"}}]
    return {
        "profile": "tabular-data-resource", "name": table.name, "path": f"{table.name}.csv",
        "description": table.description, "format": "csv", "mediatype": "text/csv", "encoding": "utf-8",
        "bytes": os.path.getsize(path), "hash": f"sha256:{_sha256(path)}", "schema": schema,
    }


def _field(field: Column) -> Dict[str, Any]:
    found: Dict[str, Any] = {"name": field.name, "type": field.type, "description": field.description}
    if field.type == "datetime":
        found["format"] = _TIME_FORMAT
    if field.required:
        found["constraints"] = {"required": True}
    return found


_WHAT = "Runs, scores, goals, events and link quality of a competition, from the journal of roah_rsbb."
_ANONYMOUS = f"{_WHAT} Teams, robots, people, addresses and free texts have pseudonyms."


def _readme(options: DatasetOptions) -> str:
    """Return the data dictionary for people."""
    lines = [
        f"# {one_line(options.title) or _TITLE}", "",
        _ANONYMOUS if options.names is not None else _WHAT, "",
        f"Licence: {one_line(options.licence) or 'none given. Ask the organisers before you use the data'}", "",
        "All files are UTF-8. Times are UTC. An empty cell is a missing value. A text that a spreadsheet program would",
        "run as a formula starts with an apostrophe. If a text starts with an apostrophe, remove this one character.",
        "Characters that cannot be printed are written as escapes, such as `\\x1b`.",
        f"`{SUMS}` has the checksums: `sha256sum -c {SUMS}`.", "",
    ]
    for table in TABLES:
        lines += [f"## {table.name}.csv", "", table.description, "", "| column | type | |", "|---|---|---|"]
        lines += [f"| `{field.name}` | {field.type} | {field.description} |" for field in table.fields]
        lines.append("")
    return "\n".join(lines)


def _sha256(path: str) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for piece in iter(lambda: file.read(1 << 16), b""):
            digest.update(piece)
    return digest.hexdigest()
