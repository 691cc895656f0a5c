"""Tracks which parts of the runs' records are not on the disk yet.

A score or sign-off counts at once, even while the disk cannot be written. Referees see what would be lost.
"""

import math
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.scoring.book import MAX_KEPT

# Seconds. Usually the disk is faster, so only what waits longer is shown.
SHOWN_AFTER_S = 0.5


class _Waiting(NamedTuple):
    ticket: int  # of the journal's write
    mono: float
    record: RunRecord


def unsaved_parts(saved: Optional[RunRecord], present: RunRecord) -> UnsavedParts:
    """Compare the present record with the saved one. None: no record of the run is saved."""
    known = set() if saved is None else set(saved.history)
    stops = () if saved is None else saved.stops
    return UnsavedParts(
        present.identity, present.zone,
        tuple(entry.number for entry in present.history if entry not in known),
        tuple(i for i, stop in enumerate(present.stops, 1) if stop not in stops),
        present.sign_off is not None and (saved is None or saved.sign_off != present.sign_off),
    )


class Unsaved:
    """Compares the present records with those on the disk."""

    def __init__(self) -> None:
        self._saved: Dict[str, RunRecord] = {}  # by identity, the one that changed last at the end
        self._waiting: List[_Waiting] = []

    def restore(self, records: Iterable[RunRecord]) -> None:
        """Take the records that were read from the disk."""
        for record in sorted(records, key=lambda record: record.closed_utc or math.inf):
            self._keep(record)

    def changed(self, mono: float, ticket: int, record: RunRecord) -> None:
        """Note that a record was passed to the journal with this ticket."""
        self._waiting.append(_Waiting(ticket, mono, record))

    def look(self, mono: float, saved_ticket: int) -> Tuple[UnsavedParts, ...]:
        """Return what has been waiting for the disk for a while. Tickets up to `saved_ticket` are on it."""
        if not self._waiting:
            return ()
        done = [w for w in self._waiting if w.ticket <= saved_ticket]
        self._waiting = [w for w in self._waiting if w.ticket > saved_ticket]
        for each in done:
            self._keep(each.record)
        present = {w.record.identity: w.record for w in self._waiting if mono - w.mono >= SHOWN_AFTER_S}
        found = (unsaved_parts(self._saved.get(identity), record) for identity, record in present.items())
        return tuple(parts for parts in found if parts.entries or parts.stops or parts.sign_off)

    def _keep(self, record: RunRecord) -> None:
        """Keep a saved record. Only runs in progress and the newest finished ones still change."""
        self._saved.pop(record.identity, None)
        self._saved[record.identity] = record
        while len(self._saved) > 2 * MAX_KEPT:
            del self._saved[next(iter(self._saved))]
