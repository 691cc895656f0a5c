"""Reading a journal: while it is written, afterwards, from wherever it lies."""

import os
import re
import shutil
import tempfile
import threading

import pytest

from helpers.journals import UTC0, Writer, spoil
from roah_rsbb.journal import log
from roah_rsbb.journal.contents import utc_text
from roah_rsbb.journal.reader import JournalError, JournalMember, JournalReader, JournalRun
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import RunRecord

RECORD = RunRecord("HNF-6667-1.000", "fbm", "HNF", "Alpha", 1, 2, UTC0 - 600.0, UTC0)
NOBODY = 65534
UTC_END = utc_text(UTC0 + 4.0)


@pytest.fixture
def writer(tmp_path):
    writer = Writer(tmp_path / "log")
    writer.run(RECORD)
    writer.entry("/rsbb_log/rsbb_state", 1, RECORD.identity)
    writer.entry("command", {"command": "start"}, RECORD.identity, "fbm", who="/referee")
    writer.entry("command", {"command": "start", "refused": ["no"]}, "", "tbm", port=None, who="/referee")
    writer.link(LinkSample(1.0, received=1))
    yield writer
    writer.journal.close()


def files_beside(path):
    return sorted(os.listdir(os.path.dirname(path)))


def identities(path):
    return [run.identity for run in JournalReader(str(path)).runs()]


def segments(path):
    return sorted(os.path.join(path, name) for name in os.listdir(path))


def test_what_is_in_it(writer):
    reader = JournalReader(writer.path)
    [run] = reader.runs()
    assert run == JournalRun(*RECORD[:8], None, {**run.outcome})
    assert run.outcome["team"] == "Alpha"
    assert reader.run(RECORD.identity) == run
    assert reader.run("another") is None
    writer.outcome(RECORD._replace(closed_utc=UTC0 + 60.0))
    assert JournalReader(writer.path).run(RECORD.identity).closed_utc == UTC0 + 60.0
    assert reader.members(RECORD.identity) == [
        JournalMember(6667, RECORD.identity, "Alpha", "r1", "/logs/6667.bag")
    ]
    state, start = reader.entries(RECORD.identity)
    assert (state.kind, state.value, state.port, state.utc, state.session) == (
        "/rsbb_log/rsbb_state", 1, 6667, UTC0 + 1.0, 1
    )
    assert (start.who, start.value, start.number) == ("/referee", {"command": "start"}, state.number + 1)
    assert [c.value.get("refused") for c in reader.commands("tbm")] == [["no"]]
    assert [c.value for c in reader.commands("fbm")] == [{"command": "start"}]
    assert [e.value for e in reader.entries("")] == [c.value for c in reader.commands("tbm")]
    [link] = reader.links(6667)
    assert (link.sample, link.utc) == ({"seconds": 1.0, "received": 1}, UTC0 + 4.0)
    assert reader.links(6668) == []
    [session] = reader.sessions()
    assert (session.box_uuid, session.pid) == ("uuid", 1234)


def test_while_the_box_writes_it_is_of_one_moment(writer):
    reader = JournalReader(writer.path)
    writer.run(RECORD._replace(identity="later"), ())
    assert [run.identity for run in reader.runs()] == [RECORD.identity]
    assert identities(writer.path) == [RECORD.identity, "later"]


def test_it_is_whole_while_segments_follow_each_other(writer, monkeypatch):
    monkeypatch.setattr(log, "FULL_BYTES", 10_000)
    writer.journal._writer.log._full_at = 0

    def write():
        for i in range(1500):
            writer.entry("notice", {"text": f"{i} " * (i % 50)}, RECORD.identity)
            if i % 50 == 0:
                writer.journal.why_not_saved(writer.journal.committed)

    thread, counts = threading.Thread(target=write), []
    thread.start()
    while thread.is_alive() or not counts:
        reader = JournalReader(writer.path)
        numbers = [entry.number for entry in reader.entries(RECORD.identity)]
        assert (reader.damage, numbers) == ([], [1, 2, *range(4, numbers[-1] + 1)])  # 3 is of no run
        counts.append(len(numbers))
    thread.join()
    assert counts == sorted(counts) and len(segments(writer.path)) > 5


def test_reading_leaves_a_past_competition_unchanged(writer):
    writer.close()
    before = files_beside(writer.path)
    assert identities(writer.path) == [RECORD.identity]
    assert files_beside(writer.path) == before


def test_a_torn_end_of_a_running_box_is_no_damage(writer):
    """It may be writing."""
    segment = segments(writer.path)[-1]
    with open(segment, "ab") as file:
        file.write(b"RsbR" + bytes(20))
    reader = JournalReader(writer.path)
    assert reader.identities() == [RECORD.identity]
    found, = reader.damage
    assert "torn or damaged: what happened after record" in found and UTC_END in found


def as_nobody(do):
    """Return the result of `do` (a text), called without permission to write outside /tmp."""
    if os.getuid() != 0:
        return do()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setgroups([])
            os.setgid(NOBODY)
            os.setuid(NOBODY)
            os.write(write, do().encode())
        except BaseException as error:
            os.write(write, f"failed: {error!r}".encode())
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    os.close(write)
    with os.fdopen(read) as file:
        return file.read()


def test_a_directory_that_cannot_be_written(writer, monkeypatch):
    """A read-only copy, such as on a CD, even if it was made while the box ran."""
    directory, temporary = tempfile.mkdtemp(), tempfile.mkdtemp()
    os.chmod(temporary, 0o1777)
    # Other test runs write to the directory that all share.
    monkeypatch.setattr(tempfile, "tempdir", temporary)
    try:
        shutil.copytree(writer.path, os.path.join(directory, "j"))
        for path, mode in ((segments(os.path.join(directory, "j"))[0], 0o444), (directory, 0o555)):
            os.chmod(path, mode)
        assert as_nobody(lambda: str(identities(os.path.join(directory, "j")))) == str([RECORD.identity])
        assert os.listdir(temporary) == []
    finally:
        os.chmod(directory, 0o755)
        shutil.rmtree(directory)
        shutil.rmtree(temporary)


def error_of(path):
    with pytest.raises(JournalError) as caught:
        reader = JournalReader(str(path))
        reader.runs()
        reader.entries(RECORD.identity)
        reader.links(6667)
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_what_cannot_be_read_is_said_with_the_remedy(writer, tmp_path, monkeypatch):
    assert "the journal is missing" in error_of(tmp_path / "none")
    (tmp_path / "empty").mkdir()
    assert "this folder has no journal" in error_of(tmp_path / "empty")
    writer.close()
    text = tmp_path / "text"
    text.write_text("a text\n" * 100)
    assert "this is a file, and a journal is a folder" in error_of(text)
    monkeypatch.setattr(log, "VERSION", log.VERSION - 1)
    assert "a newer version of roah_rsbb" in error_of(writer.path)


@pytest.mark.parametrize("keep", [0.9, 0.5, 0.2])
def test_a_segment_that_lost_its_end(writer, keep):
    """Everything before is there."""
    for i in range(300):
        writer.entry("notice", {"text": str(i) * 20}, RECORD.identity)
    writer.close()
    segment, = segments(writer.path)
    os.truncate(segment, int(os.path.getsize(segment) * keep))
    reader = JournalReader(writer.path)
    numbers = [entry.number for entry in reader.entries(RECORD.identity)]
    assert reader.damage
    assert 300 * (keep - 0.2) < len(numbers) < 300 * (keep + 0.2)
    assert numbers == sorted(numbers)


def test_damage_is_reported_with_its_times(writer):
    for i in range(5):
        writer.entry("notice", {"text": f"number {i}"}, RECORD.identity)
    writer.close()
    times = [entry.utc for entry in JournalReader(writer.path).entries(RECORD.identity)]
    spoil(writer.path, b"number 2")
    spoil(writer.path, b"number 3")
    reader = JournalReader(writer.path)
    found, = reader.damage
    left = [entry.utc for entry in reader.entries(RECORD.identity)]
    assert left == times[:-3] + times[-1:]
    assert re.match(r"records \d+ to \d+ damaged or missing, between ", found)
    assert f"between {utc_text(times[-4])} and {utc_text(times[-1])}" in found


def test_an_earlier_record_of_a_run_counts_if_the_newest_is_damaged(writer):
    writer.outcome(RECORD._replace(team="Delta"))
    writer.close()
    spoil(writer.path, b"Delta")
    reader = JournalReader(writer.path)
    assert reader.run(RECORD.identity).outcome["team"] == "Alpha"
    assert len(reader.damage) == 1


# -- large journals ---------------------------------------------------------------------------------


OTHER = RECORD._replace(identity="HNF-6668-2.000", opened_utc=UTC0)


@pytest.fixture
def large(writer, monkeypatch):
    """A journal that counts as large, with a run in each of two segments."""
    monkeypatch.setattr("roah_rsbb.journal.reader.SMALL_BYTES", 0)
    writer.entry("notice", {"text": "first"}, RECORD.identity)
    writer.close()
    second = Writer(os.path.dirname(writer.path))
    second.run(OTHER, robots=((6668, "r1"),))
    second.entry("notice", {"text": "second"}, OTHER.identity, port=6668)
    second.close()
    third = Writer(os.path.dirname(writer.path))
    third.entry("notice", {"text": "third"}, port=None)
    third.close()
    return writer.path


@pytest.mark.parametrize("changed, of_run", [(b'"second"', 1), (b'"first"', 0), (b'o{"HNF-6668', 1)])
def test_a_large_journal_is_checked_where_it_is_read(large, changed, of_run):
    spoil(large, changed)
    reported = []
    reader = JournalReader(large, checks_all=False, on_damage=reported.append)
    assert reader.damage == []
    assert len(reader.damage_of(OTHER.identity)) == of_run
    assert [bool(run.outcome) for run in reader.runs()] == [True, b"o{" not in changed]
    assert len(reported) == (b"o{" in changed) and all(OTHER.identity in text for text in reported)
    reader = JournalReader(large, on_damage=reported.append)
    assert len(reader.damage) == 1, "all of it is checked"
    assert reader.damage_of(OTHER.identity) == [], "it is reported once"
    assert len(reader.runs()) == 2 and len(reported) <= 1


def test_runs_of_many_segments(large, monkeypatch):
    """Only some segments are in memory at the same time."""
    monkeypatch.setattr("roah_rsbb.journal.reader._MOST_LOADED", 1)
    reader = JournalReader(large)
    for _ in range(2):
        assert [e.value["text"] for run in (RECORD, OTHER) for e in reader.entries(run.identity)
                if e.kind == "notice"] == ["first", "second"]
