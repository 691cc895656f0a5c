"""Bags are made from the journal: whole or not at all, many of them in one reading."""

import errno
import subprocess
import sys

import pytest

from helpers.bags import END, NAME, SCORE, STATE, TEXT, UTC, entries, plain, read, rosbag
from helpers.journals import Writer
from helpers.results_of import task_record
from roah_rsbb.ground import durable
from roah_rsbb.journal import contents
from roah_rsbb.journal import log as logs
from roah_rsbb.journal import reader as readers
from roah_rsbb.run_logs.bag import write_bag, write_bags

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
from roah_rsbb.run_logs.bag import write_bag
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
