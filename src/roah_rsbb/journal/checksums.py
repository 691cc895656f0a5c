"""Verifies the checksums of many rows of the numbered tables, several times as fast as `schema.row_crc` row by row.

A checksum begins with numbers that neighbouring rows share, such as the time of the event, and continues with short
texts that recur. The bytes of both are kept, so that only the last column is new in most rows. A row that does not pass
is verified again by `row_crc`, which decides.
"""

import contextlib
import itertools
import pathlib
import sqlite3
import zlib
from functools import partial
from typing import Callable, Dict, Iterator, List, NamedTuple, Sequence, Tuple

from roah_rsbb.journal import schema
from roah_rsbb.journal.processes import shared_out

# The columns that number rows without gaps.
NUMBERS = {"entries": "id", "links": "rowid"}
HIGHEST = (1 << 63) - 1
# How many of the checked columns are the beginning, which neighbouring rows share.
_BEGINNING = {"entries": 3, "links": 1}
# Rows that are verified at once: few enough for the processor's cache.
_BATCH = 64
# Values whose bytes are kept.
_KEPT = 5000
# Rows that a process verifies at once, and the maximum number of these parts, whatever a damaged number says.
_PART = 20_000
_MOST_PARTS = 1000
_Row = Tuple[object, ...]


class Verified(NamedTuple):
    """Some neighbouring rows of a table."""

    numbers: Sequence[int]  # of all of them, in order
    damaged: List[int]  # of the damaged ones, in order


def verified_rows(connection: sqlite3.Connection, table: str, first: int, last: int) -> Iterator[Verified]:
    """Verify the rows of a numbered table with these numbers, in order. Raises sqlite3.Error after the last row that
    can be read."""
    beginnings, middles = _Beginnings(), _Middles()
    columns, split = ", ".join(schema.CHECKED[table]), _BEGINNING[table]
    is_end = False
    while not is_end:
        try:
            for batch in _rows(connection, table, f"{columns}, crc", first, last):
                numbers, *values, texts, sums = zip(*batch)
                starts = map(beginnings.__getitem__, zip(*values[:split]))
                starts = map(zlib.crc32, map(middles.__getitem__, zip(*values[split:])), starts)
                damaged = [] if _are_good(starts, texts, sums) else _damaged(connection, table, numbers)
                yield Verified(numbers, damaged)
                first = max(first, numbers[-1]) + 1
            is_end = True
        except sqlite3.Error:  # the row cannot be read, or a text in it is not UTF-8
            batch = next(_rows(connection, table, f"crc IS NOT {schema.crc_of(table)}", first, last), None)
            if batch is None:
                break
            yield Verified([number for number, _ in batch], [number for number, is_damaged in batch if is_damaged])
            first = max(first, batch[-1][0]) + 1


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


def _parts(connection: sqlite3.Connection, table: str) -> Iterator[Tuple[str, int, int]]:
    """Return the first and last numbers of parts of a table."""
    key = NUMBERS[table]
    low, high = connection.execute(f"SELECT min({key}), max({key}) FROM {table}").fetchone()
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


def _are_good(starts: Iterator[int], texts: Sequence[object], sums: Sequence[object]) -> bool:
    try:
        return tuple(map(zlib.crc32, map(str.encode, texts), starts)) == sums
    except TypeError:  # one is not a text
        return False


def _rows(connection: sqlite3.Connection, table: str, columns: str, first: int, last: int) -> Iterator[List[_Row]]:
    """Return rows in batches. Raises sqlite3.Error after the last row that can be read."""
    key = NUMBERS[table]
    rows = connection.execute(
        f"SELECT {key}, {columns} FROM {table} WHERE {key} BETWEEN ? AND ? ORDER BY {key}", (first, last))
    try:
        problem = None
        while problem is None:
            batch: List[_Row] = []
            texts, connection.text_factory = connection.text_factory, str
            try:
                for row in itertools.islice(rows, _BATCH):
                    batch.append(row)  # noqa: PERF402: keep the rows before an error
            except sqlite3.Error as error:
                problem = error
            finally:
                connection.text_factory = texts
            if not batch:
                break
            yield batch
        if problem is not None:
            raise problem
    finally:
        # Python 3.8 shares statements between cursors. One that is collected as garbage would restart another's rows.
        rows.close()


def _damaged(connection: sqlite3.Connection, table: str, numbers: Sequence[int]) -> List[int]:
    key = NUMBERS[table]
    statement = f"SELECT {key} FROM {table} WHERE {key} BETWEEN ? AND ? AND crc IS NOT {schema.crc_of(table)}"
    damaged = {number for (number,) in connection.execute(statement, (min(numbers), max(numbers)))}
    return [number for number in numbers if number in damaged]


class _Beginnings(Dict[_Row, int]):
    """The checksum of the first columns, by their values."""

    def __missing__(self, values: _Row) -> int:
        if len(self) >= _KEPT:
            self.clear()
        crc = self[values] = zlib.crc32(_bytes(values) + b"\0")
        return crc


class _Middles(Dict[_Row, bytes]):
    """The bytes of the columns between the first ones and the text of the last one, by their values."""

    def __missing__(self, values: _Row) -> bytes:
        if len(self) >= _KEPT:
            self.clear()
        found = self[values] = _bytes(values) + b"\0s"
        return found


def _bytes(values: _Row) -> bytes:
    """Return the bytes of some columns. A blob, which no good row has, gets a byte that no row has."""
    return b"\xff" if any(value.__class__ is bytes for value in values) else schema.row_bytes(*values)
