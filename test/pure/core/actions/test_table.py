"""Every action of the table is carried out, recorded and refused in one place."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.core import effects
from roah_rsbb.core.actions import table
from roah_rsbb.core.actions.runs import SIGNED_OFF
from roah_rsbb.core.actions.table import KINDS, Target, confirmed_by
from roah_rsbb.model.actions import ACTIONS, ENTRIES, EVERY
from roah_rsbb.model.reason import Refused, RunName, decoded, encoded
from roah_rsbb.model.records import Phase


def refusal(driver, target, name, given=None):
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.event(driver.box.act, target, name, "Anna", given or {})
    return refused.value.reasons


def test_what_faces_show_has_the_order_of_the_table_whatever_that_of_the_code(monkeypatch):
    driver = BoxDriver()
    expected = driver.box.actions.shown(driver.now, driver.box.zones["tbm"])
    monkeypatch.setattr(table, "KINDS", table.KINDS[::-1])
    other = BoxDriver()
    assert other.box.actions.shown(other.now, other.box.zones["tbm"]) == expected


def test_each_row_of_the_table_has_code():
    box = BoxDriver().box
    assert sorted(kind.name for kind in KINDS) == sorted(ACTIONS)
    assert set(box.entries._all) == set(ENTRIES)
    assert not set(ACTIONS) & set(ENTRIES)


def test_an_unknown_action():
    assert refusal(BoxDriver(), Target("tbm"), "connekt") == ["no action 'connekt': did you mean 'connect'?"]


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("given", [{"no such field": 1}, {"robot": [1], "reason": {}, "running": "x", "command": "y"}])
def test_wrong_values_are_refused_and_recorded(name, given):
    driver = BoxDriver()
    reasons = refusal(driver, Target("tbm"), name, given)
    recorded, = driver.taken(effects.Recorded)
    assert recorded.value["refused"] == reasons and recorded.who == "Anna"
    journaled = {kind.name: kind.journaled for kind in KINDS}
    journaled.update(judge_mark="mark", withdraw_sheet="withdraw")
    assert recorded.value["command"] == (journaled.get(name) or name)


@pytest.mark.parametrize("name", [name for name in EVERY if name not in ("connect", "publish")])
def test_an_unknown_zone_is_refused_with_the_zones_that_there_are(name):
    given = {"team": "Alpha", "event": "x", "judge": "Ben", "desc": "door", "number": 1, "entry": 1, "id": "x"}
    fields = {field.name for field in EVERY[name].fields}
    reasons = refusal(BoxDriver(), Target("tmb"), name, {key: value for key, value in given.items() if key in fields})
    assert "no zone 'tmb': did you mean 'tbm'?" in reasons or "name the run" in reasons[0]


@pytest.mark.parametrize("name, more", [
    *((name, more) for name in ("mark", "settle") for more in ({}, {"text": ""}, {"text": "", "not_attempted": False})),
    ("judge_mark", {}),
])
def test_an_item_gets_no_value_that_nobody_gave(name, more):
    driver = BoxDriver()
    driver.executing()
    given = {"group": "Penalized", "desc": "bumps", **({"judge": "Ben"} if name == "judge_mark" else {}), **more}
    reasons = refusal(driver, Target("tbm", driver.run_in().identity), name, given)
    assert reasons == ["The item gets no value: give its value, or say that it was not attempted"]


def test_a_mark_of_an_older_page_that_is_sent_again_is_no_error():
    """It said no value where it meant 0."""
    driver = BoxDriver()
    driver.executing()
    run, mark = RunName("tbm", driver.run_in().identity), {"group": "Penalized", "desc": "bumps", "id": "one"}
    driver.enter("mark", run, value=2, **mark)
    driver.enter("mark", run, **mark)
    other = {**mark, "group": "Achievements", "desc": "detects the door"}
    assert refusal(driver, Target(*run), "mark", {**other, "value": 1}) == [
        "the id 'one' was used for 'bumps': give each mark a new UUID"]
    assert [item.value for item in driver.run_in().sheet.items()][-1] == 2


@pytest.mark.parametrize("given", [{"reason": 5}, {"reason": None}, {"reason": "\ud800"}, {"foo": 1}])
def test_nothing_that_is_given_with_stop_prevents_it(given):
    driver = BoxDriver()
    driver.executing()
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", given)
    assert driver.run_in().phase is Phase.ENDED


def test_an_unknown_zone_is_the_reason_also_where_a_run_is_named():
    assert refusal(BoxDriver(), Target("tmb", "HGTKMH-1-2.000"), "sign_off") == [
        "no zone 'tmb': did you mean 'tbm'?"]


def test_a_call_that_means_another_run_or_event_changes_nothing():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    driver.connected()
    assert refusal(driver, Target("tbm", "HGTKMH-1-2.000"), "start") == [
        "run HGTKMH-1-2.000 is not connected in zone 'tbm'"]
    assert refusal(driver, Target("tbm", event="other"), "next") == [
        "Zone 'tbm' is at another event of team Alpha now: choose the event first"]
    driver.event(driver.box.act, Target("tbm", driver.run_in().identity), "start")


@pytest.mark.parametrize("code", ["HGTKMH", "HOMF", "HSUF"])
def test_what_is_kept_of_zones_without_a_run_is_as_it_would_be_made(code):
    driver = BoxDriver(competition(tbm=[code]))
    zone, actions = driver.box.zones["tbm"], driver.box.actions
    kept = [name for name in ACTIONS if actions[name].off_without_run is not None]
    assert len(kept) == 9
    shown = actions.shown(driver.now, zone)
    assert list(shown) == list(ACTIONS)
    for name, found in shown.items():
        action, form = actions[name], actions[name].form(driver.now, zone)
        nothing = {field.name: field.nothing for field in action.action.fields}
        assert found == (
            tuple(action.off(driver.now, zone, nothing)), action.shown(zone),
            None if form is action.action.fields else form, action.text(zone), action.question(driver.now, zone)), name


@pytest.mark.parametrize("name", ["connect", "open_sheet", "no_show", "withdrawn"])
def test_a_result_that_is_signed_off_is_replaced_only_by_who_says_so(name):
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    driver.executing()
    driver.command("stop")
    driver.command("disconnect")
    assert driver.view().action(name).question == ""
    record = driver.box.finished.records()[0]
    driver.event(driver.box.scores.sign_off, RunName("tbm", record.identity), "Anna")
    shown = driver.view()
    assert shown.action(name).question == SIGNED_OFF in shown.state
    with pytest.raises(Refused, match=f"^{SIGNED_OFF}. For another attempt, press the button again and confirm$") as e:
        driver.command(name)
    assert confirmed_by(decoded(encoded(e.value.reasons)), "Give it") == [f"{SIGNED_OFF}. Give it"]
    assert confirmed_by([SIGNED_OFF], "Give it") == [SIGNED_OFF]
    assert driver.run_in() is None and len(driver.box.finished.records()) == 1
    driver.command("next")
    assert driver.view().action(name).question == ""
    driver.command("previous")
    driver.robot().beacon()
    driver.command(name, again=True)
    assert driver.view().action(name).question == "", "the run that there is now is asked for"
    assert len(driver.box.finished.records()) + (driver.run_in() is not None) == 2


def test_a_run_in_progress_is_left_only_by_who_knows_it():
    driver = BoxDriver()
    driver.executing()
    shown = Target("tbm", driver.run_in().identity)
    assert "is running: stop it first" in refusal(driver, shown, "disconnect")[0]
    driver.event(driver.box.act, shown, "disconnect", "Anna", {"running": True})
    assert driver.run_in() is None
