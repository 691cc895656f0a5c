"""The services of the core node (ROS interface, Core node): each is one event for the box."""

from typing import Any, Callable, Tuple

import rospy

from roah_rsbb.core.box import Box
from roah_rsbb.core.commands import COMMANDS
from roah_rsbb.core.refused import Refused
from roah_rsbb.nodes.ros_loop import RosLoop
from roah_rsbb.srv import ManualOperationAnswer, Zone, ZoneScore, ZoneUInt8


class CoreServices:
    """Offers all of /core/…; `event` puts a method of the box and its arguments in, in the loop's thread."""

    def __init__(self, box: Box, ros: RosLoop, event: Callable[..., None]) -> None:
        self._ros = ros
        self._event = event
        for command in COMMANDS:
            self._serve(command, Zone, lambda r, c=command: (box.command, r.zone, c))
        self._serve(
            "set_score", ZoneScore, lambda r: (box.set_score, r.zone, r.score.group, r.score.desc, r.score.value)
        )
        self._serve("manual_operation_complete", Zone, lambda r: (box.manual_operation_complete, r.zone))
        self._serve(
            "manual_operation_answer", ManualOperationAnswer,
            lambda r: (box.manual_operation_complete, r.zone, r.operation, r.answer),
        )
        self._serve("omf_switches/button", ZoneUInt8, lambda r: (box.omf_button, r.zone, r.data))
        self._serve("omf_switches/damaged", ZoneUInt8, lambda r: (box.omf_damaged, r.zone, r.data))
        self._serve("omf_switches/complete", Zone, lambda r: (box.omf_complete, r.zone))

    def _serve(self, name: str, service: type, event_of: Callable[[Any], Tuple]) -> None:
        """Offer /core/NAME: `event_of` makes a request the box's method and its arguments.

        A refusal fails the call with its reasons in the error text.
        """

        def handle(request: object) -> object:
            try:
                self._ros.call(lambda: self._event(*event_of(request)))
            except Refused as refused:
                raise rospy.ServiceException(str(refused)) from None
            return service._response_class()

        rospy.Service(f"/core/{name}", service, handle)
