"""A bag has the bytes that rosbag writes, and its messages those of ROS."""

import errno
import io
import random
import subprocess
import sys

import pytest

from helpers.bags import END, NAME, SCORE, STATE, TEXT, UTC, entries, plain, read, rosbag
from helpers.journals import Writer
from helpers.results_of import task_record
from roah_rsbb.ground import durable
from roah_rsbb.journal import bag, contents
from roah_rsbb.journal import log as logs
from roah_rsbb.journal import reader as readers
from roah_rsbb.journal.bag import HEADERS, BadEntry, message_of, write_bag, write_bags
from roah_rsbb.model.run_log import KINDS, LogKind

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


# -- making bags from the journal -------------------------------------------------------------------


ALL_KINDS = [(STATE, 3, UTC), (TEXT, "Grüße", UTC), (SCORE, ["Group", "Item", -2], UTC + 1), (END, None, UTC + 1)]


@pytest.fixture
def path(tmp_path):
    return tmp_path / NAME


def test_a_bag_holds_entries_of_all_kinds_in_their_order(path):
    write_bag(str(path), ALL_KINDS)
    assert read(path) == [(STATE, 3), (TEXT, "Grüße"), (SCORE, ("Group", "Item", -2)), (END, None)]
    with rosbag.Bag(str(path)) as bag:
        assert bag.get_type_and_topic_info().topics[SCORE].msg_type == "roah_rsbb/Score"
        assert abs(bag.get_start_time() - UTC) < 1e-6


def test_entries_of_one_moment_stay_in_their_order(path):
    logged = [(topic, value, UTC) for topic, value in ((END, None), (TEXT, "b"), (STATE, 1), (TEXT, "a"), (END, None))]
    write_bag(str(path), logged)
    assert read(path) == plain(logged)


def test_an_entry_that_no_message_can_hold_is_left_out(path):
    write_bag(str(path), [(STATE, 300, UTC), ("/unknown", 1, UTC), (STATE, "text", UTC), (SCORE, ["a"], UTC),
                          (STATE, 1, -1.0), (TEXT, "good", UTC)])
    assert read(path) == [(TEXT, "good")]


def test_the_last_of_the_disk_belongs_to_the_journal(path, monkeypatch):
    monkeypatch.setattr(durable, "SPACE_BYTES", 1 << 60)
    with pytest.raises(OSError, match="No space") as error:
        write_bag(str(path), entries(3))
    assert error.value.errno == errno.ENOSPC and not list(path.parent.iterdir())


KILLED = """
import os, signal, sys
from roah_rsbb.journal.bag import write_bag
step = sys.argv[2]
def kill(*_):
    os.kill(os.getpid(), signal.SIGKILL)
if step == "sync":
    os.fsync = kill
else:
    os.replace = kill
write_bag(sys.argv[1], [("/notification", "x" * 100, 1e9)] * 1000)
"""


@pytest.mark.parametrize("step", ["sync", "rename"])
def test_a_kill_leaves_nothing_under_the_final_name(path, step):
    paths = f"import sys; sys.path[:0] = {sys.path!r}\n"
    assert subprocess.run([sys.executable, "-c", paths + KILLED, str(path), step], check=False).returncode == -9
    assert not path.exists()
    write_bag(str(path), entries(9))
    assert read(path) == plain(entries(9)) and list(path.parent.iterdir()) == [path]


def test_many_bags_take_one_reading_of_the_journal(tmp_path, monkeypatch):
    monkeypatch.setattr(logs, "FULL_BYTES", 20_000)
    writer, ports = Writer(tmp_path), range(6667, 6677)
    records = [task_record(f"Team {port}", 1)._replace(identity=f"run {port}") for port in ports]
    for port, record in zip(ports, records):
        writer.run(record, ((port, "r1"),))
    for number in range(40):
        for port, record in zip(ports, records):
            writer.entry(TEXT, f"{port} {number} {'x' * 100}", record.identity, port=port)
            writer.entry("command", {"command": "start"}, record.identity, port=port)
        writer.journal.why_not_saved(writer.journal.write(contents.records.Batch(states={"box": number})))
    writer.close()
    reader = readers.JournalReader(writer.path, checks_all=False)
    read_segments, scan = [], readers.scan_at
    monkeypatch.setattr(
        readers, "scan_at", lambda segments, place: read_segments.append(place) or scan(segments, place))
    paths = {(record.identity, port): str(tmp_path / f"{port}.bag") for port, record in zip(ports, records)}
    write_bags(reader, paths)
    assert len(read_segments) == len(set(read_segments)) > 2
    for port in ports:
        found = read(tmp_path / f"{port}.bag")
        assert [text.split()[:2] for _, text in found] == [[str(port), str(number)] for number in range(40)]
