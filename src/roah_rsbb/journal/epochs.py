"""Epochs: which of two computers with copies of one journal is the box (docs/standby.md, "How it works").

Each takeover raises the epoch of the journal that it continues, with an entry of its own. A box that hears of a higher
epoch than its own writes an entry, too, and is superseded from then on. The newest entries alone say what is in force.
"""

import contextlib
import json
import os
import sqlite3
from typing import List, NamedTuple, Tuple

from roah_rsbb.journal import kinds, schema

FIRST = 1
# Entries that no core wrote. A core's restart finds the end of the previous core by its session.
NO_SESSION, NO_MONO = 0, 0.0

# Keys of an entry's value: a takeover has "epoch", the end of a superseded box "superseded_by".
_EPOCH, _SUPERSEDED_BY, _CUT, _BY = "epoch", "superseded_by", "cut", "by"


class Standing(NamedTuple):
    """What a journal says about its box."""

    epoch: int = FIRST
    superseded_by: int = 0  # the epoch of the box that took over from this one; 0: none
    cut: int = 0  # number of the last entry that both journals have
    by: str = ""  # address of the box that took over

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over from this one."""
        return self.superseded_by > 0


def superseded_value(epoch: int, cut: int, by: str) -> dict:
    """Return the value of the entry of a box that was superseded."""
    return {_SUPERSEDED_BY: epoch, _CUT: cut, _BY: by}


def read_standing(connection: sqlite3.Connection) -> Standing:
    """Read what is in force. Raises sqlite3.Error."""
    # Entries of no run are few, and the index finds them.
    rows = connection.execute(
        f"SELECT value FROM entries WHERE identity = '' AND kind = ? AND crc IS {schema.crc_of('entries')} ORDER BY id",
        (kinds.EPOCH,)).fetchall()
    standing = Standing()
    for (text,) in rows:
        with contextlib.suppress(ValueError, TypeError, AttributeError):
            standing = _after(standing, json.loads(text))
    return standing


def _after(standing: Standing, value: dict) -> Standing:
    epoch, superseded_by = int(value.get(_EPOCH, 0)), int(value.get(_SUPERSEDED_BY, 0))
    if epoch > max(standing.epoch, standing.superseded_by):
        return Standing(epoch, cut=int(value.get(_CUT, 0)))
    if superseded_by >= standing.epoch and superseded_by > standing.superseded_by:
        return standing._replace(superseded_by=superseded_by, cut=int(value.get(_CUT, 0)), by=str(value.get(_BY, "")))
    return standing


def standing_in(path: str) -> Standing:
    """Read what a journal says; the first epoch if it cannot be read."""
    if not os.path.exists(path):
        return Standing()
    with contextlib.suppress(sqlite3.Error), contextlib.closing(sqlite3.connect(path, timeout=1.0)) as connection:
        connection.execute("PRAGMA query_only = ON")
        schema.add_functions(connection)
        if schema.is_readable(connection):
            return read_standing(connection)
    return Standing()


def raise_epoch(path: str, utc: float, who: str) -> Standing:
    """Raise the epoch of a journal that no core uses. It is on the disk when this returns. Raises sqlite3.Error."""
    with contextlib.closing(sqlite3.connect(path, timeout=1.0, isolation_level=None)) as connection:
        schema.add_functions(connection)
        connection.execute("PRAGMA synchronous = FULL")
        before = read_standing(connection)
        (cut,) = connection.execute("SELECT ifnull(max(id), 0) FROM entries").fetchone()
        value = {_EPOCH: max(before.epoch, before.superseded_by) + 1, _CUT: cut}
        connection.execute(schema.insertion("entries"), (
            NO_SESSION, utc, NO_MONO, "", "", None, who, kinds.EPOCH, json.dumps(value)))
        return read_standing(connection)


def only_here(connection: sqlite3.Connection, standing: Standing) -> List[Tuple[str, int]]:
    """Return the runs with entries that the box which took over does not have, and how many. Raises sqlite3.Error."""
    if not standing.is_superseded:
        return []
    return connection.execute(
        "SELECT identity, count(*) FROM entries WHERE id > ? AND identity != '' GROUP BY identity ORDER BY min(id)",
        (standing.cut,)).fetchall()
