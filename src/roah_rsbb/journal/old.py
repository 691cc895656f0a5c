"""Imports the journal of an earlier version: one SQLite file. The file stays as it is.

Each row that SQLite can read, and whose checksum is right, is taken; the others are named. SQLite itself ends its
write-ahead log at the first damaged part, so what is lost there is not known.
"""

import bisect
import contextlib
import heapq
import json
import os
import pathlib
import sqlite3
import zlib
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import kinds
from roah_rsbb.journal.batch import Batch, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.contents import no_journal
from roah_rsbb.journal.log import DRAFT, NEWEST, Files
from roah_rsbb.journal.writer import Writer

APPLICATION_ID, VERSION = 0x52534242, 2  # of the newest one; version 1 had no checksums
_BUSY_S = 5.0
# SQLite's messages may contain a text of the damaged file.
_ERRORS = (sqlite3.Error, UnicodeDecodeError)
# Records that are written at once.
_AT_ONCE = 10_000
_SHOWN = 5
# The columns of which the checksum of a row is made, and before them the key of the table.
_COLUMNS = {
    "sessions": ("id", "utc", "mono", "boot_id", "pid", "box_uuid", "launch"),
    "runs": ("identity", "zone", "benchmark", "team", "round", "run", "scheduled", "opened_utc", "closed_utc",
             "outcome"),
    "members": ("port", "identity", "team", "robot", "log_file"),
    "entries": ("id", "session", "utc", "mono", "zone", "identity", "port", "who", "kind", "value"),
    "links": ("rowid", "port", "utc", "mono", "sample"),
    "states": ("name", "state"),
}
_NUMBERED = {"sessions", "entries", "links"}
_TIMES = {"utc", "mono", "scheduled", "opened_utc", "closed_utc"}
_WHOLE = {"id", "rowid", "session", "port", "pid", "round", "run"}
_MAY_BE_MISSING = {"closed_utc", "outcome", "port", "log_file"}
# No clock reaches this many seconds.
_LAST_MOMENT = 1e12


class CannotImport(Exception):
    """Nothing of the file can be read. The text says why."""


class _Event(NamedTuple):
    """What becomes one record."""

    utc: float
    order: int  # among those of the same time
    session: Optional[int]  # None: the newest one so far
    first_entry: int  # number; 0: it has no entries
    batch: Batch
    started: Tuple[Any, ...] = ()  # a start of the core


def import_journal(path: str, folder: str, files: Files) -> List[str]:
    """Import a SQLite file into a new folder. It is complete and on the disk when it gets its name. Returns what is
    damaged or missing, in words. Raises `CannotImport` or OSError."""
    if os.path.getsize(path) == 0:
        raise CannotImport("it is empty, as after a power failure")
    draft, damage = folder + DRAFT, []  # type: str, List[str]
    with contextlib.suppress(FileNotFoundError):
        for name in os.listdir(draft):
            files.remove(os.path.join(draft, name))
    with contextlib.closing(_Reader(path)) as reader:
        writer = Writer(draft, no_journal(), files)
        _write(reader, writer)
        damage += reader.damage
    writer.log.close()
    files.rename(draft, folder)
    files.sync_folder(os.path.dirname(folder) or ".")
    with contextlib.suppress(FileNotFoundError):
        files.remove(draft + NEWEST)
    return damage


def _write(reader: "_Reader", writer: Writer) -> None:
    competition, places = reader.competition(), ([0], [0])
    writer.log.begin()
    for count, event in enumerate(reader.events(), 1):
        for entry in event.batch.entries:
            if entry.kind == kinds.EPOCH and isinstance(entry.value, dict) and "cut" in entry.value:
                # It was the number of an entry.
                entry.value["cut"] = places[1][bisect.bisect(places[0], entry.value["cut"]) - 1]
        if event.first_entry:
            writer.contents.entry = event.first_entry - 1
        if event.started:
            writer.begin_session(event.started, competition)
        else:
            writer.add(event.batch, event.session)
        places[0].append(writer.contents.entry)
        places[1].append(writer.log.last)
        if count % _AT_ONCE == 0:
            writer.log.write()
            writer.log.sync()
    writer.log.write()
    if writer.contents.standing.epoch > writer.log.epoch:
        writer.log.begin(writer.contents.standing.epoch)
    writer.log.finish()


class _Reader:
    """Reads the rows of a SQLite journal."""

    def __init__(self, path: str) -> None:
        self.damage: List[str] = []
        self._path = path
        self._cleanup = contextlib.ExitStack()
        try:
            self._connection = self._connect()
            version = self._pragma("user_version")
            if self._pragma("application_id") != APPLICATION_ID:
                raise CannotImport("this database belongs to another program")
            if version > VERSION:
                raise CannotImport(f"a newer version of roah_rsbb wrote it (tables of version {version})")
            self._has_checksums = version > 1
        except _ERRORS as error:
            self.close()
            raise CannotImport(f"it is damaged, or not a journal ({error})") from None
        except CannotImport:
            self.close()
            raise

    def _connect(self) -> sqlite3.Connection:
        # Without a log, SQLite creates no files beside it. With one, it must not merge it.
        has_log = any(os.path.exists(self._path + suffix) for suffix in ("-wal", "-journal"))
        address = f"{pathlib.Path(self._path).resolve().as_uri()}?{'mode=ro' if has_log else 'immutable=1'}"
        connection = sqlite3.connect(address, uri=True, timeout=_BUSY_S, isolation_level=None)
        self._cleanup.callback(connection.close)
        connection.text_factory = bytes
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        return connection

    def close(self) -> None:
        """Close the file."""
        self._cleanup.close()

    def competition(self) -> Any:
        """Return the events of the schedule; None: unknown."""
        with contextlib.suppress(sqlite3.Error, ValueError):
            row = self._connection.execute("SELECT value FROM meta WHERE key = 'competition'").fetchone()
            return None if row is None else json.loads(row[0])
        return None

    def events(self) -> Iterator[_Event]:
        """Return everything in the order in which it happened, as far as it is known."""
        yield from heapq.merge(self._sessions(), self._runs(), self._entries(), self._links(),
                               key=lambda event: event[:2])
        yield from self._outcomes()
        states = {name: _value(state) for name, state in self._rows("states")}
        known = {name: state for name, state in states.items() if state is not None}
        yield _Event(0.0, 0, None, 0, Batch(states=known))

    def _sessions(self) -> Iterator[_Event]:
        newest = 0.0
        for number, *session in self._rows("sessions"):
            newest = max(newest, session[0])
            yield _Event(newest, 0, number, 0, Batch(), tuple(session))

    def _runs(self) -> Iterator[_Event]:
        members: Dict[str, List[Tuple[Member, Optional[str]]]] = {}
        for *member, log_file in self._rows("members"):
            members.setdefault(member[1], []).append((Member(*member), log_file))
        rows = [row[:8] for row in self._rows("runs")]
        for row in sorted(rows, key=lambda row: row[7]):
            own = members.pop(row[0], [])
            yield _Event(row[7], 1, None, 0, _batch_of([RunRow(*row)], own))
        for identity, own in members.items():
            self._lost(f"the row of the run {identity}")
            yield _Event(float("inf"), 1, None, 0, _batch_of([], own))

    def _outcomes(self) -> Iterator[_Event]:
        for identity, *_, closed, outcome in self._rows("runs"):
            value = None if outcome is None else _value(outcome)
            if value is not None:
                yield _Event(0.0, 0, None, 0, Batch(outcomes={identity: OutcomeRow(closed, value)}))

    def _entries(self) -> Iterator[_Event]:
        """Return the entries; those of one moment are one event."""
        event: Optional[_Event] = None
        newest, last = 0.0, 0
        for number, session, *row, value in self._rows("entries"):
            entry = NewEntry(*row, _value(value))
            newest = max(newest, entry.utc)
            before = event.batch.entries[-1] if event is not None else None
            if (before is not None and number == last + 1 and session == event.session
                    and (before.utc, before.identity) == (entry.utc, entry.identity)):
                event.batch.entries.append(entry)
            else:
                if event is not None:
                    yield event
                event = _Event(newest, 2, session, number, Batch(entries=[entry]))
            last = number
        if event is not None:
            yield event

    def _links(self) -> Iterator[_Event]:
        newest = 0.0
        for _, *row, sample in self._rows("links"):
            newest = max(newest, row[1])
            yield _Event(newest, 3, None, 0, Batch(links=[LinkRow(*row, _value(sample))]))

    def _rows(self, table: str) -> Iterator[Tuple[Any, ...]]:
        """Return the rows of a table whose checksums are right, in the order of their keys."""
        columns = _COLUMNS[table]
        first = 1 if table in _NUMBERED else 0
        bad: List[Any] = []
        last: Optional[int] = None
        for *row, crc in self._readable_rows(table):
            values = tuple(row)
            is_whole = crc == row_crc(*values[first:]) if self._has_checksums else all(map(_fits, columns, values))
            if not is_whole or not _fits(columns[0], values[0]):
                bad.append(_text(values[0]))
                continue
            if table == "entries" and last is not None and values[0] > last + 1 + len(bad):
                self._lost(f"entries {last + 1} to {values[0] - 1} are missing")
            last = values[0] if table == "entries" else None
            yield tuple(map(_text, values))
        if bad:
            shown = ", ".join(map(str, bad[:_SHOWN])) + (", …" if len(bad) > _SHOWN else "")
            self._lost(f"{len(bad)} rows of {table} ({columns[0]} {shown})")

    def _readable_rows(self, table: str) -> Iterator[Tuple[Any, ...]]:
        """Return the rows that SQLite can read: from both ends, if it cannot read what is between."""
        columns = _COLUMNS[table]
        key, crc = columns[0], "crc" if self._has_checksums else "0"
        statement = f"SELECT {', '.join(columns)}, {crc} FROM {table} WHERE {key} > ? ORDER BY {key}"
        last: Any = -1 if columns[0] in ("id", "rowid", "port") else " "  # no name is before it
        found: List[Tuple[Any, ...]] = []
        try:
            for row in self._connection.execute(statement, (last,)):
                yield row
                last = row[0]
            return
        except _ERRORS as error:
            self._lost(f"a part of {table} ({error})")
        with contextlib.suppress(*_ERRORS):
            found.extend(self._connection.execute(f"{statement} DESC", (_text(last),)))
        yield from reversed(found)

    def _lost(self, text: str) -> None:
        if text not in self.damage:
            self.damage.append(text)

    def _pragma(self, name: str) -> int:
        return self._connection.execute(f"PRAGMA {name}").fetchone()[0]


def _batch_of(runs: List[RunRow], members: List[Tuple[Member, Optional[str]]]) -> Batch:
    return Batch(runs=runs, members=[member for member, _ in members],
                 log_files={member.port: path for member, path in members if path})


def _fits(column: str, value: Any) -> bool:
    """Whether a column can have a value: SQLite returns any from a damaged file, and version 1 had no checksums."""
    if value is None:
        return column in _MAY_BE_MISSING
    if column in _TIMES:
        return isinstance(value, (int, float)) and abs(value) < _LAST_MOMENT
    if column == "identity" and isinstance(value, bytes) and (b"\t" in value or b"\n" in value):
        return False  # nobody writes this, and the first line of a record is made of it
    return isinstance(value, int if column in _WHOLE else bytes)


def _text(value: Any) -> Any:
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else value


def _value(text: Any) -> Any:
    """Return the value of a JSON text; None for one that nobody wrote."""
    with contextlib.suppress(ValueError, TypeError, RecursionError):
        return json.loads(text)
    return None


def row_crc(*values: object) -> int:
    """Return the checksum of a row's values. Real columns may store integers, so 1 and 1.0 have the same checksum."""
    return zlib.crc32(b"\0".join([
        b"s" + value if value.__class__ is bytes else
        b"-" if value is None else
        b"s" + value.encode("utf-8", errors="replace") if value.__class__ is str else
        b"%a" % float(value)
        for value in values
    ]))
