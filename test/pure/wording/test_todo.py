"""What a referee must do now: the most urgent thing first."""

from helpers.commands import actions_shown
from helpers.shown_box import zone_of
from roah_rsbb.model.zone import Switches
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
