"""Journals of earlier versions, which were SQLite files: made of a journal of today."""

import contextlib
import json
import sqlite3

from roah_rsbb.journal.contents import open_journal
from roah_rsbb.journal.log import read_chain, scans
from roah_rsbb.journal.old import APPLICATION_ID, row_crc
from roah_rsbb.journal.records import LINKS, OF_ENTRIES, entries_in, line_of, top_of

# By table: the columns of version 1. Version 2 added `crc` to all but the first.
TABLES = {
    "meta": "key TEXT PRIMARY KEY, value TEXT NOT NULL",
    "sessions": "id INTEGER PRIMARY KEY, utc REAL NOT NULL, mono REAL NOT NULL, boot_id TEXT NOT NULL,"
                " pid INTEGER NOT NULL, box_uuid TEXT NOT NULL, launch TEXT NOT NULL",
    "runs": "identity TEXT PRIMARY KEY, zone TEXT NOT NULL, benchmark TEXT NOT NULL, team TEXT NOT NULL,"
            " round INTEGER NOT NULL, run INTEGER NOT NULL, scheduled REAL NOT NULL, opened_utc REAL NOT NULL,"
            " closed_utc REAL, outcome TEXT",
    "members": "port INTEGER PRIMARY KEY, identity TEXT NOT NULL, team TEXT NOT NULL, robot TEXT NOT NULL,"
               " log_file TEXT",
    "entries": "id INTEGER PRIMARY KEY AUTOINCREMENT, session INTEGER NOT NULL, utc REAL NOT NULL, mono REAL NOT NULL,"
               " zone TEXT NOT NULL, identity TEXT NOT NULL, port INTEGER, who TEXT NOT NULL, kind TEXT NOT NULL,"
               " value TEXT NOT NULL",
    "links": "port INTEGER NOT NULL, utc REAL NOT NULL, mono REAL NOT NULL, sample TEXT NOT NULL",
    "states": "name TEXT PRIMARY KEY, state TEXT NOT NULL",
}
INDEXES = ("CREATE INDEX entries_of_run ON entries (identity, id)", "CREATE INDEX links_of_port ON links (port)")


def write_old(journal, path, version=2):
    """Write what is in a journal as the file of an earlier version."""
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("BEGIN")
        for table, columns in TABLES.items():
            crc = ", crc INTEGER" if version > 1 and table != "meta" else ""
            without = "" if "INTEGER PRIMARY" in columns or table == "links" else " WITHOUT ROWID"
            connection.execute(f"CREATE TABLE {table} ({columns}{crc}){without}")
        for statement in INDEXES:
            connection.execute(statement)
        for table, row in _rows(journal):
            numbered = table in ("sessions", "entries")
            crc = [row_crc(*row[numbered:])] if version > 1 and table != "meta" else []
            connection.execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len([*row, *crc]))})", (*row, *crc))
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {version}")
        connection.execute("COMMIT")


def _rows(journal):
    opened = open_journal(journal)
    contents = opened.contents
    yield "meta", ("competition", _text(contents.competition))
    for number, session in enumerate(contents.sessions, 1):
        yield "sessions", (number, *session)
    for run in contents.runs.values():
        outcome = next(outcome for _, outcome in opened.outcomes([run]))
        yield "runs", (*run.row, run.closed, None if outcome is None else _text(outcome))
        for *member, log_file in run.members:
            yield "members", (*member, log_file or None)
    for _, found in scans(read_chain(journal).segments):
        for frame in found.records:
            for number, *entry, value in entries_in(frame.payload, OF_ENTRIES):
                yield "entries", (number, top_of(frame.payload).session, *entry, _text(value))
            for *link, sample in line_of(frame.payload, LINKS) or ():
                yield "links", (*link, _text(sample))
    for name, state in contents.states.items():
        yield "states", (name, _text(state.state))


def _text(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
