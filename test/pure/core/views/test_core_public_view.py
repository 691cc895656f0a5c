"""The box as the public may see it."""

import pytest

from helpers.all_robots import all_robots_box, connect_all, robots_of, start_all
from helpers.box_driver import BoxDriver
from helpers.competition import DOOR, UTC0, competition, event, run_record
from helpers.module_player import started
from roah_rsbb.core.views.public import MAX_FINISHED, MAX_FOLLOWING, PublicResults, public_view
from roah_rsbb.model.modules import RequestKind, ScoreValue
from roah_rsbb.model.records import EndReason, Phase, SignOff
from roah_rsbb.model.referee import RunName

NONE, OUTCOMES, SCORES = PublicResults.NONE, PublicResults.OUTCOMES, PublicResults.SCORES


def _view(driver, results=NONE):
    return public_view(driver.box, driver.now, results)


def _run(driver, results=NONE):
    (run,) = _view(driver, results).runs
    return run


def _following(driver):
    return [(line.zone, line.event.benchmark.code) for line in _view(driver).following]


def test_a_run_from_connect_to_its_end():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)], other=["HWV"]))
    assert _view(driver).runs == ()
    robot = driver.connected()
    run = _run(driver)
    assert (run.zone, run.event.benchmark.code, run.teams) == ("tbm", "HGTKMH", ("Alpha",))
    assert (run.phase, run.counting, run.left, run.end_reason) == (Phase.CONNECTED, False, 60.0, None)
    driver.command("start")
    robot.lives(20)
    run = _run(driver)
    assert (run.phase, run.counting) == (Phase.RUNNING, True)
    assert run.left == pytest.approx(40.0, abs=0.1)
    driver.command("stop")
    run = _run(driver, OUTCOMES)
    assert (run.phase, run.counting, run.end_reason) == (Phase.ENDED, False, EndReason.STOPPED)


def test_how_a_run_ended_is_published_only_if_allowed():
    driver = BoxDriver()
    driver.executing()
    driver.command("stop")
    assert [_run(driver, results).end_reason for results in (NONE, OUTCOMES, SCORES)] == [
        None, EndReason.STOPPED, EndReason.STOPPED
    ]


def test_the_time_of_the_whole_run_counts_and_pauses_during_a_manual_operation():
    driver, modules, robot = started()
    modules.asks(goal="[1, 2, 3]", timeout=5.0)
    modules.lives(2.0, robot)
    assert _run(driver).left == pytest.approx(driver.run_in().clock.left(driver.now)) == pytest.approx(598.0, abs=1.0)
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="Place the object")
    left = _run(driver).left
    modules.lives(10.0, robot)
    assert not _run(driver).counting
    assert _run(driver).left == pytest.approx(left)


def test_all_robots_at_once_name_their_teams():
    driver = all_robots_box()
    robots = robots_of(driver)
    connect_all(driver, robots)
    start_all(driver, robots)
    run = _run(driver)
    assert (run.event.team, run.teams, run.counting) == ("ALL", ("Alpha", "Beta", "Gamma"), True)


def test_what_follows_is_sorted_over_all_zones_and_is_not_what_runs():
    driver = BoxDriver(competition(
        tbm=[event("HGTKMH", scheduled=UTC0), event("HCFGAC", scheduled=UTC0 + 200.0)],
        other=[event("HWV", team="Beta", scheduled=UTC0 + 100.0)],
    ))
    assert _following(driver) == [("tbm", "HGTKMH"), ("other", "HWV"), ("tbm", "HCFGAC")]
    robot = driver.executing()
    assert _following(driver) == [("other", "HWV"), ("tbm", "HCFGAC")]
    driver.command("stop")
    driver.command("disconnect")
    assert _following(driver)[0] == ("tbm", "HGTKMH")  # stopped: the referee may repeat it
    robot = driver.executing()
    robot.completes()
    driver.command("disconnect")
    assert _following(driver) == [("other", "HWV"), ("tbm", "HCFGAC")]


def test_the_last_event_of_a_zone_comes_no_more_once_it_was_completed():
    driver = BoxDriver()
    driver.executing().completes()
    driver.command("disconnect")
    assert _following(driver) == []


def test_the_list_of_next_events_is_bounded():
    driver = BoxDriver(competition(tbm=[event(run=run) for run in range(1, MAX_FOLLOWING + 3)]))
    assert [line.event.run for line in _view(driver).following] == list(range(1, MAX_FOLLOWING + 1))


def _sign(driver):
    identity = driver.box.finished.records()[0].identity
    driver.enter("sign_off", RunName("tbm", identity), "Anna")


def _a_run(driver):
    robot = driver.executing()
    driver.score(DOOR.group, DOOR.desc, 1)
    robot.completes()
    driver.command("disconnect")


def test_results_are_public_once_they_are_signed_off():
    driver = BoxDriver()
    _a_run(driver)
    view = _view(driver, SCORES)
    assert (view.finished, view.provisional) == ((), ())
    _sign(driver)
    view = _view(driver, SCORES)
    assert [run.signed for run in view.finished] == [True]
    _a_run(driver)
    assert _view(driver, SCORES).finished == (), "the run was repeated, and the new one is not signed off"


def test_results_that_are_not_signed_off_are_provisional_if_the_organisers_show_them():
    driver = BoxDriver()
    _a_run(driver)
    view = public_view(driver.box, driver.now, OUTCOMES, provisional=True)
    assert view.finished == ()
    assert [(run.end_reason, run.items) for run in view.provisional] == [("completed", ())]
    assert public_view(driver.box, driver.now, NONE, provisional=True).provisional == ()
    _sign(driver)
    view = public_view(driver.box, driver.now, SCORES, provisional=True)
    assert (len(view.finished), view.provisional) == (1, ())


def test_results_are_published_only_if_allowed():
    driver = BoxDriver()
    _a_run(driver)
    _sign(driver)
    assert _view(driver, NONE).finished == ()
    (outcome,) = _view(driver, OUTCOMES).finished
    assert (outcome.end_reason, outcome.items, outcome.module_scores) == ("completed", (), ())
    (score,) = _view(driver, SCORES).finished
    assert [item.value for item in score.items if item.desc == DOOR.desc] == [1]


def test_what_a_module_scored_is_a_result():
    driver, modules, _ = started()
    reached = ScoreValue("", "reached", "1", "")
    modules.says(scores=(reached,), finished=True)
    driver.command("disconnect")
    _sign(driver)
    assert _view(driver, SCORES).finished[0].module_scores == (reached,)
    assert _view(driver, OUTCOMES).finished[0].module_scores == ()


def test_only_the_newest_results_are_published():
    driver = BoxDriver()
    for run in range(MAX_FINISHED + 1):
        driver.box.finished.add(run_record(run, sign_off=SignOff(1.0, "Anna")))
    assert [run.event.run for run in _view(driver, OUTCOMES).finished] == list(range(MAX_FINISHED, 0, -1))


def test_while_nothing_happens_only_the_time_changes():
    driver = BoxDriver()
    robot = driver.executing()
    before = _view(driver)
    robot.lives(3)
    now = _view(driver)
    assert now != before
    assert now.without_time() == before.without_time()
    driver.command("stop")
    assert _view(driver).without_time() != before.without_time()
