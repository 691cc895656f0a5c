"""Converts the judging of runs to the messages for judges and referees."""

from typing import Optional

from roah_rsbb.core.box import Box
from roah_rsbb.core.judges.desk import Judging as RunJudging
from roah_rsbb.core.views.sheets import judged_run, judging
from roah_rsbb.model.clock import Now
from roah_rsbb.model.judging import AGREED, DIFFER, NOT_JUDGED, SETTLED, JudgedItem, Judging
from roah_rsbb.msg import JudgedItem as JudgedItemMsg
from roah_rsbb.msg import JudgeState, Judgings, Objection
from roah_rsbb.msg import Judging as JudgingMsg
from roah_rsbb.nodes.core.score_convert import item_message
from roah_rsbb.ros.times import ros_time
from roah_rsbb.srv import GetJudgingResponse

# By the numbers in JudgedItem.
_OUTCOMES = (AGREED, DIFFER, SETTLED, NOT_JUDGED)


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
        message = Judgings(self._box_uuid, [judging_message(one) for one in self._box.judges.unsigned(now)])
        if message == self._last:
            return None
        self._last = message
        return message


def judging_message(found: RunJudging) -> JudgingMsg:
    """The progress of the judges, without any values."""
    return _message(judging(found))


def _message(one: Judging) -> JudgingMsg:
    return JudgingMsg(
        zone=one.zone, identity=one.identity, revision=one.revision, count=one.count, rule=one.rule,
        missing=one.missing, complete=one.complete,
        judges=[JudgeState(judge.judge, "", ros_time(judge.submitted_utc_s or 0.0), judge.again)
                for judge in one.judges],
        waiver=one.waiver, differences=one.differences, published=ros_time(one.published_utc_s or 0.0),
        objections_until=ros_time(one.objections_until_utc_s or 0.0), open_objections=one.open_objections,
    )


def answer(found: RunJudging) -> GetJudgingResponse:
    """What a judge or the head referee may see."""
    run = judged_run(found)
    return GetJudgingResponse(
        state=_message(run.judging), submitted=run.submitted, again=run.again, own=list(map(item_message, run.own)),
        items=list(map(item_message, run.items)), judged=list(map(_judged, run.judged)),
        objections=[Objection(
            one.number, ros_time(one.utc_s), one.by, one.text, one.who, ros_time(one.answered_utc_s or 0.0),
            one.answered_by, one.upheld, one.answer) for one in run.objections],
    )


def _judged(one: JudgedItem) -> JudgedItemMsg:
    return JudgedItemMsg(
        one.item.group, one.item.desc, _OUTCOMES.index(one.outcome), [given.judge for given in one.given],
        [given.value for given in one.given], [given.text for given in one.given],
        [given.not_attempted for given in one.given], one.who, one.reason,
    )
