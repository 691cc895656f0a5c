"""From the core's messages to plain values and JSON."""

import json
import pathlib
from types import SimpleNamespace

from helpers.commands import actions_text
from helpers.forms import form, shown_form
from helpers.referee_box import UTC0, box, robot, running_zone
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.fields import Choice, form_of
from roah_rsbb.referee import sheets
from roah_rsbb.referee.state import (
    BoxSnapshot,
    EventSnapshot,
    ManualOperation,
    ModuleScoreLine,
    RobotSnapshot,
    RunTimes,
    SheetItem,
    SwitchesSnapshot,
    ZoneSnapshot,
    as_json,
    box_of,
)


class Seconds(float):
    """A ROS time or duration."""

    def to_sec(self) -> float:
        return float(self)


class Clock(Seconds):
    """A moment; the difference of two is a duration."""

    def __sub__(self, other: float) -> Seconds:
        return Seconds(float(self) - float(other))


def _gui(*zones):
    robots = [SimpleNamespace(team="T", robot="mbot", skew=Seconds(-0.15), beacon=Seconds(UTC0 - 2))]
    return SimpleNamespace(clock=Clock(UTC0), status="OK", addr="127.255.255.255", port="6666", active_robots=robots,
                           zones=zones)


def _item(group, desc, type_, value, **fields):
    default = {"not_attempted": False, "text": "", "points": "", "choices": [], "judges": [], "ratings": []}
    return SimpleNamespace(group=group, desc=desc, type=type_, value=value, **{**default, **fields})


ITEMS = [_item("Good", "door", 0, 1), _item("Good", "things", 1, 3), _item("Bad", "bumps", 1, 0)]


def _zone_state():
    return SimpleNamespace(
        zone="Home A", code="HWV", name="Name", desc="What", team="T", round=2, run=3, schedule=Seconds(UTC0 + 60),
        timeout=Seconds(600), timer=Seconds(12.5), state="first\nsecond", manual_operation="",
        log="log\n", online_data="data\n", omf=False, omf_switches=b"", omf_damaged=0, omf_complete=False,
    )


def _details(**fields):
    default = {
        "zone": "Home A", "phase": "running", "identity": "HWV-1", "end_reason": "", "robot": "mbot", "port": 6667,
        "box_state": "PREPARE", "robot_state": "STOP", "skew_known": True, "skew": Seconds(-0.15),
        "last_message": Seconds(UTC0 - 1), "messages_saved": 7, "log_file": "/x.bag", "warnings": ["w"], "operation": 0,
        "held": False, "module_status": "", "module_scores": [],
        "robots_preparing": 0, "robots_executing": 0, "robots_stopped": 0, "robots": [],
        "items": ITEMS, "points": SimpleNamespace(total="", groups=[]),
        "by_hand": False, "attempt": 0, "attempts": 0, "not_stopped": [],
        "actions": actions_text({name: [f"why no {name}"] for name in ACTIONS}),
    }
    return SimpleNamespace(box_uuid="u", warnings=["box"], zones=[SimpleNamespace(**{**default, **fields})])


def _clocks(zone="Home A", **fields):
    default = {
        "zone": zone, "identity": "HWV-1", "phase": "running", "limit": Seconds(600), "elapsed": Seconds(100),
        "counting": True, "paused": "", "goal_limit": Seconds(60), "goal": 2, "goal_elapsed": Seconds(20),
        "goal_counting": True, "after_stop": Seconds(0), "setup_limit": Seconds(0), "setup_elapsed": Seconds(0),
        "setup_counting": False, "phases": 0, "phase_number": 0, "phase_name": "", "phase_limit": Seconds(0),
        "phase_elapsed": Seconds(0),
    }
    return SimpleNamespace(clock=Clock(UTC0 - 0.5), zones=[SimpleNamespace(**{**default, **fields})])


def test_the_messages_make_one_snapshot():
    seen = box_of(_gui(_zone_state()), _details(), _clocks())
    zone = seen.zone("Home A")
    assert (seen.clock_utc_s, seen.box_uuid, seen.warnings) == (UTC0, "u", ("box",))
    assert seen.robots[0] == ("T", "mbot", -0.15, UTC0 - 2, 2.0)
    assert zone.event == ("HWV", "Name", "What", "T", 2, 3, UTC0 + 60, 600.0)
    assert (zone.phase, zone.port, zone.timer_s, zone.state) == ("running", 6667, 12.5, ("first", "second"))
    assert (zone.skew_s, zone.last_message_utc_s, zone.messages_saved) == (-0.15, UTC0 - 1, 7)
    assert zone.off["previous"] == ["why no previous"]
    assert zone.off["connect"] == ["why no connect"]
    assert zone.score == (
        SheetItem(1, "Good", "door", "bool", 1), SheetItem(2, "Good", "things", "uint", 3),
        SheetItem(3, "Bad", "bumps", "uint", 0),
    )


def test_items_of_every_type():
    items = [
        _item("G", "water", 3, 2, text="2.5", points="-5"), _item("G", "help", 4, 1, text="alone", choices=["alone"]),
        _item("G", "poster", 5, 7, text="7", judges=["1", "2"], ratings=["7", ""]), _item("G", "of the future", 9, 1),
    ]
    assert box_of(_gui(_zone_state()), _details(items=items), _clocks()).zones[0].score == (
        SheetItem(1, "G", "water", "decimal", 2, text="2.5", points="-5"),
        SheetItem(2, "G", "help", "choice", 1, text="alone", choices=("alone",)),
        SheetItem(3, "G", "poster", "rating", 7, text="7", judges=("1", "2"), ratings=("7", "")),
        SheetItem(4, "G", "of the future", "uint", 1),
    )


def test_points_of_the_sheet():
    points = SimpleNamespace(total="85", groups=[
        SimpleNamespace(name="Good", points="100"), SimpleNamespace(name="Bad", points="-15")])
    assert box_of(_gui(_zone_state()), _details(points=points), _clocks()).zones[0].points == (
        "85 points: Good 100 · Bad -15")
    assert box_of(_gui(_zone_state()), _details(), _clocks()).zones[0].points == ""


def test_not_attempted_items_are_marked():
    items = [*ITEMS[:2], _item("Bad", "bumps", 1, 0, not_attempted=True)]
    zone = box_of(_gui(_zone_state()), _details(items=items), _clocks()).zones[0]
    assert [item.not_attempted for item in zone.score] == [False, False, True]


def test_unknown_values_are_none():
    zone = box_of(_gui(_zone_state()), _details(skew_known=False, last_message=Seconds(0)), _clocks()).zones[0]
    assert (zone.skew_s, zone.last_message_utc_s) == (None, None)


def test_what_a_benchmarking_module_asks_and_says():
    state = _zone_state()
    state.manual_operation, state.omf, state.omf_switches, state.omf_damaged = "Place it", True, b"\x01\x03", 2
    scores = [SimpleNamespace(group="goal 1", name="time", value="1.5", unit="s", desc="Time"),
              SimpleNamespace(group="", name="odd", value="no JSON", unit="", desc="")]
    fields = form_of(form("again", "skip", asks_text=True))
    zone = box_of(_gui(state), _details(
        operation=4, actions=actions_text(asked=shown_form(4, fields, "Place it")), held=True, module_status="Goal 1",
        module_scores=scores,
    ), _clocks()).zones[0]
    assert zone.operation == (4, "Place it", ("again", "skip"), True, fields)
    assert as_json(zone.operation)["fields"][0] == {
        "kind": "choice", "name": "answer", "label": "Answer", "required": True, "choices": ("again", "skip")}
    assert "operation" in zone.off and "switch" not in zone.off
    assert zone.switches == ((1, 3), 2, False)
    assert (zone.held, zone.module_status) == (True, "Goal 1")
    assert zone.module_score == (("goal 1", "time", 1.5, "s", "Time"), ("", "odd", "no JSON", "", ""))


def test_all_robots_at_once():
    zone = box_of(_gui(_zone_state()), _details(
        robot="2 robots", robots_preparing=1, robots_stopped=1, robots=["a of team T: preparing", "b of team T: ready"],
    ), _clocks()).zones[0]
    assert zone.all_robots == (1, 0, 1, ("a of team T: preparing", "b of team T: ready"))
    assert box_of(_gui(_zone_state()), _details(), _clocks()).zones[0].all_robots is None


def test_what_is_not_asked_any_more_is_ignored():
    assert box_of(_gui(_zone_state()), _details(operation=4), _clocks()).zones[0].operation is None


def test_the_times_of_a_run_are_those_of_the_panels():
    times = box_of(_gui(_zone_state()), _details(), _clocks()).zones[0].times
    text = ("Run: time left 8:20", "Goal: time left 0:40", "Used: 1:40 of 10:00")
    assert times[:10] == (text, "", 600.0, 100.5, True, 2, 60.0, 20.5, True, 0.0)
    times = box_of(_gui(_zone_state()), _details(), _clocks(counting=False, paused="the mug")).zones[0].times
    assert (times.pause, times.elapsed_s, times.text[0]) == ("PAUSED: the mug", 100.0, "Run: time left 8:20")
    stopped = _clocks(phase="ended", counting=False, goal_counting=False, after_stop=Seconds(30))
    times = box_of(_gui(_zone_state()), _details(phase="ended"), stopped).zones[0].times
    assert (times.after_stop_s, times.text[0]) == (29.5, "Final time of the run 1:40.0")
    assert times.text[1:] == ("Time left after the stop: 0:30",)


def test_times_of_another_run_are_waited_for():
    for other in ({"phase": "connected"}, {"identity": "HWV-2"}, {"zone": "Home B"}):
        assert box_of(_gui(_zone_state()), _details(), _clocks(**other)) is None


def test_messages_of_two_schedules_do_not_go_together():
    assert box_of(_gui(_zone_state()), _details(zone="Home B"), _clocks()) is None
    assert box_of(_gui(), _details(), _clocks()) is None


def test_a_robot_is_never_heard_in_the_future():
    gui = _gui(_zone_state())
    gui.active_robots[0].beacon = Seconds(UTC0 + 1)
    assert box_of(gui, _details(), _clocks()).robots[0].age_s == 0.0


def test_json_has_the_names_of_the_fields_all_the_way_down():
    made = json.loads(json.dumps(as_json(box(running_zone(), robots=(robot(),)))))
    zone = made["zones"][0]
    assert zone["event"]["code"] == "HGTKMH"
    assert zone["score"][0] == {"number": 1, "group": "Achievements", "item": "Detects the door", "type": "bool",
                                "value": 0, "not_attempted": False, "text": "", "points": "", "choices": [],
                                "judges": [], "ratings": []}
    assert zone["off"]["connect"] == []
    assert made["robots"][0]["skew_s"] == 0.0123


def test_the_documentation_names_every_field():
    text = (pathlib.Path(__file__).resolve().parents[3] / "docs" / "referee.md").read_text(encoding="utf-8")
    kinds = (
        BoxSnapshot, RobotSnapshot, ZoneSnapshot, EventSnapshot,
        SheetItem, ManualOperation, SwitchesSnapshot,
        ModuleScoreLine, RunTimes, sheets.RunLine, sheets.Sheet, sheets.HistoryEntry,
        sheets.RunEnd,
    )
    missing = [f"{kind.__name__}.{field}" for kind in kinds for field in kind._fields if f"`{field}`" not in text]
    assert not missing


def test_phases_setup_time_and_attempts_are_in_the_snapshot():
    clocks = _clocks(phases=3, phase_number=2, phase_name="Serve", phase_limit=Seconds(60), phase_elapsed=Seconds(10),
                     goal=0)
    label = ACTIONS["connect"].fields[0].label
    off, robots = {"no_show": ["why no no_show"]}, (Choice("robot", label, False, ("a", "b")),)
    details = _details(by_hand=True, attempt=1, attempts=2, actions=actions_text(off, fields={"connect": robots}),
                       not_stopped=["a of team T"])
    zone, = box_of(_gui(_zone_state()), details, clocks).zones
    assert (zone.by_hand, zone.attempt, zone.attempts, zone.robots_to_choose) == (True, 1, 2, ("a", "b"))
    assert zone.not_stopped == ("a of team T",)
    assert (zone.times.phase, zone.times.phase_name, zone.times.phase_limit_s) == (2, "Serve", 60.0)
    assert zone.times.phase_elapsed_s == 10.5  # half a second after the message
    assert "Phase 2 of 3, Serve: time left 0:50" in zone.times.text
    setup = _clocks(phase="connected", setup_limit=Seconds(60), setup_elapsed=Seconds(10), setup_counting=True)
    zone, = box_of(_gui(_zone_state()), _details(phase="connected"), setup).zones
    assert (zone.times.setup_limit_s, zone.times.setup_elapsed_s, zone.times.setup_counting) == (60.0, 10.5, True)
    assert zone.off["no_show"] == ["why no no_show"]
