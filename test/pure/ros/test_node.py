"""Messages that come faster than they are taken."""

import pytest

pytest.importorskip("rospy")

from roah_rsbb.ros.node import Newest  # noqa: E402  (only with ROS)


def test_the_newest_of_each_sender_is_taken_once():
    posted, taken = [], []
    newest = Newest(posted.append, taken.append, most=3)
    for number in range(1000):
        newest.put("a", f"a{number}")
        newest.put("b", f"b{number}")
    assert (len(posted), taken) == (1, [])
    posted.pop()()
    assert taken == ["a999", "b999"]
    newest.put("b", "b again")
    posted.pop()()
    assert taken[2:] == ["b again"]


def test_a_flood_of_senders_does_not_grow():
    posted, taken = [], []
    newest = Newest(posted.append, taken.append, most=3)
    for number in range(1000):
        newest.put(str(number), number)
    newest.put("1", "newer")
    posted.pop()()
    assert taken == [0, "newer", 2]
    assert posted == []


def test_what_comes_while_it_is_taken_is_taken_next():
    posted, taken = [], []

    def take(message):
        taken.append(message)
        if message == "first":
            newest.put("a", "second")

    newest = Newest(posted.append, take, most=3)
    newest.put("a", "first")
    posted.pop(0)()
    posted.pop(0)()
    assert taken == ["first", "second"]
