"""Recovering the readable part of a damaged journal."""

import contextlib
import os
import pathlib
import shutil
import sqlite3

import pytest

from helpers.journals import UTC0, Writer, make_old
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal import pages
from roah_rsbb.journal import recover as recover_module
from roah_rsbb.journal.pages import is_damaged, read_frames
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.recover import recover

RECORD = RunRecord("HNF-6667-1.000", "fbm", "HNF", "Alpha", 1, 2, UTC0 - 600.0, UTC0)
COUNT = 400
PAGE = 4096


@pytest.fixture(scope="module")
def closed(tmp_path_factory):
    """A journal of many pages that was closed, for tests that do not change it."""
    writer = Writer(tmp_path_factory.mktemp("closed") / "log")
    writer.run(RECORD)
    for i in range(COUNT):
        writer.entry("notice", {"text": f"{i} " * 20}, RECORD.identity)
    writer.close()
    return writer.path


@pytest.fixture
def path(closed, tmp_path):
    """A copy of the closed journal."""
    return shutil.copy(closed, tmp_path)


def numbers(path):
    with JournalReader(path) as reader:
        assert reader.run(RECORD.identity).outcome["team"] == "Alpha"
        assert reader.members(RECORD.identity)[0].robot == "r1"
        return [entry.number for entry in reader.entries(RECORD.identity)]


def spoil(path, page, pages=1):
    with open(path, "r+b") as file:
        file.seek(page * PAGE)
        file.write(b"\xaa" * PAGE * pages)


def page_of(path, text):
    """The number of a page that holds this text."""
    with open(path, "rb") as file:
        return file.read().index(text.encode()) // PAGE


def test_all_of_a_journal_that_is_not_damaged(path, tmp_path):
    new = str(tmp_path / "new")
    counts, damage = recover(path, new)
    assert damage == []
    assert sorted(tmp_path.iterdir()) == sorted(map(pathlib.Path, (path, new)))
    with contextlib.closing(sqlite3.connect(new)) as connection:
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("delete",)
    recover(path, f"{new} again")
    assert pathlib.Path(new).read_bytes() == pathlib.Path(f"{new} again").read_bytes()
    assert (counts["entries"], counts["runs"], counts["members"]) == (COUNT, 1, 1)
    assert numbers(new) == list(range(1, COUNT + 1))


def test_an_index_that_does_not_fit_is_rebuilt(path, tmp_path):
    """A sound file is copied with its indexes, so these must be those of its rows."""
    with open(path, "rb") as file:
        content = file.read()
    rows = (b"HNF-6667-1.000", b"HNF-6667-1.001")
    at = next(page * PAGE for page in range(len(content) // PAGE)
              if content[page * PAGE] == 0x0A and content.count(rows[0], page * PAGE, (page + 1) * PAGE) > 20)
    with open(path, "r+b") as file:
        file.seek(content.index(rows[0], at))
        file.write(rows[1])
    new = str(tmp_path / "new")
    assert recover(path, new).damage == []
    assert numbers(new) == list(range(1, COUNT + 1))


def test_a_changed_row_of_a_sound_file_is_reported_and_left_out(path, tmp_path):
    with open(path, "rb") as file:
        at = file.read().index(b'"100 100')
    with open(path, "r+b") as file:
        file.seek(at)
        file.write(b'"900')
    new = str(tmp_path / "new")
    rows, damage = recover(path, new)
    assert [hole.what for hole in damage] == ["101 to 101: 1 missing"]
    assert numbers(new) == [n for n in range(1, COUNT + 1) if n != 101]
    assert rows["entries"] == COUNT - 1


@pytest.mark.parametrize("statement", [
    "CREATE INDEX more ON entries (who)", "CREATE TRIGGER more AFTER INSERT ON entries BEGIN DELETE FROM entries; END",
])
def test_nothing_that_is_not_of_a_journal_is_copied(path, tmp_path, statement):
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.execute(statement)
    new = str(tmp_path / "new")
    assert recover(path, new).damage == []
    with contextlib.closing(sqlite3.connect(new)) as connection:
        assert connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'more'").fetchall() == []
    assert numbers(new) == list(range(1, COUNT + 1))


def test_both_sides_of_damaged_pages(path, tmp_path):
    first, second = page_of(path, '"100 '), page_of(path, '"200 ')
    assert first != second
    spoil(path, first)
    spoil(path, second)
    with pytest.raises(JournalError):
        numbers(path)
    new = str(tmp_path / "new")
    recover(path, new)
    found = numbers(new)
    assert len(found) > COUNT * 0.8
    assert {1, 150, COUNT} <= set(found)
    assert not {101, 201} & set(found)
    assert found == sorted(set(found))


def test_both_sides_of_a_damaged_page_of_runs(tmp_path):
    writer = Writer(tmp_path / "log")
    for i in range(100):
        writer.run(RECORD._replace(identity=f"run {i:03d}", zone="long " * 40), ())
    writer.close()
    spoil(writer.path, page_of(writer.path, "run 050"))
    recover(writer.path, str(tmp_path / "new"))
    with JournalReader(str(tmp_path / "new")) as reader:
        found = [run.identity for run in reader.runs()]
    assert {"run 000", "run 099"} <= set(found)
    assert len(found) > 50


@pytest.mark.parametrize("spares_pages", [False, True])
def test_what_lies_between_damaged_pages(path, tmp_path, monkeypatch, spares_pages):
    """SQLite alone reads it; the search of all pages finds no more."""
    if spares_pages:
        monkeypatch.setattr(recover_module, "_take_from_pages", lambda *_: None)
    lost = set()
    for text in ('"100 100', '"300 300'):
        page = page_of(path, text)
        with open(path, "rb") as file:
            file.seek(page * PAGE)
            content = file.read(PAGE)
        lost |= {n for n in range(1, COUNT + 1) if f'"{n - 1} {n - 1} '.encode() in content}
        spoil(path, page)
    new = str(tmp_path / "new")
    damage = recover(path, new).damage
    assert len(lost) >= 4
    skipped = set(range(1, COUNT + 1)) - set(numbers(new))
    assert lost <= skipped
    assert len(skipped) <= (4 * len(lost) if spares_pages else len(lost))
    assert len(damage) == 2


def test_a_journal_whose_first_page_is_damaged(path, tmp_path):
    spoil(path, 0)
    new = str(tmp_path / "new")
    assert recover(path, new).damage == []
    assert numbers(new) == list(range(1, COUNT + 1))


@pytest.mark.parametrize("is_old", [False, True])
@pytest.mark.parametrize("pages", range(3, 24, 4))
def test_all_that_is_in_the_pages_of_a_truncated_journal(path, tmp_path, pages, is_old):
    """Whichever page is the last: everything in those before it is taken, in order, and the rest is named."""
    if is_old:
        make_old(path)
    os.truncate(path, pages * PAGE)
    with open(path, "rb") as file:
        left = [n for n in range(1, COUNT + 1) if f'"{n - 1} {n - 1} '.encode() in file.read()[file.seek(0):]]
    new = str(tmp_path / "new")
    rows, damage = recover(path, new)
    with JournalReader(new) as reader:
        found = [entry.number for entry in reader.entries(RECORD.identity)]
        if found:
            times = {entry.number: entry.utc for entry in reader.entries(RECORD.identity)}
    assert rows["entries"] == len(found)
    assert found == sorted(found)
    assert set(left) - set(found) == set()
    if found:
        hole, = (d for d in damage if d.table == "entries")
        assert hole.from_utc == times[found[-1]]
        assert f"{found[-1] + 1} to {COUNT}: {COUNT - len(found)} missing" in hole.what


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """The journal of a box that was killed. Its newest runs are in the write-ahead log alone."""
    tmp_path = tmp_path_factory.mktemp("killed")
    writer = Writer(tmp_path / "log")
    for number in range(6):
        record = RECORD._replace(identity=f"HNF-{number}-1.000", run=number)
        writer.run(record, ((6667 + number, "r1"),))
        for i in range(10):
            writer.entry("notice", {"text": f"{number} {i} " * 30}, record.identity, port=6667 + number)
    copy = tmp_path / "crashed" / os.path.basename(writer.path)
    copy.parent.mkdir()
    for suffix in ("", "-wal"):
        shutil.copy(f"{writer.path}{suffix}", f"{copy}{suffix}")
    writer.close()
    assert read_frames(f"{copy}-wal") != []
    return copy


@pytest.fixture
def crashed(killed, tmp_path):
    """A copy of the journal of a killed box; returns its path."""
    for suffix in ("", "-wal"):
        shutil.copy(f"{killed}{suffix}", tmp_path)
    return str(tmp_path / killed.name)


@pytest.mark.long
@pytest.mark.parametrize("place", [0.0, 0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_damaged_write_ahead_log_is_reported_and_costs_only_what_is_damaged(crashed, tmp_path, place):
    log = f"{crashed}-wal"
    assert not is_damaged(read_frames(log))
    at = int(os.path.getsize(log) * place) + 8
    with open(log, "r+b") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 0x40]))
    if place:
        with JournalReader(crashed) as reader:
            assert len(reader.damage) == 1 and "write-ahead log" in reader.damage[0]
    else:  # SQLite ignores all of the log, and all of this journal is in it
        with pytest.raises(JournalError, match="write-ahead log"):
            JournalReader(crashed)
    new = str(tmp_path / "new")
    recover(crashed, new)
    with JournalReader(new) as reader:
        runs = [run.identity for run in reader.runs()]
        entries = [entry.number for run in runs for entry in reader.entries(run)]
    assert len(runs) >= 5
    assert len(entries) >= 55
    assert "HNF-5-1.000" in runs


@pytest.mark.parametrize("missing", [0, 7])
def test_a_row_below_the_first_number_is_no_gap_and_hides_none(path, tmp_path, missing):
    with contextlib.closing(sqlite3.connect(path)) as connection:
        columns = connection.execute("SELECT group_concat(name) FROM pragma_table_info('entries')").fetchone()[0]
        values = columns.replace("id,", "0,", 1)
        connection.execute(f"INSERT INTO entries ({columns}) SELECT {values} FROM entries WHERE id = 7")
        connection.execute("DELETE FROM entries WHERE id = ?", (missing or -1,))
        connection.commit()
    found = [hole.what for hole in recover(path, str(tmp_path / "new")).damage]
    assert found == (["7 to 7: 1 missing"] if missing else [])


def test_nothing_half_is_left(path, tmp_path, monkeypatch):
    def full(*_):
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(recover_module, "_insert", full)
    with pytest.raises(JournalError, match="full"):
        recover(path, str(tmp_path / "new"))
    assert list(tmp_path.iterdir()) == [pathlib.Path(path)]


def test_the_search_of_pages_skips_known_rows_and_indexes(path, tmp_path, monkeypatch):
    """It would take several times as long as everything else."""
    decoded, read = [], pages._record
    monkeypatch.setattr(pages, "_record", lambda *arguments: decoded.append(1) or read(*arguments))
    spoil(path, page_of(path, '"100 '))
    assert recover(path, str(tmp_path / "new")).damage
    assert 0 < len(decoded) < COUNT // 2


def test_a_torn_journal(path, tmp_path):
    os.truncate(path, os.path.getsize(path) * 2 // 3)
    new = str(tmp_path / "new")
    recover(path, new)
    assert 50 < len(numbers(new)) < COUNT


def test_a_file_that_is_not_a_journal_or_missing_is_refused(path, tmp_path):
    new = str(tmp_path / "new")
    spoil(path, 0, os.path.getsize(path) // PAGE)
    with pytest.raises(JournalError, match="no part of this journal is readable"):
        recover(path, new)
    assert not os.path.exists(new)
    with pytest.raises(JournalError, match="No such file"):
        recover(str(tmp_path / "none"), new)
    with pytest.raises(JournalError, match="the file exists"):
        recover(path, path)
