"""The times of a robot's messages, and the numbers behind acknowledgements."""

import pytest

from roah_rsbb.robot.link import MessageTimes, wire_time

T0 = 1_800_000_000


@pytest.mark.parametrize("clock, times", [
    ([0.25], [(0, 250_000_000)]),
    ([0, 0, 0], [(0, 0), (0, 1), (0, 2)]),  # a standing clock
    ([10, 9.5, 9, 10.5], [(10, 0), (10, 1), (10, 2), (10, 500_000_000)]),  # a step back of up to a second
    ([10, 8.75, 8.75], [(10, 0), (8, 750_000_000), (8, 750_000_001)]),  # one that is followed
])
def test_the_time_of_each_message_by_the_clock(clock, times):
    found = MessageTimes()
    assert [found.next(T0 + utc)[0] for utc in clock] == [(T0 + sec, nsec) for sec, nsec in times]
    assert wire_time(1.5) == (1, 500_000_000)


def test_numbers_are_known_by_their_exact_time():
    times = MessageTimes()
    first, one = times.next(T0)
    second, two = times.next(T0)
    assert (one, two) == (1, 2)
    assert (times.number_of(first), times.number_of(second)) == (1, 2)
    assert times.number_of((T0 + 1, 0)) is None
    assert times.number_of((0, 0)) is None
    # Any int64 may arrive.
    assert times.number_of((-(2**63), 2**63 - 1)) is None


def test_numbers_survive_that_the_clock_is_set_back():
    times = MessageTimes()
    before, _ = times.next(T0 + 100)
    after, _ = times.next(T0)
    assert (times.number_of(before), times.number_of(after)) == (1, 2)


def test_a_time_typed_by_hand_reaches_the_messages_up_to_it():
    times = MessageTimes()
    assert times.number_reached((T0, 0)) is None
    times.next(T0)
    times.next(T0 + 1)
    assert times.number_reached((T0 - 1, 0)) is None
    assert times.number_reached((T0, 5)) == 1
    assert times.number_reached((T0 + 100, 0)) == 2


def test_only_recent_messages_are_remembered():
    times = MessageTimes()
    sent = [times.next(T0 + i)[0] for i in range(5000)]
    assert times.number_of(sent[0]) is None
    assert times.number_of(sent[-1000]) == 4001
    assert sum(times.number_of(time) is not None for time in sent) == 1000
