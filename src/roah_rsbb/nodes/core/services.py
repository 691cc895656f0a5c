"""The services of the core node (docs/ros_interface.md, "Core node"): each is one event for the box."""

import json
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import rospy

from roah_rsbb.box import standby_answers
from roah_rsbb.core.actions.table import NOTHING, Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.judges.desk import Judging
from roah_rsbb.core.scoring.counting import Why
from roah_rsbb.model.actions import ACTIONS, EVERY, MARK, STOP
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.referee import Refused, RunName
from roah_rsbb.nodes.core import judging_convert
from roah_rsbb.nodes.core.results_convert import sheet_message
from roah_rsbb.ros import refusals, texts
from roah_rsbb.ros.connections import REFEREE_HEADER
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.times import ros_time
from roah_rsbb.srv import (
    Act,
    ActResponse,
    GetClock,
    GetClockResponse,
    GetJudging,
    GetJudgingResponse,
    GetRunSheet,
    GetRunSheetResponse,
    StopRun,
    Zone,
    ZoneScore,
    ZoneUInt8,
)

# The answer if a result counts, but is not on the disk yet.
NOT_SAVED = say("not saved: {why}. It counts, and is saved as soon as the disk can be written: do not enter it again. "
                "Free or repair the disk of log_dir")
NO_OBJECT = say("The values of the fields are not a JSON object, such as {example}")(example='{"robot": "r1"}')
NOT_RECORDED = say("not saved: internal error. It counts until the box ends. Report the error in the core's log")


# What the callers of the original services mean, which cannot say it: *disconnect* also ends a run in progress.
ORIGINAL_GIVEN: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}


class _Acted(NamedTuple):
    """A call that was carried out."""

    ticket: Optional[int]  # of the journal; None: the record failed
    of_standby: Optional[standby_answers.Answer]  # None: the answer does not wait for the standby
    answer: object
    with_values: bool  # the caller wants reasons as values


class CoreServices:
    """Offers all of /core/…; `event` calls a method of the box with arguments in the loop's thread.

    `ticket` returns, in the loop's thread, the journal's ticket of the event's changes. `why_not_saved` waits until
    they are on the disk; it is called in another thread before a referee's entry is confirmed. `ask_standby` asks, in
    the loop's thread, whether the standby has them; None: the answer does not wait for it. `renew` is called when
    somebody asks for the clock, and therefore waits for messages with a later time.
    """

    def __init__(
        self, box: Box, services: LoopServices, event: Callable[..., None],
        ticket: Callable[[], Optional[int]] = lambda: 0,
        why_not_saved: Callable[[int], str] = lambda ticket: "",
        ask_standby: Callable[[int], Optional[standby_answers.Answer]] = lambda ticket: None,
        renew: Callable[[], None] = lambda: None,
    ) -> None:
        self._box = box
        self._services = services
        self._event = event
        self._ticket = ticket
        self._why_not_saved = why_not_saved
        self._ask_standby = ask_standby
        self._renew = renew
        for action in ACTIONS.values():
            if action.is_original:
                self._serve(action.name, Zone, lambda r, action=action: (
                    box.act, Target(r.zone), action.name, who_of(r), ORIGINAL_GIVEN.get(action.name, NOTHING)
                ), is_urgent=action.name == STOP)
        self._serve("stop_run", StopRun, lambda r: (box.scores.stop, _run_of(r), who_of(r)), is_urgent=True)
        for name, action in (("manual_operation_complete", "operation"), ("omf_switches/complete", "confirm_switches")):
            self._serve(name, Zone, lambda r, action=action: (box.act, Target(r.zone), action, who_of(r)))
        for name, action in (("omf_switches/button", "switch"), ("omf_switches/damaged", "damaged")):
            self._serve(name, ZoneUInt8, lambda r, action=action: (
                box.act, Target(r.zone), action, who_of(r), {"number": r.data}
            ))
        self._serve_scores(box)
        self._add("clock", GetClock, self._clock)

    def _serve_scores(self, box: Box) -> None:
        """Services whose success means that the result is on the disk, and with `durable: two` on the standby's."""
        self._serve("set_score", ZoneScore, lambda r: (
            box.act, Target(r.zone), MARK, who_of(r),
            {"group": r.score.group, "desc": r.score.desc, "value": r.score.value}
        ), durable=True)
        self._serve("act", Act, lambda r: (
            box.act, Target(r.zone, r.run, r.event), r.action, who_of(r, r.referee), given_in(r.given)
        ), durable=True, answer_of=self._acted)
        self._add("run_sheet", GetRunSheet, self._run_sheet)
        self._add("judges", GetJudging, self._judging)

    def _serve(
        self, name: str, service: type, event_of: Callable[[Any], Tuple], durable: bool = False,
        answer_of: Optional[Callable[[Any], object]] = None, is_urgent: bool = False,
    ) -> None:
        """Offer /core/NAME: `event_of` makes a request the box's method and its arguments.

        A refusal fails the call with its reasons in the error text. `durable`: the call succeeds only when its result
        is on the disk, and with `durable: two` on the standby's. If it is not, the call fails, but its result counts
        and is saved as soon as possible.
        `answer_of` returns the answer, in the loop's thread, right after the event; None: the answer is empty.
        `is_urgent`: it stops a robot, and does not wait for other calls.
        """
        answer_of = answer_of or (lambda request: service._response_class())

        def act(request: object) -> _Acted:
            self._ticket()  # discards earlier internal errors: only this event counts
            self._event(*event_of(request))
            ticket = self._ticket()
            # The standby is asked at once: it writes while the disk of this computer does.
            waits = durable and is_durable(request)
            of_standby = self._ask_standby(ticket) if waits and ticket is not None else None
            return _Acted(ticket if waits else 0, of_standby, answer_of(request), wants_values(request))

        def wait(acted: _Acted) -> object:
            trouble = self._trouble(acted)
            if trouble:
                raise rospy.ServiceException(refusals.error_text([trouble], acted.with_values))
            return acted.answer

        self._add(name, service, act if durable else lambda r: act(r).answer, wait if durable else None, is_urgent)

    def _trouble(self, acted: "_Acted") -> str:
        """Wait until what was done is on the disks. Return why it is not; empty: it is."""
        if acted.ticket is None:
            return NOT_RECORDED
        why = self._why_not_saved(acted.ticket) if acted.ticket else ""
        return NOT_SAVED(why=why) if why else standby_answers.wait(acted.of_standby)

    def _add(self, name: str, service: type, handle: Callable[[Any], object],
             wait: Optional[Callable[[Any], object]] = None, is_urgent: bool = False) -> None:
        """Offer /core/NAME; see `LoopServices.add`."""
        def checked(request: Any) -> object:
            problem = texts.too_long(request)
            if problem:
                raise rospy.ServiceException(problem)
            try:
                return handle(request)
            except Refused as refused:
                raise rospy.ServiceException(refusals.error_text(refused.reasons, wants_values(request))) from None

        self._services.add(f"/core/{name}", service, checked, wait, is_urgent)

    def _clock(self, _request: Any) -> GetClockResponse:
        """Every command that was answered before has been carried out."""
        found: List[Now] = []
        self._event(found.append)
        self._renew()
        return GetClockResponse(ros_time(found[0].utc))

    def _acted(self, request: Any) -> ActResponse:
        found = self._box.outcome(Target(request.zone, request.run), request.action, given_in(request.given))
        return ActResponse(json.dumps(found) if found else "")

    def _judging(self, request: Any) -> GetJudgingResponse:
        found: List[Judging] = []
        self._event(lambda now: found.append(self._box.judges.judging(now, _run_of(request), request.judge)))
        return judging_convert.answer(found[0])

    def _run_sheet(self, request: Any) -> GetRunSheetResponse:
        found: List[Tuple[RunRecord, Optional[Why]]] = []
        self._event(lambda now: found.append(self._ruled(now, _run_of(request))))
        return GetRunSheetResponse(sheet_message(*found[0]))

    def _ruled(self, now: Now, name: RunName) -> Tuple[RunRecord, Optional[Why]]:
        record = self._box.scores.record_of(now, name)
        return record, self._box.scores.why(now, record.identity)


def is_durable(request: Any) -> bool:
    """Whether the answer to a call waits until what it did is on the disk: that of an action says it itself."""
    action = EVERY.get(getattr(request, "action", ""))
    return action is None or action.durable


def wants_values(request: Any) -> bool:
    """Whether the caller wants reasons as values."""
    return (getattr(request, "_connection_header", None) or {}).get(refusals.HEADER) == refusals.VALUES


def given_in(text: str) -> Dict[str, Any]:
    """Return the values of an action's fields in a request to /core/act. Raises `Refused`."""
    try:
        given = json.loads(text or "{}")
    except (ValueError, RecursionError):
        given = None
    if not isinstance(given, dict):
        raise Refused([NO_OBJECT])
    return given


def who_of(request: Any, referee: str = "") -> str:
    """Who calls: the name that the referee typed, if any, and the ROS node.

    Requests without a field for the name have it in the header of their connection.
    """
    header = getattr(request, "_connection_header", None) or {}
    node = header.get("callerid", "")
    name = referee.strip() or header.get(REFEREE_HEADER, "").strip()
    return f"{name} ({node})" if name and node else name or node


def _run_of(request: Any) -> RunName:
    return RunName(request.zone, request.identity)
