"""A bag has the bytes that rosbag writes, and its messages those of ROS."""

import io
import random

import pytest

from helpers.bags import END, SCORE, STATE, TEXT, rosbag
from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.run_logs import bag
from roah_rsbb.run_logs.bag import HEADERS, BadEntry, message_of

genpy, std_msgs = pytest.importorskip("genpy"), pytest.importorskip("std_msgs.msg")
TYPES = {LogKind.UINT8: std_msgs.UInt8, LogKind.STRING: std_msgs.String, LogKind.EMPTY: std_msgs.Empty,
         LogKind.SCORE: pytest.importorskip("roah_rsbb.msg").Score}
TOPICS = (STATE, TEXT, SCORE, END, "/notification")


def entry(rng, number):
    """Any entry. Times may go back, because the box's clock may."""
    topic = rng.choice(TOPICS)
    text = rng.choice(("", "a", "Grüße 🤖", "x" * rng.randrange(5000)))
    value = {LogKind.UINT8: rng.randrange(256), LogKind.STRING: text, LogKind.EMPTY: None,
             LogKind.SCORE: (text, "item", rng.randrange(-2**31, 2**31))}[KINDS[topic]]
    return topic, value, 1_800_000_000 + number + rng.uniform(-5.0, 5.0)


def ros_message(logged):
    """The message of an entry, and its time, made by ROS."""
    topic, value, utc = logged
    kind = KINDS[topic]
    fields = value if kind is LogKind.SCORE else () if kind is LogKind.EMPTY else (value,)
    return TYPES[kind](*fields), genpy.Time.from_sec(utc)


@pytest.mark.parametrize("count, chunk", [(0, 1), (1, 1), (300, 1), (300, 10_000), (4000, bag.CHUNK_SIZE)])
def test_it_has_the_bytes_of_rosbag(tmp_path, monkeypatch, count, chunk):
    """`chunk`: bytes after which one ends."""
    monkeypatch.setattr(bag, "CHUNK_SIZE", chunk)
    rng = random.Random(count + chunk)
    ours, theirs = bag.Bag(), tmp_path / "theirs.bag"
    with rosbag.Bag(str(theirs), "w", chunk_threshold=chunk) as other:
        for number in range(count):
            logged = entry(rng, number)
            made, (message, time) = message_of(logged), ros_message(logged)
            ours.write(made.topic, made.stamp, made.data, made.kind)
            other.write(logged[0], message, time)
    content = ours.content()
    assert content == theirs.read_bytes()
    assert count < 4000 or len(content) > 2 * chunk


@pytest.mark.parametrize("kind", LogKind)
def test_a_connection_says_what_ros_says(kind):
    cls, header = TYPES[kind], HEADERS[kind]
    assert header == {"type": cls._type.encode(), "md5sum": cls._md5sum.encode(),
                      "message_definition": cls._full_text.encode()}


def test_messages_have_the_bytes_of_ros():
    rng = random.Random(1)
    for number in range(500):
        logged = entry(rng, number)
        message, time = ros_message(logged)
        data = io.BytesIO()
        message.serialize(data)
        made = message_of(logged)
        assert (made.data, made.stamp) == (data.getvalue(), (time.secs, time.nsecs))


@pytest.mark.parametrize("topic, value, utc", [
    (STATE, 300, 1.0), (STATE, -1, 1.0), (STATE, "text", 1.0), (STATE, None, 1.0), (TEXT, 1, 1.0),
    (TEXT, "\ud800", 1.0), (SCORE, ("a",), 1.0), (SCORE, ("a", "b", 2**31), 1.0), ("/unknown", 1, 1.0),
    (STATE, 1, -1.0), (STATE, 1, 2.0**32), (STATE, 1, float("nan")),
])
def test_an_entry_that_does_not_fit_is_refused(topic, value, utc):
    with pytest.raises(BadEntry, match="cannot hold"):
        message_of((topic, value, utc))
