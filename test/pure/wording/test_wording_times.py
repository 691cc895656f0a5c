"""The wording of times, durations and skews, and of the clock of a run."""

import pytest

from helpers.time_zones import local_time
from roah_rsbb.model.zone import Count, RunClock
from roah_rsbb.wording import times
from roah_rsbb.wording.times import Clock, Figure, Hurry, clock_lines

NOON = 1446379200.0  # 2015-11-01 12:00:00 UTC


@pytest.mark.parametrize(("seconds", "shown"), [
    (600.0, "10:00"), (599.01, "10:00"), (599.0, "9:59"), (0.4, "0:01"), (0.0, "0:00"), (-3.0, "0:00"),
    (3599.5, "1:00:00"), (3723.0, "1:02:03"),
    (59.9999999, "1:00"), (60.0000001, "1:00"),  # nanoseconds are no second more
])
def test_a_countdown_is_over_only_at_zero(seconds, shown):
    assert times.countdown(seconds) == shown


@pytest.mark.parametrize(("seconds", "shown"), [
    (6.057, "0:06.1"), (0.0, "0:00.0"), (599.96, "10:00.0"), (61.3, "1:01.3"), (3723.44, "1:02:03.4"), (-1.0, "0:00.0"),
])
def test_an_elapsed_time_has_tenths(seconds, shown):
    assert times.elapsed(seconds) == shown


def test_an_event_of_today_has_no_date():
    assert times.Moments(in_utc=True).scheduled(NOON, NOON - 3600) == "12:00"
    assert times.Moments(in_utc=True).scheduled(NOON + 86400, NOON) == "2015-11-02 12:00"


@pytest.mark.parametrize(("moment", "clock", "shown"), [
    ("2015-12-31 10:00:00", "2015-12-31 09:59:59", "10:00"),
    ("2016-01-01 10:00:00", "2015-12-31 09:59:59", "Fri 10:00"),
    ("2015-12-25 10:00:00", "2015-12-31 09:59:59", "Fri 10:00"),
    ("2015-12-24 10:00:00", "2015-12-31 09:59:59", "24 Dec 10:00"),
    ("2016-01-07 10:00:00", "2015-12-31 09:59:59", "7 Jan 10:00"),
    ("10:00", "09:00:00", "10:00"),
    ("some day 10:00:00", "2015-12-31 09:59:59", "some day 10:00"),
    ("soon", "2015-12-31 09:59:59", "soon"),
    ("", "", ""),
])
def test_the_public_reads_no_seconds_and_no_date_of_today(moment, clock, shown):
    assert times.short_time(moment, clock) == shown


@pytest.mark.parametrize(("seconds", "shown"), [
    (-5.0, "just now"), (1.0, "just now"), (4.0, "4 s ago"), (119.0, "119 s ago"), (180.0, "3 min ago"),
    (7200.0, "2 h ago"),
])
def test_how_long_ago(seconds, shown):
    assert times.ago(seconds) == shown


def test_zero_on_the_ros_interface_means_never():
    assert times.Moments().and_age(0.0, NOON) == "never"
    assert times.Moments(in_utc=True).and_age(NOON - 4, NOON) == "11:59:56 (4 s ago)"


@pytest.fixture
def in_lisbon_summer():
    """A local time one hour ahead of UTC."""
    with local_time("WEST-1"):
        yield


def test_panels_show_local_time_or_utc_and_say_which(in_lisbon_summer):
    local, utc = times.Moments(), times.Moments(in_utc=True)
    assert (local.with_zone(NOON), utc.with_zone(NOON)) == ("13:00:00 WEST", "12:00:00 UTC")
    assert (local.short(NOON), utc.short(NOON)) == ("13:00", "12:00")
    assert local.tip(NOON) == utc.tip(NOON) == "2015-11-01 12:00:00 UTC"
    late = NOON + 11.5 * 3600
    assert (local.scheduled(late, NOON), utc.scheduled(late, NOON)) == ("2015-11-02 00:30", "23:30")


def test_the_times_of_log_lines_are_local_and_nothing_else_in_them_changes(in_lisbon_summer):
    text = "23:30:59Z WARNING: signed at 10:00:00Z\nno time\n00:00:00Z end"
    assert times.Moments().lines(text, NOON) == "00:30:59 WARNING: signed at 10:00:00Z\nno time\n01:00:00 end"
    assert times.Moments(in_utc=True).lines(text, NOON) == text


def test_a_clock_that_is_far_off_is_not_an_error():
    assert times.time_of_day(1e30) == times.Moments().short(1e30) == "?"
    assert times.Moments().lines("10:00:00Z a", 1e30) == "10:00:00 a"


def test_silence_names_its_length():
    assert times.silence(None) == "OLD: waiting for the box"
    assert times.silence(0.8) == "OLD: nothing heard from the box for 1 s"
    assert times.silence(12.3) == "OLD: nothing heard from the box for 12 s"


@pytest.mark.parametrize(("seconds", "shown"), [
    (0.0123, "+0.012 s"), (-0.0871, "-0.087 s"), (-0.0001, "+0.000 s"), (0.0, "+0.000 s"),
    (-1.5e9, "-1.5e+09 s"),
])
def test_a_skew_has_a_sign(seconds, shown):
    assert times.skew(seconds) == shown


@pytest.mark.parametrize("seconds, text", [
    (-1.0, "0"), (3.4, "3"), (9.4, "9"), (10.4, "10"), (19.4, "10"), (59.0, "50"), (60.0, "60"), (179.0, "120")])
def test_a_sentence_counts_in_steps(seconds, text):
    assert times.in_sentence(seconds) == text


# -- the clock of a run: one label never stands for two times -------------------------------------

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
    return times.clock_of(clock, phase, MONO + passed_s)


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
