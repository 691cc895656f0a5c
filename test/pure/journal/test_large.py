"""A core that comes back reads little of a large journal, and nothing twice: 44 runs, 90 MB."""

import collections
import os
import shutil

from helpers.journals import Writer
from helpers.results_of import task_record
from roah_rsbb.journal import contents
from roah_rsbb.journal.records import Batch, LinkRow, NewEntry, OutcomeRow
from roah_rsbb.model.as_json import to_json

PORTS = range(6667, 6711)
BYTES = 90_000_000


def write_killed(before, log_dir):
    """Write the journal of a core, as it is when the core is killed."""
    box = Writer(before)
    records = {port: task_record("Alpha", port)._replace(closed_utc=0.0) for port in PORTS}
    for port, record in records.items():
        box.run(record, ((port, f"r{port}"),))
    second = size = 0
    while size < BYTES:
        second += 1
        moment = box.utc + second, 10.0 + second
        ticket = box.journal.write(Batch(
            entries=[NewEntry(*moment, "tbm", record.identity, port, "10.0.0.2", "/notification", "x" * 1000)
                     for port, record in records.items()],
            links=[LinkRow(port, *moment, {"received": 10, "delay": 0.0123}) for port in PORTS],
            states={f"zone:{second % 44}": {"second": second}}))
        if second % 20 == 0:
            assert box.journal.why_not_saved(ticket) == ""
            size = sum(entry.stat().st_size for entry in os.scandir(box.path))
    # All are stopped at once.
    box.journal.write(Batch(outcomes={record.identity: OutcomeRow(None, {**to_json(record), "end_reason": "stopped"})
                                      for record in records.values()}))
    shutil.copytree(str(before), str(log_dir))
    box.close()
    return second


def test_a_start_reads_the_newest_segment_once_and_the_newest_records_of_runs(tmp_path, monkeypatch):
    seconds = write_killed(tmp_path / "before", tmp_path / "log")
    taken = collections.Counter()
    read, read_at = contents.read, os.pread

    def count_read(path):
        content = read(path)
        taken[path] += len(content)
        return content

    def count_read_at(fd, size, at):
        content = read_at(fd, size, at)
        taken[at] += len(content)
        return content

    monkeypatch.setattr(contents, "read", count_read)
    monkeypatch.setattr(os, "pread", count_read_at)
    after = Writer(tmp_path / "log")
    previous = after.journal.previous
    assert max(state["second"] for state in previous.states.values()) == seconds
    assert [outcome["end_reason"] for outcome in previous.outcomes] == ["stopped"] * len(PORTS)
    assert previous.last_port == PORTS[-1]
    newest = sorted(entry.path for entry in os.scandir(after.path))[-2]
    assert taken.pop(newest) == os.path.getsize(newest) < 10_000_000
    assert sum(taken.values()) < 500_000
    before = sum(taken.values())
    after.entry("/notification", "it continues", task_record("Alpha", PORTS[0]).identity)
    assert sum(taken.values()) == before
    after.close()
