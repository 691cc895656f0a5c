"""The changes between two snapshots."""

import pytest

from helpers.forms import form
from helpers.referee_box import EVENTS, ITEMS, ROBOT, UTC0, asked, box, robot, running_zone, zone
from roah_rsbb.model.fields import form_of
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.zone import RunClock, Switches
from roah_rsbb.referee.state import changes, news

RUNNING = running_zone()
DOOR_MARKED = (ITEMS[0]._replace(value=1), *ITEMS[1:])
NOT_ATTEMPTED = (ITEMS[0]._replace(not_attempted=True), *ITEMS[1:])
LINES = [f"12:00:{second:02d}Z a line long enough to be found again" for second in range(20)]
FIELDS = form_of(form("done", "skip"))
TIME = ScoreValue("goal 1", "time", "null", "s", "Time")
SCORED = {"module_scores": (TIME._replace(value="1.5"), TIME), "module_status": "Goal 2 of 2"}


def _facts(old, new, **options):
    return [(change.kind, change.zone, change.facts) for change in changes(old, new, UTC0, **options)]


def of_zone(kind, **facts):
    """A change in the zone."""
    return kind, "Home A", facts


def log(*lines):
    """Lines of the log."""
    return [of_zone("log", text=line) for line in lines]


def scored(**facts):
    """A change of the first item."""
    return of_zone("score", **{
        "number": 1, "group": "Achievements", "item": "Detects the door", "type": "bool", "old": 0, "value": 0,
        "old_not_attempted": False, "not_attempted": False, "old_text": "", "text": "", "unit": "", **facts})


def to_do(number, *fields):
    """A manual operation is asked for; 0: it is over."""
    return of_zone("manual_operation", operation=number, text="Place the mug" if number else "",
                   choices=["done", "skip"] if number else [], asks_text=False, fields=list(fields))


@pytest.mark.parametrize("old, new, facts", [
    ({}, {}, []),
    # Times and skews alone are not reported.
    ({}, {"clock": RunClock(), "robot": ROBOT._replace(skew=0.02, messages_saved=4, silent_since=1.0)}, []),
    # Lines, once and in order, also where the beginning was cut off, and in the next run.
    ({"log": "a\nb\n", "online_data": "x\n"}, {"log": "a\nb\nc\nd\n", "online_data": "x\ny\n"},
     [*log("c", "d"), of_zone("online_data", text="y")]),
    ({"log": "\n".join(LINES[:15])}, {"log": "\n".join(LINES[5:18])}, log(*LINES[15:18])),
    ({"log": "old run\n"}, {"log": "new\n"}, log("new")),
    # A warning and a score are reported once, although the core logs them, too.
    ({}, {"log": "12:00:00Z WARNING: No message for 4 s\nother\n", "warnings": ("No message for 3 s",)},
     [*log("other"), of_zone("warning", text="No message for 3 s", over=False)]),
    ({}, {"log": "Score: Achievements: Detects the door 0 -> 1\nother\n"}, log("other")),
    ({}, {"items": DOOR_MARKED, "log": "Score: Achievements: Detects the door 0 -> 1\nother\n"},
     [*log("other"), scored(value=1)]),
    *(({}, {"log": f"{line}\n"}, log(line)) for line in (  # on an item that stays as it is
        "Score: Achievements: Detects the door 7 -> 7 (Anna: 8)",
        "Score: Achievements: Detects the door (entry 1 withdrawn)")),
    # What was not attempted, although the value stays.
    ({}, {"items": NOT_ATTEMPTED}, [scored(not_attempted=True)]),
    ({"items": NOT_ATTEMPTED}, {}, [scored(old_not_attempted=True)]),
    # Another run's sheet is no change of scores.
    ({"items": DOOR_MARKED}, {"identity": "HGTKMH-6667-2"}, []),
    # What benchmarking modules ask and say.
    ({"module_scores": (TIME,), "module_status": "Goal 1 of 2"}, SCORED, [
        of_zone("module_score", **{**TIME._asdict(), "value": 1.5, "old": None}),
        of_zone("module_status", text="Goal 2 of 2")]),
    (SCORED, {}, []),
    ({"switches": Switches((1,), 0, False)}, {"switches": Switches((1,), 1, False)},
     [of_zone("switches", on=(1,), damaged=1, to_confirm=False)]),
    ({}, {"switches": Switches((1,), 1, False)}, [of_zone("switches", on=(1,), damaged=1, to_confirm=False)]),
    ({"switches": Switches((1,), 0, False)}, {}, []),
])
def test_changes_in_a_zone(old, new, facts):
    assert _facts(box(running_zone(**old)), box(running_zone(**new))) == facts


@pytest.mark.parametrize("old, new, facts", [
    (0, 3, [to_do(3, *FIELDS)]), (3, 0, [to_do(0)]), (3, 4, [to_do(4, *FIELDS)]), (3, 3, []),
])
def test_manual_operations_come_and_go(old, new, facts):
    zones = (asked(RUNNING, number, "Place the mug", *FIELDS) if number else RUNNING for number in (old, new))
    assert _facts(*map(box, zones)) == facts


def test_the_states_are_reported_with_what_changed_and_the_boxs_time():
    new = box(running_zone(robot=ROBOT._replace(robot_state="EXECUTING", box_state="GOAL_TX")))
    change, = changes(box(RUNNING), new, UTC0 + 5)
    assert (change.utc_s, change.kind, change.zone) == (UTC0 + 5, "state", "Home A")
    assert change.facts["changed"] == ["box_state", "robot_state"]
    assert (change.facts["phase"], change.facts["robot_state"]) == ("running", "EXECUTING")


@pytest.mark.parametrize("old, new, facts", [
    (box(robots=(robot("a"),)), box(robots=(robot("b", skew=0.5),)), [
        ("robot", "", {"what": "came", "team": "TestingTeam", "robot": "b", "skew_s": 0.5}),
        ("robot", "", {"what": "gone", "team": "TestingTeam", "robot": "a", "skew_s": 0.0123})]),
    (box(running_zone(warnings=("a",)), warnings=("b",)), box(running_zone(warnings=()), warnings=("b", "c")), [
        ("warning", "", {"text": "c", "over": False}), of_zone("warning", text="a", over=True)]),
    (box(), box(uuid="uuid-2"), [("core", "", {"what": "restarted", "box_uuid": "uuid-2"})]),
])
def test_changes_of_the_box(old, new, facts):
    assert _facts(old, new) == facts


@pytest.mark.parametrize("old, new", [
    ("No message for 3 s", "No message for 4 s"), ("skew +0.150 s", "skew -0.2 s"),
])
def test_a_warning_with_other_numbers_is_the_same_one(old, new):
    assert news((old,), (new,)) == []


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
