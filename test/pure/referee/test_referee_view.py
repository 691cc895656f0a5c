"""The terminal's output."""

import json
import re

import pytest

from helpers.forms import ODD, form
from helpers.referee_box import EVENTS, ITEMS, MONO0, NOW, ROBOT, RUN_CLOCK, UTC0, asked, box, robot, running_zone, zone
from helpers.time_zones import local_time
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.fields import Number, form_of
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import GroupPoints, ScoreValue, SheetPoints
from roah_rsbb.model.results import EventSeen
from roah_rsbb.model.zone import AllRobots, SheetItem, Switches
from roah_rsbb.referee import view
from roah_rsbb.referee.commands import parser
from roah_rsbb.referee.state import Change, changes
from roah_rsbb.wording.times import Moments

UTC, COLOUR = (view.Style(in_colour, Moments(in_utc=True)) for in_colour in (False, True))


def _status(*zones, **fields):
    return "\n".join(view.status(box(*zones, **fields), NOW, UTC))


def _lines(old, new):
    return [view.change_line(change, UTC) for change in changes(old, new, UTC0)]


@pytest.mark.parametrize("zones, fields, texts", [
    ([running_zone(), zone(zone="Home B", off={"connect": ["a reason"], "next": []})], {}, [
        "RSBB at 127.255.255.255:6666, 16:26:40 UTC: OK",
        "Home A: RUNNING\n    Run: time left 8:33, Goal: time left 0:45, Used: 1:27 of 10:00\n    Name of",
        "robot mbot: PREPARING, skew +0.012 s, heard just now (UDP port 6667)",
        "Home B: NOT CONNECTED\n    Time limit of the run 10:00\n",
        "HGTKMH, team TestingTeam, round 1, run 1, scheduled 16:36 UTC", "allowed now: next"]),
    ([], {"robots": (robot("late", skew=-0.15, silent_since=MONO0 - 12.0),)},
     ["    Team         Robot  Link        Clock skew  Run in zone  Last heard\n"
      "    TestingTeam  late   ▯▯▯ silent  -0.150 s    –            12 s ago\n"]),
    ([], {"robots": (robot("\x1b[2J"),)}, ["  \\x1b[2J  "]),
    ([], {"robots": ()}, ["Active robots: none"]),
    ([running_zone(state=("Running",), warnings=("silent",))], {"warnings": ("Another box",)},
     ["WARNING: Another box", "    WARNING: silent"]),
    ([running_zone(robot=ROBOT._replace(robot_state="", skew=None, heard=False))], {},
     ["robot mbot: no state yet, skew not known, never heard on its private channel"]),
    ([running_zone(phase="ended", end_reason="no_messages_saved")], {}, ["ENDED: no data saved\n"]),
    ([running_zone(clock=RUN_CLOCK._replace(paused="place the \x1b mug"))], {},
     ["Home A: RUNNING\n    PAUSED: place the \\x1b mug\n    Run: time left 8:33"]),
    # What the referee has to do.
    *(([asked(running_zone(), 1, "Place it", *form_fields)], {}, [f"TO DO by the referee: Place it{answers}\n"])
      for form_fields, answers in (
        ((), ""), (form_of(form("again", "skip")), " (again / skip)"), ((Number("n", say("How often?")),), " (from 0)"),
        (ODD, " (held: Did the robot hold it? (yes / no); drops: How often did it fall? (0 to 9); place: Where is it "
              "now? (table / floor); pose: Pose of the cup (x y direction, in m and degrees))"))),
    ([running_zone(switches=Switches((1, 3), 2, False))], {}, ["switches that are on: 1, 3; damaged: 2\n"]),
    ([running_zone(switches=Switches((), 0, True))], {},
     ["switches that are on: none; damaged: 0; TO DO by the referee: enter"]),
])
def test_all_zones_at_a_glance(zones, fields, texts):
    shown = _status(*zones, **fields)
    assert [text for text in texts if text not in shown] == []


def test_what_is_allowed_now_can_be_typed():
    text = _status(zone(off={action: [] for action in ACTIONS}))
    words = text.split("allowed now: ")[1].split(", ")
    known = next(action for action in parser()._actions if action.dest == "command").choices
    assert len(words) == len(ACTIONS) and not set(words) - set(known)


def test_a_warning_that_is_the_boxs_status_is_shown_once():
    assert _status(status="A; B", warnings=("A", "B")).count("B") - _status().count("B") == 1


def test_all_robots_at_once_are_listed_in_the_zones_report():
    robots = AllRobots(6667, 1, 0, 1, ("a of team T: preparing", "b\n of team T: ready"))
    of_all = running_zone(robot=None, all_robots=robots)
    assert "2 robots" not in _status(of_all)  # its state counts them
    report = view.zone_report(of_all, NOW, UTC)
    assert [line.strip() for line in report if "of team" in line] == [
        "robot a of team T: preparing", "robot b\\n of team T: ready"
    ]


def test_times_are_local_unless_utc_is_asked_for():
    with local_time("Brest-02:30"):
        old, new = box(running_zone()), box(running_zone(log="16:26:38Z PREPARE: x\n", online_data="23:59:59Z y\n"))
        local = view.Style()
        assert view.status(new, NOW, local)[0] == "RSBB at 127.255.255.255:6666, 18:56:40 Brest: OK"
        assert "    HGTKMH, team TestingTeam, round 1, run 1, scheduled 19:06" in view.status(new, NOW, local)
        assert view.zone_report(new.zones["Home A"], NOW, local)[-1] == "    02:29:59 y"
        shown = [view.change_line(change, local) for change in changes(old, new, UTC0)]
        assert shown == ["18:56:38 Home A: PREPARE: x", "02:29:59 Home A: online data: y"]
        assert view.change_line(Change(UTC0, "core", "", {"what": "back"}), local) == "18:56:40 box is back"
        assert view.schedule_lines([_event(1)], local)[1].startswith("Home A  1    2015-11-08 18:56  ~19:08  +12 min")


SCORES = (
    ScoreValue("goal 1", "time", "1.25", "s", "Time"), ScoreValue("", "reached", "1", "", "Goals reached"),
    ScoreValue("goal 1", "error", "null", "m", "Distance error"),
)


def test_what_a_module_scored_is_behind_the_score_sheet():
    shown = "\n".join(view.score_sheet(running_zone(items=(), module_scores=SCORES), UTC))
    assert shown.endswith("""    no scoring items for the referee
Score of the benchmarking module
    Whole run
        1  Goals reached
    goal 1
        1.25 s  Time
             –  Distance error""")


@pytest.mark.parametrize(("old", "new", "reported"), [
    (None, 1.25, True), (1.25, 2.5, False), (False, True, True), ("", "a", True), (1.25, None, False),
    ("a", None, False),
])
def test_a_score_that_changes_all_the_time_is_reported_once(old, new, reported):
    zones = [running_zone(module_scores=(SCORES[0]._replace(value=json.dumps(value)),)) for value in (old, new)]
    lines = _lines(*map(box, zones))
    assert [line.partition(" Home A: ")[2] for line in lines] == (
        ["module's score: goal 1: Time: " + {1.25: "1.25 s", True: "yes s", "a": "a s"}[new] if reported else ""])


def test_a_zone_in_full_has_every_reason_scores_and_online_data():
    full = running_zone(off={"connect": ["one", "two"]}, online_data="a\nb\n")
    text = "\n".join(view.zone_report(full, NOW, UTC))
    for part in ("no connect: one", "no connect: two", "log: /logs/run.bag", "Score sheet: HGTKMH", "    a\n    b"):
        assert part in text


def test_the_score_sheet_has_numbers_values_and_groups():
    scores = (ITEMS[0]._replace(value=1), ITEMS[1]._replace(value=12), ITEMS[2])
    assert view.score_sheet(running_zone(items=scores), UTC) == [
        "Score sheet: HGTKMH, team TestingTeam, round 1, run 1",
        "    Achievements",
        "       1    yes  Detects the door",
        "       2     12  Moved furniture",
        "    Penalized",
        "       3      0  Bumps into the furniture",
    ]


def test_the_score_sheet_shows_points_and_ratings():
    scores = (
        SheetItem("Table", "Opens", "choice", 1, text="alone", points="50"),
        SheetItem("Jury", "Poster", "rating", 7, text="7.5", points="15", judges=("Anna", "Ben"),
                  ratings=("7.5", "")),
    )
    points = SheetPoints("65", (GroupPoints("Table", "50"), GroupPoints("Jury", "15")))
    assert view.score_sheet(running_zone(items=scores, points=points), UTC)[1:] == [
        "    Table",
        "       1  alone      50  Opens",
        "    Jury",
        "       2    7.5      15  Poster (Anna 7.5)",
        "    65 points: Table 50 · Jury 15",
    ]


NOT_ATTEMPTED = ITEMS[1]._replace(not_attempted=True)


def test_not_attempted_is_not_shown_as_0():
    sheet = view.score_sheet(running_zone(items=(ITEMS[0], NOT_ATTEMPTED)), UTC)
    assert sheet[2:] == ["       1     no  Detects the door", "       2  not attempted  Moved furniture"]


def test_values_that_were_set_are_highlighted():
    sheet = view.score_sheet(running_zone(items=(ITEMS[0]._replace(value=1), ITEMS[1])), COLOUR)
    assert ["\x1b" in line for line in sheet] == [False, False, True, False]


def test_a_benchmark_without_items_says_so():
    assert "no scoring items" in view.score_sheet(running_zone(items=()), UTC)[-1]


BUSY = asked(running_zone(module_status="Goal 1"), 1, "Place the mug", *form_of(form("ok")))


@pytest.mark.parametrize("old, new, lines", [
    (box(zone(), robots=()), box(running_zone()),
     ["Z robot TestingTeam mbot is active, skew +0.012 s", "Z Home A: RUNNING, robot is in PREPARING"]),
    (box(zone()), box(zone(event=EVENTS[1])), ["Z Home A: now at HWV, team TestingTeam, round 1, run 2"]),
    (box(running_zone()), box(running_zone(items=(ITEMS[0]._replace(value=1), *ITEMS[1:]))),
     ["Z Home A: score: Achievements: Detects the door: no → yes"]),
    (box(running_zone(items=(NOT_ATTEMPTED,))), box(running_zone(items=(ITEMS[1]._replace(value=2),))),
     ["Z Home A: score: Achievements: Moved furniture: not attempted → 2"]),
    (box(running_zone()), box(BUSY),
     ["Z Home A: TO DO by the referee: Place the mug (ok)", "Z Home A: module: Goal 1"]),
    (box(BUSY), box(running_zone()), ["Z Home A: manual operation over"]),
    (box(running_zone()), box(running_zone(switches=Switches((2,), 0, False))),
     ["Z Home A: switches that are on: 2; damaged: 0"]),
    (box(warnings=("first",)), box(warnings=("second",)), ["Z WARNING: second", "Z over: first"]),
])
def test_changes_are_one_line_each_with_the_time(old, new, lines):
    assert _lines(old, new) == [f"16:26:40{line}" for line in lines]


def test_lines_of_the_core_keep_their_own_time():
    new = running_zone(log="16:26:38Z PREPARE: x\n", online_data="16:26:39Z visitor: y\n")
    assert _lines(box(running_zone()), box(new)) == [
        "16:26:38Z Home A: PREPARE: x", "16:26:39Z Home A: online data: visitor: y",
    ]


def test_a_state_that_the_core_logs_itself_is_not_reported_twice():
    assert _lines(box(running_zone()), box(running_zone(robot=ROBOT._replace(box_state="WAITING_RESULT")))) == [""]


@pytest.mark.parametrize("kind, facts, text", [
    ("state", {"phase": "connected", "end_reason": "", "robot": "mbot", "port": 6667},
     "Home A: CONNECTED to mbot on UDP port 6667"),
    ("state", {"phase": "ended", "end_reason": "no_messages_saved"}, "Home A: ENDED: no data saved"),
    ("state", {"phase": "idle", "end_reason": ""}, "Home A: NOT CONNECTED"),
    ("core", {"what": "silent"}, "box SILENT: the state above is old; waiting for the box"),
    ("core", {"what": "silent", "why": "restart it\x1b"},
     "box SILENT: the state above is old; waiting for the box (restart it\\x1b)"),
    ("core", {"what": "back"}, "box is back"), ("core", {"what": "restarted"}, "box was RESTARTED"),
])
def test_phases_and_a_core_that_disappears_and_returns(kind, facts, text):
    change = Change(UTC0, kind, "" if kind == "core" else "Home A", {**facts, "changed": ["phase"]})
    assert view.change_line(change, UTC) == f"16:26:40Z {text}"


def test_colour_only_adds_to_the_words():
    old, new = box(zone(), robots=()), box(running_zone(warnings=("w",)), warnings=("x",))
    coloured = "\n".join(view.status(new, NOW, COLOUR))
    assert "\x1b[" in coloured
    assert re.sub(r"\x1b\[[\d;]*m", "", coloured) == "\n".join(view.status(new, NOW, UTC))
    for change in changes(old, new, UTC0):
        line = view.change_line(change, COLOUR)
        assert re.sub(r"\x1b\[[\d;]*m", "", line) == view.change_line(change, UTC)


def test_what_robots_say_cannot_command_the_terminal():
    evil = "\x1b[2Jgone\r\u202e"
    loud = asked(running_zone(
        robot=ROBOT._replace(robot=evil, robot_state=evil), state=(evil,), online_data=evil, log=evil, log_file=evil,
        event=EVENTS[0]._replace(team=evil, name=evil, code=evil), warnings=(evil,), zone=evil,
        items=(ITEMS[0]._replace(desc=evil, group=evil),), off={"connect": [evil]},
        module_scores=(ScoreValue(evil, evil, evil, evil, evil),), module_status=evil,
    ), 1, evil, *form_of(form(evil)))
    quiet = asked(loud, 0, "")._replace(
        online_data="", log="", phase="connected", warnings=(), robot=ROBOT, module_scores=(), module_status="",
        items=(loud.items[0]._replace(value=1),), event=EVENTS[0])
    new = box(loud, robots=(robot(evil, evil),), status=evil, host=evil, warnings=(evil,))
    shown = view.status(new, NOW, UTC) + view.zone_report(loud, NOW, UTC) + _lines(box(quiet), new)
    assert [line for line in shown if not line.isprintable()] == []
    assert "\\x1b[2Jgone" in "".join(shown)


# -- the schedule -----------------------------------------------------------------------------------


def _event(number, **fields):
    event = EventSeen(f"e{number}", number, "Home A", "HWV", "Welcoming", "Beta", 1, number, UTC0, UTC0 + 720.0,
                      "later", False)
    return event._replace(**fields)


def test_the_schedule_is_a_table():
    events = [
        _event(1, state="done", identity="r", end_reason="stopped", score="Good 3", signed_utc_s=UTC0),
        _event(2, state="next", current=True),
        _event(3, state="skipped", begins_utc_s=UTC0, team="Evil\x1b[31m"),
    ]
    assert view.schedule_lines(events, UTC) == [
        "Zone    No.  Scheduled         Begins  Late     Event                                   State            "
        "Score   Sheet",
        "Home A  1    2015-11-08 16:26  16:38   +12 min  HWV, team Beta, round 1, run 1          ✓ done: stopped  "
        "Good 3  signed off",
        "Home A  2*   2015-11-08 16:26  ~16:38  +12 min  HWV, team Beta, round 1, run 2          → next",
        "Home A  3    2015-11-08 16:26                   HWV, team Evil\\x1b[31m, round 1, run 3  – skipped",
    ]
    assert view.schedule_lines(events, COLOUR)[2].startswith("\x1b[1m")
    assert view.schedule_lines([], UTC) == [
        "Zone  No.  Scheduled  Begins  Late  Event  State  Score  Sheet"]
