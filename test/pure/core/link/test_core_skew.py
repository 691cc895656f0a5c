"""Clock skew from messages that are delayed on their way."""

import random

import pytest

from roah_rsbb.core.link.skew import MAX_SAMPLES, WINDOW_S, SkewEstimate, within
from roah_rsbb.wording import times


def test_nothing_is_known_before_the_first_sample():
    estimate = SkewEstimate()
    assert (estimate.seconds, estimate.count) == (None, 0)
    assert not within(estimate.seconds, 1e9)


@pytest.mark.parametrize("true_skew", [-0.15, -0.05, 0.0, 0.05, 0.15])
@pytest.mark.parametrize("seed", range(5))
def test_delays_of_most_messages_do_not_matter(true_skew, seed):
    rng = random.Random(seed)
    estimate = SkewEstimate()
    for i in range(20):
        delay = 0.001 if i % 3 == 0 else rng.uniform(0.001, 0.4)
        estimate.sample(i * 0.5, true_skew - delay)
        if i >= 5:
            assert estimate.seconds == pytest.approx(true_skew, abs=0.002)


def test_a_clock_that_was_put_right_is_believed_after_the_window():
    estimate = SkewEstimate()
    for second in range(10):
        estimate.sample(second, 0.5)
    after = [estimate.sample(10 + i, 0.0) for i in range(5)]
    assert after == [0.5, 0.5, 0.0, 0.0, 0.0]
    assert WINDOW_S == 2.5


def test_the_first_message_after_a_silence_may_have_been_late():
    estimate = SkewEstimate()
    estimate.sample(0.0, 0.01)
    assert estimate.sample(10.0, -2.1) == 0.01
    assert estimate.sample(10.1, 0.01) == 0.01


def test_a_clock_that_was_put_back_in_a_silence_is_believed_after_the_window():
    estimate = SkewEstimate()
    estimate.sample(0.0, 0.5)
    assert [estimate.sample(10.0 + i, 0.0) for i in range(4)] == [0.5, 0.5, 0.5, 0.0]


def test_one_who_seldom_says_something_is_believed_too():
    estimate = SkewEstimate()
    assert [estimate.sample(3.0 * i, -float(i)) for i in range(4)] == [0.0, 0.0, -1.0, -2.0]


def test_a_flood_of_samples_does_not_grow_anything():
    estimate = SkewEstimate()
    for i in range(10_000):
        estimate.sample(i * 1e-5, 0.0)
    assert estimate.count == MAX_SAMPLES


def test_all_is_forgotten_when_a_clock_was_set():
    estimate = SkewEstimate()
    estimate.sample(0.0, 5.0)
    estimate.restart()
    assert (estimate.seconds, estimate.count) == (None, 0)
    assert estimate.sample(0.1, -0.2) == -0.2


@pytest.mark.parametrize("skew, is_within", [
    (0.0, True), (0.0999, True), (-0.0999, True), (0.1, False), (-0.1, False), (0.15, False), (-0.15, False),
    (9.2e18, False), (-9.2e18, False),
])
def test_only_a_skew_below_the_allowed_one_will_do_in_both_directions(skew, is_within):
    assert within(skew, 0.1) is is_within


@pytest.mark.parametrize("skew, text", [
    (0.15, "+0.150 s"), (-0.0456, "-0.046 s"), (99.9, "+99.900 s"), (-1e18, "-1e+18 s"), (3600.0, "+3.6e+03 s"),
])
def test_a_skew_for_the_referee(skew, text):
    assert times.skew(skew) == text


@pytest.mark.parametrize("seed", range(20))
def test_the_estimate_is_always_the_largest_sample_of_the_window(seed):
    chance, estimate, mono, samples = random.Random(seed), SkewEstimate(), 0.0, []
    for _ in range(500):
        mono += chance.choice([0.0, 0.05, 0.05, 1.0, 2.5, 3.0])
        skew = chance.choice([-0.1, 0.0, 0.1, chance.uniform(-1.0, 1.0)])
        late = [(mono, samples[-1][1])] if samples and samples[-1][0] < mono - WINDOW_S else []
        samples = [*(one for one in samples if one[0] >= mono - WINDOW_S), *late, (mono, skew)][-MAX_SAMPLES:]
        assert estimate.sample(mono, skew) == max(one for _, one in samples)
        assert estimate.count == len(samples)
