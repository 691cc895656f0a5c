"""Converts records of runs to the messages that show them to the referees."""

import json
import zlib
from typing import Dict, Iterable, List, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.scoring.counting import Why
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import ItemRecord, RunRecord, ScoreEntry, StopRecord, grouped
from roah_rsbb.model.saved import freeze
from roah_rsbb.msg import Results, RunSheet, RunStop, RunSummary, ScoreChange
from roah_rsbb.nodes.core.score_convert import points_message, score_message, sheet_items
from roah_rsbb.ros.times import ros_duration, ros_time
from roah_rsbb.wording.sheets import GroupOfValues, author, points_text, sums_text


class ResultsBoard:
    """Builds /core/results of a box when it has changed."""

    def __init__(self, box: Box, box_uuid: str) -> None:
        self._box = box
        self._box_uuid = box_uuid
        self._changed = True
        self._connected: Tuple[str, ...] = ()
        self._summaries: Dict[str, Tuple[RunRecord, RunSummary]] = {}  # by identity

    def on_record_changed(self) -> None:
        """Note that a record changed."""
        self._changed = True

    def take(self, now: Now) -> Optional[Results]:
        """Return the message if it differs from the last one, else None."""
        connected = tuple(zone.run.identity for zone in self._box.zones.values() if zone.run is not None)
        if not self._changed and connected == self._connected:
            return None
        self._changed, self._connected = False, connected
        records = [_timeless(record) for record in self._box.scores.records(now)]
        why = {ruling.record.identity: ruling.why for ruling in self._box.scores.rulings(now)}
        self._summaries = {
            record.identity: (record, self._summary(record, why[record.identity])) for record in records}
        return Results(self._box_uuid, [summary for _, summary in self._summaries.values()])

    def _summary(self, record: RunRecord, why: Why) -> RunSummary:
        known, summary = self._summaries.get(record.identity, (None, None))
        return summary if known == record and summary.counts == why.value else summary_message(record, why)


def summary_message(record: RunRecord, why: Optional[Why]) -> RunSummary:
    """Convert a record to a line of /core/results. `why`: why it counts or not; None: not known."""
    signed = record.sign_off
    return RunSummary(
        identity=record.identity,
        revision=_revision(record),
        zone=record.zone,
        code=record.benchmark,
        team=record.team,
        round=record.round,
        run=record.run,
        schedule=ros_time(record.scheduled),
        opened=ros_time(record.opened_utc),
        started=ros_time(record.started_utc),
        closed=ros_time(record.closed_utc),
        end_reason=record.end_reason,
        score=sums_of_record(record),
        corrected=any(item.corrected for item in record.items),
        signed=ros_time(0.0 if signed is None else signed.utc),
        signed_by="" if signed is None else signed.who,
        counts="" if why is None else why.value,
    )


def sums_of_record(record: RunRecord) -> str:
    """The points of a run's score sheet, or the sums of its groups if it gives none."""
    return sums_text(_groups(record.items)) if record.points is None else points_text(*record.points)


def sheet_message(record: RunRecord, why: Optional[Why]) -> RunSheet:
    """Convert a record to the complete sheet."""
    return RunSheet(
        summary=summary_message(record, why),
        elapsed=ros_duration(record.elapsed_s),
        robots=list(record.robots),
        items=sheet_items(record.items, record.form),
        history=[_change(entry) for entry in record.history],
        module_scores=[score_message(score) for score in record.module_scores],
        stops=[_stop(stop) for stop in record.stops],
        points=points_message(record.points),
    )


def _timeless(record: RunRecord) -> RunRecord:
    """Return the record without values that change with time only."""
    return record._replace(elapsed_s=0.0)


def _revision(record: RunRecord) -> int:
    return zlib.crc32(json.dumps(freeze(_timeless(record))).encode())


def _groups(items: Iterable[ItemRecord]) -> List[GroupOfValues]:
    return [
        GroupOfValues(name, [item.value for item in group if not item.text], sum(item.not_attempted for item in group))
        for name, group in grouped(items).items()
    ]


def _change(entry: ScoreEntry) -> ScoreChange:
    return ScoreChange(
        number=entry.number,
        time=ros_time(entry.utc),
        who=author(entry.who, entry.role, entry.device),
        group=entry.group,
        desc=entry.desc,
        old=entry.old,
        old_not_attempted=entry.old_not_attempted,
        value=entry.value,
        not_attempted=entry.not_attempted,
        note=entry.note,
        correction=entry.correction,
        withdrawn=ros_time(entry.withdrawn_utc),
        withdrawn_by=entry.withdrawn_by,
        withdrawn_note=entry.withdrawn_note,
        withdrawal_corrects=entry.withdrawal_corrects,
        old_text=entry.old_text,
        text=entry.text,
        judge=entry.judge,
    )


def _stop(stop: StopRecord) -> RunStop:
    return RunStop(ros_time(stop.utc), stop.who, stop.end_reason, stop.desc, stop.reason, stop.reason_by)
