"""The scores of a fake core. It uses the real core's record of a run."""

import contextlib
import time
from typing import Dict, Iterator, List

import rospy

from roah_rsbb.core.clock import Now
from roah_rsbb.core.referee import Refused
from roah_rsbb.core.scoring.records import By, RunRecord
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.nodes.core.results_convert import sheet_message
from roah_rsbb.srv import GetRunSheet, GetRunSheetResponse, ScoreMark, ScoreWithdraw, SignOff, StopReason
from support.fakes.node import Answers

# The core's services for scores beside /core/set_score.
SCORE_SERVICES = {
    "/core/score": ScoreMark,
    "/core/score/withdraw": ScoreWithdraw,
    "/core/stop_reason": StopReason,
    "/core/sign_off": SignOff,
    "/core/run_sheet": GetRunSheet,
}
# In `FakeScores.calls`, instead of a value.
NOT_ATTEMPTED = -1


def present() -> Now:
    """The present moment, for the parts of the real core."""
    return Now(time.monotonic(), time.time())


class FakeScores:
    """A part of `FakeCore`, which has the zones."""

    zones: Dict[str, object]
    calls: List[tuple]
    words: List[tuple]  # (identity, note, referee) of the calls that have them

    def score_answers(self) -> Answers:
        """The answers of these services."""
        return {
            "/core/score": self._on_mark,
            "/core/score/withdraw": self._on_withdrawal,
            "/core/stop_reason": self._on_reason,
            "/core/sign_off": self._on_sign_off,
            "/core/run_sheet": self._on_run_sheet,
        }

    def records(self) -> List[RunRecord]:
        """All runs, as the real core has them."""
        zones = self.zones.values()
        connected = [zone.record() for zone in zones if zone.identity]
        return connected + [record for zone in zones for record in zone.finished.records()]

    def _is_connected(self, r: object) -> bool:
        return r.identity in ("", self.zones[r.zone].identity)

    def _on_mark(self, r: object) -> list:
        self.calls.append(("score", r.zone, r.group, r.desc, NOT_ATTEMPTED if r.not_attempted else r.value))
        self.words.append((r.identity, r.note, r.referee))
        self._answer()
        zone, mark = self.zones[r.zone], Mark(r.group, r.desc, r.value, r.not_attempted, r.note)
        with _refusing():
            if self._is_connected(r):
                zone.mark(mark, r.referee)
            else:
                zone.finished.find(r.identity).mark(present(), r.referee, mark)
        return []

    def _on_withdrawal(self, r: object) -> list:
        self.calls.append(("withdraw", r.zone, r.number))
        self.words.append((r.identity, r.note, r.referee))
        self._answer()
        zone, by = self.zones[r.zone], By(r.referee, r.note)
        with _refusing():
            if self._is_connected(r):
                marked = zone.book.withdraw(present(), by, r.number)
                zone.scores[(marked.item.group, marked.item.desc)] = marked.item.value
            else:
                zone.finished.find(r.identity).withdraw_score(present(), by, r.number)
        return []

    def _on_reason(self, r: object) -> list:
        self.calls.append(("stop_reason", r.zone, r.stop))
        self.words.append((r.identity, r.reason, r.referee))
        self._answer()
        zone, by = self.zones[r.zone], By(r.referee, r.reason)
        with _refusing():
            if self._is_connected(r):
                zone.book.give_reason(r.stop, by)
            else:
                zone.finished.find(r.identity).give_stop_reason(present(), by, r.stop)
        return []

    def _on_sign_off(self, r: object) -> list:
        self.calls.append(("sign_off", r.zone))
        self.words.append((r.identity, "", r.referee))
        self._answer()
        with _refusing():
            self.zones[r.zone].finished.find(r.identity).sign_off(present(), r.referee)
        return []

    def _on_run_sheet(self, r: object) -> GetRunSheetResponse:
        identity = r.identity or self.zones[r.zone].identity
        record = next((record for record in self.records() if record.identity == identity), None)
        if record is None:
            raise rospy.ServiceException(f"no run {r.identity}")
        return GetRunSheetResponse(sheet_message(record))


@contextlib.contextmanager
def _refusing() -> Iterator[None]:
    try:
        yield
    except Refused as refused:
        raise rospy.ServiceException(str(refused)) from None
