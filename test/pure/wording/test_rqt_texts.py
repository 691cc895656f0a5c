"""What panels write of times."""

import pytest

from roah_rsbb.wording import panel_texts

NOON = 1446379200.0  # 2015-11-01 12:00:00 UTC


@pytest.mark.parametrize(("seconds", "shown"), [
    (600.0, "10:00"), (599.01, "10:00"), (599.0, "9:59"), (0.4, "0:01"), (0.0, "0:00"), (-3.0, "0:00"),
    (3599.5, "1:00:00"), (3723.0, "1:02:03"),
    (59.9999999, "1:00"), (60.0000001, "1:00"),  # nanoseconds are no second more
])
def test_a_countdown_is_over_only_at_zero(seconds, shown):
    assert panel_texts.countdown(seconds) == shown


def test_an_event_of_today_has_no_date():
    assert panel_texts.scheduled(NOON, NOON - 3600) == "12:00"
    assert panel_texts.scheduled(NOON + 86400, NOON) == "2015-11-02 12:00"


@pytest.mark.parametrize(("moment", "clock", "shown"), [
    ("2015-12-31 10:00:00", "2015-12-31 09:59:59", "10:00"),
    ("2016-01-01 10:00:00", "2015-12-31 09:59:59", "1 Jan 10:00"),
    ("10:00", "09:00:00", "10:00"),
    ("some day 10:00:00", "2015-12-31 09:59:59", "some day 10:00"),
    ("soon", "2015-12-31 09:59:59", "soon"),
    ("", "", ""),
])
def test_the_public_reads_no_seconds_and_no_date_of_today(moment, clock, shown):
    assert panel_texts.short_time(moment, clock) == shown


@pytest.mark.parametrize(("seconds", "shown"), [
    (-5.0, "just now"), (1.0, "just now"), (4.0, "4 s ago"), (119.0, "119 s ago"), (180.0, "3 min ago"),
    (7200.0, "2 h ago"),
])
def test_how_long_ago(seconds, shown):
    assert panel_texts.ago(seconds) == shown


def test_zero_on_the_ros_interface_means_never():
    assert panel_texts.moment(0.0, NOON) == "never"
    assert panel_texts.moment(NOON - 4, NOON) == "11:59:56 UTC (4 s ago)"


def test_a_clock_that_is_far_off_is_no_error():
    assert panel_texts.time_of_day(1e30) == "?"


def test_several_reasons_are_a_list():
    assert panel_texts.bullets(["only one"]) == "only one"
    assert panel_texts.bullets(["one", "two"]) == "• one\n• two"
    assert panel_texts.bullets([]) == ""


def test_silence_names_its_length():
    assert panel_texts.silence(None) == "OLD: waiting for the core"
    assert panel_texts.silence(0.8) == "OLD: no news from the core for 1 s"
    assert panel_texts.silence(12.3) == "OLD: no news from the core for 12 s"


@pytest.mark.parametrize(("seconds", "shown"), [
    (0.0123, "+0.012 s"), (-0.0871, "−0.087 s"), (-0.0001, "+0.000 s"), (0.0, "+0.000 s"),
])
def test_a_skew_has_a_sign(seconds, shown):
    assert panel_texts.skew(seconds) == shown
