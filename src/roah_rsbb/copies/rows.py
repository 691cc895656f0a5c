"""Reads from a journal in use the rows that a copy does not have yet.

Theory of operation. `Known` describes what a copy has: the numbers of its last entry and link sample, which only rise,
and the checksums of all other rows, which the core replaces. Entries and link samples come in parts of `PART` rows,
each part older than the next. The last part brings everything else, so a copy's state for a restart is never newer
than its entries.

It would take too long to compare the records of 10,000 runs after each change. Each change of a record comes with an
entry of the run in the same transaction, so only new runs, open runs and runs with new entries are compared. Every
`ALL_S` seconds, all runs are.
"""

import contextlib
import pathlib
import sqlite3
import time
from dataclasses import dataclass, field
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema

# Rows that are copied in one transaction.
PART = 5000
ALL_S = 60.0
# SQLite locks a file without a write-ahead log while it is written.
BUSY_S = 1.0

Row = Tuple[object, ...]

# The columns of each table, its key first. `links` has only SQLite's own number.
COLUMNS: Dict[str, Tuple[str, ...]] = {
    "entries": ("id", *schema.CHECKED["entries"], "crc"),
    "links": ("rowid", *schema.CHECKED["links"], "crc"),
    "sessions": ("id", *schema.CHECKED["sessions"], "crc"),
    "runs": (*schema.CHECKED["runs"], "crc"),
    "members": (*schema.CHECKED["members"], "crc"),
    "states": (*schema.CHECKED["states"], "crc"),
    "meta": ("key", "value"),
}
# Tables to which the core only appends.
APPENDED = ("entries", "links")
# Tables with few rows, all of which are compared.
SMALL = ("sessions", "states", "meta")
_IDENTITY = COLUMNS["entries"].index("identity")
_CLOSED = COLUMNS["runs"].index("closed_utc")
_MEMBERS_RUN = COLUMNS["members"].index("identity")


class CannotReadJournal(Exception):
    """The journal cannot be read now."""


class OtherJournal(Exception):
    """The copy is not an earlier state of the journal."""


class Last(NamedTuple):
    """The newest row of a table to which the core only appends."""

    number: int = 0
    crc: Optional[int] = None


@dataclass
class Known:
    """What a copy has."""

    last: Dict[str, Last] = field(default_factory=lambda: {table: Last() for table in APPENDED})
    # The last column (a checksum, or the value) by the key, for each other table.
    rest: Dict[str, Dict[object, object]] = field(
        default_factory=lambda: {table: {} for table in COLUMNS if table not in APPENDED})

    def add(self, rows: "Rows") -> None:
        """Take rows that the copy has now."""
        for table, found in rows.tables.items():
            if table in APPENDED:
                if found:
                    self.last[table] = Last(found[-1][0], found[-1][-1])
            else:
                self.rest[table].update((row[0], row[-1]) for row in found)


class Rows(NamedTuple):
    """Rows that a copy lacks."""

    tables: Dict[str, List[Row]]
    is_last: bool  # nothing else was missing

    def is_empty(self) -> bool:
        """Whether the copy lacks nothing."""
        return not any(self.tables.values())


def known_of(connection: sqlite3.Connection) -> Known:
    """Return what a journal contains. Raises sqlite3.Error."""
    known = Known()
    for table in APPENDED:
        key = COLUMNS[table][0]
        row = connection.execute(f"SELECT {key}, crc FROM {table} ORDER BY {key} DESC LIMIT 1").fetchone()
        known.last[table] = Last() if row is None else Last(*row)
    for table, found in known.rest.items():
        found.update(connection.execute(f"SELECT {COLUMNS[table][0]}, {COLUMNS[table][-1]} FROM {table}"))
    return known


class JournalRows:
    """One journal in use, opened for reading only. Call all methods in one thread."""

    def __init__(self, path: str) -> None:
        """Raises `CannotReadJournal`."""
        self._path = path
        self._file = files.identity(path)
        self._version: Optional[int] = None  # SQLite's number of the state that was read last
        self._open_runs: Dict[object, List[object]] = {}  # ports of the runs that are open, by identity
        self._all_read_mono: Optional[float] = None  # when all runs were compared
        try:
            self._connection = sqlite3.connect(f"{pathlib.Path(path).resolve().as_uri()}?mode=ro", uri=True,
                                               timeout=BUSY_S, isolation_level=None, check_same_thread=False)
        except sqlite3.Error as error:
            raise CannotReadJournal(f"{path}: {error}") from None

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def is_in_place(self) -> bool:
        """Whether the path still leads to this file: the core replaces a file that it cannot continue."""
        return files.identity(self._path) == self._file

    def begin(self, known: Known) -> None:
        """Begin with a copy that has so much. Raises `CannotReadJournal`, or `OtherJournal` if it is no copy of this
        journal."""
        self._version = self._all_read_mono = None
        self._open_runs = {}
        with self._reading():
            self._check(known)

    def has_changed(self) -> bool:
        """Whether there is something that was not read yet. Raises `CannotReadJournal`."""
        with self._reading():
            return self._version is None or self._version != self._present_version()

    def newest_entry(self) -> int:
        """Return the number of the newest entry. Raises `CannotReadJournal`."""
        with self._reading():
            return self._connection.execute("SELECT ifnull(max(id), 0) FROM entries").fetchone()[0]

    def missing(self, known: Known) -> Rows:
        """Return rows that a copy does not have, the oldest first. Raises `CannotReadJournal`."""
        with self._reading():
            # The number is read before the rows. A change between the two is read again.
            version = self._present_version()
            self._connection.execute("BEGIN")
            try:
                rows = self._read(known)
            finally:
                self._connection.execute("ROLLBACK")
        self._version = version if rows.is_last else None
        return rows

    # -- steps --------------------------------------------------------------------------------------

    def _present_version(self) -> int:
        return self._connection.execute("PRAGMA data_version").fetchone()[0]

    @contextlib.contextmanager
    def _reading(self):
        try:
            yield
        except sqlite3.Error as error:
            raise CannotReadJournal(f"{self._path}: {error}") from None

    def _check(self, known: Known) -> None:
        if not schema.is_readable(self._connection):
            raise CannotReadJournal(f"{self._path} is not a journal of this version of roah_rsbb yet")
        for number, crc in known.rest["sessions"].items():
            if self._crc("sessions", number) != (crc,):
                raise OtherJournal(f"session {number} is another one")
        for table, last in known.last.items():
            if last.number and self._crc(table, last.number) != (last.crc,):
                raise OtherJournal(f"row {last.number} of {table} is another one")

    def _crc(self, table: str, number: object) -> Optional[Row]:
        key = COLUMNS[table][0]
        return self._connection.execute(f"SELECT crc FROM {table} WHERE {key} = ?", (number,)).fetchone()

    def _read(self, known: Known) -> Rows:
        tables: Dict[str, List[Row]] = {}
        for table in APPENDED:
            key = COLUMNS[table][0]
            tables[table] = self._select(table, f"WHERE {key} > ? ORDER BY {key} LIMIT ?",
                                         (known.last[table].number, PART))
            if len(tables[table]) == PART:
                self._all_read_mono = None  # runs with entries in this part are not compared yet
                return Rows(tables, is_last=False)
        for table in SMALL:
            tables[table] = self._differing(table, known, self._keys(table))
        now = time.monotonic()
        compares_all = self._all_read_mono is None or now - self._all_read_mono >= ALL_S
        runs = None if compares_all else self._runs_to_compare(known, tables["entries"])
        tables["runs"] = self._differing("runs", known, self._keys("runs") if runs is None else runs)
        tables["members"] = self._differing("members", known, self._members_to_compare(known, runs))
        if compares_all:
            self._note_all_open_runs()
            self._all_read_mono = now
        else:
            self._note_open_runs(tables["runs"], tables["members"])
        return Rows(tables, is_last=True)

    def _select(self, table: str, rest: str, values: Tuple[object, ...]) -> List[Row]:
        return self._fetch(f"SELECT {', '.join(COLUMNS[table])} FROM {table} {rest}", values)

    def _fetch(self, statement: str, values: Tuple[object, ...] = ()) -> List[Row]:
        try:
            return self._connection.execute(statement, values).fetchall()
        except sqlite3.OperationalError as error:
            if "decode" not in str(error):
                raise
        # Damaged text is rare, and to decode each text here takes as long as all the rest.
        self._connection.text_factory = _text
        try:
            return self._connection.execute(statement, values).fetchall()
        finally:
            self._connection.text_factory = str

    def _keys(self, table: str) -> List[object]:
        return [key for (key,) in self._fetch(f"SELECT {COLUMNS[table][0]} FROM {table}")]

    def _differing(self, table: str, known: Known, keys: Iterable[object]) -> List[Row]:
        """Return those of these rows that the copy does not have in their present state."""
        columns = COLUMNS[table]
        have, found = known.rest[table], []
        for key in keys:
            row = self._connection.execute(f"SELECT {columns[-1]} FROM {table} WHERE {columns[0]} = ?", (key,))
            if row.fetchone() != (have.get(key, _ABSENT),):
                found += self._select(table, f"WHERE {columns[0]} = ?", (key,))
        return found

    def _runs_to_compare(self, known: Known, entries: List[Row]) -> List[object]:
        """Return the identities of runs that are new or may have changed."""
        runs = {*self._open_runs, *(entry[_IDENTITY] for entry in entries)}
        (count,) = self._connection.execute("SELECT count(*) FROM runs").fetchone()
        if count != len(known.rest["runs"]):  # the record of a no-show comes without an entry of its run
            runs.update(identity for identity in self._keys("runs") if identity not in known.rest["runs"])
        return list(runs)

    def _members_to_compare(self, known: Known, runs: Optional[List[object]]) -> List[object]:
        if runs is None:
            return self._keys("members")
        newest = max(known.rest["members"], default=0)
        new = [port for (port,) in self._connection.execute("SELECT port FROM members WHERE port > ?", (newest,))]
        return new + [port for run in runs for port in self._open_runs.get(run, ())]

    def _note_all_open_runs(self) -> None:
        self._open_runs = {}
        self._note_open_runs(self._select("runs", "WHERE closed_utc IS NULL", ()), self._select("members", "", ()))

    def _note_open_runs(self, runs: List[Row], members: List[Row]) -> None:
        for row in runs:
            if row[_CLOSED] is None:
                self._open_runs.setdefault(row[0], [])
            else:
                self._open_runs.pop(row[0], None)
        for row in members:
            ports = self._open_runs.get(row[_MEMBERS_RUN])
            if ports is not None and row[0] not in ports:
                ports.append(row[0])


_ABSENT = object()


def _text(value: bytes) -> str:
    """Damaged text is copied, too. Its checksum shows the damage."""
    return value.decode("utf-8", errors="replace")
