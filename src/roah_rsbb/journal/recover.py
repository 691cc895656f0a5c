"""Copies the readable part of a damaged journal to a new one. The damaged file is not changed.

Rows that SQLite can read come first, because SQLite knows the present version of each row. Then all pages are searched
for rows that SQLite no longer finds. If the tables have the present version, rows need a correct checksum.
"""

import contextlib
import os
import sqlite3
import tempfile
from typing import Dict, Iterator, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import pages, schema
from roah_rsbb.journal.damage import Damage, find_damage
from roah_rsbb.journal.reader import JournalError

Row = Tuple[object, ...]
# By table, then by key: the row's number, or the first column if the table has no numbers.
Found = Dict[str, Dict[object, Row]]

COLUMNS = {
    "meta": ("key", "value"),
    "sessions": ("id", *schema.CHECKED["sessions"]),
    "runs": schema.CHECKED["runs"],
    "members": schema.CHECKED["members"],
    "entries": ("id", *schema.CHECKED["entries"]),
    "links": ("rowid", *schema.CHECKED["links"]),
    "states": schema.CHECKED["states"],
}
_REALS = {"utc", "mono", "scheduled", "opened_utc", "closed_utc"}
_WHOLES = {"id", "rowid", "pid", "round", "run", "port", "session"}
_MAY_BE_NULL = {("runs", "closed_utc"), ("runs", "outcome"), ("members", "log_file"), ("entries", "port")}


class Recovered(NamedTuple):
    """The contents of the new journal."""

    rows: Dict[str, int]  # their number by table
    damage: List[Damage]  # in the new journal


def recover(path: str, new: str) -> Recovered:
    """Copy the readable part of the journal at `path` to a new one. Raises JournalError."""
    if os.path.exists(new):
        raise JournalError(f"{new}: the file exists: name another one")
    try:
        image = pages.read_image(path)
        found = _read(image)
        if not any(found[table] for table in schema.CHECKED):
            raise JournalError(
                f"{path}: no part of this journal is readable. Look for another copy, and for the run logs (.bag)")
        return _write(found, _last_number(image), new)
    except OSError as error:
        raise JournalError(f"{error.filename}: {error.strerror}: name a journal, and a new file for it") from None
    except sqlite3.Error as error:
        with contextlib.suppress(FileNotFoundError):
            os.remove(new)
        raise JournalError(f"{new}: cannot be written ({error}): name another place, or free space there") from None


def _read(image: bytes) -> Found:
    found: Found = {table: {} for table in COLUMNS}
    for table, row in _rows_of_sqlite(image):
        found[table].setdefault(row[0], row)
    by_key: Dict[Tuple[str, object], List[Row]] = {}
    for table, row in _rows_of_pages(image):
        if row[0] not in found[table]:
            by_key.setdefault((table, row[0]), []).append(row)
    for (table, key), rows in by_key.items():
        row = _newest(table, rows)
        if row is not None:
            found[table][key] = row
    return found


def _newest(table: str, rows: List[Row]) -> Optional[Row]:
    """Return the latest of several versions of a row; None if unknown."""
    if table == "runs":
        return max(rows, key=lambda row: (row[-2] or 0.0, len(row[-1] or "")))
    if table == "states" and len(set(rows)) > 1:
        return None  # a core must not resume from an old state
    return rows[-1]


# -- through SQLite ---------------------------------------------------------------------------------


def _rows_of_sqlite(image: bytes) -> Iterator[Tuple[str, Row]]:
    """Return all rows up to the first unreadable one, from both ends of each table."""
    with tempfile.TemporaryDirectory(prefix="roah_rsbb_journal_") as directory:
        copy = os.path.join(directory, "journal.sqlite3")
        with open(copy, "wb") as file:
            file.write(image)
        with contextlib.closing(sqlite3.connect(copy)) as connection:
            connection.text_factory = bytes
            schema.add_functions(connection)
            for table, columns in COLUMNS.items():
                for order in ("ASC", "DESC"):
                    yield from _rows_in_order(connection, table, columns, order)


def _rows_in_order(
    connection: sqlite3.Connection, table: str, columns: Tuple[str, ...], order: str
) -> Iterator[Tuple[str, Row]]:
    with contextlib.suppress(sqlite3.DatabaseError):
        has_crc = any(row[1] == b"crc" for row in connection.execute(f"PRAGMA table_info({table})"))
        names = ", ".join((*columns, "crc") if has_crc else columns)
        for values in connection.execute(f"SELECT {names} FROM {table} ORDER BY {columns[0]} {order}"):
            row = _checked(table, values)
            if row is not None:
                yield table, row


def _checked(table: str, values: Row) -> Optional[Row]:
    """Make a row of the table from its values, with or without checksum; None if it is invalid."""
    columns = COLUMNS[table]
    row = tuple(_value(table, name, value) for name, value in zip(columns, values))
    if _BAD in row or len(values) not in (len(columns), len(columns) + (table != "meta")):
        return None
    has_crc = len(values) > len(columns)
    return None if has_crc and schema.row_crc(*row[-len(schema.CHECKED[table]):]) != values[-1] else row


_BAD = object()


def _value(table: str, name: str, value: object) -> object:
    """Convert a value to the type of the column; `_BAD` if it does not fit."""
    if isinstance(value, bytes):
        try:
            value = value.decode("utf-8")
        except UnicodeDecodeError:
            return _BAD
    if value is None:
        return None if (table, name) in _MAY_BE_NULL else _BAD
    if name in _REALS:
        return float(value) if isinstance(value, (int, float)) and abs(value) < 1e12 else _BAD
    if name in _WHOLES:
        return value if isinstance(value, int) else _BAD
    return value if isinstance(value, str) else _BAD


# -- from the pages ---------------------------------------------------------------------------------


def _rows_of_pages(image: bytes) -> Iterator[Tuple[str, Row]]:
    """Return all rows of the journal's tables in all pages."""
    for record in pages.page_records(image):
        for table in COLUMNS:
            row = _row_of(table, record)
            if row is not None:
                yield table, row
                break


def _row_of(table: str, record: pages.PageRecord) -> Optional[Row]:
    has_rowid = COLUMNS[table][0] in ("id", "port", "rowid")
    if has_rowid is (record.rowid is None):
        return None
    values = record.values
    if table == "links":
        values = (record.rowid, *values)
    elif has_rowid:
        if not values or values[0] is not None:
            return None
        values = (record.rowid, *values[1:])
    is_meta = values[:1] == ("competition",)
    if table in ("meta", "states") and (table == "meta") is not is_meta:
        return None
    return _checked(table, values)


def _last_number(image: bytes) -> int:
    """Return the number of the latest entry that was ever written, if it is readable."""
    numbers = [
        record.values[1] for record in pages.page_records(image)
        if record.rowid is not None and record.values[:1] == ("entries",) and len(record.values) == 2
    ]
    return max((n for n in numbers if isinstance(n, int)), default=0)


# -- writing ----------------------------------------------------------------------------------------


def _write(found: Found, last_number: int, new: str) -> Recovered:
    with contextlib.closing(sqlite3.connect(new, isolation_level=None)) as out:
        schema.add_functions(out)
        schema.create(out)
        out.execute("BEGIN")
        for table, rows in found.items():
            _insert(out, table, sorted(rows.values(), key=lambda row: row[0]))
        if last_number:
            out.execute("UPDATE sqlite_sequence SET seq = max(seq, ?) WHERE name = 'entries'", (last_number,))
        out.execute("COMMIT")
        damage = find_damage(out)
    return Recovered({table: len(rows) for table, rows in found.items()}, damage)


def _insert(out: sqlite3.Connection, table: str, rows: List[Row]) -> None:
    columns = COLUMNS[table]
    marks = ", ".join("?" for _ in columns)
    out.executemany(f"INSERT INTO {table} ({', '.join(columns)}) VALUES ({marks})", rows)
    if table in schema.CHECKED:
        out.execute(f"UPDATE {table} SET crc = {schema.crc_of(table)}")
