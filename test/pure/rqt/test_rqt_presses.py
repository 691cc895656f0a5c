"""Keys that must be pressed twice."""

import pytest

from roah_rsbb.rqt.keys import NOT_BEFORE_S, WITHIN_S, DoublePress

STOP_A, STOP_B, START_A = ("stop", "A"), ("stop", "B"), ("start", "A")
LATE_S = WITHIN_S + 0.01


@pytest.mark.parametrize(("presses", "acts"), [
    ([(0.0, STOP_A)], [False]),
    ([(0.0, STOP_A), (0.5, STOP_A), (1.0, STOP_A)], [False, True, False]),  # the third is a first one
    ([(0.0, STOP_A), (LATE_S, STOP_A), (LATE_S + 1.0, STOP_A)], [False, False, True]),
    ([(0.0, STOP_A), (NOT_BEFORE_S / 2, STOP_A), (0.5, STOP_A)], [False, False, True]),  # a bouncing key
    ([(0.0, STOP_A), (0.5, STOP_B), (1.0, START_A), (1.5, START_A)], [False, False, False, True]),
])
def test_the_second_press_of_the_same_command_acts(presses, acts):
    key = DoublePress()
    assert [key.press(100.0 + seconds, what) for seconds, what in presses] == acts


def test_what_the_next_press_does_is_known_while_it_may_come():
    key = DoublePress()
    assert key.armed(100.0) is None
    key.press(100.0, STOP_A)
    assert key.armed(100.5) == STOP_A
    assert key.armed(100.0 + LATE_S) is None
    key.press(101.0, STOP_A)
    assert key.armed(101.1) is None
