"""What paired devices are shown. Without sockets and without time."""

import json

import pytest

from helpers.commands import actions_shown
from helpers.forms import ODD, ODD_ASKED, shown_form
from helpers.public_box import PublicBox
from helpers.shown_box import MONO, NOW, ShownBox, zone_of
from roah_rsbb.core.actions.runs import SIGNED_OFF
from roah_rsbb.model.results import Judging, RunLine
from roah_rsbb.model.zone import Count, RunClock, SheetItem
from roah_rsbb.web import device_documents
from roah_rsbb.web.device_documents import MAX_UNSIGNED, NO_STOP, STOP, Absent, Desk
from roah_rsbb.web.limits import STUCK_S
from roah_rsbb.web.public_documents import Store
from roah_rsbb.wording.language import in_language

KEY = ("page.zone", "en", "Home")
CLOCK = ("page.clock", "en", "Home")
RUNNING = RunClock(600.0, Count(10.0, MONO))


def closed_run(identity, zone="Home", closed=NOW, signed=None):
    return RunLine(identity, 7, zone, "HWV", "Alpha", 1, 1, NOW, NOW, closed, "stopped", "2", signed_utc_s=signed,
                   counts="not_last")


def by_identity(*lines):
    return {line.identity: line for line in lines}


class World(Desk):
    """A desk whose box changes as the test says."""

    def __init__(self):
        super().__init__(Store(ShownBox(zone_of(clock=RUNNING)), {"de": lambda text, n: f"auf Deutsch: {text}"}))
        self.show([("en", "Home")])

    def put(self, *zones, **how):
        self.box.show(*zones, **how)
        return self.look()

    def pass_time(self, seconds):
        self.box.mono += seconds
        return self.look()


@pytest.fixture
def desk():
    return World()


def data(desk, key=KEY):
    return json.loads(desk.document(key).text)


def test_a_zone_is_shown_with_the_reason_of_each_command(desk):
    shown = data(desk)
    assert (shown["team"], shown["phase_text"], shown["identity"]) == ("Alpha", "RUNNING", "run 1")
    assert shown["off"]["start"] == ["Already started"] and shown["off"]["stop"] == []
    assert (shown["warnings"], shown["state"]) == ([], ["All OK for start"]), "what to do now is not repeated"
    assert shown["is_urgent"] and shown["todo"] == "No message from the robot for 3 s"
    assert (shown["robot"], shown["title"], shown["event_id"]) == ("R", "HCFGAC  Catering", "kx2")


def test_the_form_of_a_module_that_nobody_knows_is_shown(desk):
    assert (data(desk)["fields"], data(desk)["texts"], data(desk)["shown"]["operation"]) == ({}, {}, False)
    desk.put(zone_of(asked=shown_form(7, ODD, ODD_ASKED)))
    shown = data(desk)
    assert (shown["texts"], shown["shown"]["operation"]) == ({"operation": ODD_ASKED}, True)
    number, *fields = shown["fields"]["operation"]
    assert (number["kind"], number["default"]) == ("fixed", 7)
    assert [(field["kind"], field["name"], field["label"]) for field in fields] == [
        (field.kind, field.name, str(field.label)) for field in ODD]


def test_a_reason_of_a_command_is_no_state_of_the_run_as_well(desk):
    desk.put(zone_of(off={"start": ["All OK for start"]}))
    assert data(desk)["off"]["start"] == ["All OK for start"] and data(desk)["state"] == []


def test_a_robot_that_may_be_moving_comes_before_the_warnings_of_the_box(desk):
    warned = {"phase": "ended", "warnings": ("The robot has disappeared", "Two robots")}
    desk.put(zone_of(**warned), warnings=["The box was restarted"])
    shown = data(desk)
    assert (shown["todo"], shown["warnings"]) == ("The robot has disappeared", ["Two robots", "The box was restarted"])
    assert shown["leaving"].startswith("R did not answer STOP")
    desk.put(zone_of(**warned, not_stopped=(), manual_operation="Move it"))
    shown = data(desk)
    assert (shown["todo"], shown["warnings"]) == ("Move it", ["The robot has disappeared", "Two robots"])
    assert shown["leaving"] == ""


def test_the_clock_is_a_document_of_its_own(desk):
    assert data(desk, CLOCK)["main"] == {"label": "Run: time left", "text": "9:50", "hurry": 0}
    before = desk.document(KEY)
    assert desk.pass_time(1.0)
    assert data(desk, CLOCK)["main"]["text"] == "9:49"
    assert desk.document(KEY) == before, "only the time has passed"
    assert not desk.pass_time(0.0), "nothing is sent"
    desk.put(zone_of(clock=RunClock(600.0, Count(571.0, MONO))))
    assert data(desk, CLOCK)["main"]["hurry"] == 1


def test_the_clock_stands_while_the_box_is_silent(desk):
    desk.box.is_old = True
    desk.look()
    before = desk.document(CLOCK)
    assert not desk.pass_time(60.0) and desk.document(CLOCK) == before
    desk.box.is_old = False
    assert desk.look() and desk.document(CLOCK) != before


def test_only_what_has_changed_is_made_again(desk, monkeypatch):
    made = []
    for name in ("zone_page", "zones_page", "clock_page", "stop_page"):
        real = getattr(device_documents, name)
        monkeypatch.setattr(device_documents, name, lambda *what, name=name, real=real: (
            made.append(name) or real(*what)))
    home, hall = zone_of(clock=RUNNING), zone_of("Hall")
    desk.put(home, hall)
    made.clear()
    desk.look()
    desk.put(home, hall)
    assert made == []
    desk.pass_time(0.1)
    assert made == ["clock_page"]
    made.clear()
    desk.put(home, zone_of("Hall", identity="run 2"))
    assert sorted(made) == ["stop_page", "stop_page", "zones_page"]
    made.clear()
    desk.box.is_old = True
    desk.look()
    made.clear()
    desk.pass_time(0.1)
    assert made == []


def test_a_new_day_and_the_end_of_objections_change_a_page(desk):
    run = closed_run("a")
    desk.put(zone_of(), results=by_identity(run), judging=by_identity(
        Judging("Home", "a", 4, published_utc_s=NOW, objections_until_utc_s=NOW + 60.0)))
    assert "until" in data(desk)["judging"][0]["publication"]
    assert desk.pass_time(61.0)
    assert "over" in data(desk)["judging"][0]["publication"]
    today = data(desk)["facts"]
    assert desk.pass_time(86400.0) and data(desk)["facts"] != today


def test_only_what_devices_show_is_made(desk):
    desk.show([("de", "Home")])
    assert data(desk, ("page.zone", "de", "Home"))["todo"].startswith("auf Deutsch: ")
    before = desk.document(KEY)
    desk.put(zone_of(team="Beta"))
    assert desk.document(KEY) == before
    assert data(desk, ("page.zone", "de", "Home"))["team"] == "Beta"


def test_the_points_of_an_item_have_the_decimal_sign_of_the_language():
    item = SheetItem("Table", "Litres", "decimal", text="1.25", points="41.669")
    with in_language(lambda text, n: text.replace("{whole}.", "{whole},")):
        shown = device_documents.item_page(item)
    assert (shown["shown"], shown["points"]) == ("1,25", "41,669")


def test_a_box_is_heard_while_its_document_is_current(desk):
    assert desk.is_heard and desk.clock() == NOW and desk.zones() == ["Home"]
    desk.box.is_old = True
    assert not desk.is_heard
    desk.box.is_old, desk.box.why = False, "the connection was lost just now"
    assert not desk.is_heard
    desk.box.why, document = "", desk.box.document
    desk.box.document = document._replace(box=document.box._replace(
        superseded_by="10.0.0.2", warnings=["the box at 10.0.0.2 has taken over"]))
    assert desk.look() and not desk.is_heard and data(desk)["warnings"] == ["the box at 10.0.0.2 has taken over"]
    assert data(desk, ("page.stop", ""))["successor"] == "10.0.0.2"
    unknown = Desk(Store(PublicBox(), {}))
    assert not unknown.look() and not unknown.is_heard and unknown.clock() is None and unknown.zones() == []
    assert unknown.team_facts("Alpha", "en") is None


def test_what_the_zone_asks_before_an_action_is_what_there_is_to_do(desk):
    questions = {"connect": SIGNED_OFF, "no_show": SIGNED_OFF}
    desk.put(zone_of(phase="idle", warnings=(), not_stopped=(), state=(SIGNED_OFF, "Robot ready"),
                     actions=actions_shown(questions=questions)))
    found = data(desk)
    assert (found["questions"], found["todo"], found["state"]) == (questions, SIGNED_OFF, ["Robot ready"])
    desk.put(zone_of())
    assert data(desk)["questions"] == {}


def test_score_sheets_that_wait_for_a_signature(desk):
    desk.put(zone_of(), results=by_identity(
        closed_run("open", closed=None), closed_run("a"), closed_run("signed", signed=NOW),
        closed_run("b", zone="Hall")))
    assert [(run["identity"], run["revision"]) for run in data(desk)["unsigned"]] == [("a", 7)]


def test_before_the_sign_off_devices_are_named_on_which_marks_may_wait():
    later = NOW + 60.0 + STUCK_S
    absent = [Absent("Anna, Assistant", NOW + 1.0), Absent("Ben, Judge", NOW - 1.0),
              Absent("heard after the run was left", later),
              Absent("Cleo, Assistant", later + STUCK_S, later + 1.0),  # marked then, and not heard since
              Absent("heard after the last mark", later + STUCK_S, later)]
    desk = Desk(Store(ShownBox(zone_of()), {}), tuple, lambda zone: absent if zone == "Home" else [])
    desk.show([("en", "Home")])
    desk.box.show(zone_of(), results=by_identity(
        closed_run("a", closed=NOW + 60.0), closed_run("b", signed=NOW)._replace(proposals=2)))
    desk.look()
    assert data(desk)["unsigned"][0]["unheard"] == ["Anna, Assistant", "Cleo, Assistant"]
    assert [(run["identity"], run["number"]) for run in data(desk)["proposed"]] == [("b", 2)]
    absent.clear()
    desk.look()
    assert data(desk)["unsigned"][0]["unheard"] == []


def test_incidents_of_other_runs_of_the_team_today():
    desk = Desk(Store(ShownBox(zone_of()), {}))
    desk.show([("en", "Home")])
    team = zone_of().event.team
    happened = (("Restart", 1), ("Own incident", 2))
    runs = [closed_run(name)._replace(**{"incidents": happened, "team": team, **more}) for name, more in (
        ("a", {}), ("quiet", {"incidents": ()}), ("other", {"team": "Others"}), ("old", {"opened_utc_s": NOW - 2e5}))]
    desk.box.show(zone_of(), results=by_identity(*runs))
    desk.look()
    (found,) = data(desk)["earlier"]
    assert found["text"] == "Restart 1, Own incident 2" and found["run"].startswith("HWV, ")


def test_a_result_without_judges_can_be_published(desk):
    runs = [closed_run(f"run {n}", closed=NOW - n) for n in range(MAX_UNSIGNED + 2)]
    last, listed = f"run {MAX_UNSIGNED + 1}", [f"run {n}" for n in range(MAX_UNSIGNED)]
    desk.put(
        zone_of(),
        results=by_identity(*runs, closed_run("hall", zone="Hall"), closed_run("judged", closed=None)),
        judging=by_identity(
            Judging("Home", last, 4, published_utc_s=NOW, objections_until_utc_s=NOW + 60.0, open_objections=1),
            Judging("Home", "judged", 4, count=2)))
    assert [run["identity"] for run in data(desk)["unsigned"]] == [*listed, last]
    assert data(desk)["unlisted"] == 1 and len(listed) > 13, "the page counts all"
    shown = {run["identity"]: run for run in data(desk)["judging"]}
    listed.remove("run 1")
    assert list(shown) == ["run 1", "judged", *listed, last], "that in the zone is the first one"
    new, old = shown["run 0"], shown[last]
    assert (new["count"], new["revision"], new["publication"]) == (0, 0, "")
    assert not new["off"]["publish"] and not new["off"]["object"]
    assert not old["off"]["object"] and "objections to answer: 1" in old["publication"]


def test_a_message_names_each_document_once(desk):
    keys = desk.keys("en", "Home")
    message = json.loads(desk.message("snapshot", keys, {}))
    assert set(message["documents"]) == {"page.words", "page.device_words", "page.zones", "page.zone", "page.clock",
                                         "page.timeline"}
    assert message["documents"]["page.zones"]["data"] == [{
        "zone": "Home", "team": "Alpha", "phase": "RUNNING", "todo": "No message from the robot for 3 s",
        "is_urgent": True}]
    assert set(json.loads(desk.beat(keys, {}))["numbers"]) == set(message["documents"])
    assert message["documents"]["page.device_words"]["data"]["stop"] == "■ STOP"


def test_stop_needs_few_values_and_no_text(desk):
    assert data(desk, (STOP, "Home")) == {"all": False, "successor": "", "zones": [
        {"zone": "Home", "identity": "run 1", "running": True, "by_hand": False, "not_stopped": True}]}
    assert data(desk, (STOP, ""))["all"] and data(desk, NO_STOP) == {"all": False, "successor": "", "zones": []}
    desk.put(zone_of(phase="ended", not_stopped=()))
    assert (data(desk, (STOP, ""))["zones"][0]["running"], data(desk, (STOP, "Home"))["zones"][0]["not_stopped"]) == (
        False, False)


def test_a_zone_that_is_gone_is_shown_no_more(desk):
    desk.show([("en", "Home"), ("en", "Hall")])
    hall = data(desk, (STOP, "Hall"))
    assert data(desk, ("page.zone", "en", "Hall")) is None and hall is None
    desk.put(zone_of("Hall"))
    assert data(desk, (STOP, "Home")) == {"all": False, "successor": "", "zones": []}
    assert [one["zone"] for one in data(desk, (STOP, ""))["zones"]] == ["Hall"]
    assert data(desk) is None and data(desk, CLOCK) is None
    assert data(desk, ("page.zone", "en", "Hall"))["zone"] == "Hall"
    assert [one["zone"] for one in data(desk, ("page.zones", "en"))] == ["Hall"]
    desk.put(zone_of())
    assert data(desk)["zone"] == "Home" and data(desk, (STOP, "Home"))["zones"][0]["running"], "it is there again"


@pytest.mark.parametrize(
    "name, key", [("zone_page", "page.zone"), ("zones_page", "page.zones"), ("clock_page", "page.clock")])
def test_a_document_that_cannot_be_made_costs_no_other_phone_anything(desk, monkeypatch, caplog, name, key):
    """In a language whose texts raise, as the German ones of a manual operation once did."""
    real = getattr(device_documents, name)

    def make(*what):
        if device_documents.sheets.phase("idle") != "NOT CONNECTED":
            raise TypeError(f"{name}: tr() got multiple values for argument 'text'")
        return real(*what)

    desk.show([("de", "Home"), ("en", "Home")])
    monkeypatch.setattr(device_documents, name, make)
    for n in range(1, 4):
        desk.put(zone_of(identity=f"run {n}", team=f"Team {n}", clock=RunClock(600.0, Count(10.0 * n, MONO))))
        desk.pass_time(1.0)
    documents = {one: data(desk, (one, "de", "Home") if one != "page.zones" else (one, "de"))
                 for one in ("page.zone", "page.zones", "page.clock")}
    assert documents.pop(key) is None and None not in documents.values()
    assert (data(desk)["team"], data(desk, CLOCK)["main"]["text"]) == ("Team 3", "9:27")
    assert data(desk, (STOP, "Home"))["zones"][0]["identity"] == "run 3"
    assert len(caplog.records) == 1, "it is logged once"
    monkeypatch.setattr(device_documents, name, real)
    assert desk.look()
    assert data(desk, (key, "de", "Home") if key != "page.zones" else (key, "de")) is not None


def test_a_stop_document_that_cannot_be_made_costs_nothing_else(desk, monkeypatch):
    monkeypatch.setattr(device_documents, "stop_page", lambda *shown: 1 / 0)
    desk.put(zone_of(identity="run 2"))
    assert data(desk, (STOP, "")) is None and data(desk)["identity"] == "run 2"


def test_a_language_whose_translation_raises_is_english(desk):
    def translate(text, n):
        raise TypeError("tr() got multiple values for argument 'text'")

    desk._store._languages["bad"] = translate
    desk.show([("bad", "Home"), ("en", "Home")])
    desk.put(zone_of(team="Beta", manual_operation="Move the robot"))
    assert data(desk, ("page.zone", "bad", "Home")) == data(desk)
