"""The times of a robot's messages, and the numbers behind acknowledgements."""

from roah_rsbb.robot.link import MessageTimes, wire_time

T0 = 1_800_000_000


def _next_times(*clock):
    times = MessageTimes()
    return [times.next(utc)[0] for utc in clock]


def test_a_time_is_seconds_and_nanoseconds_of_the_clock():
    assert _next_times(T0 + 0.25) == [(T0, 250_000_000)]
    assert wire_time(1.5) == (1, 500_000_000)


def test_a_standing_clock_gives_times_that_increase_by_one_nanosecond():
    assert _next_times(T0, T0, T0) == [(T0, 0), (T0, 1), (T0, 2)]


def test_a_clock_that_steps_back_a_little_never_gives_an_earlier_time():
    assert _next_times(T0 + 10, T0 + 9.5, T0 + 9, T0 + 10.5) == [
        (T0 + 10, 0), (T0 + 10, 1), (T0 + 10, 2), (T0 + 10, 500_000_000)
    ]


def test_a_clock_set_back_by_more_than_a_second_is_followed():
    assert _next_times(T0 + 10, T0 + 8.75, T0 + 8.75) == [
        (T0 + 10, 0), (T0 + 8, 750_000_000), (T0 + 8, 750_000_001)
    ]


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
