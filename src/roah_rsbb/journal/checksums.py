"""Verifies the checksums of many rows of the numbered tables, several times as fast as `schema.row_crc` row by row.

SQLite counts the rows that do not pass, so that no row becomes a Python object. A checksum begins with numbers that
neighbouring rows share, such as the time of the event, and continues with short texts that recur. The bytes of both are
kept, so that only the last column is new in most rows. If a row does not pass, its neighbours and it are verified again
by `row_crc`, which decides.
"""

import contextlib
import itertools
import pathlib
import sqlite3
import zlib
from functools import partial
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal import schema
from roah_rsbb.journal.processes import shared_out

# The columns that number rows without gaps.
NUMBERS = {"entries": "id", "links": "rowid"}
HIGHEST = (1 << 63) - 1
# The first checked columns, which neighbouring rows share.
_BEGINNING = {"entries": ("session", "utc", "mono"), "links": ("port",)}
# Rows that SQLite verifies at once.
_AT_ONCE = 1000
# Rows that are verified one by one, until the next ones are taken.
_BATCH = 64
# Values whose bytes are kept.
_KEPT = 5000
# Rows that a process verifies at once, and the maximum number of these parts, whatever a damaged number says.
_PART = 20_000
_MOST_PARTS = 1000
_Values = Tuple[object, ...]


class Verified(NamedTuple):
    """Some neighbouring rows of a table."""

    numbers: Sequence[int]  # of all of them, in order
    damaged: List[int]  # of the damaged ones, in order


def verified_rows(connection: sqlite3.Connection, table: str, first: int, last: int) -> Iterator[Verified]:
    """Verify the rows of a numbered table with these numbers, in order. Raises sqlite3.Error after the last row that
    can be read."""
    checksums = _Checksums(connection, table)
    while True:
        low = checksums.next_number(first, last)
        if low is None:
            break
        high = min(last, low + _AT_ONCE - 1)
        numbers = checksums.if_good(low, high)
        if numbers:
            yield Verified(numbers, [])
        else:
            yield from _one_by_one(connection, table, low, high)
        if high == last:
            break
        first = high + 1


class _Checksums:
    """Lets SQLite verify rows of a table."""

    def __init__(self, connection: sqlite3.Connection, table: str) -> None:
        self._connection = connection
        beginning, rest = _BEGINNING[table], schema.CHECKED[table][len(_BEGINNING[table]):]
        key = NUMBERS[table]
        connection.create_function(f"{table}_crc", len(beginning) + len(rest), _CRC[table]())
        crc = f"{table}_crc({', '.join((*beginning, *map(schema.bytes_of, rest)))})"
        of = f"FROM {table} WHERE {key} BETWEEN ? AND ?"
        self._next = f"SELECT min({key}) {of}"
        self._numbers = f"SELECT {key} {of} ORDER BY {key}"
        self._verify = f"SELECT count(*), max({key}), sum(crc IS NOT {crc}) {of}"

    def next_number(self, first: int, last: int) -> Optional[int]:
        """Return the first of these numbers that a row has; None: no row has one."""
        return self._connection.execute(self._next, (first, last)).fetchone()[0]

    def if_good(self, low: int, high: int) -> Sequence[int]:
        """Return the numbers of the rows from `low`, which exists, to `high` if all of them are good; else nothing."""
        try:
            count, found, bad = self._connection.execute(self._verify, (low, high)).fetchone()
            if bad:
                return ()
            if count == found - low + 1:
                return range(low, found + 1)
            return [number for (number,) in self._connection.execute(self._numbers, (low, high))]
        except sqlite3.Error:  # a row cannot be read, or the last column is not a text
            return ()


@contextlib.contextmanager
def verified_parts(
    connection: sqlite3.Connection, path: str, tables: Sequence[str], processes: int
) -> Iterator[Iterator[Tuple[str, Verified]]]:
    """Verify all rows of numbered tables, in several processes that work at once. The results are in order.

    `path`: the file of the connection, which nothing may change. Raises sqlite3.Error.
    """
    parts = [part for table in tables for part in _parts(connection, table)]
    with shared_out(partial(_verifier, path), parts, processes) as found:
        yield zip((table for table, _, _ in parts), found)


def first_and_last(connection: sqlite3.Connection, table: str) -> Tuple[Optional[int], Optional[int]]:
    """Return the first and the last number of a table; None: it is empty. Raises sqlite3.Error."""
    key = NUMBERS[table]
    # SQLite reads the whole table for a statement with both, and a single row for each of them alone.
    return connection.execute(f"SELECT (SELECT min({key}) FROM {table}), (SELECT max({key}) FROM {table})").fetchone()


def _parts(connection: sqlite3.Connection, table: str) -> Iterator[Tuple[str, int, int]]:
    """Return the first and last numbers of parts of a table."""
    low, high = first_and_last(connection, table)
    if low is not None:
        step = max(_PART, (high - low) // _MOST_PARTS)
        for first in range(low, high + 1, step):
            yield table, first, min(high, first + step - 1)


@contextlib.contextmanager
def _verifier(path: str) -> Iterator[Callable[[Tuple[str, int, int]], Verified]]:
    with contextlib.closing(sqlite3.connect(immutable(path), uri=True)) as connection:
        schema.add_functions(connection)
        yield lambda part: _verified_part(connection, *part)


def _verified_part(connection: sqlite3.Connection, table: str, first: int, last: int) -> Verified:
    numbers: List[int] = []
    damaged: List[int] = []
    for rows in verified_rows(connection, table, first, last):
        numbers += rows.numbers
        damaged += rows.damaged
    has_holes = not numbers or len(numbers) != numbers[-1] - numbers[0] + 1
    return Verified(numbers if has_holes else range(numbers[0], numbers[-1] + 1), damaged)


def immutable(path: str) -> str:
    """Return the address under which SQLite reads a file without locks."""
    return f"{pathlib.Path(path).absolute().as_uri()}?immutable=1"


def _one_by_one(connection: sqlite3.Connection, table: str, low: int, high: int) -> Iterator[Verified]:
    """Verify rows by `row_crc`. Raises sqlite3.Error after the last row that can be read."""
    for batch in _rows(connection, table, low, high):
        yield Verified([number for number, _ in batch], [number for number, is_damaged in batch if is_damaged])


def _rows(connection: sqlite3.Connection, table: str, low: int, high: int) -> Iterator[List[Tuple[int, bool]]]:
    """Return the numbers of rows, and whether they are damaged, in batches. Raises sqlite3.Error after the last row
    that can be read."""
    key = NUMBERS[table]
    rows = connection.execute(
        f"SELECT {key}, crc IS NOT {schema.crc_of(table)} FROM {table} WHERE {key} BETWEEN ? AND ? ORDER BY {key}",
        (low, high))
    try:
        problem = None
        while problem is None:
            batch: List[Tuple[int, bool]] = []
            try:
                for row in itertools.islice(rows, _BATCH):
                    batch.append(row)  # noqa: PERF402: keep the rows before an error
            except sqlite3.Error as error:
                problem = error
            if not batch:
                break
            yield batch
        if problem is not None:
            raise problem
    finally:
        # Python 3.8 shares statements between cursors. One that is collected as garbage would restart another's rows.
        rows.close()


class _Beginnings(Dict[_Values, int]):
    """The checksum of the first columns, by their values."""

    def __missing__(self, values: _Values) -> int:
        if len(self) >= _KEPT:
            self.clear()
        crc = self[values] = zlib.crc32(schema.row_bytes(*values) + b"\0")
        return crc


class _Middles(Dict[_Values, bytes]):
    """The bytes of the columns between the first ones and the text of the last one, by their values."""

    def __missing__(self, values: _Values) -> bytes:
        if len(self) >= _KEPT:
            self.clear()
        found = self[values] = schema.row_bytes(*values) + b"\0s"
        return found


def _entries_crc() -> Callable[..., int]:
    crc32, beginnings, middles = zlib.crc32, _Beginnings(), _Middles()

    def crc(
        session: int, utc: float, mono: float, zone: bytes, identity: bytes, port: int, who: bytes, kind: bytes,
        value: bytes,
    ) -> int:
        return crc32(middles[zone, identity, port, who, kind] + value, beginnings[session, utc, mono])

    return crc


def _links_crc() -> Callable[..., int]:
    crc32, beginnings, middles = zlib.crc32, _Beginnings(), _Middles()

    def crc(port: int, utc: float, mono: float, sample: bytes) -> int:
        return crc32(middles[utc, mono] + sample, beginnings[port,])

    return crc


# Functions for SQL. They have a parameter for each column, because a tuple of all of them takes longer.
_CRC = {"entries": _entries_crc, "links": _links_crc}
