"""From the values of the box to JSON."""

import json
import pathlib

from helpers.forms import form
from helpers.referee_box import ITEMS, MONO0, NOW, ROBOT, RUN_CLOCK, UTC0, asked, box, robot, running_zone, zone
from roah_rsbb.model.actions import ACTIONS, Shown
from roah_rsbb.model.fields import Choice, form_of
from roah_rsbb.model.records import GroupPoints, ScoreValue, SheetPoints
from roah_rsbb.model.results import EventSeen, HistoryEntry, RunEnd, RunLine, RunSheet
from roah_rsbb.model.zone import AllRobots, Count, RunClock, SheetItem, Switches
from roah_rsbb.referee.state import as_json, box_json, scheduled_json, sheet_json, zone_json, zones_of
from roah_rsbb.referee.view import Style, zone_lines
from roah_rsbb.referee.words import command_of


def _zone(seconds=0.0, **fields):
    """A running zone as JSON, so long after its values were made."""
    return as_json(zone_json(running_zone(**fields), NOW.later(seconds)))


def test_a_box_as_json():
    made = json.loads(json.dumps(as_json(box_json(
        box(running_zone(), robots=(robot(), robot("late", silent_since=MONO0 - 2.0)), warnings=("w",)), NOW))))
    assert (made["clock_utc_s"], made["box_uuid"], made["warnings"], made["port"]) == (UTC0, "uuid-1", ["w"], "6666")
    assert made["robots"] == [
        {"team": "TestingTeam", "robot": "mbot", "skew_s": 0.0123, "last_heard_utc_s": UTC0, "age_s": 0.0},
        {"team": "TestingTeam", "robot": "late", "skew_s": 0.0123, "last_heard_utc_s": UTC0 - 2.0, "age_s": 2.0}]
    assert [one["zone"] for one in made["zones"]] == ["Home A"]


def test_the_zones_have_the_order_of_the_schedule():
    shown = box(zone(zone="B"), zone(zone="A"))
    assert [one.zone for one in zones_of(shown._replace(zones=dict(sorted(shown.zones.items()))))] == ["B", "A"]


def test_a_zone_as_json():
    made = _zone(state=("first", "second"), warnings=("w",), off={name: [f"why no {name}"] for name in ACTIONS})
    assert made["event"] == {"code": "HGTKMH", "name": "Name of HGTKMH", "desc": "What HGTKMH is",
                             "team": "TestingTeam", "round": 1, "run": 1, "scheduled_utc_s": UTC0 + 600.0,
                             "timeout_s": 600.0}
    assert (made["phase"], made["robot"], made["port"], made["timer_s"]) == ("running", "mbot", 6667, 45.0)
    assert (made["state"], made["warnings"]) == (["first", "second", "WARNING: w"], ["w"])
    assert (made["skew_s"], made["last_message_utc_s"], made["messages_saved"]) == (0.0123, UTC0, 0)
    assert made["off"]["previous"] == ["why no previous"]
    assert [item["number"] for item in made["score"]] == [1, 2, 3]
    assert made["score"][0] == {"number": 1, "group": "Achievements", "item": "Detects the door", "type": "bool",
                                "value": 0, "not_attempted": False, "text": "", "points": "", "choices": [],
                                "judges": [], "ratings": []}


def test_what_needs_a_confirmation_is_not_allowed_without_it_and_has_the_name_of_its_command():
    seen = zone(actions={"open_sheet": Shown(question="Signed off"),
                         "connect": Shown(("No robot",), question="Signed off"), "choose_event": Shown()})
    assert as_json(zone_json(seen, NOW))["off"] == {
        "open-sheet": ["Signed off. Give --again for another attempt"],
        "connect": ["No robot", "Signed off. Give --again for another attempt"], "choose": []}
    assert zone_lines(seen, NOW, Style())[-1].strip() == "allowed now: choose"


def test_a_robot_that_is_silent_was_heard_before():
    silent = ROBOT._replace(silent_since=MONO0 - 3.0)
    assert _zone(1.0, robot=silent)["last_message_utc_s"] == UTC0 - 3.0
    assert _zone(robot=ROBOT._replace(heard=False))["last_message_utc_s"] is None


def test_points_of_the_sheet():
    points = SheetPoints("85", (GroupPoints("Good", "100"), GroupPoints("Bad", "-15")))
    assert _zone(points=points)["points"] == "85 points: Good 100 · Bad -15"


def test_what_a_benchmarking_module_asks_and_says():
    scores = (ScoreValue("goal 1", "time", "1.5", "s", "Time"), ScoreValue("", "odd", "no JSON", ""))
    seen = running_zone(held=True, module_status="Goal 1", module_scores=scores, switches=Switches((1, 3), 2, False))
    hidden = {name: Shown((), False) for name in ("switch", "damaged", "confirm_switches")}
    seen = seen._replace(actions={**seen.actions, **hidden})
    made = as_json(zone_json(asked(seen, 4, "Place it", *form_of(form("again", "skip", asks_text=True))), NOW))
    operation = made["operation"]
    assert (operation["number"], operation["text"], operation["choices"], operation["asks_text"]) == (
        4, "Place it", ["again", "skip"], True)
    assert operation["fields"][0] == {
        "kind": "choice", "name": "answer", "label": "Answer", "required": True, "choices": ("again", "skip")}
    assert "done" in made["off"] and "switch" not in made["off"]
    assert made["switches"] == {"on": [1, 3], "damaged": 2, "to_confirm": False}
    assert (made["held"], made["module_status"]) == (True, "Goal 1")
    assert [score["value"] for score in made["module_score"]] == [1.5, "no JSON"]


def test_all_robots_at_once():
    made = _zone(robot=None, all_robots=AllRobots(6667, 1, 0, 1, ("a of team T: preparing", "b of team T: ready")))
    assert made["all_robots"] == {"preparing": 1, "executing": 0, "stopped": 1,
                                  "robots": ["a of team T: preparing", "b of team T: ready"]}
    assert (made["robot"], made["port"]) == ("2 robots", 6667)


def test_the_times_of_a_run_are_those_of_the_panels():
    times = _zone(0.5)["times"]
    assert times["text"] == ["Run: time left 8:32", "Goal: time left 0:45", "Used: 1:28 of 10:00"]
    assert (times["elapsed_s"], times["counting"], times["goal"], times["goal_elapsed_s"]) == (88.2, True, 2, 15.5)
    stopped = RUN_CLOCK._replace(elapsed=Count(100.0), paused="the mug")
    times = _zone(0.5, clock=stopped)["times"]
    assert (times["pause"], times["elapsed_s"], times["text"][0]) == ("PAUSED: the mug", 100.0, "Run: time left 8:20")
    ended = RunClock(600.0, Count(100.0), after_stop_until=MONO0 + 30.0)
    times = _zone(0.5, phase="ended", clock=ended)["times"]
    assert (times["after_stop_s"], times["text"]) == (
        29.5, ["Final time of the run 1:40.0", "Time left after the stop: 0:30"])


def test_phases_setup_time_and_attempts():
    robots = (Choice("robot", ACTIONS["connect"].fields[0].label, False, ("a", "b")),)
    clock = RunClock(600.0, phases=3, phase_number=2, phase_name="Serve", phase_limit=60.0,
                     phase_elapsed=Count(10.0, MONO0))
    seen = running_zone(by_hand=True, attempt=1, attempts=2, not_stopped=("a of team T",), clock=clock,
                        robot=None)
    made = as_json(zone_json(seen._replace(actions={**seen.actions, "connect": Shown(fields=robots)}), NOW.later(0.5)))
    assert (made["by_hand"], made["attempt"], made["attempts"], made["robots_to_choose"]) == (True, 1, 2, ["a", "b"])
    assert made["not_stopped"] == ["a of team T"]
    times = made["times"]
    assert (times["phase"], times["phase_name"], times["phase_limit_s"], times["phase_elapsed_s"]) == (
        2, "Serve", 60.0, 10.5)
    assert "Phase 2 of 3, Serve: time left 0:50" in times["text"]
    times = _zone(0.5, phase="connected", clock=RunClock(setup_limit=60.0, setup_elapsed=Count(10.0, MONO0)))["times"]
    assert (times["setup_limit_s"], times["setup_elapsed_s"], times["setup_counting"]) == (60.0, 10.5, True)


RUN = RunLine("HWV-1", 7, "Home A", "HWV", "T", 1, 2, UTC0)
SHEET = RunSheet(
    RUN, ("mbot",), 12.0, (ITEMS[0], ITEMS[1]._replace(corrected=True)),
    (HistoryEntry(1, UTC0, "Anna", "Achievements", "Detects the door", "bool", 0, False, 1, False),),
    (RunEnd(1, UTC0, "Anna", "stopped", "Stopped", "fire"),))


def test_a_sheet_as_json():
    made = as_json(sheet_json(SHEET))
    assert (made["run"]["identity"], made["robots"], made["corrected"]) == ("HWV-1", ["mbot"], [2])
    assert "revision" not in made["run"]
    assert (made["history"][0]["who"], made["ends"][0]["reason"], made["points"]) == ("Anna", "fire", "")


def test_an_event_of_the_schedule_as_json():
    event = EventSeen("e1", 1, "Home A", "HWV", "Welcoming", "T", 1, 1, UTC0, UTC0 + 60.0, "later", False)
    made = as_json(scheduled_json(event))
    assert (made["late_s"], made["signed_utc_s"], "id" in made) == (60.0, None, False)


def test_the_documentation_names_every_field():
    text = (pathlib.Path(__file__).resolve().parents[3] / "docs" / "referee.md").read_text(encoding="utf-8")
    whole = asked(running_zone(
        items=(SheetItem("G", "poster", "rating"),), module_scores=(ScoreValue("", "n", "1", ""),),
        switches=Switches((1,), 0, True), all_robots=AllRobots(1, 0, 0, 1, ("r",))), 1, "Place it")
    event = EventSeen("e1", 1, "Home A", "HWV", "Welcoming", "T", 1, 1, UTC0, UTC0, "later", False)
    made = [as_json(one) for one in (box_json(box(whole), NOW), sheet_json(SHEET), scheduled_json(event))]
    assert not {name for name in _names(made) - set(map(command_of, ACTIONS)) if f"`{name}`" not in text}


def _names(made):
    """All names in JSON."""
    if isinstance(made, dict):
        return set(made).union(*map(_names, made.values()))
    return set().union(*map(_names, made)) if isinstance(made, list) else set()
