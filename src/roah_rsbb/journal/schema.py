"""The journal's tables, their version, and the way from older versions (docs/journal.md).

Who changes a table raises `VERSION` and adds the statements that lead there from the version before: a journal
of an older version is brought up to date when the core opens it.
"""

import contextlib
import functools
import sqlite3
from typing import Dict, Tuple

# "RSBB": by this a file is known as a journal.
APPLICATION_ID = 0x52534242
VERSION = 1

SCHEMA = (
    "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID",
    "CREATE TABLE sessions (id INTEGER PRIMARY KEY, utc REAL NOT NULL, mono REAL NOT NULL, boot_id TEXT NOT NULL,"
    " pid INTEGER NOT NULL, box_uuid TEXT NOT NULL, launch TEXT NOT NULL)",
    "CREATE TABLE runs (identity TEXT PRIMARY KEY, zone TEXT NOT NULL, benchmark TEXT NOT NULL, team TEXT NOT NULL,"
    " round INTEGER NOT NULL, run INTEGER NOT NULL, scheduled REAL NOT NULL, opened_utc REAL NOT NULL,"
    " closed_utc REAL, outcome TEXT) WITHOUT ROWID",
    "CREATE TABLE members (port INTEGER PRIMARY KEY, identity TEXT NOT NULL, team TEXT NOT NULL, robot TEXT NOT NULL,"
    " log_file TEXT)",
    "CREATE TABLE entries (id INTEGER PRIMARY KEY AUTOINCREMENT, session INTEGER NOT NULL, utc REAL NOT NULL,"
    " mono REAL NOT NULL, zone TEXT NOT NULL, identity TEXT NOT NULL, port INTEGER, who TEXT NOT NULL,"
    " kind TEXT NOT NULL, value TEXT NOT NULL)",
    "CREATE INDEX entries_of_run ON entries (identity, id)",
    "CREATE TABLE links (port INTEGER NOT NULL, utc REAL NOT NULL, mono REAL NOT NULL, sample TEXT NOT NULL)",
    "CREATE INDEX links_of_port ON links (port)",
    "CREATE TABLE states (name TEXT PRIMARY KEY, state TEXT NOT NULL) WITHOUT ROWID",
)

# version -> the statements that make the next version of it.
MIGRATIONS: Dict[int, Tuple[str, ...]] = {}


def create(connection: sqlite3.Connection) -> None:
    """Make the tables in an empty file."""
    _run(connection, SCHEMA, VERSION)


def migrate(connection: sqlite3.Connection, version: int) -> None:
    """Bring a journal of an older `version` up to date; raises KeyError if there is no way."""
    while version < VERSION:
        _run(connection, MIGRATIONS[version], version + 1)
        version += 1


def is_whole(connection: sqlite3.Connection) -> bool:
    """Whether a file of the present version has the tables that it should have, and nothing that acts on them."""
    return _shape(connection) == _whole_shape()


@functools.lru_cache(maxsize=1)
def _whole_shape() -> Dict[str, Tuple[str, ...]]:
    with contextlib.closing(sqlite3.connect(":memory:", isolation_level=None)) as connection:
        create(connection)
        return _shape(connection)


def _shape(connection: sqlite3.Connection) -> Dict[str, Tuple[str, ...]]:
    """The columns of each table, and triggers and views, which no journal has."""
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
