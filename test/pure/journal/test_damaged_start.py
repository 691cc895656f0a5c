"""A core can record even if a power cut or another program damaged or replaced the journal."""

import json
import sqlite3

import pytest

from roah_rsbb.journal.batch import Batch, Member, NewEntry
from roah_rsbb.journal.file import FILE_NAME, CoreSession, Resume
from roah_rsbb.journal.previous_session import NOTHING
from roah_rsbb.journal.schema import APPLICATION_ID, VERSION
from roah_rsbb.journal.store import Journal

COMPETITION = json.dumps([["Home", "HNF", "Alpha", 1, 1, 0.0]])
ENTRY = NewEntry(1e9, 5.0, "Home", "HNF-6667-1", 6667, "/referee", "notice", "")


@pytest.fixture
def start(tmp_path):
    """Start a core's journal in the folder; return it, its reports, and the files that were set aside."""
    opened = []

    def start():
        troubles = []
        journal = Journal(
            str(tmp_path), CoreSession(1e9, 1.0, "boot", 1, "uuid", ""), COMPETITION, Resume.ALWAYS, troubles.append
        )
        opened.append(journal)
        journal.write(Batch(states={"box": "{}"}))
        return journal, [*troubles, *journal.warnings], list(tmp_path.glob("*_aside_*.sqlite3"))

    yield start
    for journal in opened:
        journal.close()


@pytest.mark.parametrize("makes", [lambda path: path.write_bytes(b""), lambda path: sqlite3.connect(str(path)).close()])
def test_a_file_in_which_is_nothing_is_begun(start, tmp_path, makes):
    """The file as it is if the power fails while it is created."""
    makes(tmp_path / FILE_NAME)
    journal, reported, aside = start()
    assert (reported, aside) == ([], [])
    assert journal.previous == NOTHING
    journal.close()
    journal, reported, _ = start()
    assert reported == []
    assert journal.previous.states == {"box": "{}"}


@pytest.mark.parametrize("statement", [
    "DROP TABLE meta", "DROP TABLE sessions", "DROP TABLE entries", "DROP TABLE states",
    "ALTER TABLE states ADD COLUMN more TEXT", "CREATE VIEW more AS SELECT * FROM meta",
    "CREATE TRIGGER no BEFORE INSERT ON states BEGIN SELECT RAISE(ABORT, 'no'); END",
    "UPDATE meta SET value = '[1]'", "UPDATE meta SET value = '{'", f"UPDATE meta SET value = '{'[' * 5000}'",
])
def test_a_file_with_other_tables_is_set_aside(start, tmp_path, statement):
    start()[0].close()
    with sqlite3.connect(str(tmp_path / FILE_NAME)) as connection:
        connection.execute(statement)
    connection.close()
    journal, reported, aside = start()
    assert len(aside) == 1
    assert len(reported) == 1 and "is not continued" in reported[0]
    assert journal.previous == NOTHING


@pytest.mark.parametrize("statement", [
    "UPDATE sessions SET mono = 'x'", "UPDATE sessions SET utc = x'ff'", "UPDATE sessions SET mono = -1e300",
    "INSERT INTO links VALUES (1, 'x', 'y', '{}', 0)", "UPDATE states SET name = x'ff'",
    "UPDATE states SET state = cast(x'ff' AS TEXT)",
])
def test_invalid_values_do_not_prevent_resuming(start, tmp_path, statement):
    start()[0].close()
    with sqlite3.connect(str(tmp_path / FILE_NAME)) as connection:
        connection.execute(statement)
    connection.close()
    journal, reported, aside = start()
    assert aside == []
    warning, = reported
    assert "is damaged" in warning
    last = journal.previous.last
    assert last is None or abs(last.mono) < 1e12
    assert all(isinstance(text, str) for pair in journal.previous.states.items() for text in pair)


def test_a_file_that_only_says_that_it_is_a_journal(start, tmp_path):
    with sqlite3.connect(str(tmp_path / FILE_NAME)) as connection:
        connection.execute("CREATE TABLE meta (key, value)")
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {VERSION}")
    connection.close()
    _, reported, aside = start()
    assert len(aside) == 1 and "its tables are not a journal's" in reported[0]


def test_a_core_resumes_behind_a_damaged_write_ahead_log(start, tmp_path):
    """SQLite would silently drop everything behind the damage."""
    journal, _, _ = start()
    journal.write(Batch(members=[Member(6667, "HNF-6667-1", "Alpha", "r1")]))
    for number in range(40):
        journal.write(Batch(states={"box": f'{{"n":{number}}}'}, entries=[ENTRY._replace(value=str(number))]))
    copies = {suffix: (tmp_path / f"{FILE_NAME}{suffix}").read_bytes() for suffix in ("", "-wal")}
    journal.close()
    log = bytearray(copies["-wal"])
    log[len(log) // 2] ^= 1
    (tmp_path / FILE_NAME).write_bytes(copies[""])
    (tmp_path / f"{FILE_NAME}-wal").write_bytes(log)
    again, reported, aside = start()
    assert again.previous.states == {"box": '{"n":39}'}
    assert len(aside) == 1
    assert "write-ahead log" in reported[0] and str(aside[0]) in reported[0]
    assert len(again.entries_of(6667)) >= 35
