"""Repeated strings against the box's rule, over a link that loses, doubles and reorders."""

import random
from collections import defaultdict

import pytest

from helpers.linked_world import FakeLink
from roah_rsbb.robot.link import MessageTimes, RepeatedStrings, wire_time
from roah_rsbb.robot.machine import IllegalEvent

FIELDS = ("notifications", "visitor")


class BoxRule:
    """What a box does with repeated strings (docs/protocol.md, "Repeated strings").

    It logs what a message contains and the one received before it did not, and ignores a message that
    is not newer than all before.
    """

    def __init__(self):
        self.acknowledgement = 0
        self.logged = defaultdict(list)
        self._before = defaultdict(list)

    def receive(self, number, content):
        if number <= self.acknowledgement:
            return
        self.acknowledgement = number
        for field in FIELDS:
            texts = content.get(field, [])
            self.logged[field] += [text for text in texts if text not in self._before[field]]
            self._before[field] = texts


class OneWay:
    """Carries things one way, on a bad link; the time is the number of the round."""

    def __init__(self, rng, **of_link):
        self._link = FakeLink(rng, **of_link)
        self._under_way = []

    def send(self, number, thing):
        self._under_way += [(number + delay, thing) for delay in self._link.delays()]

    def deliver(self, number):
        """Deliver what has arrived by now, in the order of arrival."""
        self._under_way.sort(key=lambda entry: entry[0])
        arrived = [thing for at, thing in self._under_way if at <= number]
        self._under_way = self._under_way[len(arrived):]
        return arrived


def _run(rng, sender, plan, rounds, **of_link):
    """Let `sender` send the strings of `plan`, a list of (field, text), at random times."""
    box, there, back = BoxRule(), OneWay(rng, **of_link), OneWay(rng, **of_link)
    plan = list(plan)
    for number in range(1, rounds):
        while plan and rng.random() < 0.4:
            sender.add(*plan.pop(0))
        there.send(number, (number, sender.for_message(number)))
        for message in there.deliver(number):
            box.receive(*message)
        if rng.random() < 0.8:
            back.send(number, box.acknowledgement)
        for acknowledgement in back.deliver(number):
            sender.acknowledged(acknowledgement)
        if not plan and not sender.pending:
            return box
    raise AssertionError(f"still pending after {rounds} messages: {sender.pending}")


@pytest.mark.parametrize("loss, double, late", [
    (0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 1.0), (0.4, 0.4, 0.7), (0.7, 0.2, 0.5),
])
@pytest.mark.parametrize("seed", range(5))
def test_each_string_is_logged_as_often_and_in_the_order_it_was_sent(loss, double, late, seed):
    rng = random.Random(f"{seed}/{loss}/{double}/{late}")
    # Few different texts, so that twins are frequent; a budget that holds about three of them.
    plan = [(rng.choice(FIELDS), rng.choice(["a", "b", "a", "cc", "a"])) for _ in range(rng.randint(1, 40))]
    sender = RepeatedStrings(FIELDS, budget_bytes=rng.choice([6, 15, 100]))
    box = _run(rng, sender, plan, 20_000, loss=loss, double=double, late=late, longest_delay=6.0)
    for field in FIELDS:
        assert box.logged[field] == [text for planned, text in plan if planned == field]


def test_a_string_stays_until_a_message_with_it_is_acknowledged():
    sender = RepeatedStrings(FIELDS, 100)
    assert sender.for_message(1) == {}
    sender.add("visitor", "Deli Man")
    assert sender.for_message(2) == {"visitor": ["Deli Man"]}
    sender.acknowledged(1)
    assert sender.for_message(3) == {"visitor": ["Deli Man"]}
    sender.acknowledged(2)
    assert sender.for_message(4) == {}
    assert sender.pending == 0


def test_a_twin_waits_until_the_box_has_seen_a_message_without_it():
    sender = RepeatedStrings(FIELDS, 100)
    sender.add("visitor", "a")
    sender.add("visitor", "a")
    assert sender.for_message(1) == {"visitor": ["a"]}
    sender.acknowledged(1)
    assert sender.for_message(2) == {}
    # Sent is not received: without this acknowledgement the box may still take both for one.
    sender.acknowledged(1)
    assert sender.for_message(3) == {}
    sender.acknowledged(2)
    assert sender.for_message(4) == {"visitor": ["a"]}


def test_a_twin_holds_back_what_comes_after_it():
    sender = RepeatedStrings(FIELDS, 100)
    for text in "aab":
        sender.add("visitor", text)
    assert sender.for_message(1) == {"visitor": ["a"]}


def test_the_same_text_in_two_fields_is_not_a_duplicate():
    sender = RepeatedStrings(FIELDS, 100)
    sender.add("visitor", "a")
    sender.add("notifications", "a")
    assert sender.for_message(1) == {"visitor": ["a"], "notifications": ["a"]}


def test_an_acknowledgement_brings_on_waiting_strings_only():
    sender = RepeatedStrings(FIELDS, 100)
    sender.add("visitor", "a")
    sender.for_message(1)
    assert not sender.acknowledged(1), "nothing waits"
    sender.add("visitor", "a")
    sender.for_message(2)
    assert sender.acknowledged(2), "the twin may go now"
    assert not sender.acknowledged(2), "the same acknowledgement again is no news"


def test_a_message_never_takes_more_than_its_budget():
    sender = RepeatedStrings(FIELDS, budget_bytes=30)
    for text in ("x" * 10, "y" * 10, "z" * 26, "ü"):
        sender.add("visitor", text)
    assert sender.for_message(1) == {"visitor": ["x" * 10, "y" * 10]}
    sender.acknowledged(1)
    assert sender.for_message(2) == {"visitor": ["z" * 26]}
    sender.acknowledged(2)
    assert sender.for_message(3) == {"visitor": ["ü"]}


@pytest.mark.parametrize("field, text, found", [
    ("visitor", "x" * 27, "27 bytes.* at most 26"),
    ("visitor", "ü" * 14, "28 bytes"),
    ("visitor", "\ud800", "Unicode"),
    ("visitors", "a", "choose from notifications, visitor"),
])
def test_a_text_that_cannot_be_sent_is_refused_and_changes_nothing(field, text, found):
    sender = RepeatedStrings(FIELDS, budget_bytes=30)
    with pytest.raises(IllegalEvent, match=found):
        sender.add(field, text)
    assert sender.pending == 0


def test_the_queue_is_bounded():
    sender = RepeatedStrings(FIELDS, budget_bytes=30, max_waiting=3)
    for number in range(3):
        sender.add("visitor", str(number))
    with pytest.raises(IllegalEvent, match="3 strings already wait"):
        sender.add("visitor", "one more")
    sender.for_message(1)
    sender.add("visitor", "one more")


# -- the times of a robot's messages, and the numbers behind acknowledgements -------------------------

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
