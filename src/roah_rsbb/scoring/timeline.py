"""What happened in a run, of its record, as faces and results show it."""

from typing import Iterable, Tuple

from roah_rsbb.model.records import CaptainSign, ItemRecord, RunRecord, ScoreEntry
from roah_rsbb.model.results import HistoryEntry, ProposedMark, RunEnd, RunTimeline, VersionLine
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
        "" if signed is None else signed.who, _proposals(record), captain_signs(record), version_lines(record),
        record.changes, record.publication.objections)


def version_lines(record: RunRecord) -> Tuple[VersionLine, ...]:
    """Return the signed sheets of a run that other versions replaced."""
    found = []
    for number, version in enumerate(record.versions, 1):
        after = record.versions[number] if number < len(record.versions) else record
        then, signed = {item.key: item for item in after.items}, after.sign_off
        changed = tuple((item, then[item.key]) for item in version.items if item.key in then and _value_of(item)
                        != _value_of(then[item.key]))
        by = next((change.undone_by or change.who for change in record.changes
                   if version.replaced_utc in (change.utc, change.undone_utc)), "" if signed is None else signed.who)
        points, later = ("" if each.points is None else each.points.total for each in (version, after))
        found.append(VersionLine(number, version.sign_off.utc, version.sign_off.who, version.replaced_utc, by,
                                 version.why, points, later, changed))
    return tuple(found)


def _value_of(item: ItemRecord) -> Tuple[object, ...]:
    return item.value, item.text, item.not_attempted, item.points


def captain_signs(record: RunRecord) -> Tuple[CaptainSign, ...]:
    """Return the captain's signatures, with whether the sheet was corrected after them."""
    changed = [utc for entry in record.history for utc in (entry.utc, entry.arrived_utc, entry.withdrawn_utc)]
    changed += [line.replaced_utc_s for line in version_lines(record)
                if line.changed or line.points != line.then_points]
    last = max(changed, default=0.0)
    return tuple(sign._replace(outdated=True) if sign.utc < last else sign for sign in record.captain)


def _entries(record: RunRecord, entries: Iterable[ScoreEntry]) -> Iterable[HistoryEntry]:
    items = {item.key: (type_of(item), item.unit) for item in record.items}
    return (history_entry(entry, *items.get((entry.group, entry.desc), ("uint", ""))) for entry in entries)


def _proposals(record: RunRecord) -> Tuple[ProposedMark, ...]:
    entries = _entries(record, [each.entry for each in record.proposals])
    return tuple(ProposedMark(each.number, entry, each.decided_utc or None, each.decided_by, each.accepted, each.reason)
                 for each, entry in zip(record.proposals, entries))
