"""Reads a journal: of the competition that goes on, of a past one, of a copy. Never changes it.

Beside a running box it reads what was committed when it was opened. A journal that nobody writes is left as it
is, without even the files that SQLite keeps beside one. Where it lies in a directory that cannot be written, and
when its tables are of an older version, a copy is read, which is removed again.
"""

import contextlib
import json
import os
import pathlib
import shutil
import sqlite3
import tempfile
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal import schema
from roah_rsbb.journal.damage import find_damage, last_moment, text_of
from roah_rsbb.journal.pages import has_damaged_log, has_torn_log

# For so long the box may hold the file where its file system knows no write-ahead log.
BUSY_S = 5.0
# A copy that was made while the box wrote may be torn: then another one is made.
COPIES = 3

# What SQLite keeps beside a file that is written, besides what can be made again.
LOG_SUFFIX = "-wal"
LOGS = (LOG_SUFFIX, "-journal")
# The byte of the file's header that tells a write-ahead log, and its value.
READ_VERSION_AT, WRITE_AHEAD = 19, 2


class JournalError(Exception):
    """A journal that cannot be read; the text names the file and the remedy."""


class JournalSession(NamedTuple):
    """One start of the core."""

    number: int
    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock
    boot_id: str  # of the computer's start: another one has another monotonic clock
    pid: int
    box_uuid: str
    launch: str


class JournalRun(NamedTuple):
    """A run, from *connect* on."""

    identity: str
    zone: str
    benchmark: str  # code
    team: str
    round: int
    run: int
    scheduled: float  # UTC seconds
    opened_utc: float  # UTC seconds of *connect*
    closed_utc: Optional[float]  # UTC seconds of *disconnect*; None: still connected
    outcome: Dict[str, Any]  # the core's RunRecord, fields that have their default left out; empty: none yet


class JournalMember(NamedTuple):
    """A robot's part in a run."""

    port: int  # UDP port of its private channel: no other robot in no other run has it
    identity: str
    team: str
    robot: str
    log_file: str  # path of its run log, where the box was; empty: none


class JournalEntry(NamedTuple):
    """One thing that happened."""

    number: int  # rising, in order
    session: int
    utc: float  # UTC seconds
    mono: float  # seconds on the session's monotonic clock
    zone: str
    identity: str  # of the run; empty: it belongs to none
    port: Optional[int]  # of the robot; None: it belongs to no robot
    who: str  # who did it; empty: the box
    kind: str
    value: Any  # JSON's value


class JournalLink(NamedTuple):
    """A second of a robot's link record."""

    port: int
    utc: float  # UTC seconds
    mono: float
    sample: Dict[str, Any]  # the core's LinkSample, fields that have their default left out


_RUN = "identity, zone, benchmark, team, round, run, scheduled, opened_utc, closed_utc, outcome"
_ENTRY = "id, session, utc, mono, zone, identity, port, who, kind, value"


class JournalReader:
    """One journal as it was when it was opened. Use it in a `with`, or call `close`; every method raises
    `JournalError`."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._cleanup = contextlib.ExitStack()
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
        """Let go of the file."""
        self._cleanup.close()

    # -- what is in it ------------------------------------------------------------------------------

    def meta(self) -> Dict[str, str]:
        """What is known of the whole journal, such as the competition's events (JSON)."""
        return dict(self._rows("SELECT key, value FROM meta"))

    def sessions(self) -> List[JournalSession]:
        """All starts of the core, in order."""
        rows = self._rows("SELECT id, utc, mono, boot_id, pid, box_uuid, launch FROM sessions ORDER BY id")
        return [JournalSession(*row) for row in rows]

    def runs(self) -> List[JournalRun]:
        """All runs, in the order in which they were connected."""
        return [self._run(row) for row in self._rows(f"SELECT {_RUN} FROM runs ORDER BY opened_utc, identity")]

    def run(self, identity: str) -> Optional[JournalRun]:
        """A run; None: there is none of that name."""
        rows = self._rows(f"SELECT {_RUN} FROM runs WHERE identity = ?", identity)
        return self._run(rows[0]) if rows else None

    def members(self, identity: str) -> List[JournalMember]:
        """The robots of a run."""
        rows = self._rows(
            "SELECT port, identity, team, robot, coalesce(log_file, '') FROM members WHERE identity = ? ORDER BY port",
            identity,
        )
        return [JournalMember(*row) for row in rows]

    def entries(self, identity: str) -> List[JournalEntry]:
        """All that happened in a run, in order."""
        return self._entries("identity = ?", identity)

    def commands(self, zone: str) -> List[JournalEntry]:
        """The referees' commands to a zone, also those that were refused, in order."""
        return self._entries("zone = ? AND kind = 'command'", zone)

    def links(self, port: int) -> List[JournalLink]:
        """The link record of a robot, in order."""
        rows = self._rows("SELECT port, utc, mono, sample FROM links WHERE port = ? ORDER BY rowid", port)
        return [JournalLink(*row[:3], self._json(row[3])) for row in rows]

    def _entries(self, where: str, *values: object) -> List[JournalEntry]:
        rows = self._rows(f"SELECT {_ENTRY} FROM entries WHERE {where} ORDER BY id", *values)
        return [JournalEntry(*row[:-1], self._json(row[-1])) for row in rows]

    def _run(self, row: Tuple[Any, ...]) -> JournalRun:
        return JournalRun(*row[:-1], {} if row[-1] is None else self._json(row[-1]))

    def _json(self, text: str) -> Any:
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:
            raise self._damaged(f"{error}: {text[:40]!r}") from None

    def _rows(self, statement: str, *values: object) -> List[Tuple[Any, ...]]:
        try:
            return self._connection.execute(statement, values).fetchall()
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None

    @property
    def damage(self) -> List[str]:
        """What is damaged or missing in the journal, with from when to when. The rest is read all the same."""
        try:
            found = [text_of(damage) for damage in find_damage(self._connection)]
            if self._has(has_damaged_log):
                found.append(f"the write-ahead log: what happened after {last_moment(self._connection)} cannot be read")
            elif self._has(has_torn_log):
                found.append("the end of the write-ahead log is torn or damaged: what happened after "
                             f"{last_moment(self._connection)} may be missing")
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None
        return found

    def _has(self, damage: Callable[[str], bool]) -> bool:
        """A box may write while this looks: damage is found again."""
        with contextlib.suppress(OSError):
            return all(damage(self.path) for _ in range(COPIES))
        return False

    # -- opening ------------------------------------------------------------------------------------

    def _open(self) -> sqlite3.Connection:
        if not os.path.isfile(self.path):
            raise JournalError(
                f"{self.path}: there is no such file. A box keeps its journal in its log_dir, from its first start "
                "on: name it with --journal FILE"
            )
        try:
            connection = self._connect(self.path, "immutable=1" if self._is_at_rest() else "mode=ro")
            version = self._check(connection)
        except sqlite3.OperationalError:
            return self._open_copy()
        except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
            raise self._damaged(str(error)) from None
        return connection if version == schema.VERSION else self._open_copy()

    def _is_at_rest(self) -> bool:
        """Whether nobody writes the file: SQLite would only leave files beside it."""
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
        self._cleanup.callback(connection.close)
        return connection

    def _check(self, connection: sqlite3.Connection) -> int:
        """See that this version can read the file; returns the version of its tables. From here on what is read is of
        one moment. Raises sqlite3.Error, too."""
        connection.execute("BEGIN")
        if connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0:
            if self._has(has_damaged_log):
                raise self._damaged("its write-ahead log")
            raise JournalError(f"{self.path}: nothing was written to this journal yet: connect a robot first")
        if _pragma(connection, "application_id") != schema.APPLICATION_ID:
            raise JournalError(f"{self.path}: this is another program's database: name a box's journal")
        version = _pragma(connection, "user_version")
        if version > schema.VERSION:
            raise JournalError(
                f"{self.path}: a newer version of roah_rsbb wrote this journal (its tables have version {version}, "
                f"known are {schema.VERSION}): read it with that version"
            )
        if any(v not in schema.MIGRATIONS for v in range(version, schema.VERSION)):
            raise JournalError(
                f"{self.path}: its tables have version {version}, which this version of roah_rsbb does not know any "
                "more: read it with the version that wrote it"
            )
        found = _pragma(connection, "integrity_check(1)")
        if found != "ok":
            raise self._damaged(str(found))
        if version != schema.VERSION:
            connection.execute("COMMIT")
        return version

    def _damaged(self, what: str) -> JournalError:
        return JournalError(
            f"{self.path}: this journal is damaged, or no journal at all ({what}). Look for another copy of it. What "
            f"can be had of it: rosrun roah_rsbb results recover '{self.path}' NEW_FILE, then --journal NEW_FILE. "
            "The run logs (.bag) are files of their own"
        )


def _pragma(connection: sqlite3.Connection, name: str) -> Any:
    return connection.execute(f"PRAGMA {name}").fetchone()[0]
