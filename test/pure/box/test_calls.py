"""Calls turn into events with the caller's name, and answer when what they did is on the disks."""

import json
from types import SimpleNamespace

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, OBJECTS, competition, event, id_of
from roah_rsbb.box.calls import MAX_TEXT, BoxCalls, Disks
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.copies import unconfirmed
from roah_rsbb.document.calls import Caller, Waiting, carried_out, waited
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.results import JudgedRun, RunSheet

NOW = Now(12.5, 1447000000.25)
RUN = RunName("Home", "HWV-1-2")
TICKET = 7
ITEM = {"number": 4, "value": 2, "not_attempted": False, "text": "2.5"}
CALLER = Caller()


class Recorded:
    """A box that only records what is called, and disks that say what a test wants."""

    def __init__(self):
        self.happened = []
        self.refuses, self.waits = False, False
        self.disk_trouble, self.standby_trouble = "", ""
        self.ticket = TICKET
        box = SimpleNamespace(act=self._event("act"), scores=SimpleNamespace(stop=self._event("stop")),
                              entries=SimpleNamespace(
                                  outcome=lambda target, action, given: ITEM if action == "mark" else {}))
        self.calls = BoxCalls(box, lambda method, *arguments: method(NOW, *arguments), Disks(
            lambda: self.ticket, self._why_not_saved, self._ask_standby, lambda ticket: ""))

    def _event(self, name):
        def event(*arguments):
            if self.refuses:
                raise Refused(["first reason", "second reason"])
            self.happened.append((name, *arguments))

        return event

    def _why_not_saved(self, ticket):
        assert ticket == TICKET
        self.happened.append("on disk")
        return self.disk_trouble

    def _ask_standby(self, ticket):
        assert ticket == TICKET
        return SimpleNamespace(result=self._of_standby) if self.waits else None

    def _of_standby(self, _limit_s):
        self.happened.append("on the standby")
        return self.standby_trouble

    def call(self, name, **arguments):
        found = carried_out(self.calls.named()[name], arguments, CALLER)
        return waited(found) if isinstance(found, Waiting) else found


@pytest.fixture
def box():
    return Recorded()


def test_a_call_has_the_name_of_the_referee_and_the_program(box):
    for by, node, who in (("Anna", "/panel", "Anna (/panel)"), (" Anna ", "", "Anna"), ("", "/panel", "/panel")):
        box.happened = []
        assert box.call("stop", zone="Home", run=RUN.identity, by=by, node=node) == {"answer": None}
        assert box.happened == [("stop", NOW, RUN, who)]


def test_an_action_has_the_run_and_the_event_that_its_caller_sees(box):
    box.call("act", action="no_show", zone="Home", run=RUN.identity, event="e1", given={"team": "Alpha"}, by="Anna")
    box.call("act", action="start", zone="Home")
    assert box.happened == [
        ("act", NOW, Target("Home", RUN.identity, "e1"), "no_show", "Anna", {"team": "Alpha"}),
        ("act", NOW, Target("Home"), "start", "", {})]


@pytest.mark.parametrize("broken", [
    {"given": []}, {"given": "{}"}, {"zone": 7}, {"zone": None}, {"action": ["start"]}, {"by": "x" * (MAX_TEXT + 1)},
    {"run": "\ud800"}])
def test_malformed_arguments_are_refused_with_what_is_expected(box, broken):
    answer = box.call("act", **{"action": "start", "zone": "Home", **broken})
    assert "not a" in json.dumps(answer["refused"]) and box.happened == []


def test_a_value_outside_of_given_is_refused_but_stop_is_carried_out(box):
    (why,) = box.call("act", action="mark", zone="Home", run="", desc="bumps", value="1")["refused"]
    assert "the values of the fields of an action go into given" in str(why) and "'desc'" in str(why)
    assert box.happened == []
    assert box.call("stop", zone="Home", run="", desc="bumps") == {"answer": None}


def test_what_a_referee_writes_down_is_on_the_disks_when_the_answer_comes(box):
    event = ("act", NOW, Target(*RUN), "sign_off", "", {})
    assert box.call("act", action="sign_off", zone="Home", run=RUN.identity) == {"answer": None}
    assert box.happened == [event, "on disk"]
    box.happened, box.waits = [], True
    box.call("act", action="sign_off", zone="Home", run=RUN.identity)
    assert box.happened == [event, "on disk", "on the standby"]


def test_a_command_waits_for_no_disk(box):
    box.waits, box.disk_trouble = True, "the disk is full"
    assert box.call("act", action="start", zone="Home") == {"answer": None}
    assert box.call("stop", zone="Home", run="") == {"answer": None}
    assert len(box.happened) == 2


def test_the_answer_to_a_mark_has_the_item_as_it_is_then(box):
    assert box.call("act", action="mark", zone="Home", run=RUN.identity, given={"id": "1"}) == {"answer": ITEM}


def test_a_refusal_has_all_reasons_and_waits_for_no_disk(box):
    box.refuses = True
    for name in ("act", "stop"):
        assert box.call(name, action="sign_off", zone="Home", run="") == {
            "refused": ["first reason", "second reason"]}
    assert box.happened == []


@pytest.mark.parametrize("trouble", ["disk", "standby", "record"])
def test_a_score_that_is_not_on_the_disks_is_not_confirmed_and_counts(box, trouble):
    expected = {"disk": "not saved: the disk is full. It counts", "record": "not saved: internal error",
                "standby": "not confirmed: no standby. It counts, and is saved on"}[trouble]
    box.disk_trouble = "the disk is full" if trouble == "disk" else ""
    box.standby_trouble, box.waits = (unconfirmed("no standby"), True) if trouble == "standby" else ("", False)
    box.ticket = None if trouble == "record" else TICKET
    answer = box.call("act", action="sign_off", zone="Home", run=RUN.identity)
    assert answer["known"] is False
    [template, values] = answer["refused"][0] if isinstance(answer["refused"][0], list) else (answer["refused"][0], {})
    assert template.format(**{name: _text(value) for name, value in values.items()}).startswith(expected)


def _text(value):
    return value[0].format(**value[1]) if isinstance(value, list) else value


def test_sheet_and_judges_of_a_run():
    driver = BoxDriver(competition(tbm=["HGTKMH"]))
    calls = BoxCalls(driver.box, driver.event).named()
    empty = from_json(RunSheet, carried_out(calls["sheet"], {"zone": "tbm", "run": ""}, CALLER)["answer"])
    assert "refused" in carried_out(calls["sheet"], {"zone": "fbm", "run": ""}, CALLER)
    driver.connected()
    driver.score(BUMPS.group, BUMPS.desc, 2)
    found = carried_out(calls["sheet"], {"zone": "tbm", "run": ""}, CALLER)
    sheet = from_json(RunSheet, json.loads(json.dumps(found["answer"])))
    assert (sheet.run.identity, sheet.run.closed_utc_s) == (driver.run_in().identity, None)
    assert [(entry.item, entry.old, entry.value) for entry in sheet.history] == [(BUMPS.desc, 0, 2)]
    assert [item.value for item in sheet.items if item.desc == BUMPS.desc] == [2]
    assert (empty.run.identity, empty.run.team, [item.desc for item in empty.items]) == (
        "", sheet.run.team, [item.desc for item in sheet.items])
    judged = carried_out(calls["judges"], {"zone": "tbm", "run": sheet.run.identity}, CALLER)
    assert from_json(JudgedRun, judged["answer"]).items == sheet.items
    assert "refused" in carried_out(calls["sheet"], {"zone": "tbm", "run": "HWV-1-2"}, CALLER)


def test_the_empty_sheet_of_any_event_of_a_zone():
    later = event("HWV", scoring=(OBJECTS,))
    driver = BoxDriver(competition(tbm=[event("HGTKMH"), later]))
    calls = BoxCalls(driver.box, driver.event).named()
    asked = {"zone": "tbm", "run": "", "event": id_of(later)}
    driver.connected()
    sheet = from_json(RunSheet, carried_out(calls["sheet"], asked, CALLER)["answer"])
    assert (sheet.run.identity, sheet.run.code) == ("", "HWV")
    assert [item.desc for item in sheet.items] == [OBJECTS.desc]
    assert "has no event" in str(carried_out(calls["sheet"], {**asked, "event": "HWV:Gone"}, CALLER)["refused"])
