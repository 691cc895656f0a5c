"""When a state is due: at once, ten times at 50 ms, then each second."""

import math

from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.comm.sender import StateSender


def sends(sender, until, step=0.001, start=0.0):
    """The times, in ms, at which the state was sent when asked every `step` seconds."""
    times, count = [], 0
    while start + count * step <= until:
        now = start + count * step
        if sender.due(now + 1e-9):
            times.append(round(now * 1000))
        count += 1
    return times


BURST = list(range(0, 501, 50))


def test_nothing_is_due_before_the_first_change():
    sender = StateSender()
    assert sender.deadline == math.inf
    assert not sender.due(1e9)


def test_a_change_is_sent_at_once_then_ten_times_then_each_second():
    sender = StateSender()
    sender.changed(0.0)
    assert sender.deadline == 0.0
    assert sends(sender, 3.6) == [*BURST, 1500, 2500, 3500]


def test_a_change_in_a_burst_begins_a_new_one():
    sender = StateSender()
    sender.changed(0.0)
    assert sends(sender, 0.12) == [0, 50, 100]
    sender.changed(0.121)
    assert sends(sender, 1.7, start=0.121) == [121 + time for time in BURST] + [1621]


def test_a_reply_is_one_extra_send_and_moves_nothing():
    sender = StateSender()
    sender.changed(0.0)
    assert sends(sender, 0.12) == [0, 50, 100]
    sender.reply(0.121)
    assert sender.deadline == 0.121
    assert sends(sender, 1.6, start=0.121) == [121, *BURST[3:], 1500]


def test_a_reply_that_is_due_with_the_state_is_one_send():
    sender = StateSender()
    sender.changed(0.0)
    sender.reply(0.0)
    sender.reply(0.0)
    assert sends(sender, 0.049) == [0]


def test_a_reply_alone_is_sent_once():
    sender = StateSender()
    sender.reply(7.0)
    assert sender.deadline == 7.0
    assert sender.due(7.0)
    assert sender.deadline == math.inf


def test_whoever_asks_late_gets_one_send():
    sender = StateSender()
    sender.changed(0.0)
    assert sender.due(0.3)
    assert not sender.due(0.3)
    assert sender.deadline == 0.35


def test_a_little_late_keeps_the_pace():
    sender = StateSender()
    sender.changed(0.0)
    sender.due(0.0)
    assert sender.due(0.06)
    assert abs(sender.deadline - 0.1) < 1e-9


def test_a_suspended_computer_catches_up_on_nothing():
    sender = StateSender()
    sender.changed(0.0)
    sends(sender, 2.0)
    assert sends(sender, 3605.0, start=3600.0) == [3600000, 3601000, 3602000, 3603000, 3604000, 3605000]


@examples()
@given(st.lists(st.tuples(st.floats(0, 2), st.sampled_from(["due", "due", "changed", "reply"])), max_size=60))
def test_after_a_send_the_next_deadline_is_later(steps):
    sender, now = StateSender(), 0.0
    for wait, step in steps:
        now += wait
        if step != "due":
            getattr(sender, step)(now)
            assert sender.deadline <= now
        elif sender.due(now):
            assert sender.deadline > now
        else:
            assert sender.deadline > now
