"""The box's clock as displays estimate it."""

import pytest

from roah_rsbb.client.client import BoxClock


def test_before_the_first_message_it_is_not_known():
    assert BoxClock().now(50.0) == 0.0


@pytest.mark.parametrize("heard, box, now, expected", [
    (53.0, 1000.1, 53.0, 1003.0),  # it was 2.9 s under way: late messages do not set it back
    (50.5, 1000.7, 51.0, 1001.2),  # a faster message gives a better estimate
    (50.1, 4600.1, 50.1, 4600.1),  # the box's clock is set forward
    (50.1, 400.1, 50.1, 400.1),  # and back
])
def test_what_a_second_message_says(heard, box, now, expected):
    clock = BoxClock()
    clock.sample(50.0, 1000.0)
    clock.sample(heard, box)
    assert clock.now(now) == pytest.approx(expected, abs=0.001)


def test_a_box_whose_clock_runs_slower_is_followed():
    clock = BoxClock()
    for second in range(3600):
        clock.sample(50.0 + second, 1000.0 + second * 0.9999)
    assert clock.now(3650.0) == pytest.approx(1000.0 + 3600 * 0.9999, abs=0.01)
