"""When a state is due: at once, ten times at 50 ms, then each second."""

import math

import pytest
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


@pytest.mark.parametrize("steps, sent", [
    ([("changed", 0.0, 3.6)], [*BURST, 1500, 2500, 3500]),
    # A change in a burst begins a new one.
    ([("changed", 0.0, 0.12), ("changed", 0.121, 1.7)], [0, 50, 100, *(121 + time for time in BURST), 1621]),
    # A reply is one extra send, and moves nothing; with the state, it is one send.
    ([("changed", 0.0, 0.12), ("reply", 0.121, 1.6)], [0, 50, 100, 121, *BURST[3:], 1500]),
    ([("changed", 0.0, -1.0), ("reply", 0.0, -1.0), ("reply", 0.0, 0.049)], [0]),
    ([("reply", 7.0, 20.0)], [7000]),
    # A computer that was suspended catches up on nothing.
    ([("changed", 0.0, 2.0), ("", 3600.0, 3602.0)], [*BURST, 1500, 3600000, 3601000, 3602000]),
], ids=["change", "change in a burst", "reply", "reply with the state", "reply alone", "suspended"])
def test_when_the_state_is_sent(steps, sent):
    """What happens, when, and until when the sender is asked."""
    sender, found = StateSender(), []
    assert sender.deadline == math.inf and not sender.due(1e9), "nothing is due before the first change"
    for what, at, until in steps:
        if what:
            getattr(sender, what)(at)
            assert sender.deadline == at
        found += sends(sender, until, start=at)
    assert found == sent


def test_whoever_asks_late_gets_one_send_and_a_little_late_keeps_the_pace():
    sender = StateSender()
    sender.changed(0.0)
    assert sender.due(0.3) and not sender.due(0.3)
    assert sender.deadline == 0.35
    assert sender.due(0.36)
    assert abs(sender.deadline - 0.4) < 1e-9


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
