"""Score sheets: in the terminal and as pages, also of robots that mean harm."""

import html
import json
import re

import pytest

from helpers.journals import UTC0, Writer
from helpers.results_of import EVIL, runs_in, task_record, write_full_run
from helpers.time_zones import local_time
from roah_rsbb.journal.reader import JournalEntry, JournalReader
from roah_rsbb.journal.records import Batch, OutcomeRow
from roah_rsbb.model.records import PhaseTime
from roah_rsbb.results.events import box_states, goals, robot_states, sections
from roah_rsbb.results.export import result_rows
from roah_rsbb.results.lists import list_lines
from roah_rsbb.results.page import tag
from roah_rsbb.results.paper import front_of
from roah_rsbb.results.runs import NotPossible, RobotPart, RunResult, find, records, run_state_text
from roah_rsbb.results.sheet import sheet_lines, sheet_page
from roah_rsbb.wording import texts, times


@pytest.fixture
def lisbon():
    """Local time in November is UTC + 1 h in Madrid."""
    with local_time("Europe/Madrid"):
        yield


def read(writer):
    return runs_in(writer.path)[0]


@pytest.fixture
def writer(tmp_path):
    writer = Writer(tmp_path / "log")
    yield writer
    writer.journal.close()


@pytest.fixture
def result(writer):
    write_full_run(writer)
    return read(writer)


def text_of(page):
    """The text of a page, each element on a line."""
    return html.unescape(re.sub("<[^>]*>", "\n", re.sub("<wbr>|<style>.*?</style>", "", page, flags=re.S)))


# -- times and texts --------------------------------------------------------------------------------


def test_times_are_local_with_their_offset_or_utc(lisbon):
    assert times.date_time(UTC0) == "2025-11-21 12:00:00 +01:00"
    assert times.date_time(UTC0, in_utc=True) == "2025-11-21 11:00:00Z"
    assert times.iso(UTC0 + 0.25) == "2025-11-21T12:00:00.250+01:00"
    assert times.time_with_tenths(UTC0 + 0.98) == "12:00:00.9"
    assert times.time_with_tenths(UTC0, in_utc=True) == "11:00:00.0"


def test_a_run_is_found_by_number_identity_or_its_beginning():
    records_ = (task_record("Alpha", 1), task_record("Beta", 2), task_record("Beta", 12, benchmark="HWV"))
    known = [record.identity for record in records_]
    assert [find(known, word) for word in ("1", "3", known[1], "HWV")] == [0, 2, 1, 2]
    for word, text in (("0", "there are 1 to 3"), ("4", "there are 1 to 3"), ("HG", "matches 2 runs"), ("", "list"),
                       ("x", "results list")):
        with pytest.raises(NotPossible, match=text):
            find(known, word)
    with pytest.raises(NotPossible, match="no runs yet"):
        find([], "1")


def test_a_record_that_cannot_be_read_costs_only_itself(writer):
    writer.run(task_record("Alpha", 1))
    writer.run(task_record("Beta", 2), ())
    for record, value in ((task_record("Alpha", 1), {"team": 3}), (task_record("Beta", 2), None)):
        writer.journal.write(Batch(outcomes={record.identity: OutcomeRow(record.closed_utc, value)}))
    warnings = []
    found = records(JournalReader(writer.path), warnings.append)
    assert [(r.team, r.round, r.items, r.closed_utc) for r in found] == [
        ("Alpha", 1, (), task_record("Alpha", 1).closed_utc), ("Beta", 1, (), task_record("Beta", 2).closed_utc)
    ]
    assert len(warnings) == 1
    assert "HGTKMH-6667" in warnings[0]


# -- what happened ----------------------------------------------------------------------------------


def test_the_events_of_a_run(result):
    reported = {section.title: [h.text for h in section.events] for section in sections(result)}
    assert reported["Timeline of states"] == [
        "Box: STOP: Connected", "Robot: STOP", "Robot's address: 10.0.0.7",
        "Box: PREPARE: Robot preparing for the task", "Robot: PREPARING",
        "Box: WAITING_RESULT: Robot prepared, executing", "Robot: EXECUTING", "Disconnected",
    ]
    assert reported["Goals and results"] == [
        "Goal: waypoint 1; goal: [1, 2, 0.5]; pose: [1, 2, 0.5]; 120.0 s", "Result: {class: a" + EVIL + "}"
    ]
    assert reported["Manual operations"] == ["place the object " + EVIL]
    assert reported["Referee's commands"] == [f"start; REFUSED: Robot has not answered; {EVIL}", "start"]
    assert reported["Online data"] == [f"notification: {EVIL}"]
    assert reported["Home devices and tablet"] == ["dimmer: 40"]
    assert reported["Warnings"] == ["WARNING: No message from the robot for 9 s"]
    assert reported["Other"] == ['something_new: {"a": 1}']
    by_title = {section.title: section.events for section in sections(result)}
    assert [(h.bad, h.who) for h in by_title["Referee's commands"]] == [(True, "anna"), (False, "anna")]
    assert by_title["Warnings"][0].bad
    assert by_title["Online data"][0].who == "10.0.0.7"


def test_a_robots_state_that_is_said_again_is_reported_once(writer):
    record = task_record("Alpha", 1)
    writer.run(record)
    for state in (3, 3, 4, 9):
        writer.entry("/rsbb_log/client_state", state, record.identity)
    [section] = sections(read(writer))
    assert [h.text for h in section.events] == ["Robot: EXECUTING", "Robot: RESULT_TX", "Robot: 9"]


def test_of_several_robots_each_is_named(writer):
    record = task_record("ALL", 1, benchmark="HSUF")
    writer.run(record, ((6667, "r1"), (6668, "r2")))
    writer.entry("/notification", "hello", record.identity, port=6668)
    writer.entry("command", {"command": "start"}, record.identity, port=None)
    named = [h.robot for section in sections(read(writer)) for h in section.events]
    assert sorted(named) == ["", "r2 of team ALL"]
    assert "r2 of team ALL  notification: hello" in "\n".join(sheet_lines(read(writer), True, False))


def test_a_state_that_is_said_again_is_one_stretch(writer):
    record = task_record("Alpha", 1)
    writer.run(record)
    for state in ("STOP", "PREPARE", "PREPARE", "PREPARE"):
        writer.entry("/rsbb_log/rsbb_state_str", state, record.identity)
    stretches = box_states(read(writer), 6667, writer.utc + 5.0)
    assert [(s.name, s.end_utc - s.begin_utc) for s in stretches] == [("STOP", 1.0), ("PREPARE", 7.0)]


def test_stretches_of_states(result):
    begin = result.record.opened_utc
    stretches = box_states(result, 6667, begin + 500.0)
    assert [s.name for s in stretches] == ["STOP", "PREPARE", "WAITING_RESULT"]
    assert [round(s.end_utc - begin) for s in stretches] == [22, 84, 500]
    assert [s.name for s in robot_states(result, 6667, begin + 500.0)] == ["STOP", "PREPARING", "EXECUTING"]
    assert box_states(result, 6668, begin) == []


# -- in the terminal --------------------------------------------------------------------------------


def test_the_list(lisbon):
    rows = list(list_lines([task_record("Beta", 2), task_record("Gamma", 3, started_utc=0.0, end_reason="")], False))
    assert rows[0].split() == "No. Connected Zone Benchmark Team Round Run Time Sheet State".split()
    assert " ".join(rows[1].split()) == (
        "1 2025-11-21 14:00:00 +01:00 tbm HGTKMH Beta 1 2 10:00.5 not signed off completed"
    )
    assert rows[2].endswith("never started")


def test_the_time_of_a_run_in_progress_is_not_shown():
    """The journal has that of its last entry: 6:32 for a run whose box shows 7:49."""
    running = task_record("Alpha", 1, end_reason="", closed_utc=0.0, elapsed_s=392.0)
    _, row = list_lines([running], True)
    assert " ".join(row.split()).endswith("HGTKMH Alpha 1 1 – open running")
    lines = [" ".join(text.split()) for text in sheet_lines(RunResult(1, running, (), ()), True, False)]
    assert "Time: –" in lines
    assert ("End", "running") in front_of(running, None, "", True).facts
    assert {cells["elapsed_s"] for cells in result_rows([running], True)} == {None}


@pytest.mark.parametrize(("fields", "state"), [
    ({}, "completed"), ({"end_reason": "", "closed_utc": 0.0}, "running"),
    ({"started_utc": 0.0, "end_reason": "", "closed_utc": 0.0}, "connected"),
    ({"started_utc": 0.0, "end_reason": ""}, "never started"),
    ({"end_reason": "of a newer version"}, "of a newer version"),
])
def test_where_a_run_is(fields, state):
    assert run_state_text(task_record("Alpha", 1, **fields)) == state


def test_the_sheet_in_the_terminal(result, lisbon):
    lines = list(sheet_lines(result, in_utc=False, strike=False))
    text = "\n".join(" ".join(line.split()) for line in lines)
    for expected in (
        "HGTKMH, team Alpha, round 1, run 1 (HGTKMH-6667-",
        "signed off by chief at 2025-11-21 13:15:00 +01:00",
        "not attempted Detects the door",
        "2 Detects a changed object corrected",
        "1 2025-11-21 13:00:40 +01:00 anna Achievements: Detects a changed object 0 → 1",
        " withdrawn by bert at 2025-11-21 13:01:00 +01:00: seen twice",
        "Detects the door no → not attempted",
        " bert correction Achievements: Detects a changed object 1 → 2 from the video",
        "anna Benchmark stopped by the referee cable",
        "2025-11-21 13:11:00 +01:00 Stopped due to timeout",
        "2 Waypoints reached", "0.123 m Distance error",
        "9 lost on the way to the box (3.0%)", "3 datagrams of the box", "0.030 s at best, 0.050 s at worst",
        "longest silence 9.0 s", "silence over 2.5 s: 7", "robot's address: 10.0.0.7", "/logs/6667.bag",
    ):
        assert expected in text
    assert not re.search("[\x00-\x1f\u202e]", "".join(lines)), "nothing of a robot reaches the terminal as it is"


def test_withdrawn_entries_are_struck_through_where_possible(result):
    struck = [text for text in sheet_lines(result, in_utc=True, strike=True) if "\033[9m" in text]
    assert len(struck) == 1
    assert "1 → 3" in struck[0]
    assert struck[0].index("\033[29m") < struck[0].index("withdrawn by bert at 2025-11-21 12:01:00Z")


def test_attributes_are_escaped():
    assert tag("a", "x", href='"><script>\u202e') == '<a href="&quot;&gt;&lt;script&gt;\\u202e">x</a>'


# -- as a page --------------------------------------------------------------------------------------


def test_the_page_has_all(result, lisbon):
    page = sheet_page(result, in_utc=False)
    text = text_of(page)
    for expected in (
        "HGTKMH, team Alpha, round 1, run 1", "signed off by chief", "not attempted", "from the video",
        "Detects a changed object", "no → not attempted", "Stopped due to timeout", "Waypoints reached", "0.123 m",
        "Referee: name, date, signature", "10.0.0.7", "Goal: waypoint 1", "dimmer: 40", result.record.identity,
        "2025-11-21 13:00:40 +01:00", "withdrawn by bert", "cable ",
    ):
        assert expected in text
    assert text.count(texts.visible(EVIL)) >= 7, "shown as it is, at all places"
    what, change, note = re.findall("<del>(.*?)</del>", page)
    assert (what, change, note[:9]) == ("Achievements: Detects a changed object", "1 → 3", "note &lt;")
    marks = [words.split()[0] for words in re.findall('class="mark">([^<]*)', page)]
    assert sorted(marks) == ["corrected", "correction", "withdrawn"]


def test_a_page_of_a_run_with_hardly_anything(writer):
    writer.run(task_record("Alpha", 1, started_utc=0.0, closed_utc=0.0, end_reason="", items=()), ())
    page = sheet_page(read(writer), in_utc=True)
    assert "not signed off: may still change" in page and "connected" in page
    assert "<svg" not in page


def test_a_sheet_without_a_robot_and_its_phases(writer):
    record = task_record("Alpha", 1)._replace(
        robots=(), phases=(PhaseTime("Enter", UTC0, 12.34), PhaseTime("Leave", UTC0 + 12.0, 600.0)))
    writer.run(record, robots=())
    writer.outcome(record)
    result = read(writer)
    lines = list(sheet_lines(result, in_utc=True, strike=False))
    assert "Robots:       none: scored by hand" in lines
    assert "Phases:       Enter 0:12.3, Leave 10:00.0" in lines
    assert "none: scored by hand" in sheet_page(result, in_utc=True)


@pytest.mark.parametrize("end", ["no_show", "withdrawn"])
def test_nobody_scores_a_team_that_does_not_run(writer, end):
    writer.run(task_record("Alpha", 1, started_utc=0.0, elapsed_s=0.0, end_reason=end, robots=()), robots=())
    for text in ("\n".join(sheet_lines(read(writer), True, False)), sheet_page(read(writer), in_utc=True)):
        assert "by hand" not in text


# -- goals ------------------------------------------------------------------------------------------


RECORD = task_record("Alpha", 1)
GOAL, STATE = "/rsbb_log/bmbox/goal", "/rsbb_log/rsbb_state_str"


def goals_of(*events):
    """The goals of a run with these events: kind, value, session, mono, UTC."""
    entries = tuple(
        JournalEntry(number, session, utc, mono, "fbm", RECORD.identity, 6667, "", kind, value)
        for number, (kind, value, session, mono, utc) in enumerate(events, 1))
    return goals(RunResult(1, RECORD, (RobotPart(6667, "Alpha", "r1", "", ()),), entries))


def given(text, *when):
    return GOAL, json.dumps({"text": text}), *when


def test_the_next_goal_and_the_states_of_the_box_end_a_goal():
    found = goals_of(
        given("first", 1, 1.0, 101.0), (STATE, "WAITING_RESULT", 1, 3.0, 103.0), given("second", 1, 8.0, 108.0),
        (STATE, "WAITING_RESULT", 1, 9.0, 109.0), ("/rsbb_log/result", "done", 1, 9.5, 109.5),
        (STATE, "PREPARE", 1, 10.5, 110.5), (STATE, "STOP", 1, 20.0, 120.0), given("third", 1, 21.0, 121.0))
    assert [(goal.text, goal.seconds, goal.result) for goal in found] == [
        ("first", 5.0, ""), ("second", 1.5, "done"), ("third", None, "")]


@pytest.mark.parametrize("step", [-3600.0, 7200.0])
def test_a_step_of_the_clock_does_not_change_how_long_a_goal_took(step):
    goal, = goals_of(given("one", 1, 1.0, 101.0), (STATE, "WAITING_RESULT", 1, 3.0, 103.0),
                     (STATE, "STOP", 1, 8.0, 108.0 + step))
    assert goal.seconds == 5.0


def test_a_goal_over_a_restart_of_the_computer():
    goal, = goals_of(given("one", 1, 501.0, 101.0), (STATE, "WAITING_RESULT", 1, 503.0, 103.0),
                     (STATE, "STOP", 2, 8.0, 143.0))
    assert goal.seconds == 40.0
