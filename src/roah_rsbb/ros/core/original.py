"""The original's interface of the core: topics for panels and for the public display, made of the document, and the
services (docs/ros_interface.md, "Core node"), each of which is one event for the box. Names and fields are fixed."""

from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from roah_rsbb.box.calls import BoxCalls, full_name
from roah_rsbb.core.actions.table import NOTHING, Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.views import document as views
from roah_rsbb.model.actions import ACTIONS, MARK, STOP, confirmed_by
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.msg import CoreToGui, CoreToPublic, RobotInfo, ScheduleInfo, ZoneState
from roah_rsbb.ros import messages
from roah_rsbb.ros.connections import REFEREE_HEADER
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.messages import ros_duration, ros_time, ros_wire_time
from roah_rsbb.ros.modules.convert import old_groups
from roah_rsbb.ros.node import RosLoop
from roah_rsbb.srv import Zone, ZoneScore, ZoneUInt8
from roah_rsbb.wording.times import formatted

# Instead of the time. The original's public display shows it.
NOT_LIVE = "not live"
# What the callers of the original services mean, which cannot say it: *disconnect* also ends a run in progress.
ORIGINAL_GIVEN: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}


class ToPublic:
    """Makes the message for the original's public display, with local times."""

    def __init__(self, box: Box, prefix: str = "") -> None:
        """`prefix`: of the clock; marks a replay."""
        self._box, self._prefix = box, prefix
        self._revision: Optional[int] = None  # of the box, to which the lines belong
        self._lines: List[ScheduleInfo] = []

    def message(self, now: Now) -> CoreToPublic:
        """Return the message of this moment. A box that is superseded has no schedule."""
        if self._box.authority.is_superseded:
            return CoreToPublic(clock=NOT_LIVE)
        if self._revision != self._box.outbox.revision:
            self._revision = self._box.outbox.revision
            self._lines = [
                ScheduleInfo(
                    line.event.team, line.event.benchmark.desc, line.event.round, line.event.run,
                    _local(line.event.scheduled), line.running,
                )
                for line in views.coming_events(self._box)
            ]
        return CoreToPublic(clock=f"{self._prefix}{_local(now.utc)}", schedule=self._lines)


def _local(utc: float) -> str:
    return formatted(utc, "%Y-%m-%d %H:%M:%S", in_utc=False)


class OriginalTopics:
    """The topics for panels and the public display; they are made only while somebody subscribes. All methods but the
    constructor are called in the loop's thread."""

    def __init__(
        self, ros: RosLoop, box: Box, now: Callable[[], Now], look: Callable[[], Document], prefix: str = "",
    ) -> None:
        """`now` returns the box's clocks; `look` sends clients of the door what has changed, and returns the document;
        `prefix`: see `ToPublic`."""
        self._now, self._look = now, look
        self._to_gui, self._to_public = ToGui(box), ToPublic(box, prefix)
        self._gui = LatchedTopic("/core/to_gui", CoreToGui, lambda: ros.post(self.publish_to_gui))
        self._public = LatchedTopic("/core/to_public", CoreToPublic, lambda: ros.post(self.publish_to_public))

    @property
    def are_wanted(self) -> bool:
        """Whether anybody subscribes to one of them."""
        return self._gui.is_wanted or self._public.is_wanted

    def publish_to_gui(self) -> None:
        """Look at the box, for clients of the door too, and publish for panels; they expect it ten times a second."""
        document = self._look()
        if self._gui.is_wanted:
            publish(self._gui, self._to_gui.message(self._now(), document))

    def publish_to_public(self) -> None:
        """Publish for the public display, twice a second."""
        if self._public.is_wanted:
            publish(self._public, self._to_public.message(self._now()))


def publish(topic: Any, message: object) -> None:
    """Publish a message; logs why that is not possible."""
    try:
        topic.publish(message)
    except rospy.ROSException as error:
        if not rospy.core.is_shutdown_requested():
            rospy.logerr_throttle(1.0, f"{topic.name} could not be published: {error}")


class LatchedTopic(rospy.SubscribeListener):
    """A topic of the original interface. A new subscriber gets a message at once, as a latched topic promises: a new
    one, and never an old one of a time when nobody subscribed."""

    def __init__(self, name: str, kind: type, on_subscribed: Callable[[], object]) -> None:
        """`on_subscribed` is called in a thread of rospy."""
        super().__init__()
        self._on_subscribed = on_subscribed
        self._publisher = rospy.Publisher(name, kind, self, queue_size=1, latch=True)

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._publisher.name)

    @property
    def is_wanted(self) -> bool:
        """Whether anybody subscribes."""
        return self._publisher.get_num_connections() > 0

    def publish(self, message: Any) -> None:
        """Publish a message. Raises rospy.ROSException."""
        self._publisher.publish(message)

    def peer_subscribe(self, _topic: str, _publish: Any, _publish_to_it: Any) -> None:
        """rospy calls it before it sends what was published last."""
        self._publisher.impl.latch = None
        self._on_subscribed()


class ToGui:
    """Makes the messages of one box. A zone's message is made again only when the zone has changed."""

    def __init__(self, box: Box) -> None:
        self._box = box
        self._zones: Dict[str, Tuple[ZoneSeen, ZoneState]] = {}

    def message(self, now: Now, document: Document) -> CoreToGui:
        """Return the message of a moment; it is true until the next one is made. `document`: of the same moment; robots
        and tablet, of which it says less than the message, come from the box."""
        heard, tablet = self._box.tablet.heard, self._box.tablet.state
        before, self._zones = self._zones, {}
        for name, zone in document.zones.items():
            kept = before.get(name)
            self._zones[name] = kept if kept is not None and kept[0] is zone else (zone, _zone_state(zone))
        for zone, state in self._zones.values():
            state.timer = ros_duration(zone.clock.timer(now.mono))
        return CoreToGui(
            clock=ros_time(now.utc),
            status=document.box.status,
            addr=document.box.host,
            port=str(document.box.port),
            tablet_last_beacon=ros_time(0.0 if heard is None else heard.utc),
            tablet_display_map=tablet.display_map,
            tablet_call_time=ros_wire_time(tablet.call_time),
            tablet_position_time=ros_wire_time(tablet.position_time),
            tablet_position_x=tablet.position_x,
            tablet_position_y=tablet.position_y,
            active_robots=[
                RobotInfo(*robot.id, ros_duration(robot.skew.seconds or 0.0), ros_time(robot.last_heard.utc))
                for robot in self._box.robots.all(now)],
            zones=[state for _, state in self._zones.values()],
        )


def _zone_state(zone: ZoneSeen) -> ZoneState:
    event, switches = zone.event, zone.switches
    return ZoneState(
        zone=zone.zone,
        name=event.name,
        desc=event.desc,
        code=event.code,
        timeout=ros_duration(zone.timeout),
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time(event.scheduled),
        state="\n".join(zone.lines),
        manual_operation=zone.manual_operation,
        connect_enabled=zone.is_on("connect") and not zone.action("connect").question,
        disconnect_enabled=zone.is_on("disconnect"),
        start_enabled=zone.is_on("start"),
        stop_enabled=zone.is_on("stop"),
        prev_enabled=zone.is_on("previous"),
        next_enabled=zone.is_on("next"),
        omf=switches is not None,
        omf_switches=b"" if switches is None else bytes(switches.on),
        omf_damaged=0 if switches is None else switches.damaged,
        omf_complete=switches is not None and switches.to_confirm,
        log=zone.log,
        online_data=zone.online_data,
        scoring=old_groups(zone.items),
    )


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
                raise rospy.ServiceException(messages.error_text([trouble]))
            return service._response_class()

        def act(request: object) -> object:
            do(request)
            return service._response_class()

        self._add(name, service, do if waits else act, wait if waits else None, is_urgent)

    def _add(self, name: str, service: type, handle: Callable[[Any], object],
             wait: Optional[Callable[[Any], object]] = None, is_urgent: bool = False) -> None:
        """Offer /core/NAME; see `LoopServices.add`."""
        def checked(request: Any) -> object:
            problem = messages.too_long(request)
            if problem:
                raise rospy.ServiceException(problem)
            try:
                return handle(request)
            except Refused as refused:
                raise rospy.ServiceException(messages.error_text(confirmed_by(
                    refused.reasons, "For another attempt, call /core/connect_again"))) from None

        self._services.add(f"/core/{name}", service, checked, wait, is_urgent)


def who_of(request: Any) -> str:
    """Who calls: the name that the referee typed, if it is in the header of the connection, and the ROS node."""
    header = getattr(request, "_connection_header", None) or {}
    return full_name(header.get(REFEREE_HEADER, ""), header.get("callerid", ""))
