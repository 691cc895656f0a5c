"""Journals as a box writes them, for tests of their readers."""

import contextlib
import json
import os
import sqlite3

from roah_rsbb.core.restart.saved import freeze
from roah_rsbb.journal.batch import Batch, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.file import CoreSession, Resume
from roah_rsbb.journal.store import Journal

UTC0 = 1763722800.0  # 2025-11-21 11:00 UTC


class Writer:
    """A box that writes a journal."""

    def __init__(self, log_dir, competition="[]"):
        self.troubles = []
        session = CoreSession(UTC0, 10.0, "boot", 1234, "uuid", "launch")
        self.journal = Journal(str(log_dir), session, competition, Resume.ALWAYS, self.troubles.append)
        self.path = self.journal.path
        self.utc = UTC0

    def run(self, record, robots=((6667, "r1"),)):
        """Add a run (which may be over): its record, and the ports and names of its robots."""
        row = RunRow(record.identity, record.zone, record.benchmark, record.team, record.round, record.run,
                     record.scheduled, record.opened_utc)
        members = [Member(port, record.identity, record.team, robot) for port, robot in robots]
        self.journal.write(Batch(
            runs=[row], members=members, log_files={m.port: f"/logs/{m.port}.bag" for m in members},
        ))
        self.outcome(record)

    def outcome(self, record):
        """A run's record changed."""
        outcome = OutcomeRow(record.closed_utc or None, text(freeze(record)))
        self.journal.write(Batch(outcomes={record.identity: outcome}))

    def entry(self, kind, value, identity="", zone="tbm", port=6667, who="", after=1.0):
        """Something happens, `after` seconds from the last thing."""
        self.utc += after
        entry = NewEntry(self.utc, self.utc - UTC0 + 10.0, zone, identity, port, who, kind, text(value))
        self.journal.write(Batch(entries=[entry]))

    def link(self, sample, port=6667, after=1.0):
        """A second of a link record."""
        self.utc += after
        self.journal.write(Batch(links=[LinkRow(port, self.utc, self.utc - UTC0 + 10.0, text(freeze(sample)))]))

    def close(self):
        """The box ends."""
        self.journal.close()
        assert not any(self.troubles)


# The tables of version 1.
OLD_SCHEMA = (
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
    "PRAGMA application_id = 1381188162",
    "PRAGMA user_version = 1",
)


def make_old(path):
    """Replace a closed journal by the same one in the format of version 1."""
    os.rename(path, f"{path}.new")
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as old:
        old.execute("ATTACH ? AS new", (f"{path}.new",))
        for statement in OLD_SCHEMA:
            old.execute(statement)
        for table in ("meta", "sessions", "runs", "members", "entries", "links", "states"):
            columns = ", ".join(row[1] for row in old.execute(f"PRAGMA main.table_info({table})"))
            old.execute(f"INSERT INTO main.{table} ({columns}) SELECT {columns} FROM new.{table}")
        old.execute("PRAGMA main.journal_mode = WAL")
    os.remove(f"{path}.new")


def text(value):
    """JSON as the box writes it."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
