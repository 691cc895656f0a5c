"""Marks in the box: they name their run, have an identity, and arrive again after a kill of the core and a sign-off."""

from decimal import Decimal

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR, competition, event
from helpers.journaled import box as journaled_box
from roah_rsbb.core import effects
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.reason import MAX_WHO, Refused, RunName
from roah_rsbb.model.records import TakenMarks
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.scoring.book import FinishedRun
from roah_rsbb.scoring.sheet import Mark

CUPS = ScoringItem("Table", "cups", ScoreKind.UINT, most=Decimal(3))
ITEMS = (BUMPS, DOOR, CUPS)


def _config():
    return competition(tbm=[event("HGTKMH", scoring=ITEMS)], other=[event("HWV", team="Beta")])


@pytest.fixture
def driver():
    return BoxDriver(_config(), Settings(auto_next=False))


def _plus(number, item=BUMPS, **of_mark):
    return Mark(*item.key, added="1", id=f"mark {number}", role="referee", device="phone", **of_mark)


def _mark(driver, name, mark, who="Anna"):
    driver.mark(name, mark, who)
    return driver.box.scores.outcome(name, mark)


def _refused(driver, name, mark):
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.mark(name, mark, "Anna")
    (recorded,) = driver.taken()
    assert recorded.value["refused"] == refused.value.reasons
    (reason,) = refused.value.reasons
    return reason


def _running(driver):
    driver.executing()
    return RunName("tbm", driver.run_in().identity)


def test_taking_back_arrives_again_after_the_run_and_its_sign_off(driver):
    name = _running(driver)
    _mark(driver, name, Mark(*DOOR.key, 1, id="the door"))
    _mark(driver, name, Mark(*BUMPS.key, 4, id="bumps"))
    driver.enter("take_back", name, "Anna", id="the door")
    driver.command("stop")
    driver.command("disconnect")
    driver.enter("sign_off", name, "Anna")
    driver.enter("take_back", name, "Anna", id="the door")
    with pytest.raises(Refused, match="signed off"):
        driver.enter("take_back", name, "Anna", id="bumps")
    with pytest.raises(Refused, match="name the run"):
        driver.enter("take_back", RunName("tbm"), "Anna", id="bumps")
    history = driver.box.scores.record_of(driver.now, name).history
    assert [(entry.desc, entry.withdrawn_utc > 0) for entry in history] == [(DOOR.desc, True), (BUMPS.desc, False)]


def test_a_mark_is_logged_and_recorded_with_role_and_device(driver):
    name = _running(driver)
    driver.taken()
    for _ in range(2):
        entry, item, _ = _mark(driver, name, _plus(1, note="the vase"))
        assert (entry, item.value) == (1, 1)
    taken = driver.taken()
    recorded = [effect for effect in taken if isinstance(effect, effects.Recorded)]
    assert [(effect.who, effect.value) for effect in recorded] == 2 * [("Anna", {
        "command": "mark", "group": "Penalized", "item": "bumps", "note": "the vase", "added": "1", "mark": "mark 1",
        "role": "referee", "device": "phone"})]
    logged = [effect.value for effect in taken if isinstance(effect, effects.RunLogged)]
    assert logged == [("Penalized", "bumps", 1)]
    assert [effect.topic for effect in taken if isinstance(effect, effects.RunLogged)] == [run_log.SCORE]
    (changed,) = [effect.record for effect in taken if isinstance(effect, effects.RecordChanged)]
    assert [(e.role, e.device, e.added) for e in changed.history] == [("referee", "phone", "1")]
    assert changed.marks == TakenMarks({"mark 1": 1}, 1)
    assert driver.view().log.count("bumps 0 -> 1 (the vase)") == 1


@pytest.mark.parametrize("mark, why", [
    (_plus(1)._replace(id=" "), "the id ' ' cannot identify a mark: give each mark a new UUID"),
    (_plus(1)._replace(id="x" * 65), "cannot identify a mark"),
    (_plus(1)._replace(id="a\nb"), "cannot identify a mark"),
    (_plus(1)._replace(role="king"), "no role 'king': choose one of referee, assistant, judge"),
    (_plus(1, CUPS)._replace(added="4"), "'cups' is a count: its value must be from 0 to 3, not 4"),
])
def test_what_cannot_be_marked_is_refused(driver, mark, why):
    assert why in _refused(driver, _running(driver), mark)


def test_a_mark_names_its_run_and_never_counts_in_the_next(driver):
    name = _running(driver)
    assert _refused(driver, RunName("tbm"), _plus(1)).startswith("name the run")
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    following = _running(driver)
    for _ in range(2):
        _mark(driver, name, _plus(1))
        _mark(driver, name, _plus(2))
    assert driver.box.scores.outcome(following, _plus(3)).item.value == 0
    record = driver.box.finished.find(name.identity).record
    assert [(item.value, item.corrected) for item in record.items if item.desc == "bumps"] == [(2, True)]
    assert [entry.correction for entry in record.history] == [False, True]


def test_a_mark_that_arrives_again_after_the_sign_off_is_no_error(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    driver.enter("sign_off", name, "Cleo (/roah_rsbb_window_1)")
    driver.taken()
    assert _mark(driver, name, _plus(1)).item.value == 1
    assert {type(effect) for effect in driver.taken()} == {effects.Recorded}
    assert "was signed off by Cleo at" in _refused(driver, name, _plus(2))


def test_long_names_of_devices_are_cut(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1)._replace(device="d" * 400))
    assert driver.run_in().record(driver.now).history[0].device == "d" * MAX_WHO


def test_a_finished_run_of_an_older_journal_has_no_marks(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    record = driver.box.finished.find(name.identity).record
    frozen = to_json(record)
    del frozen["marks"]
    del frozen["history"][0]["added"]
    old = FinishedRun(from_json(type(record), frozen), Benchmark("HGTKMH", "", "", 0.0, 0.0, ITEMS))
    assert [item.value for item in old.record.items if item.desc == "bumps"] == [1]
    assert old.sheet.taken("mark 1") is None


@pytest.mark.parametrize("saved, marks", [
    ("", TakenMarks()), ("0 up\n1 \n0 down\n2 a b\n", TakenMarks({"up": 0, "down": 0, "a b": 2}, 2)),
    ("3 one\n7 \n", TakenMarks({"one": 3}, 7))])
def test_marks_of_an_older_journal(saved, marks):
    assert from_json(TakenMarks, saved) == from_json(TakenMarks, to_json(marks)) == marks


@pytest.mark.long
def test_after_a_kill_at_any_record_all_marks_arrive_again_and_count_once(tmp_path):
    """Each record of the journal is a moment at which the core may be killed, before it answers."""
    copies = []

    def keep(driver):
        copies.append(tmp_path / f"copy {len(copies)}")
        driver.copy(copies[-1])

    driver = journaled_box(tmp_path, _config())
    name = _running(driver)
    driver.on_record = keep
    marks = [_plus(number, item) for number, item in enumerate((BUMPS, CUPS, BUMPS, CUPS))]

    def send_all(to):
        for number, mark in enumerate(marks):
            _mark(to, name, mark, "Anna" if number % 2 else "Ben")

    for mark in marks[:2]:
        _mark(driver, name, mark)
    driver.command("disconnect")
    send_all(driver)
    driver.on_record = None
    assert len(copies) >= 5
    for path in copies:
        again = journaled_box(tmp_path / f"after {path.name}", _config())
        again.now = driver.now.later(2.0)
        again.journal.close()
        again.resume_in(path)
        for _ in range(2):
            send_all(again)
        values = {item.desc: item.value for item in again.box.scores.record_of(again.now, name).items}
        assert (values["bumps"], values["cups"]) == (2, 2), path
        again.journal.close()
    driver.journal.close()
