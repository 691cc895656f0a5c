"""What happened in a run, of its record, as faces and results show it."""

from typing import Iterable, Tuple

from roah_rsbb.model.records import ItemRecord, RunRecord, ScoreEntry
from roah_rsbb.model.results import HistoryEntry, ProposedMark, RunEnd, RunTimeline
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.scoring.tree import is_late
from roah_rsbb.wording.sheets import history_entry

_TYPES = frozenset(kind.word for kind in ScoreKind)


def type_of(record: ItemRecord) -> str:
    """Return an item's type; unknown types are counts."""
    return record.kind if record.kind in _TYPES else ScoreKind.UINT.word


def run_timeline(record: RunRecord) -> RunTimeline:
    """Return what happened in a run."""
    signed = record.sign_off
    return RunTimeline(
        record.identity, record.opened_utc,
        tuple(entry._replace(late=is_late(entry.void)) if entry.void else entry
              for entry in _entries(record, record.history)),
        tuple(RunEnd(number, stop.utc, stop.who, stop.end_reason, stop.desc, stop.reason, stop.reason_by, stop.clock_s)
              for number, stop in enumerate(record.stops, 1)),
        record.timeline, record.outages, record.closed_utc or None, None if signed is None else signed.utc,
        "" if signed is None else signed.who, _proposals(record), record.captain)


def _entries(record: RunRecord, entries: Iterable[ScoreEntry]) -> Iterable[HistoryEntry]:
    items = {item.key: (type_of(item), item.unit) for item in record.items}
    return (history_entry(entry, *items.get((entry.group, entry.desc), ("uint", ""))) for entry in entries)


def _proposals(record: RunRecord) -> Tuple[ProposedMark, ...]:
    entries = _entries(record, [each.entry for each in record.proposals])
    return tuple(ProposedMark(each.number, entry, each.decided_utc or None, each.decided_by, each.accepted, each.reason)
                 for each, entry in zip(record.proposals, entries))
