"""What a referee must do now, the most urgent thing first; and how far a STOP came."""

import json
import pathlib
import re
from types import SimpleNamespace

import pytest

from helpers.commands import actions_shown
from helpers.shown_box import zone_of
from roah_rsbb.model.zone import Switches
from roah_rsbb.wording import stop
from roah_rsbb.wording.stop import DONE, LOST, NOT_DELIVERED_S, TEXTS, Way, leaving, way, way_text
from roah_rsbb.wording.todo import Urgency, todo

WARNINGS = ("No message for 4 s", "clock off")


def zone(phase, warnings=(), start_off=(), connect_off=(), **fields):
    return zone_of(off={"start": start_off, "connect": connect_off}, phase=phase, warnings=warnings, **fields)


def test_the_runs_request_comes_before_all_warnings_which_are_counted():
    assert todo(zone("running", WARNINGS, manual_operation="Place the mug")) == (Urgency.DO, "Place the mug", 2)
    what = todo(zone("running", WARNINGS, switches=Switches((), 0, True)))
    assert (what.urgency, what.warnings) == (Urgency.DO, 2)
    assert "OMF Switches" in what.text


def test_warnings_come_before_the_next_step():
    assert todo(zone("connected", WARNINGS)) == (Urgency.LOOK, "No message for 4 s", 2)


def test_a_reason_among_the_lines_is_no_further_warning():
    assert todo(zone("connected", WARNINGS[:1], state=WARNINGS[:1])).urgency is Urgency.POSSIBLE


def test_at_an_event_that_is_signed_off_connect_is_not_the_next_step():
    shown = actions_shown(questions={"connect": "Signed off. Again?"})
    assert todo(zone_of(phase="idle", warnings=(), actions=shown)) == (Urgency.NONE, "Signed off. Again?", 0)


def test_a_module_that_is_gone():
    what = todo(zone("running", held=True))
    assert what.urgency is Urgency.LOOK
    assert "module is not running" in what.text


def test_the_next_step_or_every_reason_against_it():
    assert todo(zone("idle")) == (Urgency.POSSIBLE, "Connect is possible", 0)
    assert todo(zone("connected")) == (Urgency.POSSIBLE, "Start is possible", 0)
    reasons = ["Robot is silent", "Clock is off"]
    waits = (Urgency.NONE, "Wait: Robot is silent; Clock is off", 0)
    assert todo(zone("idle", connect_off=reasons)) == waits
    assert todo(zone("connected", start_off=reasons)) == waits
    assert todo(zone("ended")).urgency is Urgency.POSSIBLE
    assert todo(zone("running", module_status="Goal 1 of 2")).text == "Goal 1 of 2"
    assert todo(zone("running")) == (Urgency.NONE, "The robot is working", 0)
    assert todo(zone("running", by_hand=True)) == (Urgency.NONE, "The run is in progress", 0)


# -- the way of a STOP ----------------------------------------------------------------------------

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOON, LATE = NOT_DELIVERED_S - 0.01, NOT_DELIVERED_S


UNKNOWN, RUNS = None, {"phase": "running", "not_stopped": ()}
MOVES, STANDS = ({"phase": "ended", "not_stopped": robots} for robots in (("mbot of team A",), ()))
BY_HAND = {**STANDS, "by_hand": True}


@pytest.mark.parametrize("passed_s, box_has_it, after, expected", [
    (0.0, False, RUNS, Way.SENT), (SOON, False, UNKNOWN, Way.SENT), (LATE, False, RUNS, Way.LOST_BOX),
    (1e6, False, BY_HAND, Way.LOST_BOX),
    *((passed_s, True, after, expected) for after in (UNKNOWN, RUNS, MOVES)
      for passed_s, expected in ((0.0, Way.AT_BOX), (SOON, Way.AT_BOX), (LATE, Way.LOST_ROBOT))),
    (0.0, True, STANDS, Way.STOPPED), (1e6, True, STANDS, Way.STOPPED),
    (0.0, True, BY_HAND, Way.NO_ROBOT), (1e6, True, {**BY_HAND, **RUNS}, Way.NO_ROBOT),
])
def test_how_far_a_stop_came(passed_s, box_has_it, after, expected):
    assert way(passed_s, box_has_it, None if after is None else zone(**after)) is expected


def test_the_referee_must_act_after_a_second():
    assert NOT_DELIVERED_S == 1.0


def test_every_way_has_a_text_with_the_zone_and_what_to_do():
    assert set(TEXTS) == set(Way)
    assert set(LOST) | set(DONE) | {Way.SENT, Way.AT_BOX} == set(Way)
    for where in Way:
        text = way_text(where, "Home {A}")
        assert text.startswith("STOP Home {A}: ")
        assert ("by hand" in text, "Trying again" in text) == (where in LOST, where in LOST)
        assert text.endswith("…") == (where not in DONE), "it continues"


@pytest.mark.parametrize("phase, not_stopped, expected", [
    ("ended", ["mbot of team A", "amigo of team B"],
     "mbot of team A, amigo of team B did not answer STOP. After the disconnect the box does not repeat it: stop by "
     "hand first"),
    ("ended", [], ""),
    ("running", ["mbot of team A"], ""),
    ("connected", ["mbot of team A"], ""),
    ("idle", [], ""),
])
def test_who_leaves_a_robot_that_has_not_stopped_is_warned(phase, not_stopped, expected):
    assert leaving(SimpleNamespace(phase=phase, not_stopped=not_stopped)) == expected


def test_the_names_on_the_web_pages_stay():
    assert [where.value for where in stop.Way] == ["sent", "at_box", "stopped", "no_robot", "lost_box", "lost_robot"]


def test_the_page_has_the_same_words_and_times():
    """The script of STOP has words of its own, because it must work without any text of the box."""
    script = (ROOT / "resource" / "web" / "assets" / "stop.js").read_text(encoding="utf-8")
    assert dict(re.findall(r'(\w+): "(STOP \{zone\}: [^"]*)"', script)) == {way.value: TEXTS[way] for way in Way}
    assert re.findall(r"LATE_MS = (\d+)", script) == [f"{1000 * NOT_DELIVERED_S:.0f}"]
    assert f'DONE = {json.dumps([way.value for way in DONE])};' in script
