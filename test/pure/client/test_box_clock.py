"""The box's clock as displays estimate it."""

import pytest

from roah_rsbb.client.client import BoxClock


def test_before_the_first_message_it_is_not_known():
    assert BoxClock().now(50.0) == 0.0


def test_late_messages_do_not_set_it_back():
    clock = BoxClock()
    clock.sample(50.0, 1000.0)
    clock.sample(53.0, 1000.1)  # was 2.9 s under way
    assert clock.now(53.0) == pytest.approx(1003.0, abs=0.01)


def test_a_faster_message_gives_a_better_estimate():
    clock = BoxClock()
    clock.sample(50.0, 1000.0)
    clock.sample(50.5, 1000.7)
    assert clock.now(51.0) == pytest.approx(1001.2)


def test_the_boxs_clock_is_set_forward():
    clock = BoxClock()
    clock.sample(50.0, 1000.0)
    clock.sample(50.1, 4600.1)
    assert clock.now(50.1) == pytest.approx(4600.1)


def test_the_boxs_clock_is_set_back():
    clock = BoxClock()
    clock.sample(50.0, 1000.0)
    clock.sample(50.1, 400.1)
    assert clock.now(50.1) == pytest.approx(400.1)


def test_a_box_whose_clock_runs_slower_is_followed():
    clock = BoxClock()
    for second in range(3600):
        clock.sample(50.0 + second, 1000.0 + second * 0.9999)
    assert clock.now(3650.0) == pytest.approx(1000.0 + 3600 * 0.9999, abs=0.01)
