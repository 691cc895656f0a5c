"""The services of the core node (docs/ros_interface.md, "Core node"): each is one event for the box."""

import json
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from roah_rsbb.box.calls import NO_OBJECT, BoxCalls, full_name
from roah_rsbb.core.actions.table import NOTHING, Target
from roah_rsbb.core.box import Box
from roah_rsbb.document.calls import Waiting
from roah_rsbb.model.actions import ACTIONS, MARK, STOP
from roah_rsbb.model.clock import Now
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
    GetRunSheet,
    GetRunSheetResponse,
    StopRun,
    Zone,
    ZoneScore,
    ZoneUInt8,
)

# What the callers of the original services mean, which cannot say it: *disconnect* also ends a run in progress.
ORIGINAL_GIVEN: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}


class CoreServices:
    """Offers all of /core/…, each as a call of the box (`box/calls.py`).

    `renew` is called when somebody asks for the clock, and therefore waits for messages with a later time.
    """

    def __init__(self, box: Box, services: LoopServices, event: Callable[..., None], calls: BoxCalls,
                 renew: Callable[[], None] = lambda: None) -> None:
        """`event` calls a method of the box with arguments, in the loop's thread."""
        self._box = box
        self._services = services
        self._event = event
        self._calls = calls
        self._renew = renew
        for action in ACTIONS.values():
            if action.is_original:
                self._serve(action.name, Zone, lambda r, action=action: calls.do(
                    False, box.act, Target(r.zone), action.name, who_of(r), ORIGINAL_GIVEN.get(action.name, NOTHING)
                ), is_urgent=action.name == STOP)
        self._serve("stop_run", StopRun, lambda r: calls.stop(_run_of(r), who_of(r)), is_urgent=True)
        for name, action in (("manual_operation_complete", "operation"), ("omf_switches/complete", "confirm_switches")):
            self._serve(name, Zone, lambda r, action=action: calls.do(
                False, box.act, Target(r.zone), action, who_of(r)))
        for name, action in (("omf_switches/button", "switch"), ("omf_switches/damaged", "damaged")):
            self._serve(name, ZoneUInt8, lambda r, action=action: calls.do(
                False, box.act, Target(r.zone), action, who_of(r), {"number": r.data}))
        # Their success means that the result is on the disk, and with `durable: two` on the standby's.
        self._serve("set_score", ZoneScore, lambda r: calls.do(
            True, box.act, Target(r.zone), MARK, who_of(r),
            {"group": r.score.group, "desc": r.score.desc, "value": r.score.value}), waits=True)
        self._add("act", Act, self._act, self._acted)
        self._add("run_sheet", GetRunSheet, lambda r: GetRunSheetResponse(sheet_message(calls.sheet(_run_of(r)))))
        self._add("judges", GetJudging, lambda r: judging_convert.answer(calls.judging(_run_of(r), r.judge)))
        self._add("clock", GetClock, self._clock)

    def _serve(self, name: str, service: type, do: Callable[[Any], Callable[[], str]], waits: bool = False,
               is_urgent: bool = False) -> None:
        """Offer /core/NAME, whose answer is empty: `do` is `BoxCalls.do`. A refusal fails the call with its reasons in
        the error text. `waits`: the call succeeds only when its result is on the disks. If it is not, the call fails,
        but its result counts and is saved as soon as possible. `is_urgent`: it stops a robot, and does not wait for
        other calls.
        """
        def wait(waiting: Callable[[], str]) -> object:
            _raise_trouble(waiting())
            return service._response_class()

        def act(request: object) -> object:
            do(request)
            return service._response_class()

        self._add(name, service, do if waits else act, wait if waits else None, is_urgent)

    def _act(self, request: Any) -> Tuple[Waiting, bool]:
        waiting = self._calls.act(Target(request.zone, request.run, request.event), request.action,
                                  who_of(request, request.referee), given_in(request.given))
        return waiting, wants_values(request)

    def _acted(self, acted: Tuple[Waiting, bool]) -> ActResponse:
        waiting, with_values = acted
        _raise_trouble(waiting.wait(), with_values)
        return ActResponse(json.dumps(waiting.answer) if waiting.answer else "")

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


def _raise_trouble(trouble: str, with_values: bool = False) -> None:
    """Fail a call whose result is not on the disks."""
    if trouble:
        raise rospy.ServiceException(refusals.error_text([trouble], with_values))


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
    return full_name(referee.strip() or header.get(REFEREE_HEADER, ""), header.get("callerid", ""))


def _run_of(request: Any) -> RunName:
    return RunName(request.zone, request.identity)
