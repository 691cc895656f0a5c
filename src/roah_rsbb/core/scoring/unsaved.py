"""Which parts of the runs' records are not on the disk yet.

A score or sign-off counts as soon as it is given, also while the disk cannot take it. Referees see what would be lost.
"""

from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.scoring.records import RunRecord

# The disk takes what happens within a moment; only what waits longer is shown.
SHOWN_AFTER_S = 0.5


class UnsavedParts(NamedTuple):
    """What of a run's record is not on the disk yet."""

    identity: str
    zone: str
    entries: Tuple[int, ...]  # numbers of entries of the history that are new, or were withdrawn
    stops: Tuple[int, ...]  # numbers of ends, from 1, that are new or whose reason changed
    sign_off: bool


class _Waiting(NamedTuple):
    ticket: int  # of the journal's write
    mono: float
    record: RunRecord


def unsaved_parts(saved: Optional[RunRecord], present: RunRecord) -> UnsavedParts:
    """What the present record has and the saved one has not; None: nothing of the run is saved."""
    known = set() if saved is None else set(saved.history)
    stops = () if saved is None else saved.stops
    return UnsavedParts(
        present.identity, present.zone,
        tuple(entry.number for entry in present.history if entry not in known),
        tuple(i for i, stop in enumerate(present.stops, 1) if stop not in stops),
        present.sign_off is not None and (saved is None or saved.sign_off != present.sign_off),
    )


class Unsaved:
    """Compares the records that are on the disk with the present ones."""

    def __init__(self) -> None:
        self._saved: Dict[str, RunRecord] = {}
        self._waiting: List[_Waiting] = []

    def restore(self, records: Iterable[RunRecord]) -> None:
        """Records that were read from the disk."""
        self._saved.update((record.identity, record) for record in records)

    def changed(self, mono: float, ticket: int, record: RunRecord) -> None:
        """A record was handed to the journal with this ticket."""
        self._waiting.append(_Waiting(ticket, mono, record))

    def look(self, mono: float, saved_ticket: int) -> Tuple[UnsavedParts, ...]:
        """What has been waiting for the disk for a while; tickets up to `saved_ticket` are on it."""
        done = [w for w in self._waiting if w.ticket <= saved_ticket]
        self._waiting = [w for w in self._waiting if w.ticket > saved_ticket]
        self._saved.update((w.record.identity, w.record) for w in done)
        present = {w.record.identity: w.record for w in self._waiting if mono - w.mono >= SHOWN_AFTER_S}
        found = (unsaved_parts(self._saved.get(identity), record) for identity, record in present.items())
        return tuple(parts for parts in found if parts.entries or parts.stops or parts.sign_off)
