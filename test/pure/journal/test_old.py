"""Journals of earlier versions: imported once, with equal results, and what is damaged in them is named."""

import contextlib
import os
import pathlib
import random
import shutil
import sqlite3

import pytest

from helpers.damaged_files import damaged
from helpers.examples import ALL
from helpers.journals import UTC0, Writer
from helpers.old_journals import write_old
from roah_rsbb.journal import kinds
from roah_rsbb.journal.batch import Batch
from roah_rsbb.journal.epochs import superseded_value
from roah_rsbb.journal.file import FILE_NAME, OLD_FILE_NAME, CoreSession, DamagedJournal, JournalInUse, Resume, lock
from roah_rsbb.journal.log import Files
from roah_rsbb.journal.old import CannotImport, import_journal
from roah_rsbb.journal.reader import JournalError, JournalReader, journal_in
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.link import LinkSample
from roah_rsbb.model.records import RunRecord

COMPETITION = [["Home", "HNF", "Alpha", 1, 1, 0.0]]
FIRST, SECOND = (RunRecord(f"HNF-{port}-1.000", "Home", "HNF", "Alpha", 1, port - 6666, UTC0, UTC0 + port - 6667)
                 for port in (6667, 6668))


@pytest.fixture(scope="module")
def journal(tmp_path_factory):
    """A journal with two runs, two starts of the core and a takeover by another box."""
    log_dir = tmp_path_factory.mktemp("new")
    for start in (1, 2):
        writer = Writer(log_dir, COMPETITION)
        if start == 1:
            writer.run(FIRST)
            writer.run(SECOND, ((6668, "r1"), (6669, "r2")))
        for i in range(20):
            writer.entry("notice", {"text": f"{start} {i}" * (i % 5 * 100)}, (FIRST, SECOND)[i % 2].identity, "Home",
                         6667 + i % 2, after=0.0 if i % 3 else 1.0)
            writer.entry(kinds.STATE, {"number": i + 1, "change": [{"zone": i}]}, FIRST.identity, "Home", None)
            writer.link(LinkSample(0.1 * i), port=6667 + i % 2)
        writer.outcome(FIRST._replace(closed_utc=UTC0 + start))
        writer.journal.write(Batch(states={"zone:Home": {"start": start}, "box": {"n": [1, None, "ü"]}}))
        if start == 1:
            cut = writer.journal.number_of(writer.journal.committed)
            writer.entry(kinds.EPOCH, superseded_value(2, cut, "10.0.0.3"), port=None)
        writer.close()
    return writer.path


@pytest.fixture
def old(journal, tmp_path):
    def make(version=2):
        path = str(tmp_path / OLD_FILE_NAME)
        write_old(journal, path, version)
        return path
    return make


def all_of(reader):
    """Everything that a reader returns."""
    runs = reader.identities()
    return (reader.sessions(), reader.runs(), reader.all_members(), reader.as_of(), reader.commands("Home"),
            [reader.entries(run) for run in runs], [reader.states(run) for run in runs],
            [reader.links(member.port) for member in reader.all_members()])


def read(path):
    with JournalReader(str(path)) as reader:
        assert reader.damage == []
        return all_of(reader)


def started(log_dir, resume=Resume.ALWAYS, troubles=None):
    session = CoreSession(UTC0 + 5000.0, 1.0, "boot", 1, "uuid", "")
    journal = Journal(str(log_dir), session, COMPETITION, resume, [].append if troubles is None else troubles.append)
    journal.close()
    return journal


@pytest.mark.parametrize("version", [1, 2])
def test_reading_it_gives_equal_results_and_changes_nothing(journal, old, version):
    path = old(version)
    before = pathlib.Path(path).read_bytes()
    assert read(path) == read(journal)
    assert pathlib.Path(path).read_bytes() == before
    assert os.listdir(os.path.dirname(path)) == [OLD_FILE_NAME]


@pytest.mark.parametrize("version", [1, 2])
def test_a_core_imports_it_once(journal, old, tmp_path, version):
    before = pathlib.Path(old(version)).read_bytes()
    first, whole = started(tmp_path), started_copy(journal, tmp_path)
    assert first.previous == whole.previous
    assert first.warnings == whole.warnings == ()
    assert all_of_but_sessions(tmp_path / FILE_NAME) == all_of_but_sessions(journal)
    assert (tmp_path / OLD_FILE_NAME).read_bytes() == before
    again = started(tmp_path)
    assert len(again.previous.outcomes) == 2
    with JournalReader(journal_in(str(tmp_path))) as reader:
        assert [session.utc for session in reader.sessions()][2:] == [UTC0 + 5000.0] * 2


def started_copy(journal, tmp_path):
    shutil.copytree(journal, tmp_path / "copy" / FILE_NAME)
    return started(tmp_path / "copy")


def all_of_but_sessions(path):
    found = read(path)
    return found[1:3] + found[4:]


def test_where_the_journals_fork_is_the_number_of_a_record(journal, old, tmp_path):
    with JournalReader(journal) as reader, JournalReader(old()) as imported:
        assert imported.standing()._replace(cut=0) == reader.standing()._replace(cut=0)
        # The records of runs and the states are at the end of an imported journal.
        assert imported.only_here() == reader.only_here()


def test_an_import_that_was_interrupted_is_repeated(journal, old, tmp_path):
    class Ending(Files):
        @staticmethod
        def rename(source, target):
            if target.endswith(FILE_NAME):
                raise KeyboardInterrupt
            os.rename(source, target)

    path = old()
    with pytest.raises(KeyboardInterrupt):
        import_journal(path, str(tmp_path / FILE_NAME), Ending())
    assert not (tmp_path / FILE_NAME).exists()
    assert len(started(tmp_path).previous.outcomes) == 2
    assert all_of_but_sessions(tmp_path / FILE_NAME) == all_of_but_sessions(journal)


def test_what_is_only_in_the_write_ahead_log_is_imported(journal, old, tmp_path):
    path = old()
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA wal_autocheckpoint = 0")
        connection.execute("DELETE FROM runs WHERE identity = ?", (SECOND.identity,))
        (tmp_path / "killed").mkdir()
        for suffix in ("", "-wal"):
            shutil.copy(path + suffix, tmp_path / "killed" / f"{OLD_FILE_NAME}{suffix}")
    files = {file.name: file.read_bytes() for file in (tmp_path / "killed").iterdir()}
    assert started(tmp_path / "killed").previous.outcomes[0]["identity"] == FIRST.identity
    assert len(started(tmp_path / "killed").previous.outcomes) == 1
    assert {name: (tmp_path / "killed" / name).read_bytes() for name in files} == files


def test_a_core_of_the_earlier_version_runs(old, tmp_path):
    old()
    with open(tmp_path / f"{OLD_FILE_NAME}.lock", "w", encoding="ascii") as file:
        import fcntl
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(DamagedJournal, match=f"{OLD_FILE_NAME} is in use by"):
            started(tmp_path)
    assert not (tmp_path / FILE_NAME).exists()


def test_it_is_not_imported_if_nothing_is_continued(old, tmp_path):
    old()
    assert started(tmp_path, Resume.NEVER).previous.outcomes == ()


def test_an_empty_file_had_a_journal(tmp_path):
    (tmp_path / OLD_FILE_NAME).touch()
    with pytest.raises(DamagedJournal, match="it is empty, as after a power failure.*resume:=never"):
        started(tmp_path)
    assert started(tmp_path, Resume.NEVER).previous.outcomes == ()


@pytest.mark.parametrize("statement, why", [
    ("PRAGMA application_id = 7", "another program"), ("PRAGMA user_version = 3", "a newer version"),
])
def test_a_file_that_cannot_be_imported(old, tmp_path, statement, why):
    with contextlib.closing(sqlite3.connect(old())) as connection:
        connection.execute(statement)
    with pytest.raises(DamagedJournal, match=f"{why}.*resume:=never"):
        started(tmp_path)
    with pytest.raises(JournalError, match=why):
        JournalReader(str(tmp_path / OLD_FILE_NAME))
    lock(str(tmp_path))


@pytest.mark.parametrize("change, what", [
    ("UPDATE entries SET value = replace(value, ':', ';') WHERE id = 2", "1 rows of entries (id 2)"),
    ("DELETE FROM entries WHERE id IN (2, 3)", "entries 2 to 3 are missing"),
    ("UPDATE runs SET outcome = replace(outcome, 'Alpha', 'Alpka')", "2 rows of runs (identity HNF-6667-1.000, "),
    ("DELETE FROM runs WHERE identity = 'HNF-6667-1.000'", "the row of the run HNF-6667-1.000"),
    ("UPDATE members SET robot = 'r5'", "3 rows of members (port 6667, 6668, 6669)"),
    ("UPDATE sessions SET utc = utc + 1 WHERE id = 1", "1 rows of sessions (id 1)"),
    ("UPDATE entries SET who = CAST(x'ff' AS TEXT) WHERE id = 1", "1 rows of entries (id 1)"),
    ("UPDATE states SET state = '{' WHERE name = 'box'", "1 rows of states (name box)"),
    ("UPDATE links SET mono = 0.0 WHERE rowid = 3", "1 rows of links (rowid 3)"),
    ("UPDATE entries SET identity = 'a' || char(10) || 'b' WHERE id = 4", "1 rows of entries (id 4)"),
    ("DROP TABLE links", "a part of links (no such table: links)"),
])
def test_damaged_rows_are_left_out_and_named(old, tmp_path, change, what):
    with contextlib.closing(sqlite3.connect(old())) as connection:
        connection.execute(change)
        connection.commit()
    with JournalReader(str(tmp_path / OLD_FILE_NAME)) as reader:
        assert what in "; ".join(reader.damage)
    warning, = started(tmp_path).warnings
    assert what in warning and "The old file stays as it was" in warning


@pytest.mark.long
def test_changed_bits_and_lost_sectors(journal, old, tmp_path):
    """Whatever is damaged, nothing wrong is imported."""
    whole = all_of(JournalReader(journal))
    content = pathlib.Path(old()).read_bytes()
    path, folder, imported, count = tmp_path / "damaged", tmp_path / "imported", 0, 2000 if ALL else 60
    for seed in range(count):
        path.write_bytes(damaged(content, random.Random(seed)))
        try:
            import_journal(str(path), str(folder), Files())
        except CannotImport:
            continue
        imported += 1
        with JournalReader(str(folder)) as reader:
            found = all_of(reader)
        shutil.rmtree(folder)
        # Of a run whose row is lost, only the robots are known.
        assert {str(run) for run in found[1] if run.zone} <= {*map(str, whole[1])} | {
            str(run._replace(closed_utc=None, outcome={})) for run in whole[1]}, seed
        assert {run.identity for run in found[1]} <= {run.identity for run in whole[1]}, seed
        # The number of an entry is not in its checksum.
        entries = {str(entry[1:]) for run in whole[5] for entry in run}
        assert all(str(entry[1:]) in entries for run in found[5] for entry in run), seed
    assert imported > 0.5 * count


def test_a_lock_of_the_new_journal_is_its_own(tmp_path):
    held = lock(str(tmp_path))
    with pytest.raises(JournalInUse):
        lock(str(tmp_path))
    os.close(held.fd)
