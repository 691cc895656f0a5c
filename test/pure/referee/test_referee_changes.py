"""The changes between two snapshots."""

import pytest

from helpers.forms import form
from helpers.referee_box import EVENTS, ITEMS, ROBOT, UTC0, asked, box, robot, running_zone, zone
from roah_rsbb.model.fields import form_of
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.zone import RunClock, Switches
from roah_rsbb.referee.state import changes, news


def _facts(old, new, **options):
    return [(change.kind, change.zone, change.facts) for change in changes(old, new, UTC0, **options)]


def test_nothing_happened():
    assert _facts(box(running_zone()), box(running_zone())) == []


def test_a_change_of_time_and_skew_alone_is_not_reported():
    old = box(running_zone())
    new = box(running_zone(clock=RunClock(), robot=ROBOT._replace(skew=0.02, messages_saved=4, silent_since=1.0)))
    assert _facts(old, new) == []


def test_a_change_has_the_boxs_time():
    new = box(running_zone(robot=ROBOT._replace(robot_state="EXECUTING")))
    assert [change.utc_s for change in changes(box(running_zone()), new, UTC0 + 5)] == [UTC0 + 5]


def test_the_states_are_reported_with_what_changed():
    (kind, name, facts), = _facts(box(running_zone()), box(running_zone(
        robot=ROBOT._replace(robot_state="EXECUTING", box_state="GOAL_TX"))))
    assert (kind, name) == ("state", "Home A")
    assert facts["changed"] == ["box_state", "robot_state"]
    assert (facts["phase"], facts["robot_state"]) == ("running", "EXECUTING")


def test_lines_are_reported_once_and_in_order():
    old = running_zone(log="a\nb\n", online_data="x\n")
    new = running_zone(log="a\nb\nc\nd\n", online_data="x\ny\n")
    assert _facts(box(old), box(new)) == [
        ("log", "Home A", {"text": "c"}), ("log", "Home A", {"text": "d"}), ("online_data", "Home A", {"text": "y"}),
    ]


def test_lines_continue_where_the_beginning_was_cut_off():
    lines = [f"12:00:{second:02d}Z a line long enough to be found again\n" for second in range(20)]
    found = changes(box(running_zone(log="".join(lines[:15]))), box(running_zone(log="".join(lines[5:18]))), UTC0)
    assert [change.facts["text"] + "\n" for change in found] == lines[15:18]


def test_the_next_runs_log_starts_empty():
    found = _facts(box(zone(log="old run\n")), box(zone(log="new\n")))
    assert found == [("log", "Home A", {"text": "new"})]


def test_a_warning_is_reported_once_although_the_core_logs_it_too():
    new = running_zone(log="12:00:00Z WARNING: No message for 4 s\nother\n", warnings=("No message for 3 s",))
    assert [(kind, facts["text"]) for kind, _, facts in _facts(box(running_zone()), box(new))] == [
        ("log", "other"), ("warning", "No message for 3 s")]


def test_a_score_is_reported_once_although_the_core_logs_it_too():
    old, new = running_zone(), running_zone(
        items=(ITEMS[0]._replace(value=1), *ITEMS[1:]), log="Score: Achievements: Detects the door 0 -> 1\nother\n")
    assert _facts(box(old), box(old._replace(log=new.log))) == [("log", "Home A", {"text": "other"})]
    assert _facts(box(old), box(new)) == [
        ("log", "Home A", {"text": "other"}),
        ("score", "Home A", {"number": 1, "group": "Achievements", "item": "Detects the door", "type": "bool",
                             "old": 0, "value": 1, "old_not_attempted": False, "not_attempted": False,
                             "old_text": "", "text": ""}),
    ]


def test_what_was_not_attempted_is_reported_although_the_value_stays():
    marked = running_zone(items=(ITEMS[0]._replace(not_attempted=True), *ITEMS[1:]))
    for old, new, reported in ((running_zone(), marked, (False, True)), (marked, running_zone(), (True, False))):
        ((kind, _, facts),) = _facts(box(old), box(new))
        assert (kind, facts["old"], facts["value"]) == ("score", 0, 0)
        assert (facts["old_not_attempted"], facts["not_attempted"]) == reported


def test_another_runs_sheet_is_not_a_change_of_scores():
    old = running_zone(items=(ITEMS[0]._replace(value=1), *ITEMS[1:]))
    assert "score" not in [kind for kind, _, _ in _facts(box(old), box(running_zone(identity="HGTKMH-6667-2")))]


def test_the_zone_moves_to_another_event():
    (kind, _, facts), = _facts(box(zone()), box(zone(event=EVENTS[1])))
    assert kind == "event"
    assert (facts["code"], facts["run"]) == ("HWV", 2)


@pytest.mark.parametrize("line", [
    "Score: Achievements: Detects the door 7 -> 7 (Anna: 8)",
    "Score: Achievements: Detects the door (entry 1 withdrawn)",
])
def test_a_line_on_an_item_that_stays_as_it_is(line: str):
    assert _facts(box(running_zone()), box(running_zone(log=f"{line}\n"))) == [("log", "Home A", {"text": line})]


def test_manual_operations_come_and_go():
    fields = form_of(form("done", "skip"))
    first = asked(running_zone(), 3, "Place the mug", *fields)
    facts = {"operation": 3, "text": "Place the mug", "choices": ["done", "skip"], "asks_text": False,
             "fields": list(fields)}
    assert _facts(box(running_zone()), box(first)) == [("manual_operation", "Home A", facts)]
    over = {"operation": 0, "text": "", "choices": [], "asks_text": False, "fields": []}
    assert _facts(box(first), box(running_zone())) == [("manual_operation", "Home A", over)]
    again = asked(running_zone(), 4, "Place the mug", *fields)
    assert _facts(box(first), box(again)) == [("manual_operation", "Home A", {**facts, "operation": 4})]


def test_what_the_module_says_and_scores():
    time = ScoreValue("goal 1", "time", "null", "s", "Time")
    old = running_zone(module_scores=(time,), module_status="Goal 1 of 2")
    new = running_zone(module_scores=(time._replace(value="1.5"), time), module_status="Goal 2 of 2")
    assert _facts(box(old), box(new)) == [
        ("module_score", "Home A", {**time._asdict(), "value": 1.5, "old": None}),
        ("module_status", "Home A", {"text": "Goal 2 of 2"}),
    ]
    assert _facts(box(new), box(running_zone())) == []


def test_switches_are_entered():
    old, new = (running_zone(switches=Switches((1,), damaged, False)) for damaged in (0, 1))
    entered = ("switches", "Home A", {"on": (1,), "damaged": 1, "to_confirm": False})
    assert _facts(box(old), box(new)) == _facts(box(running_zone()), box(new)) == [entered]
    assert _facts(box(old), box(running_zone())) == []


def test_robots_come_and_go():
    old, new = box(robots=(robot("a"),)), box(robots=(robot("b", skew=0.5),))
    assert _facts(old, new) == [
        ("robot", "", {"what": "came", "team": "TestingTeam", "robot": "b", "skew_s": 0.5}),
        ("robot", "", {"what": "gone", "team": "TestingTeam", "robot": "a", "skew_s": 0.0123}),
    ]


def test_warnings_come_and_end():
    old, new = box(running_zone(warnings=("a",)), warnings=("b",)), box(running_zone(warnings=()), warnings=("b", "c"))
    assert _facts(old, new) == [
        ("warning", "", {"text": "c", "over": False}), ("warning", "Home A", {"text": "a", "over": True}),
    ]


@pytest.mark.parametrize("old, new", [
    ("No message for 3 s", "No message for 4 s"), ("skew +0.150 s", "skew -0.2 s"),
])
def test_a_warning_with_other_numbers_is_the_same_one(old, new):
    assert news((old,), (new,)) == []


def test_a_restart_of_the_core_is_reported():
    assert _facts(box(), box(uuid="uuid-2")) == [("core", "", {"what": "restarted", "box_uuid": "uuid-2"})]


def test_one_zone_is_followed_with_its_own_teams_robots_and_the_whole_box():
    other = zone(zone="Home B", event=EVENTS[0]._replace(team="Others"))
    old = box(zone(), other, robots=())
    new = box(zone(log="a\n"), other._replace(log="b\n"), warnings=("w",),
              robots=(robot("mine"), robot("theirs", team="Others")))
    assert [(kind, name) for kind, name, _ in _facts(old, new, zone="Home A")] == [
        ("warning", ""), ("robot", ""), ("log", "Home A"),
    ]
    assert len(_facts(old, new)) == 5


def test_a_robot_does_not_come_because_the_zone_is_followed_to_its_teams_event():
    others = EVENTS[0]._replace(team="Others")
    assert "robot" not in [kind for kind, _, _ in _facts(box(zone()), box(zone(event=others)), zone="Home A")]


def test_of_a_zone_for_all_robots_those_of_all_teams_are_followed():
    of_all = zone(event=EVENTS[0]._replace(team="ALL"))
    assert [kind for kind, _, _ in _facts(box(of_all, robots=()), box(of_all), zone="Home A")] == ["robot"]
