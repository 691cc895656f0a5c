"""What can be had of a damaged journal."""

import os
import sqlite3

import pytest

from helpers.journals import UTC0, Writer
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal import recover as recover_module
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.recover import recover

RECORD = RunRecord("HNF-6667-1.000", "fbm", "HNF", "Alpha", 1, 2, UTC0 - 600.0, UTC0)
COUNT = 400
PAGE = 4096


@pytest.fixture
def path(tmp_path):
    """A journal of many pages that was closed."""
    writer = Writer(tmp_path / "log")
    writer.run(RECORD)
    for i in range(COUNT):
        writer.entry("notice", {"text": f"{i} " * 20}, RECORD.identity)
    writer.close()
    return writer.path


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
    counts = recover(path, new)
    assert (counts["entries"], counts["runs"], counts["members"]) == (COUNT, 1, 1)
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


def test_nothing_half_is_left(path, tmp_path, monkeypatch):
    def full(*_):
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(recover_module, "_copy_rows", full)
    with pytest.raises(JournalError, match="full"):
        recover(path, str(tmp_path / "new"))
    assert not (tmp_path / "new").exists()


def test_a_torn_journal(path, tmp_path):
    os.truncate(path, os.path.getsize(path) * 2 // 3)
    new = str(tmp_path / "new")
    recover(path, new)
    assert 50 < len(numbers(new)) < COUNT


def test_what_is_no_journal_or_gone(path, tmp_path):
    new = str(tmp_path / "new")
    spoil(path, 0)
    with pytest.raises(JournalError, match="nothing can be had"):
        recover(path, new)
    assert not os.path.exists(new)
    with pytest.raises(JournalError, match="No such file"):
        recover(str(tmp_path / "none"), new)
    with pytest.raises(JournalError, match="already"):
        recover(path, path)
