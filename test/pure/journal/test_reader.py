"""Reading a journal: while it is written, afterwards, from wherever it lies."""

import contextlib
import os
import shutil
import sqlite3
import tempfile

import pytest

from helpers.journals import UTC0, Writer, make_old
from roah_rsbb.core.link.record import LinkSample
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal import schema
from roah_rsbb.journal.damage import utc_text
from roah_rsbb.journal.reader import JournalError, JournalMember, JournalReader, JournalRun

RECORD = RunRecord("HNF-6667-1.000", "fbm", "HNF", "Alpha", 1, 2, UTC0 - 600.0, UTC0)
NOBODY = 65534


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
    with JournalReader(str(path)) as reader:
        return [run.identity for run in reader.runs()]


def statement(path, text):
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.execute(text)
        connection.commit()


def test_what_is_in_it(writer):
    with JournalReader(writer.path) as reader:
        [run] = reader.runs()
        assert run == JournalRun(*RECORD[:8], None, {**run.outcome})
        assert run.outcome["team"] == "Alpha"
        assert reader.run(RECORD.identity) == run
        assert reader.run("another") is None
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
        [link] = reader.links(6667)
        assert (link.sample, link.utc) == ({"seconds": 1.0, "received": 1}, UTC0 + 4.0)
        assert reader.links(6668) == []
        [session] = reader.sessions()
        assert (session.box_uuid, session.pid) == ("uuid", 1234)


def test_a_run_that_is_over(writer):
    writer.outcome(RECORD._replace(closed_utc=UTC0 + 60.0))
    with JournalReader(writer.path) as reader:
        assert reader.run(RECORD.identity).closed_utc == UTC0 + 60.0


def test_while_the_box_writes_it_is_of_one_moment(writer):
    with JournalReader(writer.path) as reader:
        writer.run(RECORD._replace(identity="later"), ())
        assert [run.identity for run in reader.runs()] == [RECORD.identity]
    assert identities(writer.path) == [RECORD.identity, "later"]


def test_the_box_can_write_while_it_is_read(writer):
    with JournalReader(writer.path) as reader:
        writer.entry("notice", {})
        writer.close()
        assert len(reader.runs()) == 1


def test_reading_leaves_a_past_competition_unchanged(writer):
    writer.close()
    before = files_beside(writer.path)
    assert identities(writer.path) == [RECORD.identity]
    assert files_beside(writer.path) == before


def test_a_copy_with_and_without_its_log(writer, tmp_path):
    """While the box runs, its latest data is only in the log (-wal)."""
    for name, suffixes in (("both", ("", "-wal")), ("file", ("",))):
        (tmp_path / name).mkdir()
        for suffix in suffixes:
            shutil.copy(writer.path + suffix, tmp_path / name / f"j.sqlite3{suffix}")
    assert identities(tmp_path / "both" / "j.sqlite3") == [RECORD.identity]
    writer.close()
    (tmp_path / "closed").mkdir()
    shutil.copy(writer.path, tmp_path / "closed" / "j.sqlite3")
    assert identities(tmp_path / "closed" / "j.sqlite3") == [RECORD.identity]


def test_a_journal_of_a_file_system_without_write_ahead_log(writer, tmp_path):
    writer.close()
    statement(writer.path, "PRAGMA journal_mode = DELETE")
    assert identities(writer.path) == [RECORD.identity]
    connection = sqlite3.connect(writer.path, isolation_level=None)
    connection.execute("BEGIN IMMEDIATE")
    connection.execute("UPDATE runs SET identity = 'changed'")
    assert identities(writer.path) == [RECORD.identity], "nothing of it is committed"
    connection.execute("COMMIT")
    connection.close()
    assert identities(writer.path) == ["changed"]


def test_a_computer_that_failed_in_the_middle_of_a_change(writer, tmp_path):
    """Without a write-ahead log, the file may contain half of a change, and a rollback journal beside it."""
    writer.close()
    statement(writer.path, "PRAGMA journal_mode = DELETE")
    connection = sqlite3.connect(writer.path, isolation_level=None)
    connection.execute("PRAGMA cache_size = 1")
    connection.execute("BEGIN")
    connection.execute("UPDATE runs SET identity = 'half'")
    connection.executemany("INSERT INTO links VALUES (1, 1, 1, ?, 0)", (("x" * 4000,) for _ in range(100)))
    for suffix in ("", "-journal"):
        shutil.copy(writer.path + suffix, tmp_path / f"j{suffix}")
    connection.execute("ROLLBACK")
    connection.close()
    assert b"half" in (tmp_path / "j").read_bytes()
    assert identities(tmp_path / "j") == [RECORD.identity]


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


@pytest.mark.parametrize("suffixes", [("",), ("", "-wal"), ("", "-wal", "-shm")])
def test_a_directory_that_cannot_be_written(writer, suffixes, monkeypatch):
    """A read-only copy, such as on a CD, even if it was made while the box ran."""
    if "-wal" not in suffixes:
        writer.close()
    directory, temporary = tempfile.mkdtemp(), tempfile.mkdtemp()
    os.chmod(temporary, 0o1777)
    # Other test runs write to the directory that all share.
    monkeypatch.setattr(tempfile, "tempdir", temporary)
    try:
        for suffix in suffixes:
            shutil.copy(writer.path + suffix, os.path.join(directory, f"j.sqlite3{suffix}"))
            os.chmod(os.path.join(directory, f"j.sqlite3{suffix}"), 0o444)
        os.chmod(directory, 0o555)
        assert as_nobody(lambda: str(identities(os.path.join(directory, "j.sqlite3")))) == str([RECORD.identity])
        assert files_beside(os.path.join(directory, "x")) == sorted(f"j.sqlite3{s}" for s in suffixes)
        assert os.listdir(temporary) == []
    finally:
        os.chmod(directory, 0o755)
        shutil.rmtree(directory)
        shutil.rmtree(temporary)


def test_a_journal_of_an_older_version_is_read_from_a_copy(writer):
    writer.close()
    make_old(writer.path)
    with JournalReader(writer.path) as reader:
        assert reader.members(RECORD.identity)[0].robot == "r1"
    with contextlib.closing(sqlite3.connect(writer.path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (1,), "the file itself is not touched"


def error_of(path):
    with pytest.raises(JournalError) as caught, JournalReader(str(path)) as reader:
        reader.runs()
        reader.entries(RECORD.identity)
        reader.links(6667)
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_what_cannot_be_read_is_said_with_the_remedy(writer, tmp_path):
    assert "the file is missing" in error_of(tmp_path / "none")
    assert "the file is missing" in error_of(tmp_path)
    writer.close()
    statement(writer.path, f"PRAGMA user_version = {schema.VERSION + 1}")
    assert "a newer version of roah_rsbb" in error_of(writer.path)
    statement(writer.path, "PRAGMA user_version = -5")
    assert "read it with the version that wrote it" in error_of(writer.path)
    text = tmp_path / "text"
    text.write_text("no database, but a text that is long enough to be one\n" * 100)
    assert "or not a journal" in error_of(text)
    foreign = tmp_path / "foreign"
    statement(foreign, "CREATE TABLE runs (identity TEXT)")
    assert "another program" in error_of(foreign)
    empty = tmp_path / "empty"
    empty.touch()
    assert "is still empty" in error_of(empty)


@pytest.mark.parametrize("keep", [0.9, 0.5, 0.2, 0.01])
def test_a_torn_file(writer, keep):
    for i in range(300):
        writer.entry("notice", {"text": str(i) * 20}, RECORD.identity)
    writer.close()
    os.truncate(writer.path, int(os.path.getsize(writer.path) * keep))
    assert "damaged" in error_of(writer.path)
    with pytest.raises(JournalError):
        identities(writer.path)


def test_damaged_pages_and_values(writer):
    for i in range(300):
        writer.entry("notice", {"text": str(i) * 20}, RECORD.identity)
    writer.close()
    statement(writer.path, "UPDATE entries SET value = '{' WHERE id = 7")
    assert "damaged" in error_of(writer.path)
    with open(writer.path, "r+b") as file:
        file.seek(file.read().index(b'"150150') // 4096 * 4096)
        file.write(b"\xaa" * 4096)
    with pytest.raises(JournalError, match="damaged"):
        identities(writer.path)  # which reads nothing of that page


def test_no_damage(writer):
    assert reader_damage(writer.path) == []
    writer.close()
    assert reader_damage(writer.path) == []


def reader_damage(path):
    with JournalReader(path) as reader:
        return reader.damage


@pytest.mark.parametrize("change, what", [
    ("UPDATE entries SET value = replace(value, ':', ';') WHERE id = 2", "entries 2 to 2: 1 damaged"),
    ("DELETE FROM entries WHERE id IN (2, 3)", "entries 2 to 3: 2 missing"),
    ("DELETE FROM entries WHERE id > 3", "entries 4 to"),
    ("UPDATE runs SET outcome = replace(outcome, 'Alpha', 'Alpka')", "records of runs: 1 damaged"),
    ("UPDATE members SET robot = 'r2'", "robots of runs: 1 damaged"),
    ("UPDATE sessions SET utc = utc + 1", "starts of the core: 1 damaged"),
    ("UPDATE entries SET who = CAST(x'ff' AS TEXT) WHERE id = 1", "entries 1 to 1: 1 damaged"),
])
def test_invalid_rows_are_reported(writer, change, what):
    for i in range(5):
        writer.entry("notice", {"text": str(i)}, RECORD.identity)
    writer.close()
    statement(writer.path, change)
    found, = reader_damage(writer.path)
    assert what in found


def test_damage_is_reported_with_its_times(writer):
    for i in range(5):
        writer.entry("notice", {"text": str(i)}, RECORD.identity)
    with JournalReader(writer.path) as reader:
        times = {entry.number: entry.utc for entry in reader.entries(RECORD.identity)}
    last = max(times)
    writer.close()
    statement(writer.path, f"DELETE FROM entries WHERE id IN ({last - 2}, {last - 1})")
    found, = reader_damage(writer.path)
    assert f"from {utc_text(times[last - 3])} to {utc_text(times[last])}" in found


# -- large journals ---------------------------------------------------------------------------------


@pytest.fixture
def large(writer, monkeypatch):
    """A journal with two runs that counts as large: the second run has entries and samples 6 to 8."""
    monkeypatch.setattr("roah_rsbb.journal.reader.SMALL_BYTES", 0)
    writer.run(OTHER, robots=((6668, "r1"),))
    for identity, port in ((RECORD.identity, 6667), (OTHER.identity, 6668)):
        for i in range(2 if port == 6667 else 3):
            writer.entry("notice", {"text": str(i)}, identity)
            writer.link(LinkSample(1.0, received=i), port)
    writer.close()
    return writer.path


OTHER = RECORD._replace(identity="HNF-6668-2.000", opened_utc=UTC0)


@pytest.mark.parametrize("change, of_records, of_run", [
    ("UPDATE entries SET utc = 0.0 WHERE id = 7", [], "entries 7 to 7: 1 damaged"),
    ("DELETE FROM entries WHERE id = 7", [], "entries 7 to 7: 1 missing"),
    ("DELETE FROM links WHERE rowid = 5", [], "link samples 5 to 5: 1 missing"),
    ("UPDATE members SET robot = 'r2' WHERE port = 6668", [], "robots of runs: 1 damaged: 6668"),
    ("UPDATE runs SET round = 7 WHERE identity = 'HNF-6668-2.000'",
     ["records of runs: 1 damaged: HNF-6668-2.000"], ""),
    ("DELETE FROM entries WHERE id = 2", [], ""),  # not of this run
])
def test_a_large_journal_is_checked_where_it_is_read(large, change, of_records, of_run):
    statement(large, change)
    with JournalReader(large, checks_all=False) as reader:
        assert reader.damage == of_records
        found = reader.damage_of(OTHER.identity)
    assert len(found) == bool(of_run)
    assert not of_run or of_run in found[0]
    with JournalReader(large) as reader:
        assert len(reader.damage) == 1, "all of it is checked"
        assert reader.damage_of(OTHER.identity) == [], "it is reported once"


def test_outlines_and_identities(large):
    with JournalReader(large) as reader:
        assert reader.identities() == [RECORD.identity, OTHER.identity]
        first, second = reader.outlines(("started_utc", "sign_off.who"))
    assert first == (*RECORD[:8], None, None)
    assert second[:1] == (OTHER.identity,)
