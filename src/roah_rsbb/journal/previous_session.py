"""The state that the previous session of the core left in the journal."""

import sqlite3
from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.journal import schema
from roah_rsbb.journal.file import CoreSession

# Number of runs whose records are restored, so that referees can correct them: as many as the core keeps.
MAX_OUTCOMES = 400


class PreviousSession(NamedTuple):
    """Everything that a core needs to resume."""

    states: Dict[str, str]  # by name; JSON
    outcomes: Tuple[str, ...]  # JSON of the records of the newest runs, including active ones; oldest first
    log_files: Dict[int, str]  # path of the run log by port
    last_port: Optional[int]  # the highest used private port
    last: Optional[CoreSession]  # the previous session, with the times of its last record


NOTHING = PreviousSession({}, (), {}, None, None)


def read_previous_session(connection: sqlite3.Connection) -> PreviousSession:
    """Read the state before the new session is written. Damaged rows are omitted. Raises sqlite3.Error."""
    outcomes = connection.execute(
        f"SELECT outcome FROM runs WHERE outcome IS NOT NULL AND crc IS {schema.crc_of('runs')}"
        " ORDER BY opened_utc DESC LIMIT ?", (MAX_OUTCOMES,)).fetchall()
    return PreviousSession(
        states=dict(connection.execute(f"SELECT name, state FROM states WHERE crc IS {schema.crc_of('states')}")),
        outcomes=tuple(outcome for (outcome,) in reversed(outcomes)),
        log_files=dict(connection.execute("SELECT port, log_file FROM members WHERE log_file IS NOT NULL")),
        last_port=connection.execute("SELECT max(port) FROM members").fetchone()[0],
        last=_last_session(connection),
    )


def _last_session(connection: sqlite3.Connection) -> Optional[CoreSession]:
    row = connection.execute(
        "SELECT id, utc, mono, boot_id, pid, box_uuid, launch FROM sessions ORDER BY id DESC LIMIT 1").fetchone()
    if row is None:
        return None
    number, session = row[0], CoreSession(*row[1:])
    newest = [(session.mono, session.utc)]
    newest += connection.execute(
        "SELECT mono, utc FROM entries WHERE session = ? ORDER BY id DESC LIMIT 1", (number,)).fetchall()
    newest += connection.execute(
        "SELECT mono, utc FROM links WHERE mono >= ? ORDER BY rowid DESC LIMIT 1", (session.mono,)).fetchall()
    # SQLite returns any value from a damaged file, even if it is not a number.
    times = [(mono, utc) for mono, utc in newest if _is_time(mono) and _is_time(utc)]
    if not times:
        return None
    mono, utc = max(times)
    return session._replace(mono=mono, utc=utc)


def _is_time(value: object) -> bool:
    return isinstance(value, float) and abs(value) < 1e12
