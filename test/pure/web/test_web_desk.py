"""What paired devices are shown. Without sockets and without time."""

import json
from types import SimpleNamespace

import pytest

from helpers.commands import actions_text
from helpers.forms import ODD, ODD_ASKED, shown_form
from helpers.public_messages import NOW, Time
from roah_rsbb.web import zone_documents
from roah_rsbb.web.desk import NO_STOP, STOP, Desk
from roah_rsbb.web.store import Store

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
    zone = {
        "zone": "Home", "phase": "running", "end_reason": "", "identity": "run 1", "event": "kx2", "robot": "R",
        "by_hand": False, "held": False, "module_status": "", "operation": 0, "said": "", "not_stopped": ["R"],
        "items": [],
        "points": SimpleNamespace(total="", groups=[]),
        "actions": actions_text(
            {"start": of_zone.pop("start_off", ["Already started"])}, asked=of_zone.pop("asked", None)),
    }
    return SimpleNamespace(warnings=[], said="", zones=[SimpleNamespace(**{**zone, **of_zone})])


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
                           revision=7, counts="not_last")


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
    assert (shown["warnings"], shown["state"]) == ([], ["All OK for start"]), "what to do now is not repeated"
    assert shown["is_urgent"] and shown["todo"] == "No message from the robot for 3 s"


def test_the_form_of_a_module_that_nobody_knows_is_shown(desk):
    assert (data(desk)["fields"], data(desk)["texts"], data(desk)["shown"]["operation"]) == ({}, {}, False)
    desk.on_details(details(asked=shown_form(7, ODD, ODD_ASKED)))
    desk.on_gui(MONO + 0.1, gui(clock=NOW + 0.1))
    shown = data(desk)
    assert (shown["texts"], shown["shown"]["operation"]) == ({"operation": ODD_ASKED}, True)
    number, *fields = shown["fields"]["operation"]
    assert (number["kind"], number["default"]) == ("fixed", 7)
    assert [(field["kind"], field["name"], field["label"]) for field in fields] == [
        (field.kind, field.name, str(field.label)) for field in ODD]


def test_a_reason_of_a_command_is_no_state_of_the_run_as_well(desk):
    desk.on_details(details(start_off=["All OK for start"]))
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1))
    assert data(desk)["off"]["start"] == ["All OK for start"] and data(desk)["state"] == []


def test_a_robot_that_may_be_moving_comes_before_the_warnings_of_the_box(desk):
    state = "WARNING: The robot has disappeared\nWARNING: Two robots\nAll OK"
    warned = details(phase="ended")
    warned.warnings = ["The core was restarted"]
    desk.on_details(warned)
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1, state=state))
    shown = data(desk)
    assert (shown["todo"], shown["warnings"]) == ("The robot has disappeared", ["Two robots", "The core was restarted"])
    assert shown["leaving"].startswith("R did not answer STOP")
    desk.on_details(details(phase="ended", not_stopped=[]))
    desk.on_gui(MONO + 0.2, gui(NOW + 0.2, state=state, manual_operation="Move it"))
    shown = data(desk)
    assert (shown["todo"], shown["warnings"]) == ("Move it", ["The robot has disappeared", "Two robots"])
    assert shown["leaving"] == ""


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
    assert (new["count"], new["revision"], new["publication"]) == (0, 0, "")
    assert not new["off"]["publish"] and new["off"]["object"] == "The result is not published yet"
    assert not old["off"]["object"] and "objections to answer: 1" in old["publication"]


def test_a_message_names_each_document_once(desk):
    keys = desk.keys("en", "Home")
    message = json.loads(desk.message("snapshot", keys, MONO, {}))
    assert set(message["documents"]) == {"page.words", "page.device_words", "page.zones", "page.zone", "page.clock"}
    assert message["documents"]["page.zones"]["data"] == [{
        "zone": "Home", "team": "Alpha", "phase": "RUNNING", "todo": "No message from the robot for 3 s",
        "is_urgent": True}]
    assert set(json.loads(desk.beat(keys, MONO, {}))["numbers"]) == set(message["documents"])
    assert message["documents"]["page.device_words"]["data"]["stop"] == "■ STOP"


def test_stop_needs_three_values_and_no_text(desk):
    assert data(desk, (STOP, "Home")) == {"all": False, "zones": [
        {"zone": "Home", "identity": "run 1", "running": True, "by_hand": False, "not_stopped": True}]}
    assert data(desk, (STOP, ""))["all"] and data(desk, NO_STOP) == {"all": False, "zones": []}
    desk.on_details(details(phase="ended", not_stopped=[]))
    assert (data(desk, (STOP, ""))["zones"][0]["running"], data(desk, (STOP, "Home"))["zones"][0]["not_stopped"]) == (
        False, False)


def test_a_zone_that_is_gone_is_shown_no_more(desk):
    desk.show([("en", "Home"), ("en", "Hall")])
    hall = data(desk, (STOP, "Hall"))
    assert data(desk, ("page.zone", "en", "Hall")) is None and hall is None
    desk.on_details(details(zone="Hall"))
    assert data(desk, (STOP, "Home")) == {"all": False, "zones": []}
    assert [one["zone"] for one in data(desk, (STOP, ""))["zones"]] == ["Hall"]
    desk.on_gui(MONO + 0.1, gui(NOW + 0.1, zone="Hall"))
    assert data(desk) is None and data(desk, CLOCK) is None
    assert data(desk, ("page.zone", "en", "Hall"))["zone"] == "Hall"
    assert [one["zone"] for one in data(desk, ("page.zones", "en"))] == ["Hall"]
    desk.on_details(details())
    desk.on_gui(MONO + 0.2, gui(NOW + 0.2))
    assert data(desk)["zone"] == "Home" and data(desk, (STOP, "Home"))["zones"][0]["running"], "it is there again"


@pytest.mark.parametrize(
    "name, key", [("zone_page", "page.zone"), ("zones_page", "page.zones"), ("clock_page", "page.clock")])
def test_a_document_that_cannot_be_made_costs_no_other_phone_anything(desk, monkeypatch, caplog, name, key):
    """In a language whose texts raise, as the German ones of a manual operation once did."""
    real = getattr(zone_documents, name)

    def make(*what):
        if zone_documents.sheets.phase("idle") != "NOT CONNECTED":
            raise TypeError(f"{name}: tr() got multiple values for argument 'text'")
        return real(*what)

    desk.show([("de", "Home"), ("en", "Home")])
    monkeypatch.setattr(zone_documents, name, make)
    for n in range(1, 4):
        desk.on_details(details(identity=f"run {n}"))
        desk.on_clocks(clocks(f"run {n}", elapsed=10.0 * n))
        desk.on_gui(MONO + n, gui(NOW + n, team=f"Team {n}"))
    documents = {one: data(desk, (one, "de", "Home") if one != "page.zones" else (one, "de"))
                 for one in ("page.zone", "page.zones", "page.clock")}
    assert documents.pop(key) is None and None not in documents.values()
    assert (data(desk)["team"], data(desk, CLOCK)["main"]["text"]) == ("Team 3", "9:27")
    assert data(desk, (STOP, "Home"))["zones"][0]["identity"] == "run 3"
    assert len(caplog.records) == 1, "it is logged once"
    monkeypatch.setattr(zone_documents, name, real)
    desk.on_gui(MONO + 9.0, gui(NOW + 9.0))
    assert data(desk, (key, "de", "Home") if key != "page.zones" else (key, "de")) is not None


def test_a_stop_document_that_cannot_be_made_costs_nothing_else(desk, monkeypatch):
    monkeypatch.setattr(zone_documents, "stop_page", lambda zones, has_all: 1 / 0)
    desk.on_details(details(identity="run 2"))
    desk.on_gui(MONO + 1.0, gui(NOW + 1.0))
    assert data(desk, (STOP, "")) is None and data(desk)["identity"] == "run 2"


def test_a_language_whose_translation_raises_is_english(desk):
    def translate(text, n):
        raise TypeError("tr() got multiple values for argument 'text'")

    desk._store._languages["bad"] = translate
    desk.show([("bad", "Home"), ("en", "Home")])
    desk.on_gui(MONO + 1.0, gui(NOW + 1.0, team="Beta", manual_operation="Move the robot"))
    assert data(desk, ("page.zone", "bad", "Home")) == data(desk)
