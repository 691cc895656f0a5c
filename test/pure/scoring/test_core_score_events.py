"""The referee's scores, stops and sign-offs, and the record of who gave them."""

import contextlib
import json

import pytest

from helpers.all_robots import connected as all_connected
from helpers.all_robots import running as all_running
from helpers.box_driver import BoxDriver
from helpers.commands import mark_with
from helpers.competition import BUMPS, DOOR, OBJECTS, competition, event
from helpers.module_player import started
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.modules import ScoreValue
from roah_rsbb.model.reason import MAX_NOTE, MAX_WHO, Refused, RunName
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.scoring.book import MAX_STOPS
from roah_rsbb.scoring.sheet import Mark


@pytest.fixture
def driver():
    return BoxDriver(competition(tbm=["HGTKMH"], other=[event("HWV", team="Beta")]), Settings(auto_next=False))


def _score(driver, item, value=0, name=None, who="Anna", **of_mark):
    name = name or RunName("tbm")
    driver.mark(name, Mark(item.group, item.desc, value, **of_mark), who)


def _record(driver, zone="tbm"):
    return driver.run_in(zone).record(driver.now)


def _values(record):
    return {item.desc: "-" if item.not_attempted else item.value for item in record.items}


def _finished(driver, **of_driver):
    """A run that is over: its name."""
    driver.executing(**of_driver)
    name = RunName("tbm", driver.run_in().identity)
    driver.command("disconnect")
    return name


def _refused(driver, method, *arguments):
    """Return the reasons of a refusal, and check that only the attempt was recorded."""
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.event(method, *arguments)
    assert {type(effect) for effect in driver.taken()} <= {effects.Recorded}
    return refused.value.reasons


# -- the record of a run ----------------------------------------------------------------------------


def test_a_record_says_which_run_it_is_of(driver):
    opened = driver.now.utc + 3.0
    driver.run(3.0)
    driver.connected()
    run, of_event = driver.run_in(), driver.box.zones["tbm"].event
    record = _record(driver)
    assert record.identity == run.identity == f"HGTKMH-{run.port}-{opened:.3f}"
    assert record[1:8] == (
        "tbm", "HGTKMH", of_event.team, of_event.round, of_event.run, of_event.scheduled, opened
    )
    assert (record.robots, record.started_utc, record.closed_utc, record.end_reason) == (("r1",), 0.0, 0.0, "")
    assert [item[:4] for item in record.items] == [
        (DOOR.group, DOOR.desc, "bool", 0), (OBJECTS.group, OBJECTS.desc, "uint", 0),
        (BUMPS.group, BUMPS.desc, "uint", 0),
    ]


def test_a_record_follows_a_run_through_its_life(driver):
    robot = driver.connected()
    driver.command("start")
    started_utc = driver.now.utc
    robot.lives(20.0)
    assert (_record(driver).started_utc, _record(driver).elapsed_s) == (started_utc, pytest.approx(20.0))
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", {"reason": "in the way of the camera"})
    robot.lives(5.0)
    record = _record(driver)
    assert (record.end_reason, record.elapsed_s) == ("stopped", pytest.approx(20.0))
    driver.command("start")
    assert (_record(driver).end_reason, len(_record(driver).stops)) == ("", 1)
    driver.run(10.0)
    driver.event(driver.box.act, Target("tbm"), "disconnect", "Ben", {"running": True})
    (record,) = driver.box.finished.records()
    assert (record.end_reason, record.closed_utc, record.elapsed_s) == (
        "stopped", driver.now.utc, pytest.approx(35.0)
    )
    first, second = record.stops
    assert first[1:] == (
        "Anna", "stopped", "Benchmark stopped by the referee", "in the way of the camera", "Anna", 20.0)
    assert second[1:] == ("Ben", "stopped", "Benchmark stopped by the referee", "", "", pytest.approx(35.0))
    assert (first.utc, second.utc) == (started_utc + 20.0, driver.now.utc)


def test_an_end_that_comes_by_itself_is_nobodys():
    driver = BoxDriver(competition(tbm=[event(timeout=30)]))
    driver.executing()
    driver.run(40.0)
    record = _record(driver)
    assert (record.end_reason, record.elapsed_s) == ("timeout", pytest.approx(30.0))
    assert [stop[1:] for stop in record.stops] == [("", "timeout", "Stopped due to timeout", "", "", 30.0)]


def test_every_change_of_a_record_is_published(driver):
    """The journal always contains the valid record."""
    def last():
        reported = [effect.record for effect in driver.taken(effects.RecordChanged)]
        return reported[-1] if reported else None

    robot = driver.connected()
    assert last() == _record(driver)
    driver.command("start")
    assert last().started_utc == driver.now.utc
    _score(driver, BUMPS, 2)
    assert last() == _record(driver)
    driver.event(driver.box.scores.withdraw, RunName("tbm"), 1)
    assert last() == _record(driver)
    robot.executes()
    assert last() is None
    robot.completes()
    assert last() == _record(driver)
    driver.event(driver.box.scores.give_stop_reason, RunName("tbm"), "well done", "Anna")
    assert last() == _record(driver)
    name = RunName("tbm", driver.run_in().identity)
    driver.command("disconnect")
    assert last() == driver.box.finished.records()[0]
    _score(driver, DOOR, 1, name)
    assert last() == driver.box.finished.records()[0]
    driver.event(driver.box.scores.withdraw, name, 2)
    assert last() == driver.box.finished.records()[0]
    driver.event(driver.box.scores.give_stop_reason, name, "very well done")
    assert last() == driver.box.finished.records()[0]
    driver.enter("sign_off", name, "Anna")
    assert last() == driver.box.finished.records()[0]


def test_what_a_module_scored_is_in_the_record():
    driver, modules, _ = started()
    driver.taken()
    reached = ScoreValue("", "reached", "1", "")
    modules.says(scores=(reached,))
    assert [effect.record.module_scores for effect in driver.taken(effects.RecordChanged)] == [(reached,)]
    driver.command("disconnect")
    assert driver.box.finished.records()[0].module_scores == (reached,)


def test_a_module_receives_the_time_of_an_attempt_when_it_has_ended():
    driver, modules, robot = started()
    modules.lives(10.0, robot)
    driver.command("stop")
    assert modules.run().elapsed_s == pytest.approx(10.0, abs=0.5)
    robot.says(RobotState.STOP)
    modules.beat()
    driver.command("start")
    assert modules.run().elapsed_s == 0.0


def test_all_robots_have_one_record():
    driver, robots = all_running()
    identity = driver.run_in().identity
    record = _record(driver)
    assert record.robots == ("r1 of team Alpha", "r2 of team Beta", "r3 of team Gamma")
    driver.run(10.0)
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", {"reason": "fire alarm"})
    reported = driver.taken(effects.RecordChanged)
    assert {effect.record.identity for effect in reported} == {identity}
    (stop,) = reported[-1].record.stops
    assert (stop.who, stop.end_reason, stop.reason) == ("Anna", "stopped", "fire alarm")
    assert stop.desc.startswith("Benchmark stopped by the referee (3 stopped")
    driver.command("disconnect")
    (record,) = driver.box.finished.records()
    assert (record.identity, record.end_reason, len(record.stops)) == (identity, "stopped", 1)


# -- scores of the run in the zone ------------------------------------------------------------------


def test_a_score_has_who_and_note_and_the_log_the_value(driver):
    robot = driver.connected()
    mark = Mark(BUMPS.group, BUMPS.desc, 2, note="both at the door")
    driver.mark(RunName("tbm"), mark, "Anna")
    (entry,) = _record(driver).history
    assert (entry.who, entry.note, entry.value, entry.correction) == ("Anna", "both at the door", 2, False)
    assert driver.logged(robot.port, run_log.SCORE) == [("Penalized", "bumps", 2)]
    assert "Score: Penalized: bumps 0 -> 2 (both at the door)" in driver.view().log


def test_not_attempted_and_withdrawn_are_logged_with_the_value_that_counts(driver):
    robot = driver.connected()
    _score(driver, BUMPS, 2)
    _score(driver, BUMPS, not_attempted=True)
    assert _values(_record(driver))["bumps"] == "-"
    driver.event(driver.box.scores.withdraw, RunName("tbm"), 2, "Ben", "it did try")
    assert _values(_record(driver))["bumps"] == 2
    assert driver.logged(robot.port, run_log.SCORE) == [("Penalized", "bumps", value) for value in (2, 0, 2)]
    assert "Score: Penalized: bumps not attempted -> 2 (entry 2 withdrawn, it did try)" in driver.view().log
    withdrawn = _record(driver).history[1]
    assert (withdrawn.withdrawn_by, withdrawn.withdrawn_note, withdrawn.withdrawal_corrects) == (
        "Ben", "it did try", False
    )


def test_typed_text_is_one_line_and_bounded(driver):
    driver.connected()
    _score(driver, BUMPS, 1, who=" A\tB\n" + "x" * 1000, note="  two\n lines\x00 ")
    (entry,) = _record(driver).history
    assert entry.note == "two lines"
    assert entry.who.startswith("A B xxx") and len(entry.who) == MAX_WHO
    mark = Mark(BUMPS.group, BUMPS.desc, 2, note="y" * (MAX_NOTE + 1))
    (reason,) = _refused(driver, driver.box.scores.mark, RunName("tbm"), mark, "Anna")
    assert "at most 500 are kept, shorten it" in reason


# -- stops ------------------------------------------------------------------------------------------


def test_no_stop_is_refused_for_many_words(driver):
    robot = driver.executing()
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", {"reason": "z" * 10_000})
    assert driver.box_state() is BoxState.STOP
    assert _record(driver).stops[0].reason == "z" * MAX_NOTE
    assert robot.port == driver.run_in().port


def test_a_reason_can_be_typed_after_the_stop_also_of_an_earlier_one(driver):
    robot = driver.executing()
    assert _refused(driver, driver.box.scores.give_stop_reason, RunName("tbm"), "x") == [
        "the run was not stopped yet, so it cannot have a reason"
    ]
    driver.command("stop")
    robot.says(RobotState.STOP)
    driver.command("start")
    driver.command("stop")
    driver.event(driver.box.scores.give_stop_reason, RunName("tbm"), "second", "Anna")
    driver.event(driver.box.scores.give_stop_reason, RunName("tbm"), "first", "Ben", 1)
    assert [(stop.reason, stop.reason_by) for stop in _record(driver).stops] == [("first", "Ben"), ("second", "Anna")]
    assert "Benchmark stopped by the referee: second" in driver.view().log
    assert _refused(driver, driver.box.scores.give_stop_reason, RunName("tbm"), "x", "", 3) == [
        "the run has no stop 3: choose from 1 to 2, or 0 for the last one"
    ]
    assert _refused(driver, driver.box.scores.give_stop_reason, RunName("tbm"), "x", "", -1)


def test_stops_are_bounded_and_those_with_a_reason_stay_longest(driver):
    robot = driver.executing()
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", {"reason": "the first"})
    for _ in range(MAX_STOPS + 5):
        robot.says(RobotState.STOP)
        driver.command("start")
        driver.command("stop")
    stops = _record(driver).stops
    assert (len(stops), stops[0].reason) == (MAX_STOPS, "the first")


# -- runs that are over -----------------------------------------------------------------------------


def test_a_run_that_is_over_is_corrected_by_its_identity(driver):
    name = _finished(driver)
    driver.taken()
    _score(driver, BUMPS, 4, name, who="Ben", note="seen on video")
    record = driver.box.finished.find(name.identity).record
    assert [(item.value, item.corrected) for item in record.items if item.desc == "bumps"] == [(4, True)]
    assert driver.notices() == [
        "HGTKMH, team Alpha, round 1, run 1: Correction: Score: Penalized: bumps 0 -> 4 (seen on video)"
    ]
    assert driver.taken(effects.RunLogged) == []  # its log is closed


def test_only_a_run_that_is_over_is_signed_off(driver):
    driver.executing()
    name = RunName("tbm", driver.run_in().identity)
    assert _refused(driver, driver.box.scores.sign_off, name) == [
        f"run {name.identity} is still connected: disconnect it first"
    ]
    assert _refused(driver, driver.box.scores.sign_off, RunName("tbm")) == [
        "name the run to sign off: only a run that is over can be signed off"
    ]
    driver.command("disconnect")
    driver.connected()
    never = driver.run_in().identity
    driver.command("disconnect")
    (reason,) = _refused(driver, driver.box.scores.sign_off, RunName("tbm", never))
    assert f"'{never}' is not one of the newest" in reason


def test_a_run_of_another_zone_is_refused(driver):
    name = _finished(driver)
    assert _refused(driver, driver.box.scores.withdraw, RunName("other", name.identity), 1) == [
        f"run {name.identity} was in zone 'tbm', not in 'other'"
    ]
    assert "no zone 'x'" in _refused(driver, driver.box.scores.withdraw, RunName("x"), 1)[0]


# -- who did what -----------------------------------------------------------------------------------


def _done(driver):
    return driver.taken(effects.Recorded)


def test_every_command_is_on_record_before_what_it_leads_to(driver):
    driver.robot().beacon()
    driver.taken()
    driver.event(driver.box.act, Target("tbm"), "connect", "/panel")
    first = driver.taken()[0]
    run = driver.run_in()
    assert first == ("tbm", run.identity, run.port, "command", {"command": "connect"}, "/panel")


def test_a_command_that_is_refused_is_on_record_with_the_reasons(driver):
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.event(driver.box.act, Target("tbm"), "start", "/panel")
    assert _done(driver) == [
        ("tbm", "", None, "command", {"command": "start", "refused": refused.value.reasons}, "/panel")
    ]


def test_all_that_a_referee_does_is_on_record(driver):
    name = _finished(driver)
    now, last = Target("tbm"), Target(*name)
    for target, action, given, value in (
        (now, "mark", mark_with(Mark("Penalized", "bumps", 1)), {"group": "Penalized", "item": "bumps", "value": 1}),
        (last, "mark", mark_with(Mark("Penalized", "bumps", not_attempted=True, note="n")),
         {"group": "Penalized", "item": "bumps", "not_attempted": True, "note": "n"}),
        (last, "withdraw", {"entry": 7}, {"entry": 7}),
        (last, "stop_reason", {"reason": "r"}, {"reason": "r", "stop": 0}),
        (last, "sign_off", {}, {}),
        (now, "operation", {"operation": 3, "answer": "yes"}, {"operation": 3, "answer": "yes"}),
        (now, "switch", {"number": 2}, {"switch": 2}),
        (now, "damaged", {"number": 1}, {"damaged": 1}),
        (now, "confirm_switches", {}, {}),
    ):
        driver.taken()
        with contextlib.suppress(Refused):
            driver.event(driver.box.act, target, action, "", given)
        (done,) = _done(driver)
        reported = {key: found for key, found in done.value.items() if key not in ("command", "refused")}
        assert (done.zone, reported) == ("tbm", value)
        json.dumps(done.value)


def test_wrong_names_cannot_fill_the_disk(driver):
    driver.taken()
    with pytest.raises(Refused):
        mark = Mark("g" * 100_000, "d", 1, note="n" * 100_000)
        driver.mark(RunName("z" * 100_000), mark, "w" * 100_000)
    (done,) = _done(driver)
    assert len(str(done)) < 10 * MAX_NOTE


def test_a_run_of_all_robots_has_no_port_of_its_own():
    driver, robots = all_connected()
    driver.taken()
    driver.event(driver.box.act, Target("tbm"), "start", "Anna")
    (done,) = _done(driver)
    assert (done.identity, done.port) == (driver.run_in().identity, None)


def test_the_run_log_has_the_complete_value_of_a_mark_that_is_no_whole_number():
    water = ScoringItem("Penalized", "water", ScoreKind.DECIMAL)
    driver = BoxDriver(competition(tbm=[event("HGTKMH", scoring=(water, BUMPS))]), Settings(auto_next=False))
    driver.executing()
    driver.taken(effects.RunLogged)
    _score(driver, water, text="2.75")
    _score(driver, BUMPS, 1)
    _score(driver, water, not_attempted=True)
    logged = [(effect.topic, effect.value) for effect in driver.taken(effects.RunLogged)
              if effect.topic in (run_log.SCORE, run_log.SCORE_TEXT)]
    assert logged == [
        (run_log.SCORE, ("Penalized", "water", 2)), (run_log.SCORE_TEXT, "Penalized: water: 2.75"),
        (run_log.SCORE, ("Penalized", "bumps", 1)),
        (run_log.SCORE, ("Penalized", "water", 0)), (run_log.SCORE_TEXT, "Penalized: water: not attempted"),
    ]
