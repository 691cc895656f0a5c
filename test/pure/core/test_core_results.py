"""What is kept of runs that are over."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import DOOR, UTC0, competition, event
from roah_rsbb.core.results import MAX_KEPT, FinishedRun, FinishedRuns
from roah_rsbb.core.run import EndReason


def _kept(driver):
    return [(run.zone, run.event.benchmark.code, run.end_reason) for run in driver.box.finished.newest()]


def test_a_run_is_kept_when_it_is_left_with_the_score_of_then():
    driver = BoxDriver()
    driver.executing().completes()
    assert _kept(driver) == []
    driver.score(DOOR.group, DOOR.desc, 1)
    driver.run(10.0)
    driver.command("disconnect")
    (run,) = driver.box.finished.newest()
    assert (run.zone, run.event, run.end_reason) == ("tbm", driver.box.zones["tbm"].event, EndReason.COMPLETED)
    assert run.disconnected_utc == driver.now.utc
    assert dict(run.scoring[0].items)[DOOR] == 1
    assert run.module_scores == ()


def test_a_run_that_is_left_while_it_runs_was_stopped():
    driver = BoxDriver()
    driver.executing()
    driver.command("disconnect")
    assert _kept(driver) == [("tbm", "HGTKMH", EndReason.STOPPED)]


def test_a_run_that_was_never_started_is_none():
    driver = BoxDriver()
    driver.connected()
    driver.command("disconnect")
    assert _kept(driver) == []


def test_a_run_that_is_repeated_replaces_the_one_before():
    driver = BoxDriver(competition(tbm=["HGTKMH"], other=[event("HWV", team="Beta")]))
    driver.executing()
    driver.command("disconnect")
    driver.executing("other", team="Beta", name="r2", host="10.0.0.3")
    driver.command("disconnect", "other")
    driver.executing().completes()
    driver.command("disconnect")
    assert _kept(driver) == [("tbm", "HGTKMH", EndReason.COMPLETED), ("other", "HWV", EndReason.STOPPED)]


def _run(number, zone="tbm"):
    return FinishedRun(zone, event(run=number), EndReason.STOPPED, UTC0 + number, (), ())


def test_the_oldest_go_where_there_are_too_many():
    runs = FinishedRuns()
    for number in range(MAX_KEPT + 2):
        runs.add(_run(number))
    assert [run.event.run for run in runs.newest(1000)] == list(range(MAX_KEPT + 1, 1, -1))
    assert [run.event.run for run in runs.newest(2)] == [MAX_KEPT + 1, MAX_KEPT]


@pytest.mark.parametrize("zones, kept", [(("tbm", "tbm"), 1), (("tbm", "other"), 2)])
def test_the_same_event_in_another_zone_is_another_one(zones, kept):
    runs = FinishedRuns()
    for zone in zones:
        runs.add(_run(1, zone))
    assert len(runs.newest()) == kept
