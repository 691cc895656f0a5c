"""The wording of runs, score sheets and scores of modules."""

import pytest

from roah_rsbb.model.modules import ScoreValue
from roah_rsbb.model.reason import Reason
from roah_rsbb.model.records import GroupPoints, ItemRecord, SheetPoints
from roah_rsbb.model.scoring import INCIDENTS
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.sheets import GroupOfValues, HistoryEntry, score_line, scores_by_group, sums_text

ENTRY = HistoryEntry(7, 3600.0, "Anna", "Penalized", "Bumps", "uint", 1, False, 2, False)


def _texts(**fields):
    return sheets.entry_texts(ENTRY._replace(**fields), times.time_with_zone)


@pytest.mark.parametrize("type_, value, not_attempted, text", [
    ("uint", 0, False, "0"), ("uint", 3, False, "3"), ("bool", 0, False, "no"), ("bool", 1, False, "yes"),
    ("uint", 0, True, "not attempted"), ("bool", 0, True, "not attempted"), ("int", -3, False, "-3"),
    ("choice", 0, False, "–"), ("rating", 0, False, "–"), ("choice", 0, True, "not attempted"),
])
def test_the_value_of_an_item(type_, value, not_attempted, text):
    assert sheets.item_value(type_, value, not_attempted) == text


@pytest.mark.parametrize("type_, value, text", [("decimal", 2, "2.5"), ("choice", 1, "alone"), ("rating", 7, "7.333")])
def test_the_value_of_an_item_that_is_not_a_whole_number(type_, value, text):
    assert sheets.item_value(type_, value, False, text) == text
    assert sheets.item_value(type_, value, True, text) == "not attempted"


@pytest.mark.parametrize("kind, value, text, points, shown", [
    ("bool", 0, "", "-162.5", "by an incident"), ("uint", 0, "", "5", "by an incident"), ("bool", 0, "", "0", "no"),
    ("choice", 0, "", "-10", "by an incident"), ("decimal", 0, "0", "", "0"), ("bool", 1, "", "-10", "yes"),
])
def test_an_item_that_an_incident_marks(kind, value, text, points, shown):
    assert sheets.in_words(ItemRecord("G", "item", kind, value, text=text, points=points)) == shown
    assert sheets.item_text(SheetItem("G", "item", kind, value, text=text, points=points)) == shown


@pytest.mark.parametrize("for_team, text", [("", "200 points"), ("-7", "200 points, and -7 for the team")])
def test_points_for_the_team_are_beside_those_of_the_sheet(for_team, text):
    assert sheets.points_text(SheetPoints("200", (), for_team=for_team)) == text


def test_a_rating_in_the_history_names_its_judge():
    texts = _texts(type="rating", judge="Anna", old_text="", text="7.5")
    assert (texts.item, texts.change) == ("Penalized: Bumps (Anna)", "– → 7.5")
    assert sheets.mark_text(ENTRY._replace(type="rating", judge="Anna", text="7.5")) == "Bumps 7.5 (Anna)"


def test_a_percentage_has_its_unit_everywhere():
    percent = ENTRY._replace(type="decimal", old_text="60", text="80", unit="%")
    assert sheets.entry_texts(percent, times.time_with_zone).change == "60 % → 80 %"
    assert sheets.mark_text(percent) == "Bumps 80 %"
    assert sheets.mark_text(percent._replace(not_attempted=True)) == "Bumps not attempted"
    record = ItemRecord("Penalized", "Bumps", "decimal", 80, text="80", unit="%")
    assert sheets.in_words(record) == "80 %"
    assert sheets.proposal(record) == "80"  # settlements of earlier journals have it so


def test_the_drawer_of_incidents_says_what_happened():
    items = (SheetItem("Table", "Bumps", "uint", 1), SheetItem(INCIDENTS, "restart", "uint", 2),
             SheetItem(INCIDENTS, "absent", "uint"), SheetItem(INCIDENTS, "cheating", "uint", 1))
    assert sheets.incidents_text(items) == "Incidents: restart 2, cheating 1"
    assert sheets.incidents_text(items[2:3]) == "Incidents"


def test_points_do_not_list_what_is_part_of_another_group_or_gives_none():
    groups = (("Test", "370"), ("Commands", "400"), ("Special", "-5"), ("Bonus", "0"))
    points = SheetPoints("365", tuple(GroupPoints(*each) for each in groups), inner=("Commands",))
    assert sheets.points_text(points) == "365 points: Test 370 · Special -5"


def test_sums_by_group_and_how_many_items_were_not_attempted():
    groups = [
        GroupOfValues("Achievements", [1, 4, 0], 1), GroupOfValues("Empty", [], 0), GroupOfValues("Penalized", [2], 0)
    ]
    assert sums_text(groups) == "Achievements 5 (1 not attempted) · Penalized 2"
    assert sums_text([]) == ""


@pytest.mark.parametrize("started, closed, end, text", [
    (5.0, 9.0, "stopped", "stopped"), (5.0, 9.0, "timeout", "timeout"),
    (5.0, 0.0, "no_messages_saved", "no data saved"),
    (5.0, 9.0, "new_one", "new_one"), (5.0, 0.0, "", "running"), (0.0, 0.0, "", "connected"),
    (None, 9.0, "", "never started"),
])
def test_how_a_run_ended(started, closed, end, text):
    assert sheets.run_state(started, closed, end) == text


def test_which_run_it_is():
    assert sheets.run_name("HWV", "Beta", 1, 2) == "HWV, team Beta, round 1, run 2"


@pytest.mark.parametrize("closed, signed, text", [
    (0.0, 0.0, "open"), (9.0, 0.0, "not signed off"), (9.0, 10.0, "signed off"),
])
def test_how_far_a_sheet_is(closed, signed, text):
    assert sheets.sheet_state(closed, signed) == text


@pytest.mark.parametrize("signed, by, text", [
    (0.0, "", "not signed off"), (None, "", "not signed off"), (3661.0, "Cleo", "signed off by Cleo at 01:01:01Z"),
    (3661.0, "", "signed off at 01:01:01Z"),
])
def test_the_signature_of_a_sheet(signed, by, text):
    assert sheets.signature(signed, by, times.time_with_zone) == text


def test_an_entry_in_words():
    assert _texts() == ("7", "01:00:00Z", "Anna", "Penalized: Bumps", "1 → 2", "", "", "", "")
    assert _texts(type="bool", old_not_attempted=True).change == "not attempted → yes"
    assert (_texts(note="video", correction=True).note, _texts(correction=True).correction) == ("video", "correction")


@pytest.mark.parametrize("fields, text", [
    ({}, ""), ({"withdrawn_utc_s": 3661.0, "withdrawn_by": "Ben"}, "withdrawn by Ben at 01:01:01Z"),
    ({"withdrawn_utc_s": 3661.0, "withdrawal_corrects": True, "withdrawn_note": "why"},
     "withdrawn at 01:01:01Z, a correction: why"),
])
def test_an_entry_that_was_withdrawn(fields, text):
    assert _texts(**fields).withdrawn == text


def test_an_entry_in_one_line():
    assert sheets.entry_line(_texts()) == "01:00:00Z Anna: Penalized: Bumps: 1 → 2"
    full = _texts(who="", note="video", correction=True, withdrawn_utc_s=3661.0)
    assert sheets.entry_line(full) == "01:00:00Z Penalized: Bumps: 1 → 2 (video); correction; withdrawn at 01:01:01Z"
    late = _texts(void=Reason("after the limit of {limit}", {"limit": "7:00"}))
    assert sheets.entry_line(late).endswith(": 1 → 2; after the limit of 7:00")
    assert sheets.entry_line(_texts(in_time=True)).endswith(": 1 → 2; in time")
    assert sheets.entry_line(_texts(in_time=True, in_time_by="Ben (/web)")).endswith(": 1 → 2; in time, says Ben")
    again = _texts(in_time_by="Ben", void=Reason("after the limit of {limit}", {"limit": "7:00"}))
    assert sheets.entry_line(again).endswith(": 1 → 2; after the limit of 7:00; late, says Ben")
    assert sheets.entry_line(full, "<{}>".format).endswith("(video); <correction>; <withdrawn at 01:01:01Z>")


@pytest.mark.parametrize("who, role, device, text", [
    ("Anna (/web)", "judge", "phone 3", "Anna, judge, phone 3 (/web)"), ("Anna (/web)", "referee", "", "Anna (/web)"),
    ("Anna", "judge", "", "Anna, judge"), ("/web", "", "phone 3", "phone 3 (/web)"), ("/web", "", "", "/web"),
    ("", "", "", ""), ("Anna (Lisbon)", "organiser", "", "Anna (Lisbon), organiser"),
])
def test_who_made_an_entry(who, role, device, text):
    assert sheets.author(who, role, device) == text
    assert sheets.node_of(text) == sheets.node_of(who)


@pytest.mark.parametrize("reason, by, stopped_by, text", [
    ("", "", "Anna", ""), ("", "Ben", "Anna", ""), ("fire", "Anna", "Anna", "fire"),
    ("fire", "Ben", "Anna", "fire (Ben)"),
])
def test_why_a_run_was_stopped(reason, by, stopped_by, text):
    assert sheets.stop_reason(reason, by, stopped_by) == text


@pytest.mark.parametrize(("who", "person", "node"), [
    ("Anna (/roah_rsbb_window_1_2)", "Anna", "/roah_rsbb_window_1_2"), ("Anna", "Anna", ""), ("", "", ""),
    ("/roah_rsbb_window", "no name", "/roah_rsbb_window"), ("Anna (Lisbon)", "Anna (Lisbon)", ""),
    ("Anna (Lisbon) (/a/b)", "Anna (Lisbon)", "/a/b"), ("and/or", "and/or", ""),
])
def test_people_are_shown_and_their_nodes_are_kept_apart(who, person, node):
    assert (sheets.person(who), sheets.node_of(who)) == (person, node)


def test_no_node_is_shown_in_texts_for_people():
    texts = _texts(who="Anna (/rqt)", withdrawn_utc_s=3605.0, withdrawn_by="Ben (/rqt)")
    assert texts.who == "Anna"
    assert texts.withdrawn == "withdrawn by Ben at 01:00:05Z"
    assert sheets.signature(3600.0, "Cleo (/rqt)", times.time_with_zone) == "signed off by Cleo at 01:00:00Z"
    assert sheets.stop_reason("fire", "Ben (/rqt)", "Anna (/rqt)") == "fire (Ben)"


@pytest.mark.parametrize(("name", "end", "text"), [
    ("idle", "", "NOT CONNECTED"), ("running", "", "RUNNING"), ("ended", "stopped", "ENDED: stopped"),
    ("dreaming", "", "DREAMING"),
])
def test_the_phase_of_a_zone_has_the_same_words_everywhere(name, end, text):
    assert sheets.phase(name, end) == text


@pytest.mark.parametrize(("fields", "text"), [
    ({}, "Bumps +1"), ({"old": 3, "value": 1}, "Bumps -2"),
    ({"value": 0, "not_attempted": True}, "Bumps not attempted"),
    ({"type": "bool", "old": 0, "value": 1}, "Bumps yes"), ({"type": "bool", "old": 1, "value": 0}, "Bumps no"),
])
def test_a_mark_says_what_it_did(fields, text):
    assert sheets.mark_text(ENTRY._replace(**fields)) == text


def test_the_last_marks_that_count_can_be_undone():
    history = [ENTRY._replace(number=n, withdrawn_utc_s=9.0 if n == 6 else None) for n in range(1, 8)]
    assert [entry.number for entry in sheets.to_undo(history, 5)] == [7, 5, 4, 3, 2]


# -- scores of benchmarking modules ---------------------------------------------------------------


@pytest.mark.parametrize("value, unit, text", [
    ("12", "", "12"), ("0.12399999", "m", "0.124 m"), ("2.0", "s", "2 s"), ("-0.0004", "rad", "0 rad"),
    ("true", "", "yes"), ("false", "", "no"), ("null", "m", "–"), ('"mug"', "", "mug"), ('""', "", ""),
    ("[1, 2]", "m", "[1, 2] m"), ("no JSON", "", "no JSON"), ("1e400", "", "inf"), ("NaN", "m", "nan m"),
])
def test_a_value_and_its_unit(value, unit, text):
    assert score_line(ScoreValue("", "x", value, unit)).value == text


def test_the_name_is_the_description_or_made_from_the_name():
    assert score_line(ScoreValue("", "distance_error", "1", "m", "Distance to the waypoint")).name == (
        "Distance to the waypoint"
    )
    assert score_line(ScoreValue("", "distance_error", "1", "m")).name == "distance error"


def test_groups_keep_their_order_and_the_whole_run_comes_first():
    scores = [
        ScoreValue("waypoint 2", "time", "3", "s"), ScoreValue("", "reached", "1", ""),
        ScoreValue("waypoint 1", "time", "4", "s"), ScoreValue("waypoint 2", "reached", "true", ""),
    ]
    assert scores_by_group(scores) == [
        ("Whole run", [("reached", "1")]),
        ("waypoint 2", [("time", "3 s"), ("reached", "yes")]),
        ("waypoint 1", [("time", "4 s")]),
    ]
    assert scores_by_group([]) == []
