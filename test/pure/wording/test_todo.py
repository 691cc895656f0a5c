"""What a referee must do now: the most urgent thing first."""

from types import SimpleNamespace

from helpers.commands import actions_text
from roah_rsbb.wording.todo import Urgency, todo


def zone(**fields):
    known = {"state": "Benchmark started\nWARNING: No message for 4 s\nWARNING: clock off", "manual_operation": "",
             "omf_complete": False, "start_enabled": False, "connect_enabled": False}
    return SimpleNamespace(**{**known, **fields})


def details(phase, **fields):
    off = {"start": fields.pop("start_off", ()), "connect": fields.pop("connect_off", ())}
    known = {"phase": phase, "held": False, "module_status": "", "actions": actions_text(off)}
    return SimpleNamespace(**{**known, **fields})


def test_the_runs_request_comes_before_all_warnings_which_are_counted():
    assert todo(zone(manual_operation="Place the mug"), details("running")) == (Urgency.DO, "Place the mug", 2)
    what = todo(zone(omf_complete=True), details("running"))
    assert (what.urgency, what.warnings) == (Urgency.DO, 2)
    assert "OMF Switches" in what.text


def test_warnings_come_before_the_next_step():
    what = todo(zone(start_enabled=True), details("connected"))
    assert what == (Urgency.LOOK, "No message for 4 s", 2)


def test_a_module_that_is_gone():
    what = todo(zone(state="running"), details("running", held=True))
    assert what.urgency is Urgency.LOOK
    assert "module is not running" in what.text


def test_the_next_step_or_every_reason_against_it():
    calm = {"state": "fine"}
    assert todo(zone(**calm, connect_enabled=True), details("idle")) == (Urgency.POSSIBLE, "Connect is possible", 0)
    assert todo(zone(**calm, start_enabled=True), details("connected")) == (Urgency.POSSIBLE, "Start is possible", 0)
    reasons = ["Robot is silent", "Clock is off"]
    waits = (Urgency.NONE, "Wait: Robot is silent; Clock is off", 0)
    assert todo(zone(**calm), details("idle", connect_off=reasons)) == waits
    assert todo(zone(**calm), details("connected", start_off=reasons)) == waits
    assert todo(zone(**calm), details("ended")).urgency is Urgency.POSSIBLE
    assert todo(zone(**calm), details("running", module_status="Goal 1 of 2")).text == "Goal 1 of 2"
    assert todo(zone(**calm), details("running")).urgency is Urgency.NONE


def test_without_details_the_zones_own_words():
    assert todo(zone(state="All OK for start\nmore"), None) == (Urgency.NONE, "All OK for start", 0)
