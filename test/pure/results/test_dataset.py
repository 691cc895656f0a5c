"""The data set for publication: its tables, its description, and pseudonyms."""

import csv
import datetime
import hashlib
import json
import os
import typing

import pytest

from helpers.golden import DATA
from helpers.journals import Writer
from helpers.results_of import full_record, runs_in, task_record, write_competition
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model import records as all_records
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import ItemRecord, Rating
from roah_rsbb.results.dataset import FILES, HIDDEN, TABLES, DatasetOptions, names_of, write_dataset
from roah_rsbb.results.runs import RobotPart


@pytest.fixture(scope="module")
def journal(tmp_path_factory):
    return write_competition(tmp_path_factory.mktemp("competition"))


def written(journal, folder, anonymous=False, **options):
    """Write the data set of a journal; returns the rows by table, and the description."""
    folder.mkdir(exist_ok=True)
    names = names_of(JournalReader(journal)) if anonymous else None
    write_dataset(str(folder), runs_in(journal), DatasetOptions(names, **options))
    assert sorted(os.listdir(str(folder))) == sorted(FILES)
    tables = {}
    for table in TABLES:
        with open(str(folder / f"{table.name}.csv"), encoding="utf-8", newline="") as file:
            tables[table.name] = list(csv.DictReader(file))
    return tables, json.loads((folder / "datapackage.json").read_text(encoding="utf-8"))


def test_what_is_written_is_described(journal, tmp_path):
    tables, package = written(journal, tmp_path / "set", licence="CC-BY-4.0", title="ERL 2026")
    schema = json.loads((DATA / "data_package" / "datapackage.schema.json").read_text(encoding="utf-8"))
    pytest.importorskip("jsonschema").validate(package, schema)
    assert package["title"] == "ERL 2026"
    assert package["licenses"] == [{"name": "CC-BY-4.0"}]
    identities = [row["run_id"] for row in tables["runs"]]
    assert len(identities) == len(set(identities)) == 5
    for resource in package["resources"]:
        content = (tmp_path / "set" / resource["path"]).read_bytes()
        assert resource["bytes"] == len(content)
        assert resource["hash"] == f"sha256:{hashlib.sha256(content).hexdigest()}"
        for row in tables[resource["name"]]:
            assert row["run_id"] in identities
            assert list(row) == [field["name"] for field in resource["schema"]["fields"]]
            for field in resource["schema"]["fields"]:
                _check(field, row[field["name"]])
    sums = [line.split("  ") for line in (tmp_path / "set" / "SHA256SUMS").read_text(encoding="utf-8").splitlines()]
    assert {name for _, name in sums} == {*FILES} - {"SHA256SUMS"}
    for digest, name in sums:
        assert hashlib.sha256((tmp_path / "set" / name).read_bytes()).hexdigest() == digest
    readme = (tmp_path / "set" / "README.md").read_text(encoding="utf-8")
    assert all(f"| `{field.name}` | {field.type} | {field.description} |" in readme
               for table in TABLES for field in table.fields)


def _check(field, cell):
    """A cell has the type of its column, as Table Schema defines it."""
    if not cell:
        assert "constraints" not in field, field
    elif field["type"] == "datetime":
        assert datetime.datetime.strptime(cell, field["format"])
    elif field["type"] in ("number", "integer"):
        assert float(cell) == float(cell)
        assert field["type"] == "number" or cell.lstrip("-").isdigit()
    elif field["type"] == "boolean":
        assert cell in ("true", "false")


def test_the_rows_of_a_run(journal, tmp_path):
    tables, _ = written(journal, tmp_path / "set")
    record = full_record()
    of_run = {name: [row for row in rows if row["run_id"] == record.identity] for name, rows in tables.items()}
    assert of_run["runs"][0]["end_reason"] == "stopped"
    assert of_run["runs"][0]["scheduled"] == "2025-11-21T12:00:00.000+00:00"
    item = next(row for row in of_run["scores"] if row["name"] == "Detects a changed object")
    assert (item["value"], item["corrected"], item["note"]) == ("2", "true", "from the video")
    distance, = (row for row in of_run["scores"] if row["name"] == "distance_error")
    assert (distance["value"], distance["unit"], distance["group"]) == ("0.12345", "m", "waypoint 1")
    note, = (row for row in of_run["scores"] if row["name"] == "note")
    assert note["value"] == "" and note["text"].startswith("'=cmd()"), "a text has its own column"
    goal, = of_run["goals"]
    assert (goal["goal"], goal["text"], goal["timeout_s"], goal["robot"]) == ("1", "waypoint 1", "120.0", "r1")
    assert goal["result"].startswith("{class: a<script>")
    assert len(of_run["link"]) == 300
    assert max(float(row["gap_s"]) for row in of_run["link"]) == 9.0
    refused = [row["text"] for row in of_run["events"] if row["bad"] == "true"]
    assert refused[0].startswith("start; REFUSED: Robot has not answered; <script>")
    assert [row["time"] for row in of_run["events"]] == sorted(row["time"] for row in of_run["events"])


@pytest.mark.parametrize("licence, described", [
    ("", None), ("ODC-By-1.0", [{"name": "ODC-By-1.0"}]),
    ("Only for science", [{"name": "custom", "title": "Only for science"}]),
])
def test_licences(journal, tmp_path, licence, described):
    _, package = written(journal, tmp_path / "set", licence=licence)
    assert package.get("licenses") == described
    schema = json.loads((DATA / "data_package" / "datapackage.schema.json").read_text(encoding="utf-8"))
    pytest.importorskip("jsonschema").validate(package, schema)


# -- pseudonyms -------------------------------------------------------------------------------------

SECRETS = ("Hidden Team", "hidden robot", "10.9.8.7", "Judge Dredd", "Referee Ray", "a secret sentence")


def _write_secrets(log_dir):
    team, robot, address, judge, referee, text = SECRETS
    writer = Writer(log_dir)
    record = full_record()
    record = record._replace(
        team=team, robots=(robot,),
        items=(*record.items, ItemRecord("Jury", "Poster", "rating", 7, text="7", ratings=(Rating(judge, "7"),))),
        history=tuple(entry._replace(who=referee, device=text, note=text, withdrawn_by=referee, withdrawn_note=text,
                                     in_time_by=referee)
                      for entry in record.history),
        stops=tuple(stop._replace(who=referee, reason=text, reason_by=referee, desc=text) for stop in record.stops),
        sign_off=record.sign_off._replace(who=referee),
        module_scores=tuple(score._replace(value=json.dumps(text)) for score in record.module_scores),
    )
    writer.run(record, ((6667, robot),))
    writer.run(task_record(team, 2, robots=(robot,)), ((6668, robot),))
    writer.utc = record.opened_utc
    for kind, value, who in (
        ("/rsbb_log/rsbb_state_str", "PREPARE", ""), ("/rsbb_log/rsbb_state_desc", text, ""),
        ("address", address, address),
        ("/rsbb_log/client_state", 1, address), ("command", {"command": "stop", "reason": text}, referee),
        ("/rsbb_log/bmbox/goal", json.dumps({"text": text}), ""), ("/rsbb_log/result", text, address),
        ("/rsbb_log/manual_operation", text, referee), ("/notification", text, address),
        ("notice", {"level": "WARNING", "text": text}, ""), ("something_new", text, ""),
    ):
        writer.entry(kind, value, record.identity, who=who)
    writer.link(LinkSample(1.0, received=1, host=address))
    writer.close()
    return writer.path


def test_an_anonymous_data_set_has_no_names(tmp_path):
    journal = _write_secrets(tmp_path / "log")
    tables, _ = written(journal, tmp_path / "named")
    contents = "".join((tmp_path / "named" / name).read_text(encoding="utf-8") for name in FILES)
    assert all(secret in contents for secret in SECRETS), "this test would see them"
    hidden, _ = written(journal, tmp_path / "hidden", anonymous=True)
    contents = "".join((tmp_path / "hidden" / name).read_text(encoding="utf-8") for name in FILES)
    assert not [secret for secret in SECRETS if secret in contents]
    assert {name: len(rows) for name, rows in hidden.items()} == {name: len(rows) for name, rows in tables.items()}
    numbers = ("points", "value", "elapsed_s", "received", "seconds", "benchmark", "name", "group")
    for name, rows in tables.items():
        for real, row in zip(rows, hidden[name]):
            assert [row.get(column) for column in numbers] == [real.get(column) for column in numbers]
    first, second = hidden["runs"]
    assert first["team"] == second["team"], "the same team has the same pseudonym"
    assert first["team"].startswith("team-")
    assert {row["robot"] for row in hidden["link"]} == {first["robots"]}
    assert "Robot: PREPARING" in {row["text"] for row in hidden["events"]}, "the box wrote this"


def test_a_person_has_one_pseudonym_for_all_programs(tmp_path):
    """The core also writes from which node a call came."""
    writer = Writer(tmp_path / "log")
    record = full_record()
    callers = ["Anna (/roah_rsbb_window_1)", "Anna (/roah_rsbb_web)", "Anna", "Ben (/roah_rsbb_web)"]
    record = record._replace(history=tuple(
        entry._replace(who=who, withdrawn_utc=0.0, desc=f"item {who}") for entry, who in zip(record.history, callers)),
        items=tuple(ItemRecord(entry.group, f"item {who}", "uint", 1) for entry, who in zip(record.history, callers)),
        sign_off=record.sign_off._replace(who="Anna (/roah_rsbb_window_2)"))
    writer.run(record)
    writer.entry("command", {"command": "stop"}, record.identity, who="Anna (/terminal)")
    writer.entry("command", {"command": "stop"}, record.identity, who="/no_name")
    writer.close()
    tables, _ = written(writer.path, tmp_path / "set", anonymous=True)
    *anna, ben = (row["changed_by"] for row in tables["scores"] if row["kind"] == "item")
    by_name, by_node = (row["by"] for row in tables["events"])
    assert {*anna, by_name, tables["runs"][0]["signed_off_by"]} == {anna[0]}
    assert len({anna[0], ben, by_node}) == 3


def test_pseudonyms_depend_on_the_journal_and_on_what_is_not_published(tmp_path):
    names = []
    for number, boot in enumerate(("boot 1", "boot 2", "boot 1")):
        writer = Writer(tmp_path / str(number), boot=boot)
        writer.run(task_record("Alpha", 1))
        writer.close()
        names.append(written(writer.path, tmp_path / f"set {number}", anonymous=True)[0]["runs"][0]["team"])
    assert names[0] == names[2] != names[1]


def test_each_text_of_a_record_is_hidden_or_of_the_rulebook():
    """Also those that no table has yet."""
    kinds = {kind for kind in vars(all_records).values() if isinstance(kind, type) and hasattr(kind, "_fields")}
    shown = {kind.__name__: {name for name, type_ in typing.get_type_hints(kind).items()
                             if type_ in (str, typing.Tuple[str, ...]) and name not in HIDDEN.get(kind, {})}
             for kind in kinds - {all_records.By} | {RobotPart, LinkSample}}
    assert {name: fields for name, fields in shown.items() if fields} == {
        "RunChange": {"what"}, "Slot": {"event"},
        "RunRecord": {"identity", "zone", "benchmark", "end_reason", "event"},
        "ItemRecord": {"group", "desc", "kind", "text", "points", "unit"}, "Rating": {"text"},
        "ScoreEntry": {"group", "desc", "old_text", "text", "added", "role", "points"},
        "GroupPoints": {"name", "points"}, "SheetPoints": {"total", "for_team", "inner"},
        "ScoreValue": {"group", "name", "unit", "desc"},
        "StopRecord": {"end_reason"}, "TimelineEntry": {"kind", "role", "id"}, "Proposal": {"mark_id"},
        "PhaseTime": {"name"}, "Settlement": {"group", "desc", "text"}, "JudgeAct": {"act"}}
