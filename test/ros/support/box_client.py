"""The core as a referee's program sees it: its topics, followed, and its services, called."""

from typing import Callable, List, Optional, TypeVar

import rospy
from std_msgs.msg import Empty

from roah_rsbb.msg import CoreDetails, CoreToGui, CoreToPublic, Score, ZoneDetails, ZoneState
from roah_rsbb.ros import refusals
from roah_rsbb.srv import Zone, ZoneScore
from support.waiting import LIMIT_S, happened, wait_until

T = TypeVar("T")


class Refusal(Exception):
    """A service call failed; the text is the core's own."""


class BoxClient:
    """Follows one core and commands it. `prefix` stands before all names of a core that was remapped.

    Each topic comes in its own time: data of one topic may not be in the last message of another yet.
    """

    def __init__(self, prefix: str = "") -> None:
        self.gui: Optional[CoreToGui] = None
        self.details: Optional[CoreDetails] = None
        self.public: Optional[CoreToPublic] = None
        self.timeouts = 0  # messages on /timeout
        self._prefix = prefix
        self._subscribers = [
            rospy.Subscriber(f"{prefix}/core/to_gui", CoreToGui, lambda m: self._set("gui", m)),
            rospy.Subscriber(f"{prefix}/core/details", CoreDetails, lambda m: self._set("details", m)),
            rospy.Subscriber(f"{prefix}/core/to_public", CoreToPublic, lambda m: self._set("public", m)),
            rospy.Subscriber(f"{prefix}/timeout", Empty, lambda _: self._set("timeouts", self.timeouts + 1)),
        ]

    def close(self) -> None:
        """Stop following."""
        for subscriber in self._subscribers:
            subscriber.unregister()

    def _set(self, what: str, value: object) -> None:
        setattr(self, what, value)
        happened()

    # -- looking ------------------------------------------------------------------------------------

    def wait_heard(self, limit_s: float = LIMIT_S) -> "BoxClient":
        """Wait for the core's first messages."""
        wait_until(lambda: self.gui and self.details and self.public, "all topics of the core are heard", limit_s)
        return self

    def zone(self, name: str) -> ZoneState:
        """A zone in the panels' message."""
        return next(zone for zone in self.gui.zones if zone.zone == name)

    def zone_details(self, name: str) -> ZoneDetails:
        """The data for which that message has no field."""
        return next(zone for zone in self.details.zones if zone.zone == name)

    def robot(self, team: str):
        """The first active robot of a team; None: there is none."""
        return next((robot for robot in self.gui.active_robots if robot.team == team), None)

    def wait_zone(self, name: str, condition: Callable[[ZoneState], T], what: str, limit_s: float = LIMIT_S) -> T:
        """Wait until a condition on a zone's state holds; fails with that state."""
        return wait_until(
            lambda: condition(self.zone(name)), lambda: f"{what}; the zone is:\n{self.zone(name)}", limit_s
        )

    def wait_details(self, name: str, condition: Callable[[ZoneDetails], T], what: str, limit_s: float = LIMIT_S) -> T:
        """Wait until a condition on a zone's details holds; fails with those."""
        return wait_until(
            lambda: condition(self.zone_details(name)),
            lambda: f"{what}; the zone's details are:\n{self.zone_details(name)}", limit_s,
        )

    def wait_text(self, zone: str, text: str) -> None:
        """Wait until the zone's state text contains a text."""
        self.wait_zone(zone, lambda z: text in z.state, f"the zone's state says '{text}'")

    def wait_phase(self, zone: str, phase: str) -> None:
        """Wait for idle, connected, running or ended."""
        self.wait_details(zone, lambda d: d.phase == phase, f"the zone is {phase}")

    # -- commands -----------------------------------------------------------------------------------

    def call(self, service: str, kind: type, *request: object) -> None:
        """Call /core/SERVICE; raises `Refusal`."""
        name = f"{self._prefix}/core/{service}"
        rospy.wait_for_service(name, LIMIT_S)
        try:
            rospy.ServiceProxy(name, kind)(*request)
        except rospy.ServiceException as error:
            assert refusals.was_answered(str(error)), f"{name} did not answer: {error}"
            raise Refusal(refusals.reason(str(error))) from None

    def command(self, command: str, zone: str) -> None:
        """Give a command to a zone; raises `Refusal`."""
        self.call(command, Zone, zone)

    def set_score(self, zone: str, group: str, desc: str, value: int) -> None:
        """Mark a scoring item; raises `Refusal`."""
        self.call("set_score", ZoneScore, zone, Score(group, desc, value))

    def refusal(self, command: str, zone: str) -> str:
        """Give a command that must be refused. Returns the reason; AssertionError if it is accepted."""
        try:
            self.command(command, zone)
        except Refusal as refused:
            return str(refused)
        raise AssertionError(f"{command} in zone '{zone}' was not refused")

    # -- ways that most tests go --------------------------------------------------------------------

    def connect(self, zone: str) -> int:
        """Connect as soon as the button is on; returns the private port once it is known."""
        self.wait_zone(zone, lambda z: z.connect_enabled, "connect is on")
        # The details may be a moment behind, and still describe the run before.
        old = self.zone_details(zone).port
        self.command("connect", zone)
        return self.wait_details(zone, lambda d: d.port != old and d.port, "the run has a port")

    def start(self, zone: str) -> None:
        """Start as soon as the button is on."""
        self.wait_zone(zone, lambda z: z.start_enabled, "start is on")
        self.command("start", zone)

    def scores(self, zone: str) -> List[tuple]:
        """All scoring items: (group, item, type, value)."""
        return [
            (group.group_name, desc, kind, value)
            for group in self.zone(zone).scoring
            for desc, kind, value in zip(group.descriptions, group.types, group.current_values)
        ]
