"""Converts records of runs to the messages that show them to the referees."""

from typing import Dict, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.scoring.counting import Why
from roah_rsbb.core.views.sheets import run_line, timeless
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.results import HistoryEntry, RunLine, RunSheet
from roah_rsbb.msg import Results, RunStop, RunSummary, ScoreChange
from roah_rsbb.msg import RunSheet as RunSheetMsg
from roah_rsbb.nodes.core.score_convert import item_message, points_message, score_message
from roah_rsbb.ros.times import ros_duration, ros_time


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
        records = [timeless(record) for record in self._box.scores.records(now)]
        why = {ruling.record.identity: ruling.why for ruling in self._box.scores.rulings(now)}
        self._summaries = {
            record.identity: (record, self._summary(record, why[record.identity])) for record in records}
        return Results(self._box_uuid, [summary for _, summary in self._summaries.values()])

    def _summary(self, record: RunRecord, why: Why) -> RunSummary:
        known, summary = self._summaries.get(record.identity, (None, None))
        return summary if known == record and summary.counts == why.value else summary_message(record, why)


def summary_message(record: RunRecord, why: Optional[Why]) -> RunSummary:
    """Convert a record to a line of /core/results. `why`: why it counts or not; None: not known."""
    return _line_message(run_line(record, why), record.scheduled)


def _line_message(line: RunLine, scheduled: float = 0.0) -> RunSummary:
    return RunSummary(
        identity=line.identity, revision=line.revision, zone=line.zone, code=line.code, team=line.team,
        round=line.round, run=line.run, schedule=ros_time(scheduled), opened=ros_time(line.opened_utc_s),
        started=ros_time(line.started_utc_s or 0.0), closed=ros_time(line.closed_utc_s or 0.0),
        end_reason=line.end_reason, score=line.score, corrected=line.corrected,
        signed=ros_time(line.signed_utc_s or 0.0), signed_by=line.signed_by, counts=line.counts,
    )


def sheet_message(sheet: RunSheet) -> RunSheetMsg:
    """Convert a run with its score sheet."""
    return RunSheetMsg(
        summary=_line_message(sheet.run),
        elapsed=ros_duration(sheet.elapsed_s),
        robots=list(sheet.robots),
        items=list(map(item_message, sheet.items)),
        history=[_change(entry) for entry in sheet.history],
        module_scores=[score_message(score) for score in sheet.module_scores],
        stops=[RunStop(ros_time(end.utc_s), end.who, end.end_reason, end.desc, end.reason, end.reason_by)
               for end in sheet.ends],
        points=points_message(sheet.points),
    )


def _change(entry: HistoryEntry) -> ScoreChange:
    return ScoreChange(
        number=entry.number, time=ros_time(entry.utc_s), who=entry.who, group=entry.group, desc=entry.item,
        old=entry.old, old_not_attempted=entry.old_not_attempted, value=entry.value,
        not_attempted=entry.not_attempted, note=entry.note, correction=entry.correction,
        withdrawn=ros_time(entry.withdrawn_utc_s or 0.0), withdrawn_by=entry.withdrawn_by,
        withdrawn_note=entry.withdrawn_note, withdrawal_corrects=entry.withdrawal_corrects,
        old_text=entry.old_text, text=entry.text, judge=entry.judge,
    )
