"""The times of a run: one label never stands for two times."""

import pytest

from roah_rsbb.model.zone import Count, RunClock
from roah_rsbb.wording import times as wording
from roah_rsbb.wording.times import Clock, Figure, Hurry, clock_lines

MONO = 500.0
COUNTED = {"elapsed": "counting", "goal_elapsed": "goal_counting", "setup_elapsed": "setup_counting"}


def message(phase, counting=False, **fields):
    """The phase and the times of a run at `MONO`. `counting`: those of the run and of the phase count."""
    counts = {name: fields.pop(flag, counting and flag == "counting") for name, flag in COUNTED.items()}
    counts["phase_elapsed"] = counting
    for name, is_counting in counts.items():
        fields[name] = Count(fields.get(name, 0.0), MONO if is_counting else None)
    after_stop = fields.pop("after_stop", None)
    return phase, RunClock(**{"limit": 600.0, **fields}, after_stop_until=None if after_stop is None else
                           MONO + after_stop)


def clock_of(found, passed_s):
    """The times in words, `passed_s` seconds later."""
    phase, clock = found
    return wording.clock_of(clock, phase, MONO + passed_s)


def test_before_the_start_the_limits_are_shown():
    for phase in ("idle", "connected"):
        assert clock_of(message(phase), 5.0) == Clock(Figure("Time limit of the run", "10:00"))
    assert clock_of(message("idle", goal_limit=120.0), 0.0).goal == Figure("Time limit of a goal", "2:00")


def test_run_and_goal_are_two_figures_and_neither_takes_the_others_label():
    before = clock_of(message("running", elapsed=10.0, counting=True, goal_limit=120.0), 0.0)
    assert (before.main, before.goal) == (Figure("Run: time left", "9:50"), None)
    goal = {"goal": 1, "goal_limit": 120.0, "goal_elapsed": 0.0, "goal_counting": True}
    during = clock_of(message("running", elapsed=10.0, counting=True, **goal), 1.0)
    assert (during.main, during.goal) == (Figure("Run: time left", "9:49"), Figure("Goal: time left", "1:59"))
    assert during.aside == "Used: 0:11 of 10:00"


def test_what_does_not_count_stays_where_it_is():
    shown = clock_of(message("running", elapsed=10.0, paused="manual operation"), 60.0)
    assert shown == Clock(Figure("Run: time left", "9:50"), None, "PAUSED: manual operation", "Used: 0:10 of 10:00")


@pytest.mark.parametrize(("elapsed", "hurry"), [
    (569.9, Hurry.NO), (570.0, Hurry.SOON), (589.9, Hurry.SOON), (590.0, Hurry.LAST), (700.0, Hurry.LAST),
])
def test_the_last_seconds(elapsed, hurry):
    assert clock_of(message("running", elapsed=elapsed, counting=True), 0.0).main.hurry is hurry
    assert clock_of(message("running", elapsed=elapsed - 7.0, counting=True), 7.0).main.hurry is hurry
    assert clock_of(message("running", elapsed=elapsed, paused="manual operation"), 0.0).main.hurry is Hurry.NO


def test_a_time_that_is_up_does_not_become_negative():
    assert clock_of(message("running", elapsed=599.0, counting=True), 9.0).main.text == "0:00"


def test_after_the_end_the_final_time_is_large_and_the_time_after_the_stop_small():
    ended = message("ended", elapsed=492.33, after_stop=120.0)
    assert clock_of(ended, 1.0) == Clock(
        Figure("Final time of the run", "8:12.3"), aside="Time left after the stop: 1:59")
    assert clock_of(ended, 200.0).aside == ""


def test_the_times_in_words():
    goal = {"goal": 1, "goal_limit": 120.0, "goal_elapsed": 20.0}
    assert clock_lines(clock_of(message("running", elapsed=30.0, paused="manual operation", **goal), 0.0)) == [
        "PAUSED: manual operation", "Run: time left 9:30", "Goal: time left 1:40", "Used: 0:30 of 10:00"]


def test_a_run_without_a_limit_counts_up():
    before = clock_of(message("idle", limit=0.0), 0.0)
    assert before.main == Figure("Time limit of the run", "no limit")
    shown = clock_of(message("running", limit=0.0, elapsed=700.0, counting=True), 5.9)
    assert shown == Clock(Figure("Run: time used", "11:45"))


def test_the_setup_time_counts_down_and_then_up():
    setup = {"setup_limit": 120.0, "setup_counting": True}
    shown = clock_of(message("connected", setup_elapsed=80.0, **setup), 15.0)
    limit = Figure("Time limit of the run", "10:00")
    assert shown == Clock(Figure("Setup: time left", "0:25", Hurry.SOON), limit)
    shown = clock_of(message("connected", setup_elapsed=120.0, **setup), 15.0)
    assert shown == Clock(Figure("Setup: over by", "0:15", Hurry.LAST), limit)


@pytest.mark.parametrize("elapsed, limit, expected", [
    (10.0, 60.0, Figure("Phase 2 of 3, Serve: time left", "0:48")),
    (35.0, 60.0, Figure("Phase 2 of 3, Serve: time left", "0:23", Hurry.SOON)),
    (70.0, 60.0, Figure("Phase 2 of 3, Serve: over by", "0:12", Hurry.LAST)),
    (70.0, 0.0, Figure("Phase 2 of 3, Serve: time used", "1:12")),
])
def test_the_phase_stands_beside_the_run(elapsed, limit, expected):
    phase = {"phases": 3, "phase_number": 2, "phase_name": "Serve", "phase_limit": limit, "phase_elapsed": elapsed}
    shown = clock_of(message("running", elapsed=100.0, counting=True, **phase), 2.0)
    assert (shown.main, shown.goal) == (Figure("Run: time left", "8:18"), expected)
    assert clock_of(message("running", elapsed=100.0, paused="by the referee", **phase), 2.0).goal.text != expected.text
