"""The journal's tables, their version, and the migration of older versions (docs/journal.md).

After changing a table, increment `VERSION` and add the statements that migrate the previous version. The core migrates
older journals when it opens them.
"""

import contextlib
import functools
import sqlite3
import zlib
from typing import Dict, Tuple

# "RSBB": identifies a file as a journal.
APPLICATION_ID = 0x52534242
VERSION = 2

SCHEMA = (
    "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID",
    "CREATE TABLE sessions (id INTEGER PRIMARY KEY, utc REAL NOT NULL, mono REAL NOT NULL, boot_id TEXT NOT NULL,"
    " pid INTEGER NOT NULL, box_uuid TEXT NOT NULL, launch TEXT NOT NULL, crc INTEGER)",
    "CREATE TABLE runs (identity TEXT PRIMARY KEY, zone TEXT NOT NULL, benchmark TEXT NOT NULL, team TEXT NOT NULL,"
    " round INTEGER NOT NULL, run INTEGER NOT NULL, scheduled REAL NOT NULL, opened_utc REAL NOT NULL,"
    " closed_utc REAL, outcome TEXT, crc INTEGER) WITHOUT ROWID",
    "CREATE TABLE members (port INTEGER PRIMARY KEY, identity TEXT NOT NULL, team TEXT NOT NULL, robot TEXT NOT NULL,"
    " log_file TEXT, crc INTEGER)",
    "CREATE TABLE entries (id INTEGER PRIMARY KEY AUTOINCREMENT, session INTEGER NOT NULL, utc REAL NOT NULL,"
    " mono REAL NOT NULL, zone TEXT NOT NULL, identity TEXT NOT NULL, port INTEGER, who TEXT NOT NULL,"
    " kind TEXT NOT NULL, value TEXT NOT NULL, crc INTEGER)",
    "CREATE INDEX entries_of_run ON entries (identity, id)",
    "CREATE TABLE links (port INTEGER NOT NULL, utc REAL NOT NULL, mono REAL NOT NULL, sample TEXT NOT NULL,"
    " crc INTEGER)",
    "CREATE INDEX links_of_port ON links (port)",
    "CREATE TABLE states (name TEXT PRIMARY KEY, state TEXT NOT NULL, crc INTEGER) WITHOUT ROWID",
)

# The columns in the checksum of a row: all except numbers that SQLite assigns.
CHECKED = {
    "sessions": ("utc", "mono", "boot_id", "pid", "box_uuid", "launch"),
    "runs": ("identity", "zone", "benchmark", "team", "round", "run", "scheduled", "opened_utc", "closed_utc",
             "outcome"),
    "members": ("port", "identity", "team", "robot", "log_file"),
    "entries": ("session", "utc", "mono", "zone", "identity", "port", "who", "kind", "value"),
    "links": ("port", "utc", "mono", "sample"),
    "states": ("name", "state"),
}

def crc_of(table: str) -> str:
    """SQL that computes the checksum of a row of a table."""
    return f"row_crc({', '.join(map(bytes_of, CHECKED[table]))})"


def bytes_of(column: str) -> str:
    """Return SQL for a value as it is stored, because Python refuses damaged text. A blob becomes 0."""
    # In SQLite's order, numbers are before texts, and these before blobs: `typeof` takes four times as long.
    return (f"CASE WHEN +{column} >= '' AND +{column} < x'' THEN CAST({column} AS BLOB)"
            f" WHEN +{column} >= x'' THEN 0 ELSE {column} END")


# version -> the statements that migrate to the next version.
MIGRATIONS: Dict[int, Tuple[str, ...]] = {
    1: tuple(
        statement for table in CHECKED
        for statement in (f"ALTER TABLE {table} ADD COLUMN crc INTEGER", f"UPDATE {table} SET crc = {crc_of(table)}")
    ),
}


def row_crc(*values: object) -> int:
    """Return the checksum of a row's values. Real columns may store integers, so 1 and 1.0 have the same checksum."""
    return zlib.crc32(row_bytes(*values))


def row_bytes(*values: object) -> bytes:
    """Return the bytes of which `row_crc` is the checksum."""
    return b"\0".join([
        b"s" + value if value.__class__ is bytes else
        b"-" if value is None else
        b"s" + value.encode("utf-8", errors="replace") if value.__class__ is str else
        b"%a" % float(value)
        for value in values
    ])


def add_functions(connection: sqlite3.Connection) -> None:
    """Add the function that computes checksums to a connection."""
    connection.create_function("row_crc", -1, row_crc)


def insertion(table: str, or_what: str = "") -> str:
    """Return a statement that inserts the checked columns of a row, with their checksum."""
    columns = CHECKED[table]
    values = ", ".join(f"?{i}" for i, _ in enumerate(columns, 1))
    return f"INSERT{or_what} INTO {table} ({', '.join(columns)}, crc) VALUES ({values}, row_crc({values}))"


def change(table: str, changed: Tuple[str, ...]) -> str:
    """Return a statement that changes some columns of a row, and its checksum. The row is identified by the table's
    first checked column. The parameters are the new values in this order, then that column's value."""
    sets = ", ".join(f"{name} = ?{i}" for i, name in enumerate(changed, 1))
    values = ", ".join(f"?{changed.index(name) + 1}" if name in changed else bytes_of(name)
                       for name in CHECKED[table])
    return f"UPDATE {table} SET {sets}, crc = row_crc({values}) WHERE {CHECKED[table][0]} = ?{len(changed) + 1}"


def create(connection: sqlite3.Connection) -> None:
    """Create the tables in an empty file."""
    _run(connection, SCHEMA, VERSION)


def migrate(connection: sqlite3.Connection, version: int) -> None:
    """Migrate a journal of an older `version`. Raises KeyError if that is impossible."""
    while version < VERSION:
        _run(connection, MIGRATIONS[version], version + 1)
        version += 1


def is_readable(connection: sqlite3.Connection) -> bool:
    """Whether the tables are those of this version, also before they are migrated."""
    found = [connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")]
    return found == [APPLICATION_ID, VERSION]


def is_whole(connection: sqlite3.Connection) -> bool:
    """Whether a file of the present version has the right tables, and no triggers or views."""
    return _shape(connection) == _whole_shape()


def is_exact(connection: sqlite3.Connection) -> bool:
    """Whether tables and indexes are exactly those that this version creates, and nothing else is in the file."""
    return _statements(connection) == _created()


@functools.lru_cache(maxsize=1)
def _created() -> Tuple[Tuple[object, ...], ...]:
    with contextlib.closing(sqlite3.connect(":memory:", isolation_level=None)) as connection:
        create(connection)
        return _statements(connection)


def _statements(connection: sqlite3.Connection) -> Tuple[Tuple[object, ...], ...]:
    """Return the format of the file's texts and tables, and the statements of all that it contains."""
    names = ("encoding", "application_id", "user_version")
    formats = [connection.execute(f"PRAGMA {name}").fetchone() for name in names]
    return (*formats, *connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY type, name"))


@functools.lru_cache(maxsize=1)
def _whole_shape() -> Dict[str, Tuple[str, ...]]:
    with contextlib.closing(sqlite3.connect(":memory:", isolation_level=None)) as connection:
        create(connection)
        return _shape(connection)


def _shape(connection: sqlite3.Connection) -> Dict[str, Tuple[str, ...]]:
    """Return the columns of each table, and any triggers and views, which a journal does not have."""
    found = connection.execute(
        "SELECT type, name FROM sqlite_master WHERE type != 'index' AND name NOT LIKE 'sqlite_%'").fetchall()
    return {
        name: tuple(column for (column,) in connection.execute("SELECT name FROM pragma_table_info(?)", (name,)))
        if kind == "table" else (kind,)
        for kind, name in found
    }


def _run(connection: sqlite3.Connection, statements: Tuple[str, ...], version: int) -> None:
    with connection:
        connection.execute("BEGIN")
        for statement in statements:
            connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {version}")
