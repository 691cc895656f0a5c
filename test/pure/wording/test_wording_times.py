"""The wording of times, durations and skews."""


import pytest

from helpers.time_zones import local_time
from roah_rsbb.wording import times

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
    assert times.silence(None) == "OLD: waiting for the core"
    assert times.silence(0.8) == "OLD: nothing heard from the core for 1 s"
    assert times.silence(12.3) == "OLD: nothing heard from the core for 12 s"


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
