"""Keys that must be pressed twice."""

from roah_rsbb.rqt.keys import NOT_BEFORE_S, WITHIN_S, DoublePress

STOP_A, STOP_B, START_A = ("stop", "A"), ("stop", "B"), ("start", "A")


def test_one_press_does_nothing_but_arm():
    presses = DoublePress()
    assert presses.armed(100.0) is None
    assert not presses.press(100.0, STOP_A)
    assert presses.armed(100.5) == STOP_A


def test_the_second_press_does_it_and_the_third_is_a_first_one():
    presses = DoublePress()
    presses.press(100.0, STOP_A)
    assert presses.press(100.5, STOP_A)
    assert presses.armed(100.6) is None
    assert not presses.press(101.0, STOP_A)


def test_a_late_second_press_is_a_first_one():
    presses = DoublePress()
    presses.press(100.0, STOP_A)
    late = 100.0 + WITHIN_S + 0.01
    assert presses.armed(late) is None
    assert not presses.press(late, STOP_A)
    assert presses.press(late + 1.0, STOP_A)


def test_a_bouncing_key_is_one_press():
    presses = DoublePress()
    presses.press(100.0, STOP_A)
    assert not presses.press(100.0 + NOT_BEFORE_S / 2, STOP_A)
    assert presses.press(100.5, STOP_A)


def test_another_command_or_another_zone_is_not_the_second_press():
    presses = DoublePress()
    presses.press(100.0, STOP_A)
    assert not presses.press(100.5, STOP_B)
    assert not presses.press(101.0, START_A)
    assert presses.press(101.5, START_A)
