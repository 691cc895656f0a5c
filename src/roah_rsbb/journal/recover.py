"""Takes what can still be read of a damaged journal into a new one. The damaged file is not changed."""

import contextlib
import os
import shutil
import sqlite3
import tempfile
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import schema
from roah_rsbb.journal.reader import LOGS, JournalError

# So many rows at most are looked for one by one behind the last that was found, where there is no end.
MAX_PROBED = 50_000

Row = Tuple[Any, ...]


class _Table(NamedTuple):
    name: str
    statement: str  # that makes it

    @property
    def has_rowid(self) -> bool:
        """Whether its rows have a number of SQLite's."""
        return "WITHOUT ROWID" not in self.statement.upper()

    @property
    def key(self) -> str:
        """What its rows are found by: without such a number the first column is the primary key."""
        return "rowid" if self.has_rowid else self.statement.partition("(")[2].split()[0]


def recover(path: str, new: str) -> Dict[str, int]:
    """Write a new journal with what can be read of the one at `path`; returns the number of rows by table.

    Raises JournalError.
    """
    if os.path.exists(new):
        raise JournalError(f"{new}: there is such a file already: name another one")
    try:
        with tempfile.TemporaryDirectory(prefix="roah_rsbb_journal_") as directory:
            copy = os.path.join(directory, "journal.sqlite3")
            for suffix in ("", *LOGS):
                if suffix == "" or os.path.exists(path + suffix):
                    shutil.copyfile(path + suffix, copy + suffix)
            return _recover(copy, new)
    except OSError as error:
        raise JournalError(f"{error.filename}: {error.strerror}: name a journal, and a new file for it") from None
    except sqlite3.Error as error:
        with contextlib.suppress(FileNotFoundError):
            os.remove(new)
        raise JournalError(
            f"{path}: nothing can be had of this journal ({error}). Look for another copy of it, and for the run logs "
            "(.bag)"
        ) from None


def _recover(copy: str, new: str) -> Dict[str, int]:
    with contextlib.closing(sqlite3.connect(copy)) as old:
        old.execute("PRAGMA writable_schema = ON")  # or SQLite reads nothing of a file that is too short
        statements = [row[0] for row in old.execute("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL")]
        tables = [
            _Table(*row) for row in old.execute(
                "SELECT name, sql FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")
        ]
        if not tables:
            raise sqlite3.DatabaseError("it has no tables")
        version = old.execute("PRAGMA user_version").fetchone()[0]
        with contextlib.closing(sqlite3.connect(new)) as out:
            for statement in statements:
                if "sqlite_sequence" not in statement:
                    out.execute(statement)
            out.execute(f"PRAGMA application_id = {schema.APPLICATION_ID}")
            out.execute(f"PRAGMA user_version = {version}")
            counts = {table.name: _copy_rows(old, out, table) for table in tables}
            out.commit()
    return counts


def _copy_rows(old: sqlite3.Connection, out: sqlite3.Connection, table: _Table) -> int:
    """Copy a table from both its ends, and what is between them row by row."""
    first, whole = _read(old, table, "ASC")
    rows: List[Row] = first
    if not whole:
        last, _ = _read(old, table, "DESC")
        rows = first + last
        if table.has_rowid:
            begin = first[-1][0] + 1 if first else 1
            end = last[-1][0] if last else begin + MAX_PROBED
            rows += [row for row in (_probe(old, table, i) for i in range(begin, end)) if row is not None]
    count = 0
    for row in rows:
        marks = ", ".join("?" * (len(row) - 1))
        count += out.execute(f"INSERT OR IGNORE INTO {table.name} VALUES ({marks})", row[1:]).rowcount
    return count


def _read(old: sqlite3.Connection, table: _Table, order: str) -> Tuple[List[Row], bool]:
    """All rows in this order up to the first that cannot be read, each behind its key; and whether that was all."""
    rows: List[Row] = []
    with contextlib.suppress(sqlite3.DatabaseError):
        rows.extend(old.execute(f"SELECT {table.key}, * FROM {table.name} ORDER BY {table.key} {order}"))
        return rows, True
    return rows, False


def _probe(old: sqlite3.Connection, table: _Table, rowid: int) -> Optional[Row]:
    with contextlib.suppress(sqlite3.DatabaseError):
        return old.execute(f"SELECT rowid, * FROM {table.name} WHERE rowid = ?", (rowid,)).fetchone()
    return None
