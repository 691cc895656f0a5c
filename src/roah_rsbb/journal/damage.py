"""Finds damage in a journal: rows that changed after they were written, and missing rows.

Each row has a checksum (`schema.row_crc`). Entries and link samples are numbered without gaps, so missing ones are also
found. SQLite itself only detects damage to the structure of its pages.
"""

import itertools
import sqlite3
import time
from typing import Iterable, Iterator, List, NamedTuple, Optional

from roah_rsbb.journal import schema
from roah_rsbb.journal.checksums import HIGHEST, NUMBERS, Verified, first_and_last, verified_parts, verified_rows

NAMES = {
    "sessions": "starts of the core", "runs": "records of runs", "members": "robots of runs", "entries": "entries",
    "links": "link samples", "states": "saved states",
}
# Maximum number of damaged rows that are named.
_SHOWN = 5


class Damage(NamedTuple):
    """Rows of a table that are damaged or missing."""

    table: str
    what: str  # which rows
    from_utc: Optional[float]  # of the last good row before; None: no such row, or the rows have no order
    to_utc: Optional[float]  # of the first good row after


def find_damage(connection: sqlite3.Connection, path: str = "", processes: int = 1) -> List[Damage]:
    """Return all damage in a journal of the present version. `processes`: how many verify rows at the same time; then
    nothing may change the connection's file at `path`. Raises sqlite3.Error and ProcessEnded."""
    found: List[Damage] = []
    if processes > 1:
        with verified_parts(connection, path, tuple(NUMBERS), processes) as parts:
            read = {table: [rows for _, rows in of] for table, of in itertools.groupby(parts, lambda part: part[0])}
    for table in NUMBERS:
        rows = read.get(table, ()) if processes > 1 else verified_rows(connection, table, 1, HIGHEST)
        found += _holes(connection, table, rows)
    for table in ("sessions", "runs", "members", "states"):
        found += damaged_rows(connection, table)
    return found


def missing_rows(connection: sqlite3.Connection) -> List[Damage]:
    """Return what is missing in a journal whose rows are all good. Raises sqlite3.Error."""
    return [hole for table in NUMBERS for hole in _holes(connection, table, _unverified_rows(connection, table))]


def damaged_rows(connection: sqlite3.Connection, table: str, where: str = "true", *values: object) -> List[Damage]:
    """Return the damaged rows of a table whose rows have no numbers. Raises sqlite3.Error."""
    key = "id" if table == "sessions" else schema.CHECKED[table][0]
    statement = f"SELECT {key} FROM {table} WHERE {where} AND crc IS NOT {schema.crc_of(table)}"
    rows = connection.execute(statement, values).fetchall()
    if not rows:
        return []
    names = ", ".join(str(row[0]) for row in rows[:_SHOWN]) + (", …" if len(rows) > _SHOWN else "")
    return [Damage(table, f"{len(rows)} damaged: {names}", None, None)]


def damage_in_run(connection: sqlite3.Connection, identity: str) -> List[Damage]:
    """Return the damage in the period of a run, also to rows of others: the run of a damaged row is not known. Raises
    sqlite3.Error."""
    found = damaged_rows(connection, "members", "identity = ?", identity)
    for table, rows in (
        ("entries", "SELECT min(id), max(id) FROM entries WHERE identity = ?"),
        ("links", "SELECT min(rowid), max(rowid) FROM links WHERE port IN (SELECT port FROM members WHERE"
                  " identity = ?)"),
    ):
        first, last = connection.execute(rows, (identity,)).fetchone()
        if first is not None:
            found += _holes(connection, table, verified_rows(connection, table, first, last), first, last)
    return found


def _holes(
    connection: sqlite3.Connection, table: str, verified: Iterable[Verified], first: int = 1,
    end: Optional[int] = None,
) -> Iterator[Damage]:
    """Return the damaged and missing rows of a table whose rows are numbered. `verified`: the rows from `first` to
    `end`; without it, all rows that were ever written."""
    last, bad = first - 1, 0
    for rows in verified:
        if not rows.numbers:
            continue
        numbers, damaged = rows.numbers, set(rows.damaged)
        if not bad and not damaged and numbers[0] == last + 1 and numbers[-1] == last + len(numbers):
            last = numbers[-1]
            continue
        for number in numbers:
            if number in damaged:
                bad += 1
                continue
            if number != last + 1:
                times = _utc(connection, table, last, first), _utc(connection, table, number, first)
                yield _hole(table, last + 1, number - 1, bad, *times)
            last, bad = number, 0
    end = _last_number(connection, table) if end is None else end
    if end > last or bad:
        yield _hole(table, last + 1, max(end, last + bad), bad, _utc(connection, table, last, first), None)


def _unverified_rows(connection: sqlite3.Connection, table: str) -> Iterator[Verified]:
    """Return the numbers of rows that are known to be good."""
    key = NUMBERS[table]
    low, high = first_and_last(connection, table)
    if low is None:
        return
    (count,) = connection.execute(f"SELECT count(*) FROM {table}").fetchone()  # SQLite reads an index, which is small
    if low > 0 and count == high - low + 1:
        yield Verified(range(low, high + 1), [])
        return
    rows = connection.execute(f"SELECT {key} FROM {table} WHERE {key} > 0 ORDER BY {key}")
    yield Verified([number for (number,) in rows], [])


def _utc(connection: sqlite3.Connection, table: str, number: int, first: int) -> Optional[float]:
    """Return the time of a good row; None if it is before the first one."""
    if number < first:
        return None
    return connection.execute(f"SELECT utc FROM {table} WHERE {NUMBERS[table]} = ?", (number,)).fetchone()[0]


def _last_number(connection: sqlite3.Connection, table: str) -> int:
    """Return the number of the last row that was ever written, if SQLite keeps it."""
    row = connection.execute("SELECT seq FROM sqlite_sequence WHERE name = ?", (table,)).fetchone()
    return row[0] if row is not None and isinstance(row[0], int) else 0


def _hole(
    table: str, first: int, last: int, bad: int, from_utc: Optional[float], to_utc: Optional[float]
) -> Damage:
    missing = last - first + 1 - bad
    states = [text for count, text in ((bad, f"{bad} damaged"), (missing, f"{missing} missing")) if count > 0]
    return Damage(table, f"{first} to {last}: {' and '.join(states)}", from_utc, to_utc)


def text_of(damage: Damage) -> str:
    """Describe what is damaged, and the period."""
    if damage.table not in ("entries", "links"):
        return f"{NAMES[damage.table]}: {damage.what}"
    begin = "the beginning" if damage.from_utc is None else utc_text(damage.from_utc)
    end = "the end" if damage.to_utc is None else utc_text(damage.to_utc)
    return f"{NAMES[damage.table]} {damage.what}, from {begin} to {end}"


def utc_text(utc: float) -> str:
    """Return a time of day for a line of text."""
    return time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(utc))


def last_moment(connection: sqlite3.Connection) -> str:
    """Return the time of the newest entry that SQLite can read."""
    row = connection.execute("SELECT utc FROM entries ORDER BY id DESC LIMIT 1").fetchone()
    return utc_text(row[0]) if row is not None and isinstance(row[0], float) else "the beginning"
