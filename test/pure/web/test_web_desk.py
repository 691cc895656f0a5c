"""What paired devices are shown. Without sockets and without time."""

import json
from types import SimpleNamespace

import pytest

from helpers.public_messages import NOW, Time
from roah_rsbb.web.desk import Desk
from roah_rsbb.web.store import Store
from roah_rsbb.web.zone_documents import OFF_FIELDS

MONO = 50.0
KEY = ("page.zone", "en", "Home")
CLOCK = ("page.clock", "en", "Home")


def gui(clock=NOW, **of_zone):
    zone = {
        "zone": "Home", "code": "HCFGAC", "desc": "Catering", "team": "Alpha", "round": 1, "run": 2,
        "schedule": Time(NOW), "state": "WARNING: No message from the robot for 3 s\nAll OK for start",
        "manual_operation": "", "omf": False, "omf_switches": b"", "omf_damaged": 0, "omf_complete": False,
        "start_enabled": True, "connect_enabled": False,
    }
    return SimpleNamespace(clock=Time(clock), zones=[SimpleNamespace(**{**zone, **of_zone})])


def details(**of_zone):
    zone = dict(zone="Home", phase="running", end_reason="", identity="run 1", robot="R", by_hand=False, held=False,
                module_status="", pause_allowed=False, robots_to_choose=[], operation=0, operation_choices=[],
                operation_asks_text=False, items=[], points=SimpleNamespace(total="", groups=[]),
                **{field: [] for field in OFF_FIELDS.values()})
    zone["start_off"] = ["Already started"]
    return SimpleNamespace(warnings=[], zones=[SimpleNamespace(**{**zone, **of_zone})])


def clocks(identity="run 1", elapsed=10.0, clock=NOW):
    return SimpleNamespace(clock=Time(clock), zones=[SimpleNamespace(
        zone="Home", identity=identity, phase="running", limit=Time(600.0), elapsed=Time(elapsed), counting=True,
        paused="", goal_limit=Time(0.0), goal=0, goal_elapsed=Time(0.0), goal_counting=False, after_stop=Time(0.0),
        setup_limit=Time(0.0), setup_elapsed=Time(0.0), setup_counting=False, phases=0, phase_number=0, phase_name="",
        phase_limit=Time(0.0), phase_elapsed=Time(0.0))])


def judging(identity, **fields):
    return SimpleNamespace(**{
        "zone": "Home", "identity": identity, "revision": 4, "count": 0, "rule": "", "missing": 0, "complete": False,
        "judges": [], "waiver": "", "differences": 0, "published": Time(0.0), "objections_until": Time(0.0),
        "open_objections": 0, **fields})


def closed_run(identity, zone="Home", closed=NOW, signed=0.0):
    return SimpleNamespace(identity=identity, zone=zone, code="HWV", team="Alpha", round=1, run=1, opened=Time(NOW),
                           started=Time(NOW), closed=Time(closed), signed=Time(signed), end_reason="stopped", score="2",
                           revision=7)


@pytest.fixture
def desk():
    made = Desk(Store({"de": lambda text, n: f"auf Deutsch: {text}"}))
    made.on_details(details())
    made.on_clocks(clocks())
    made.show([("en", "Home")])
    made.on_gui(MONO, gui())
    return made


def data(desk, key=KEY):
    return json.loads(desk.document(key).text)


def test_a_zone_is_shown_with_the_reason_of_each_command(desk):
    shown = data(desk)
    assert (shown["team"], shown["phase_text"], shown["identity"]) == ("Alpha", "▶ RUNNING", "run 1")
    assert shown["off"]["start"] == ["Already started"] and shown["off"]["stop"] == []
    assert shown["warnings"] == ["No message from the robot for 3 s"] and shown["state"] == ["All OK for start"]
    assert shown["is_urgent"] and shown["todo"] == "No message from the robot for 3 s"


def test_a_reason_of_a_command_is_no_state_of_the_run_as_well(desk):
    desk.on_details(details(start_off=["All OK for start"]))
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1))
    assert data(desk)["off"]["start"] == ["All OK for start"] and data(desk)["state"] == []


def test_the_clock_is_a_document_of_its_own(desk):
    assert data(desk, CLOCK)["main"] == {"label": "Run: time left", "text": "9:50", "hurry": 0}
    before = desk.document(KEY)
    desk.on_gui(MONO + 1.0, gui(NOW + 1.0))
    assert data(desk, CLOCK)["main"]["text"] == "9:49"
    assert desk.document(KEY) == before, "only the time has passed"
    desk.on_clocks(clocks(elapsed=571.0))
    desk.on_gui(MONO + 1.1, gui(NOW))
    assert data(desk, CLOCK)["main"]["hurry"] == 1


def test_a_clock_of_another_run_is_not_shown(desk):
    before = desk.document(CLOCK)
    desk.on_clocks(clocks("run 2", elapsed=0.0))
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1))
    assert desk.document(CLOCK) == before


def test_only_what_devices_show_is_made(desk):
    desk.show([("de", "Home")])
    assert data(desk, ("page.zone", "de", "Home"))["todo"].startswith("auf Deutsch: ")
    before = desk.document(KEY)
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1, team="Beta"))
    assert desk.document(KEY) == before
    assert data(desk, ("page.zone", "de", "Home"))["team"] == "Beta"


def test_a_repeated_message_is_no_sign_of_life(desk):
    desk.on_gui(MONO + 10.0, gui())
    assert desk.is_heard(MONO + Desk.SILENT_S) and not desk.is_heard(MONO + Desk.SILENT_S + 0.1)


def test_details_from_before_a_pause_are_not_shown_as_current(desk):
    desk.show([])
    desk.forget()
    before = desk.document(KEY)
    assert not desk.is_heard(MONO)
    desk.show([("en", "Home")])
    desk.on_gui(MONO + 60.0, gui(NOW + 60.0, team="Beta"))
    assert desk.document(KEY) == before and not desk.is_heard(MONO + 60.0)
    desk.on_details(details(identity="run 2"))
    desk.on_gui(MONO + 60.1, gui(NOW + 60.1, team="Beta"))
    assert (data(desk)["team"], data(desk)["identity"]) == ("Beta", "run 2") and desk.is_heard(MONO + 60.1)


def test_score_sheets_that_wait_for_a_signature(desk):
    desk.on_results(SimpleNamespace(runs=[
        closed_run("open", closed=0.0), closed_run("a"), closed_run("signed", signed=NOW), closed_run("b", zone="Hall"),
    ]))
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1))
    assert [(run["identity"], run["revision"]) for run in data(desk)["unsigned"]] == [("a", 7)]


def test_a_result_without_judges_can_be_published(desk):
    runs = [closed_run(f"run {n}") for n in range(7)]
    desk.on_results(SimpleNamespace(runs=[*runs, closed_run("hall", zone="Hall")]))
    desk.on_judging(SimpleNamespace(runs=[
        judging("run 6", published=Time(NOW), objections_until=Time(NOW + 60.0), open_objections=1),
        judging("judged", count=2),
    ]))
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1))
    assert [run["identity"] for run in data(desk)["unsigned"]] == ["run 0", "run 1", "run 2", "run 3", "run 4", "run 6"]
    shown = {run["identity"]: run for run in data(desk)["judging"]}
    assert list(shown) == ["run 6", "judged", "run 0", "run 1", "run 2", "run 3", "run 4"]
    new, old = shown["run 0"], shown["run 6"]
    assert (new["count"], new["revision"], new["is_over"], new["is_published"], new["publication"]) == (
        0, 0, True, False, "")
    assert old["is_published"] and "objections to answer: 1" in old["publication"]


def test_a_message_names_each_document_once(desk):
    keys = desk.keys("en", "Home")
    message = json.loads(desk.message("snapshot", keys, MONO, {}))
    assert set(message["documents"]) == {"page.words", "page.device_words", "page.zones", "page.zone", "page.clock"}
    assert message["documents"]["page.zones"]["data"] == [{"zone": "Home", "team": "Alpha", "phase": "RUNNING"}]
    assert set(json.loads(desk.beat(keys, MONO, {}))["numbers"]) == set(message["documents"])
    assert message["documents"]["page.device_words"]["data"]["stop"] == "■ STOP"
