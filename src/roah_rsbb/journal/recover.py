"""Copies the readable part of a damaged journal to a new one. The damaged file is not changed.

Rows that SQLite can read come first, because SQLite knows the present version of each row. If it cannot read all rows,
the pages are searched for rows that SQLite no longer finds. If the tables have the present version, rows need a correct
checksum.
"""

import contextlib
import os
import pathlib
import sqlite3
import tempfile
from typing import Container, Dict, Iterator, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.journal import pages, schema
from roah_rsbb.journal.checksums import HIGHEST, NUMBERS, immutable, verified_parts, verified_rows
from roah_rsbb.journal.damage import Damage, missing_rows
from roah_rsbb.journal.reader import JournalError

Row = Tuple[object, ...]
# By table: the row's number, or the first column if the table has no numbers.
Keys = Dict[str, Set[object]]
_INDEXES = tuple(statement for statement in schema.SCHEMA if statement.startswith("CREATE INDEX"))
_NUMBERED = ("entries", "links", "members", "sessions")
# A search beyond an unreadable row ends here.
_LARGEST_STEP = 1 << 32
# Rows that are written at once.
_BATCH = 2000
# Pages that SQLite keeps while it compares indexes with their tables. With its usual 2 MiB, it reads them repeatedly.
_CACHE_KIB = 20_000

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


def recover(path: str, new: str, processes: int = 1) -> Recovered:
    """Copy the readable part of the journal at `path` to a new one. `processes`: how many verify rows at the same time.
    Raises JournalError and ProcessEnded."""
    if os.path.exists(new):
        raise JournalError(f"{new}: the file exists: name another one")
    draft = f"{new}.draft"
    try:
        recovered = _write(path, draft, processes)
        if not any(recovered.rows[table] for table in schema.CHECKED):
            raise JournalError(
                f"{path}: no part of this journal is readable. Look for another copy, and for the run logs (.bag)")
        os.rename(draft, new)
    except OSError as error:
        raise JournalError(f"{error.filename}: {error.strerror}: name a journal, and a new file for it") from None
    except sqlite3.Error as error:
        raise JournalError(f"{new}: cannot be written ({error}): name another place, or free space there") from None
    finally:
        _remove(draft)
    return recovered


def _remove(draft: str) -> None:
    for path in (draft, *(f"{draft}-{suffix}" for suffix in ("journal", "wal", "shm"))):
        with contextlib.suppress(OSError):
            os.remove(path)


def _write(path: str, draft: str, processes: int) -> Recovered:
    """Write the new journal to a draft."""
    is_whole_log = all(frame.is_good for frame in pages.read_frames(f"{path}-wal"))
    with contextlib.ExitStack() as stack:
        readable = _readable(path, stack)
        _remove(draft)
        out = stack.enter_context(contextlib.closing(sqlite3.connect(_uri(draft), uri=True, isolation_level=None)))
        return _recover(path, readable, is_whole_log, processes, out)


def _uri(path: str) -> str:
    return pathlib.Path(path).absolute().as_uri()


def _readable(path: str, stack: contextlib.ExitStack) -> str:
    """Return the path of a file for SQLite: the journal, or a temporary copy that SQLite accepts. Raises OSError."""
    if pages.is_closed(path):
        return path
    directory = stack.enter_context(tempfile.TemporaryDirectory(prefix="roah_rsbb_journal_"))
    copy = os.path.join(directory, "journal.sqlite3")
    with open(copy, "wb") as file:
        file.write(pages.read_image(path))
    return copy


def _recover(
    path: str, readable: str, is_whole_log: bool, processes: int, out: sqlite3.Connection
) -> Recovered:
    schema.create(out)
    out.execute("PRAGMA synchronous = OFF")  # a draft that is not complete is removed
    for statement in _INDEXES:
        out.execute(f"DROP INDEX {statement.split()[2]}")  # it is quicker to build them at the end
    with contextlib.closing(sqlite3.connect(immutable(readable), uri=True)) as damaged:
        is_complete = _take_from_sqlite(damaged, readable, processes, out)
    holes = missing_rows(out)
    if holes or not (is_complete and is_whole_log):
        _take_from_pages(pages.read_image(path), out)
        holes = missing_rows(out)
    _create_indexes(out)
    return Recovered(_counts(out), holes)


def _create_indexes(out: sqlite3.Connection) -> None:
    for statement in _INDEXES:
        out.execute(statement.replace("CREATE INDEX", "CREATE INDEX IF NOT EXISTS"))


def _counts(connection: sqlite3.Connection) -> Dict[str, int]:
    return {table: connection.execute(f"SELECT count(*) FROM main.{table}").fetchone()[0] for table in COLUMNS}


def _newest(table: str, rows: List[Row]) -> Optional[Row]:
    """Return the latest of several versions of a row; None if unknown."""
    if table == "runs":
        return max(rows, key=lambda row: (row[-2] or 0.0, len(row[-1] or "")))
    if table == "states" and len(set(rows)) > 1:
        return None  # a core must not resume from an old state
    return rows[-1]


# -- through SQLite ---------------------------------------------------------------------------------


def _take_from_sqlite(damaged: sqlite3.Connection, readable: str, processes: int, out: sqlite3.Connection) -> bool:
    """Take all rows that SQLite can read. Returns whether these are all rows, and all of them are good."""
    is_attached = _attach(damaged, readable, out)
    all_good = _copy_sound(damaged, readable, processes, out) if is_attached else None
    damaged.text_factory = bytes
    is_complete = all_good if all_good is not None else _is_sound(damaged)
    for table in COLUMNS:
        if table not in NUMBERS or not is_attached:
            is_complete &= _take_table(damaged, table, out)
        elif all_good is None:
            is_complete &= _copy_table(damaged, table, out)
    for (number,) in _last_number(damaged):
        _set_last_number(out, number)
    return is_complete


def _attach(damaged: sqlite3.Connection, readable: str, out: sqlite3.Connection) -> bool:
    """Attach the damaged journal to the new one if it has the present tables. Returns whether it has."""
    schema.add_functions(damaged)
    with contextlib.suppress(sqlite3.DatabaseError, UnicodeDecodeError):
        if schema.is_whole(damaged):
            out.execute("ATTACH ? AS damaged", (immutable(readable),))
            return True
    return False


def _copy_sound(
    damaged: sqlite3.Connection, readable: str, processes: int, out: sqlite3.Connection
) -> Optional[bool]:
    """Copy the numbered tables of a file whose pages are sound, while other processes verify the rows. Returns whether
    all rows are good; None: some pages or rows cannot be read, and nothing is copied."""
    damaged.execute(f"PRAGMA cache_size = -{_CACHE_KIB}")
    try:
        with verified_parts(damaged, readable, tuple(NUMBERS), processes) as parts:
            if schema.is_exact(damaged) and _is_sound(damaged, "integrity_check"):
                _copy_pages(damaged, out)
            elif _is_sound(damaged):
                _copy_numbered(out)
            else:
                return None
            bad = [(table, number) for table, rows in parts for number in rows.damaged]
    except sqlite3.OperationalError:
        raise  # the new journal cannot be written
    except sqlite3.DatabaseError:
        for table in NUMBERS:
            out.execute(f"DELETE FROM main.{table}")
        return None
    for table, number in bad:
        out.execute(f"DELETE FROM main.{table} WHERE {NUMBERS[table]} = ?", (number,))
    return not bad


def _copy_pages(damaged: sqlite3.Connection, out: sqlite3.Connection) -> None:
    """Copy a file whose tables and indexes are sound: this takes a third of the time that new rows and indexes take.
    The small tables are emptied, because their rows are taken one by one."""
    damaged.backup(out)
    out.execute("PRAGMA main.journal_mode = DELETE")  # the draft must be a single file
    for table in COLUMNS:
        if table not in NUMBERS:
            out.execute(f"DELETE FROM main.{table}")


def _copy_numbered(out: sqlite3.Connection) -> None:
    """Copy the rows of the numbered tables of the attached journal, and build the indexes."""
    for table in NUMBERS:
        columns = f"{', '.join(COLUMNS[table])}, crc"
        out.execute(f"INSERT INTO main.{table} ({columns}) SELECT {columns} FROM damaged.{table}")
    _create_indexes(out)


def _copy_table(damaged: sqlite3.Connection, table: str, out: sqlite3.Connection) -> bool:
    """Copy the good rows of a numbered table. Unreadable ones are skipped in growing steps. Returns whether all of them
    could be read and are good."""
    is_good = True
    last, step = 0, 0
    good: List[int] = []
    while step < _LARGEST_STEP:
        try:
            for rows in verified_rows(damaged, table, last + step + 1, HIGHEST):
                bad = set(rows.damaged)
                good += [number for number in rows.numbers if number not in bad] if bad else rows.numbers
                is_good = is_good and not bad
                if rows.numbers[-1] > last:
                    last, step = rows.numbers[-1], 0
                if len(good) >= _BATCH:
                    is_good &= _copy_rows(out, table, good)
                    good = []
            break
        except sqlite3.DatabaseError:
            is_good, step = False, max(1, 2 * step)
    return _copy_rows(out, table, good) and is_good


def _copy_rows(out: sqlite3.Connection, table: str, numbers: List[int]) -> bool:
    """Copy rows of the attached journal. Returns whether SQLite could read them."""
    columns, key = f"{', '.join(COLUMNS[table])}, crc", NUMBERS[table]
    statement = (f"INSERT OR IGNORE INTO main.{table} ({columns}) SELECT {columns} FROM damaged.{table}"
                 f" WHERE {key} BETWEEN ? AND ?")
    try:
        if numbers and numbers == list(range(numbers[0], numbers[-1] + 1)):
            out.execute(statement, (numbers[0], numbers[-1]))
        else:
            out.executemany(statement, [(number, number) for number in numbers])
    except sqlite3.OperationalError:
        raise  # the new journal cannot be written
    except sqlite3.DatabaseError:
        return False  # they are searched for in the pages
    return True


def _last_number(connection: sqlite3.Connection) -> List[Row]:
    with contextlib.suppress(sqlite3.DatabaseError):
        return connection.execute("SELECT seq FROM sqlite_sequence WHERE name = 'entries'").fetchall()
    return []


def _is_sound(connection: sqlite3.Connection, check: str = "quick_check") -> bool:
    """Whether SQLite finds no error in the file. "quick_check" does not compare the indexes with their tables."""
    with contextlib.suppress(sqlite3.DatabaseError, UnicodeDecodeError):
        return connection.execute(f"PRAGMA {check}(1)").fetchone()[0] in ("ok", b"ok")
    return False


def _take_table(connection: sqlite3.Connection, table: str, out: sqlite3.Connection) -> bool:
    """Take the rows of a table. Returns whether all of them could be read and are good."""
    rows = _Rows(connection, table)
    good: List[Row] = []
    is_good = True
    for values in rows.numbered() if table in _NUMBERED else rows.from_both_ends():
        row = _verified(table, values)
        if row is None:
            is_good = False
            continue
        good.append(row)
        if len(good) == _BATCH:
            _insert(out, table, good)
            good = []
    _insert(out, table, good)
    return is_good and rows.are_all


class _Rows:
    """Reads the rows of a table as far as SQLite can, with their checksums if it has any."""

    def __init__(self, connection: sqlite3.Connection, table: str) -> None:
        self._connection, self._table = connection, table
        self._key = COLUMNS[table][0]
        self.are_all = True  # so far

    def from_both_ends(self) -> Iterator[Row]:
        """Return the rows up to the first unreadable one, from both ends."""
        for order in ("ASC", "DESC"):
            yield from self._read(f"ORDER BY {self._key} {order}")
            if self.are_all:
                break

    def numbered(self) -> Iterator[Row]:
        """Return the rows in the order of their numbers. Unreadable ones are skipped in growing steps."""
        last, step = 0, 0
        while step < _LARGEST_STEP:
            before = self.are_all
            self.are_all = True
            for row in self._read(f"WHERE {self._key} > {last + step} ORDER BY {self._key}"):
                last, step = int(row[0]), 0
                yield row
            is_end, self.are_all = self.are_all, self.are_all and before
            if is_end:
                break
            step = max(1, 2 * step)

    def _read(self, condition: str) -> Iterator[Row]:
        columns = COLUMNS[self._table]
        try:
            has_crc = any(row[1] == b"crc" for row in self._connection.execute(f"PRAGMA table_info({self._table})"))
            names = ", ".join((*columns, "crc") if has_crc else columns)
            yield from self._connection.execute(f"SELECT {names} FROM {self._table} {condition}")
        except sqlite3.DatabaseError:
            self.are_all = False


def _verified(table: str, values: Row) -> Optional[Row]:
    """Return a row of the table with its checksum; None if it is invalid. Rows with a checksum need no other test,
    because the box wrote them."""
    columns, checked = COLUMNS[table], schema.CHECKED.get(table)
    if checked is not None and len(values) > len(columns):
        return values if schema.row_crc(*values[-1 - len(checked):-1]) == values[-1] else None
    return _with_crc(table, _checked(table, values))


def _with_crc(table: str, row: Optional[Row]) -> Optional[Row]:
    if row is None or table not in schema.CHECKED:
        return row
    return (*row, schema.row_crc(*row[-len(schema.CHECKED[table]):]))


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


def _take_from_pages(image: bytes, out: sqlite3.Connection) -> None:
    """Take the rows in all pages that SQLite did not find."""
    known: Keys = {
        table: {row[0] for row in out.execute(f"SELECT {columns[0]} FROM main.{table}")}
        for table, columns in COLUMNS.items()
    }

    def known_on_page(record: pages.PageRecord) -> Optional[Container[object]]:
        """Return the numbers of rows that are known, on the page of a record; None: it is a page of an index."""
        if record.rowid is None:
            # The indexes have a port and a row's number, or an identity and, twice, a row's number.
            numbers = record.values[1:]
            is_index = len(numbers) in (1, 2) and isinstance(numbers[0], int) and numbers[0] == numbers[-1]
            return None if is_index else ()
        return next((known[table] for table in _NUMBERED if _row_of(table, record) is not None), ())

    found: Dict[Tuple[str, object], List[Row]] = {}
    for record in pages.page_records(image, known_on_page):
        if record.rowid is not None and record.values[:1] == ("entries",) and len(record.values) == 2:
            _set_last_number(out, record.values[1])  # of the latest entry that was ever written
        for table in COLUMNS:
            row = _row_of(table, record)
            if row is not None:
                if row[0] not in known[table]:
                    found.setdefault((table, row[0]), []).append(row)
                break
    for table in COLUMNS:
        newest = (_with_crc(table, _newest(table, rows)) for (of, _), rows in found.items() if of == table)
        _insert(out, table, [row for row in newest if row is not None])


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


# -- writing ----------------------------------------------------------------------------------------


def _insert(out: sqlite3.Connection, table: str, rows: List[Row]) -> None:
    """Write rows with their checksums. Rows that are there already stay."""
    columns = COLUMNS[table]
    values = ["?" if name in _REALS | _WHOLES else "CAST(? AS TEXT)" for name in columns]
    if table in schema.CHECKED:
        columns, values = (*columns, "crc"), [*values, "?"]
    with out:
        out.execute("BEGIN")
        out.executemany(f"INSERT OR IGNORE INTO main.{table} ({', '.join(columns)}) VALUES ({', '.join(values)})", rows)


def _set_last_number(out: sqlite3.Connection, number: object) -> None:
    """Keep the highest number that an entry ever had."""
    if isinstance(number, int):
        out.execute("UPDATE main.sqlite_sequence SET seq = max(seq, ?) WHERE name = 'entries'", (number,))
