"""Which messages of a robot are new."""

import random

import pytest

from roah_rsbb.core.link.freshness import QUIET_S, Freshness, Timeline

S = 1_000_000_000
T0 = 1_800_000_000 * S


def _judged(*messages):
    """Verdicts of messages (moment of arrival in s, time in s after T0)."""
    timeline = Timeline()
    return [timeline.judge(mono, T0 + round(time * S)).value for mono, time in messages]


def test_rising_times_are_fresh_however_close():
    timeline = Timeline()
    assert [timeline.judge(0.0, T0 + ns) for ns in range(3)] == [Freshness.FRESH] * 3


def test_a_doubled_and_an_overtaken_message():
    assert _judged((0, 0), (0, 0), (1, 1), (1, 0.5), (1, 0), (1, 1), (2, 2)) == [
        "fresh", "duplicate", "fresh", "stale", "stale", "duplicate", "fresh"
    ]


def test_a_clock_that_was_set_back_is_believed_after_a_while():
    assert _judged((0, 0), (1, 1), (2, -3600), (3, -3599), (4, -3598), (5, -3597)) == [
        "fresh", "fresh", "stale", "stale", "clock set back", "fresh"
    ]


def test_a_burst_of_old_times_is_not_believed_before_the_old_timeline_was_quiet():
    burst = [(1 + i / 20, -100 + i / 20) for i in range(30)]
    assert set(_judged((0, 0), *burst)[1:]) == {"stale"}
    late = [(QUIET_S + i / 20, -100 + i / 20) for i in range(3)]
    assert _judged((0, 0), *late)[1:] == ["stale", "stale", "clock set back"]


def test_old_times_in_falling_order_are_an_overtaking_network():
    assert set(_judged((0, 0), *[(3 + i, -1 - i) for i in range(20)])[1:]) == {"stale"}


def test_one_old_message_repeated_does_not_start_a_timeline():
    assert set(_judged((0, 0), *[(3 + i, -5) for i in range(20)])[1:]) <= {"stale", "duplicate"}


def test_a_straggler_from_before_the_clock_was_set_back_does_not_lock_the_robot_out():
    # 0.95 was overtaken by 1, then the clock is set back by an hour.
    verdicts = _judged((0, 0), (1, 1), (1.01, 0.95), (2, -3598), (3, -3597), (4, -3596), (5, -3595))
    assert verdicts[2:] == ["stale", "stale", "stale", "clock set back", "fresh"]


def test_a_clock_that_was_set_back_is_believed_on_a_network_that_doubles_everything():
    sent = [(0, 0), (1, 1), (2, -10), (3, -9), (4, -8), (5, -7)]
    verdicts = _judged(*[(mono + i / 100, time) for mono, time in sent for i in range(2)])
    assert verdicts[8:] == ["clock set back", "duplicate", "fresh", "duplicate"]


@pytest.mark.parametrize("seed", range(20))
def test_a_clock_set_back_is_found_on_a_network_that_doubles_and_swaps(seed):
    rng = random.Random(seed)
    sent = [(0.05 * i, 0.05 * i) for i in range(40)]  # until 2 s
    sent += [(2 + 0.5 * i, -1000 + 0.5 * i) for i in range(40)]
    arrived = sorted((mono + rng.uniform(0, 0.7), time) for mono, time in sent for _ in range(rng.randint(1, 2)))
    verdicts = _judged(*arrived)
    assert verdicts.count("clock set back") == 1
    assert arrived[verdicts.index("clock set back")][0] < 2 + QUIET_S + 6


@pytest.mark.parametrize("seed", range(20))
def test_recorded_messages_have_no_chance_while_the_robot_lives(seed):
    """The robot sends every second and loses one now and then; meanwhile its old messages are played again."""
    rng = random.Random(seed)
    old = [-1000 + i / 10 for i in range(1000)]
    lives = [(i, i) for i in range(100) if i % 3 or rng.random() < 0.5]
    replays = [(0.1 + i / 10, time) for i, time in enumerate(old)]
    verdicts = dict(zip(sorted(lives + replays), _judged(*sorted(lives + replays))))
    assert {verdicts[message] for message in lives} == {"fresh"}
    assert {verdicts[message] for message in replays if message[0] > lives[0][0]} == {"stale"}


@pytest.mark.parametrize("absurd", [2**63 - 1, -(2**63), 0, 2**32 * S, (2**63 - 1) * S + 2**63 - 1])
def test_one_absurd_time_does_not_lock_the_robot_out(absurd):
    timeline = Timeline()
    timeline.judge(0.0, T0)
    timeline.judge(1.0, absurd)
    verdicts = [timeline.judge(float(mono), T0 + mono * S) for mono in range(2, 10)]
    assert verdicts[-1] is Freshness.FRESH
    assert verdicts.count(Freshness.STALE) <= 3
