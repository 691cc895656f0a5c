"""Reads the journal of the present or a past competition, or a copy of one. It never changes the journal.

While the box runs, it reads the state at the time of opening. It creates no files next to a journal that is not in use.
If the folder is read-only, or the tables have an older version, it reads a temporary copy.
"""

import contextlib
import json
import os
import pathlib
import shutil
import sqlite3
import tempfile
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.journal import epochs, kinds, schema
from roah_rsbb.journal.damage import Damage, damage_in_run, damaged_rows, find_damage, last_moment, text_of
from roah_rsbb.journal.pages import has_damaged_log, has_torn_log
from roah_rsbb.journal.processes import usable_processors

# The box may lock the file for this time if its file system supports no write-ahead log.
BUSY_S = 5.0
# Number of attempts to copy, because the box may write during a copy.
COPIES = 3

# Pages that SQLite keeps. With its usual 2 MiB, it reads those that runs at the same time share for each of them.
CACHE_KIB = 16_000

# A larger journal is checked only where it is read, unless the caller wants all of it (docs/journal.md, "Damage").
SMALL_BYTES = 4_000_000

# Files that SQLite keeps next to a file in use, except those that can be rebuilt.
LOG_SUFFIX = "-wal"
LOGS = (LOG_SUFFIX, "-journal")
# The byte of the file's header that indicates a write-ahead log, and its value.
READ_VERSION_AT, WRITE_AHEAD = 19, 2

_DECODER = json.JSONDecoder()


class JournalError(Exception):
    """The journal cannot be read. The text names the file and the remedy."""


class JournalSession(NamedTuple):
    """One start of the core."""

    number: int
    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock
    boot_id: str  # identifies the computer's start, and so its monotonic clock
    pid: int
    box_uuid: str
    launch: str


class JournalRun(NamedTuple):
    """A run since *connect*."""

    identity: str
    zone: str
    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    opened_utc: float  # UTC seconds of *connect*
    closed_utc: Optional[float]  # UTC seconds of *disconnect*; None: still connected
    outcome: Dict[str, Any]  # the core's RunRecord, without fields that have their default; empty: no record yet


class JournalMember(NamedTuple):
    """A robot's part in a run."""

    port: int  # UDP port of its private channel, which is unique among all runs
    identity: str
    team: str
    robot: str
    log_file: str  # path of its run log on the box's computer; empty if none


class JournalEntry(NamedTuple):
    """An entry of the journal."""

    number: int  # rising, in order
    session: int
    utc: float  # UTC seconds
    mono: float  # seconds on the session's monotonic clock
    zone: str
    identity: str  # of the run; empty if it belongs to no run
    port: Optional[int]  # of the robot; None if it belongs to no robot
    who: str  # the originator; empty: the box
    kind: str
    value: Any  # JSON's value


class JournalLink(NamedTuple):
    """A second of a robot's link record."""

    port: int
    utc: float  # UTC seconds
    mono: float
    sample: Dict[str, Any]  # the core's LinkSample, without fields that have their default


_OUTLINE = "identity, zone, benchmark, team, round, run, scheduled, opened_utc"
_RUN = f"{_OUTLINE}, closed_utc, outcome"
_ENTRY = "id, session, utc, mono, zone, identity, port, who, kind"  # and the value


class JournalReader:
    """One journal in its state at the time of opening. Use it in a `with`, or call `close`.

    All methods raise `JournalError`.
    """

    def __init__(self, path: str, checks_all: bool = True) -> None:
        """`checks_all`: check all of a large journal, which takes seconds. A small one is always checked."""
        self.path = path
        self._checks_all = checks_all or self._is_small()
        self._cleanup = contextlib.ExitStack()
        self.is_at_rest = False  # no box has the file open, and it is read without locks
        try:
            self._connection = self._open()
        except BaseException:
            self._cleanup.close()
            raise

    def __enter__(self) -> "JournalReader":
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._cleanup.close()

    # -- contents -----------------------------------------------------------------------------------

    def sessions(self) -> List[JournalSession]:
        """All starts of the core, in order."""
        rows = self._rows("SELECT id, utc, mono, boot_id, pid, box_uuid, launch FROM sessions ORDER BY id")
        return [JournalSession(*row) for row in rows]

    def runs(self) -> List[JournalRun]:
        """All runs, in the order in which they were connected."""
        return [self._run(row) for row in self._rows(f"SELECT {_RUN} FROM runs ORDER BY opened_utc, identity")]

    def identities(self) -> List[str]:
        """The identities of all runs, in the same order."""
        return [row[0] for row in self._rows("SELECT identity FROM runs ORDER BY opened_utc, identity")]

    def outlines(self, fields: Sequence[str]) -> List[Tuple[Any, ...]]:
        """All runs in the same order: identity to opened_utc, then these fields of their outcomes (None: missing). This
        takes less time than `runs`."""
        values = ", ".join(f"json_extract(outcome, '$.{name}')" for name in fields)
        return self._rows(f"SELECT {_OUTLINE}, {values} FROM runs ORDER BY opened_utc, identity")

    def run(self, identity: str) -> Optional[JournalRun]:
        """A run; None if it does not exist."""
        rows = self._rows(f"SELECT {_RUN} FROM runs WHERE identity = ?", identity)
        return self._run(rows[0]) if rows else None

    def members(self, identity: str) -> List[JournalMember]:
        """The robots of a run."""
        rows = self._rows(
            "SELECT port, identity, team, robot, coalesce(log_file, '') FROM members WHERE identity = ? ORDER BY port",
            identity,
        )
        return [JournalMember(*row) for row in rows]

    def all_members(self) -> List[JournalMember]:
        """The robots of all runs, in the order of their ports."""
        rows = self._rows("SELECT port, identity, team, robot, coalesce(log_file, '') FROM members ORDER BY port")
        return [JournalMember(*row) for row in rows]

    def as_of(self) -> float:
        """The UTC seconds of the last thing in the journal; 0.0: there is none."""
        return max(row[0] or 0.0 for row in self._rows(
            "SELECT max(utc) FROM sessions UNION ALL SELECT utc FROM (SELECT utc FROM entries ORDER BY id DESC LIMIT 1)"
            " UNION ALL SELECT utc FROM (SELECT utc FROM links ORDER BY rowid DESC LIMIT 1)"))

    def entries(self, identity: str, without: Sequence[str] = ()) -> List[JournalEntry]:
        """All entries of a run, in order, except its states and the entries `without` which the caller can do."""
        omitted = kinds.STATE, *without
        return self._entries(f"identity = ? AND kind NOT IN ({', '.join('?' * len(omitted))})", identity, *omitted)

    def states(self, identity: str, without: Sequence[str] = ()) -> List[JournalEntry]:
        """The states of a run, in order, for `changes.ChangesReader`. `without`: parts of the state, such as
        `zone.run.link`, that are left out; to read them would take most of the time."""
        # A complete state is the only item of a list (`changes.py`).
        paths = ", ".join(f"'$.change.{part}', '$.change[0].{part}'" for part in without)
        value = f"json_remove(value, {paths})" if without else "value"
        return self._entries("identity = ? AND kind = ?", identity, kinds.STATE, value=value)

    def commands(self, zone: str) -> List[JournalEntry]:
        """The referees' commands to a zone, including refused ones, in order."""
        return self._entries("zone = ? AND kind = 'command'", zone)

    def links(self, port: int) -> List[JournalLink]:
        """The link record of a robot, in order."""
        rows = self._rows("SELECT port, utc, mono, sample FROM links WHERE port = ? ORDER BY rowid", port)
        return [JournalLink(*row[:3], self._json(row[3])) for row in rows]

    def _entries(self, where: str, *values: object, value: str = "value") -> List[JournalEntry]:
        rows = self._rows(f"SELECT {_ENTRY}, {value} FROM entries WHERE {where} ORDER BY id", *values)
        return [JournalEntry(*row[:-1], self._json(row[-1])) for row in rows]

    def _run(self, row: Tuple[Any, ...]) -> JournalRun:
        return JournalRun(*row[:-1], {} if row[-1] is None else self._json(row[-1]))

    def _json(self, text: str) -> Any:
        try:
            value, end = _DECODER.raw_decode(text)
            return value if end == len(text) else json.loads(text)  # which takes longer, for texts with spaces
        except (ValueError, RecursionError) as error:
            raise self._damaged(f"{error}: {text[:40]!r}") from None

    def _rows(self, statement: str, *values: object) -> List[Tuple[Any, ...]]:
        try:
            return self._connection.execute(statement, values).fetchall()
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None

    @property
    def damage(self) -> List[str]:
        """Return what is damaged or missing in the journal, and the periods. The rest can be read.

        Of a journal that is not checked completely, these are the records of runs; `damage_of` checks a run.
        """
        try:
            tables = self._all_damage() if self._checks_all else damaged_rows(self._connection, "runs")
            found = [text_of(damage) for damage in tables]
            if self._has(has_damaged_log):
                found.append(f"the write-ahead log: what happened after {last_moment(self._connection)} cannot be read")
            elif self._has(has_torn_log):
                found.append("the end of the write-ahead log is torn or damaged: what happened after "
                             f"{last_moment(self._connection)} may be missing")
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None
        return found

    def _all_damage(self) -> List[Damage]:
        shares = self.is_at_rest and not self._is_small()
        return find_damage(self._connection, self.path, usable_processors() if shares else 1)

    def standing(self) -> epochs.Standing:
        """Whether the box of this journal was superseded, and where the journals fork."""
        try:
            return epochs.read_standing(self._connection)
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None

    def only_here(self) -> List[Tuple[str, int]]:
        """The runs with entries that the box which took over does not have, and how many."""
        try:
            return epochs.only_here(self._connection, epochs.read_standing(self._connection))
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None

    def damage_of(self, identity: str) -> List[str]:
        """Return what is damaged or missing in the period of a run, if `damage` did not check it."""
        if self._checks_all:
            return []
        try:
            return [text_of(damage) for damage in damage_in_run(self._connection, identity)]
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None

    def _is_small(self) -> bool:
        with contextlib.suppress(OSError):
            return os.path.getsize(self.path) <= SMALL_BYTES
        return True

    def _has(self, damage: Callable[[str], bool]) -> bool:
        """Check for damage again if a box wrote at the same time."""
        with contextlib.suppress(OSError):
            return all(damage(self.path) for _ in range(COPIES))
        return False

    # -- opening ------------------------------------------------------------------------------------

    def _open(self) -> sqlite3.Connection:
        if not os.path.isfile(self.path):
            raise JournalError(
                f"{self.path}: the file is missing. A box creates its journal in its log_dir at its first start: "
                "name it with --journal FILE"
            )
        try:
            is_at_rest = self._has_no_log()
            connection = self._connect(self.path, "immutable=1" if is_at_rest else "mode=ro")
            version = self._check(connection)
        except sqlite3.OperationalError:
            return self._open_copy()
        except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None
        if version != schema.VERSION:
            return self._open_copy()
        self.is_at_rest = is_at_rest
        return connection

    def _has_no_log(self) -> bool:
        """Whether the file is not in use, so SQLite need not create files next to it."""
        try:
            with open(self.path, "rb") as file:
                header = file.read(READ_VERSION_AT + 1)
        except OSError as error:
            raise JournalError(
                f"{self.path}: cannot be read: {error.strerror}. Its owner can make it readable"
            ) from None
        return header[READ_VERSION_AT:] == bytes((WRITE_AHEAD,)) and not os.path.exists(self.path + LOG_SUFFIX)

    def _open_copy(self) -> sqlite3.Connection:
        problem: Exception = OSError("it changes all the time")
        for _ in range(COPIES):
            try:
                connection = self._connect(self._copied(), "mode=rwc")
                schema.migrate(connection, self._check(connection))
                return connection
            except OSError as error:
                raise JournalError(
                    f"{self.path}: cannot be read: {error.strerror}. Its owner can make it readable, or free space "
                    f"for a copy in {tempfile.gettempdir()}"
                ) from None
            except (sqlite3.Error, UnicodeDecodeError, JournalError) as error:
                problem = error
        raise problem if isinstance(problem, JournalError) else self._damaged(str(problem))

    def _copied(self) -> str:
        directory = self._cleanup.enter_context(tempfile.TemporaryDirectory(prefix="roah_rsbb_journal_"))
        copy = os.path.join(directory, "journal.sqlite3")
        for suffix in ("", *LOGS):
            with contextlib.suppress(FileNotFoundError):
                shutil.copyfile(self.path + suffix, copy + suffix)
        return copy

    def _connect(self, path: str, options: str) -> sqlite3.Connection:
        address = f"{pathlib.Path(path).resolve().as_uri()}?{options}"
        connection = sqlite3.connect(address, uri=True, timeout=BUSY_S, isolation_level=None)
        schema.add_functions(connection)
        connection.execute(f"PRAGMA cache_size = -{CACHE_KIB}")
        self._cleanup.callback(connection.close)
        return connection

    def _check(self, connection: sqlite3.Connection) -> int:
        """Check that this version can read the file; returns the version of its tables. From here on, all data is of
        the same moment. Raises sqlite3.Error, too."""
        connection.execute("BEGIN")
        if connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0:
            if self._has(has_damaged_log):
                raise self._damaged("its write-ahead log")
            raise JournalError(f"{self.path}: this journal is still empty: connect a robot first")
        if _pragma(connection, "application_id") != schema.APPLICATION_ID:
            raise JournalError(f"{self.path}: this database belongs to another program: name a box's journal")
        version = _pragma(connection, "user_version")
        if version > schema.VERSION:
            raise JournalError(
                f"{self.path}: a newer version of roah_rsbb wrote this journal (tables of version {version}, known up "
                f"to {schema.VERSION}): read it with that version"
            )
        if any(v not in schema.MIGRATIONS for v in range(version, schema.VERSION)):
            raise JournalError(
                f"{self.path}: its tables have version {version}, which this version of roah_rsbb no longer reads: "
                "read it with the version that wrote it"
            )
        found = _pragma(connection, "integrity_check(1)") if self._checks_all else "ok"
        if found != "ok":
            raise self._damaged(str(found))
        if version != schema.VERSION:
            connection.execute("COMMIT")
        return version

    def _damaged(self, what: str) -> JournalError:
        return JournalError(
            f"{self.path}: this journal is damaged, or not a journal ({what}). Look for another copy of it. To recover "
            f"its readable part: rosrun roah_rsbb results recover '{self.path}' NEW_FILE, then --journal NEW_FILE. "
            "The run logs (.bag) are separate files"
        )


def _pragma(connection: sqlite3.Connection, name: str) -> Any:
    return connection.execute(f"PRAGMA {name}").fetchone()[0]
