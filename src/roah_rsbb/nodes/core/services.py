"""The original services of the core node (docs/ros_interface.md, "Core node"): each is one event for the box."""

from typing import Any, Callable, Dict, Optional

import rospy

from roah_rsbb.box.calls import BoxCalls, full_name
from roah_rsbb.core.actions.table import NOTHING, Target, confirmed_by
from roah_rsbb.core.box import Box
from roah_rsbb.model.actions import ACTIONS, MARK, STOP
from roah_rsbb.model.reason import Refused
from roah_rsbb.ros import refusals, texts
from roah_rsbb.ros.connections import REFEREE_HEADER
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.srv import Zone, ZoneScore, ZoneUInt8

# What the callers of the original services mean, which cannot say it: *disconnect* also ends a run in progress.
ORIGINAL_GIVEN: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}


class CoreServices:
    """Offers the original's services /core/…, each as a call of the box (`box/calls.py`)."""

    def __init__(self, box: Box, services: LoopServices, calls: BoxCalls) -> None:
        self._services = services
        for action in ACTIONS.values():
            if action.is_original:
                self._serve(action.name, Zone, lambda r, action=action: calls.do(
                    False, box.act, Target(r.zone), action.name, who_of(r), ORIGINAL_GIVEN.get(action.name, NOTHING)
                ), is_urgent=action.name == STOP)
        self._serve("connect_again", Zone, lambda r: calls.do(
            False, box.act, Target(r.zone), "connect", who_of(r), {"again": True}))
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

    def _serve(self, name: str, service: type, do: Callable[[Any], Callable[[], str]], waits: bool = False,
               is_urgent: bool = False) -> None:
        """Offer /core/NAME, whose answer is empty: `do` is `BoxCalls.do`. A refusal fails the call with its reasons in
        the error text. `waits`: the call succeeds only when its result is on the disks. If it is not, the call fails,
        but its result counts and is saved as soon as possible. `is_urgent`: it stops a robot, and does not wait for
        other calls.
        """
        def wait(waiting: Callable[[], str]) -> object:
            trouble = waiting()
            if trouble:
                raise rospy.ServiceException(refusals.error_text([trouble]))
            return service._response_class()

        def act(request: object) -> object:
            do(request)
            return service._response_class()

        self._add(name, service, do if waits else act, wait if waits else None, is_urgent)

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
                raise rospy.ServiceException(refusals.error_text(confirmed_by(
                    refused.reasons, "For another attempt, call /core/connect_again"))) from None

        self._services.add(f"/core/{name}", service, checked, wait, is_urgent)


def who_of(request: Any) -> str:
    """Who calls: the name that the referee typed, if it is in the header of the connection, and the ROS node."""
    header = getattr(request, "_connection_header", None) or {}
    return full_name(header.get(REFEREE_HEADER, ""), header.get("callerid", ""))
