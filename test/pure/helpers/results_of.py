"""A journal of a small competition with all kinds of runs, for tests of displaying and exporting results."""

import json
import pathlib

from helpers.journals import UTC0, Writer
from roah_rsbb.journal.log_dir import InForce, Texts, write_in_force
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import ItemRecord, RunRecord, ScoreEntry, ScoreValue, SignOff, StopRecord
from roah_rsbb.results.runs import records, run_result

ACHIEVED, PENALIZED, DISQUALIFYING = "Achievements", "Penalized Behaviors", "Disqualifying Behaviors"
DOOR, OBJECTS = "Detects the door", "Detects a changed object"
BUMPS, HITS = "Bumps into the furniture", "Hits a person"
# A robot's or a referee's text that would do harm where it is not escaped.
EVIL = '<script>alert("1")</script>&amp;\u202egnp.\x1b[31m=1+1'


def _fail(why):
    raise AssertionError(why)


def task_record(team, number, door=0, objects=0, bumps=0, hits=0, benchmark="HGTKMH", **fields):
    """The record of a task benchmark's run that is over; `number` makes its identity and time."""
    opened = UTC0 + 3600.0 * number
    items = (
        ItemRecord(ACHIEVED, DOOR, "bool", door), ItemRecord(ACHIEVED, OBJECTS, "uint", objects),
        ItemRecord(PENALIZED, BUMPS, "uint", bumps), ItemRecord(DISQUALIFYING, HITS, "uint", hits),
    )
    return RunRecord(
        f"{benchmark}-{6666 + number}-{opened:.3f}", "tbm", benchmark, team, 1, number, opened, opened,
        started_utc=opened + 30.0, closed_utc=opened + 700.0, end_reason="completed", elapsed_s=600.5, items=items,
        robots=("r1",),
    )._replace(**fields)


def module_record(team, number, benchmark="HNF", **scores):
    """The record of a functionality benchmark's run, with these values of the module."""
    values = tuple(ScoreValue("", name, json.dumps(value), "", name.capitalize()) for name, value in scores.items())
    return task_record(team, number, benchmark=benchmark)._replace(items=(), module_scores=values)


def full_record():
    """A record that uses all fields, with malicious texts."""
    record = task_record("Alpha", 1, door=1, objects=2)
    utc = record.opened_utc
    history = (
        ScoreEntry(1, utc + 40.0, "anna", ACHIEVED, OBJECTS, 0, 1),
        ScoreEntry(2, utc + 50.0, "anna", ACHIEVED, OBJECTS, 1, 3, note="note " + EVIL, withdrawn_utc=utc + 60.0,
                   withdrawn_by="bert", withdrawn_note="seen twice"),
        ScoreEntry(3, utc + 70.0, "anna", ACHIEVED, DOOR, 0, 0, not_attempted=True),
        ScoreEntry(4, utc + 800.0, "bert", ACHIEVED, OBJECTS, 1, 2, correction=True, note="from the video"),
    )
    items = (
        ItemRecord(ACHIEVED, DOOR, "bool", 0, not_attempted=True),
        ItemRecord(ACHIEVED, OBJECTS, "uint", 2, corrected=True), *record.items[2:],
    )
    return record._replace(
        items=items, history=history, sign_off=SignOff(utc + 900.0, "chief"), end_reason="stopped",
        stops=(StopRecord(utc + 300.0, "anna", "stopped", "Benchmark stopped by the referee", "cable " + EVIL, "anna"),
               StopRecord(utc + 660.0, "", "timeout", "Stopped due to timeout")),
        module_scores=(
            ScoreValue("", "reached", "2", "", "Waypoints reached"),
            ScoreValue("waypoint 1", "distance_error", "0.12345", "m", "Distance error"),
            ScoreValue("waypoint 1", "note", json.dumps("=cmd()" + EVIL), "", "Note"),
        ),
    )


def write_full_run(writer):
    """The run of `full_record`, with all sorts of entries, and a link record with a silence."""
    record = full_record()
    writer.utc = record.opened_utc
    writer.run(record, ((6667, "r1"),))
    at = {"identity": record.identity}
    _states(writer, at, "STOP", "Connected", 0)
    writer.entry("address", "10.0.0.7", who="10.0.0.7", **at)
    writer.entry("command", {"command": "start", "refused": ["Robot has not answered", EVIL]}, who="anna", **at)
    writer.entry("command", {"command": "start"}, who="anna", after=20.0, **at)
    _states(writer, at, "PREPARE", "Robot preparing for the task", 1)
    for second in range(300):
        silent = 100 < second < 110
        writer.link(LinkSample(
            1.0, 0 if silent else 1, lost=9 if second == 110 else 0, gap_s=second - 100.0 if silent else 1.0,
            late_s=0.01 * (second % 7), answers=int(second == 20), round_trip_s=0.03 if second == 20 else None,
            round_trip_max_s=0.05 if second == 20 else None, skew_s=0.02, unanswered=3 if second == 111 else 0,
            host="10.0.0.7",
        ))
        if second == 60:
            _states(writer, at, "WAITING_RESULT", "Robot prepared, executing", 3)
    writer.entry("/rsbb_log/bmbox/goal", json.dumps({"number": 1, "text": "waypoint 1", "goal": "[1, 2, 0.5]",
                                                     "pose": [1, 2, 0.5], "timeout": 120.0}), **at)
    writer.entry("/rsbb_log/result", "{class: a" + EVIL + "}", who="10.0.0.7", **at)
    writer.entry("/rsbb_log/manual_operation", "place the object " + EVIL, **at)
    writer.entry("/notification", EVIL, who="10.0.0.7", **at)
    writer.entry("/rsbb_log/devices/dimmer", 40, who="10.0.0.7", **at)
    writer.entry("notice", {"level": "WARNING", "text": "No message from the robot for 9 s"}, **at)
    writer.entry("/rsbb_log/score", [ACHIEVED, OBJECTS, 1], **at)
    writer.entry("something_new", {"a": 1}, **at)
    writer.entry("/rsbb_log/end", None, **at)
    return record


def _states(writer, at, name, desc, robot):
    writer.entry("/rsbb_log/rsbb_state_str", name, after=0.1, **at)
    writer.entry("/rsbb_log/rsbb_state_desc", desc, after=0.0, **at)
    writer.entry("/rsbb_log/client_state", robot, who="10.0.0.7", after=0.2, **at)


def write_competition(log_dir):
    """Write a journal with a full run and some plain ones; returns its path."""
    writer = Writer(log_dir)
    write_full_run(writer)
    for record in (
        task_record("Beta", 2, door=1, objects=4, bumps=1),
        task_record("Gamma", 3, started_utc=0.0, end_reason="", elapsed_s=0.0),
        module_record("Alpha", 4, reached=3, position_accuracy=0.2, orientation_accuracy=0.1, execution_time=100.0),
        task_record("Alpha", 5, closed_utc=0.0, end_reason="", elapsed_s=12.0),
    ):
        writer.run(record, ((record_port(record), "r1"),))
    writer.close()
    config = pathlib.Path(__file__).resolve().parents[3] / "config"
    texts = ((config / f"{name}.yaml").read_text("utf-8") for name in ("benchmarks", "schedule", "standings"))
    keep_files(log_dir, *texts)
    return writer.path


def runs_in(path):
    """All runs of a journal in which nothing is unreadable."""
    reader = JournalReader(path)
    return [run_result(reader, number, record, _fail)
            for number, record in enumerate(records(reader, _fail), 1)]


def keep_files(log_dir, benchmarks, schedule, *standings):
    """Keep the files of a competition beside its journal, as the box does."""
    texts = (benchmarks, schedule, None, *standings)
    write_in_force(str(log_dir), InForce("", 0, {0: Texts(("",) * len(texts), texts)}))


def record_port(record):
    """The private port of a run's robot."""
    return int(record.identity.split("-")[1])
