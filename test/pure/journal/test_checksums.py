"""Verifying many rows at once finds the same rows as the checksum of each row."""

import contextlib
import shutil
import sqlite3

import pytest

from helpers.journals import Writer
from roah_rsbb.core.link.record import LinkSample
from roah_rsbb.journal import checksums, schema
from roah_rsbb.journal.checksums import HIGHEST, NUMBERS, first_and_last, verified_parts, verified_rows

COUNT = 200
CHANGED = 70
# What damage may make of a value: SQL.
VALUES = ("CAST({} AS BLOB)", "CAST({} AS BLOB) || x'ff'", "CAST(x'c3' AS TEXT)", "'other'", "{} || ' '", "''", "x''",
          "7", "-1", "6667.5", "1e300", "NULL")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    writer = Writer(tmp_path_factory.mktemp("written"))
    for i in range(COUNT):
        writer.entry("notice", {"text": f"number {i} ä"}, f"run {i // 50}", port=None if i % 3 else 6667, who="Anna")
        writer.link(LinkSample(0.1 * i), port=6667 + i % 2)
    writer.close()
    return writer.path


@pytest.fixture
def connection(written):
    with contextlib.closing(sqlite3.connect(written, isolation_level=None)) as connection:
        schema.add_functions(connection)
        connection.execute("BEGIN")
        yield connection
        connection.execute("ROLLBACK")


def verified(connection, table):
    numbers, damaged = [], []
    for rows in verified_rows(connection, table, 1, HIGHEST):
        numbers += rows.numbers
        damaged += rows.damaged
    assert numbers == list(range(1, COUNT + 1))
    return damaged


@pytest.mark.parametrize("processes", [1, 2])
def test_parts_of_tables(written, processes, tmp_path, monkeypatch):
    monkeypatch.setattr(checksums, "_PART", 30)
    path = shutil.copy(written, tmp_path)
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA journal_mode = DELETE")
        connection.execute("UPDATE entries SET kind = 'other' WHERE id IN (3, 31, 200)")
        connection.execute("DELETE FROM entries WHERE id BETWEEN 90 AND 125")
        connection.execute("UPDATE links SET port = 1 WHERE rowid = 60")
        connection.commit()
        with verified_parts(connection, path, tuple(NUMBERS), processes) as parts:
            found = list(parts)
    for table, present, damaged in (("entries", [*range(1, 90), *range(126, COUNT + 1)], [3, 31, 200]),
                                    ("links", list(range(1, COUNT + 1)), [60])):
        assert [number for of, rows in found if of == table for number in rows.numbers] == present
        assert [number for of, rows in found if of == table for number in rows.damaged] == damaged


@pytest.mark.parametrize("table", NUMBERS)
def test_the_numbers_of_a_table_are_known_without_reading_it(connection, table):
    steps = []
    connection.set_progress_handler(lambda: steps.append(1), 1)
    assert first_and_last(connection, table) == (1, COUNT)
    connection.set_progress_handler(None, 0)
    assert len(steps) < COUNT, "SQLite takes several steps for each row that it reads"
    connection.execute(f"DELETE FROM {table}")
    assert first_and_last(connection, table) == (None, None)


def row_by_row(connection, table):
    statement = f"SELECT {NUMBERS[table]} FROM {table} WHERE crc IS NOT {schema.crc_of(table)}"
    return [number for (number,) in connection.execute(statement)]


@pytest.mark.parametrize("table", NUMBERS)
def test_each_way_to_change_a_value(connection, table):
    assert verified(connection, table) == row_by_row(connection, table) == []
    found = 0
    for column in (*schema.CHECKED[table], "crc"):
        for value in VALUES:
            connection.execute("SAVEPOINT one")
            with contextlib.suppress(sqlite3.IntegrityError):  # NULL, which only damage can bring into most columns
                change = f"{column} = {value.format(column)}"
                connection.execute(f"UPDATE {table} SET {change} WHERE {NUMBERS[table]} = {CHANGED}")
                damaged = verified(connection, table)
                assert damaged == row_by_row(connection, table), change
                found += damaged == [CHANGED]
            connection.execute("ROLLBACK TO one")
    assert found > 8 * len(schema.CHECKED[table])


def test_several_damaged_rows_in_a_batch_and_the_next_ones(connection):
    connection.execute("UPDATE entries SET kind = 'other' WHERE id IN (3, 5, 64, 65, 200)")
    connection.execute("UPDATE entries SET value = CAST(x'c3' AS TEXT) WHERE id IN (66, 130)")
    assert verified(connection, "entries") == [3, 5, 64, 65, 66, 130, 200]
