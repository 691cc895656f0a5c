"""Converts the judging of runs to the messages for judges and referees."""

import json
import zlib
from typing import Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.judges.desk import Judging
from roah_rsbb.core.judges.judges import Verdict
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import JudgeSheet
from roah_rsbb.model.records import Objection as ObjectionRecord
from roah_rsbb.model.saved import freeze
from roah_rsbb.msg import JudgedItem, JudgeState, Judgings, Objection
from roah_rsbb.msg import Judging as JudgingMsg
from roah_rsbb.nodes.core.score_convert import sheet_items
from roah_rsbb.ros.times import ros_time
from roah_rsbb.srv import GetJudgingResponse


class JudgingBoard:
    """Builds /core/judging of a box when it has changed."""

    def __init__(self, box: Box, box_uuid: str) -> None:
        self._box = box
        self._box_uuid = box_uuid
        self._changed = True
        self._last: Optional[Judgings] = None

    def on_record_changed(self) -> None:
        """Note that a record changed."""
        self._changed = True

    def take(self, now: Now) -> Optional[Judgings]:
        """Return the message if it differs from the last one, else None."""
        if not self._changed:
            return None
        self._changed = False
        message = Judgings(self._box_uuid, [judging_message(judging) for judging in self._box.judges.unsigned(now)])
        if message == self._last:
            return None
        self._last = message
        return message


def judging_message(judging: Judging) -> JudgingMsg:
    """The progress of the judges, without any values."""
    record = judging.record
    published, waiver = record.publication.published, record.judging.waiver
    return JudgingMsg(
        zone=record.zone, identity=record.identity, revision=_revision(judging), count=judging.count,
        rule=judging.agreement, missing=judging.missing, complete=judging.is_complete,
        judges=[_judge(sheet) for sheet in judging.active], waiver="" if waiver is None else waiver.reason,
        differences=sum(v.value is None and bool(v.proposals) for v in judging.verdicts),
        published=ros_time(0.0 if published is None else published.utc),
        objections_until=ros_time(0.0 if published is None else published.until_utc),
        open_objections=sum(not one.answered_utc for one in record.publication.objections),
    )


def answer(judging: Judging) -> GetJudgingResponse:
    """What a judge or the head referee may see."""
    record, own = judging.record, judging.own
    return GetJudgingResponse(
        state=judging_message(judging), submitted=own is not None and bool(own.submitted_utc),
        again="" if own is None else own.again, own=sheet_items(judging.own_items, judging.own_form),
        items=sheet_items(record.items, record.form),
        judged=[_judged(verdict, judging.active) for verdict in judging.verdicts],
        objections=[_objection(one) for one in record.publication.objections],
    )


def _judge(sheet: JudgeSheet) -> JudgeState:
    return JudgeState(sheet.judge, sheet.device, ros_time(sheet.submitted_utc), sheet.again)


def _judged(verdict: Verdict, sheets: Tuple[JudgeSheet, ...]) -> JudgedItem:
    given = [(sheet.judge, item) for sheet in sheets for item in sheet.items if item.key == verdict.item.key]
    outcome = JudgedItem.DIFFERS if given else JudgedItem.NOT_JUDGED
    if verdict.value is not None:
        outcome = JudgedItem.SETTLED if verdict.is_settled else JudgedItem.AGREED
    return JudgedItem(
        *verdict.item.key, outcome, [judge for judge, _ in given], [item.value for _, item in given],
        [item.text for _, item in given], [item.not_attempted for _, item in given],
        verdict.who if verdict.is_settled else "", verdict.reason,
    )


def _objection(one: ObjectionRecord) -> Objection:
    return Objection(
        one.number, ros_time(one.utc), one.by, one.text, one.who, ros_time(one.answered_utc), one.answered_by,
        one.upheld, one.answer,
    )


def _revision(judging: Judging) -> int:
    """A checksum of all that `answer` depends on."""
    record = judging.record
    return zlib.crc32(json.dumps(freeze((record.judging, record.publication, record.items))).encode())
