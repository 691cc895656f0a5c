"""The core as a referee's program of ROS sees it: also its original topics, followed, and its services, called."""

import time
from typing import Any, Callable, List, Optional

import rospy
from std_msgs.msg import Empty

from roah_rsbb.client.places import PARAM, DoorPlace, NotFound
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.msg import CoreToGui, CoreToPublic, Score, ZoneState
from roah_rsbb.ros import messages
from roah_rsbb.srv import Zone as ZoneRequest
from roah_rsbb.srv import ZoneScore
from support.connections import wait_sends
from support.door_client import PASSING, DoorClient, NoAnswer, Refusal, T
from support.waiting import LIMIT_S, happened, wait_until

CORE = "/roah_rsbb_core"


# What the state of a zone says of an event that has a result.
SIGNED_OFF = "This event is signed off"


class BoxClient(DoorClient):
    """Follows one core and commands it. `prefix` stands before all names of a core that was remapped.

    Each topic, and the document, comes in its own time: data of one may not be in the last message of another yet. The
    attributes `gui` and `public` are the last messages, `document` the last document. `zone` and `zone_details` read
    what is true now. All waits consider only what the core made after the last command.
    """

    def __init__(self, prefix: str = "") -> None:
        self.gui: Optional[CoreToGui] = None
        self.public: Optional[CoreToPublic] = None
        self.timeouts = 0  # messages on /timeout
        self._prefix = prefix
        super().__init__(self._find, rospy.get_name())
        self._subscribers = [
            rospy.Subscriber(f"{prefix}/core/to_gui", CoreToGui, lambda m: self._set("gui", m)),
            rospy.Subscriber(f"{prefix}/core/to_public", CoreToPublic, lambda m: self._set("public", m)),
            rospy.Subscriber(f"{prefix}/timeout", Empty, lambda _: self._set("timeouts", self.timeouts + 1)),
        ]

    def close(self) -> None:
        """Stop following."""
        super().close()
        for subscriber in self._subscribers:
            subscriber.unregister()

    def _find(self) -> DoorPlace:
        try:
            found = rospy.get_param(f"{self._prefix}{PARAM}")
        except KeyError:
            raise NotFound("there is no core") from None
        return DoorPlace(found["url"], found["token"])

    def _set(self, what: str, value: object) -> None:
        setattr(self, what, value)
        happened()

    # -- looking ------------------------------------------------------------------------------------

    def wait_heard(self, limit_s: float = LIMIT_S) -> "BoxClient":
        """Wait for the core's first messages."""
        wait_until(lambda: self._is_current(self.gui) and self.public and self.document,
                   "all topics of the core, and its document, are heard", limit_s)
        return self

    def wait_timeouts_heard(self) -> None:
        """Wait until the launched core sends /timeout to this client: the topic is not latched."""
        wait_sends(CORE, self._subscribers[-1])

    def wait_other_core(self, uuid: str, what: Callable[[], str] = lambda: "another core runs") -> None:
        """Wait until another core than the one of this identity is heard."""
        began = time.time()
        wait_until(lambda: self.uuid not in ("", uuid) and self.gui and self.gui.clock.to_sec() >= began
                   and self.public, what)

    def wait_current(self) -> None:
        """Wait until the last message and the document are newer than the last command."""
        self._synchronise(LIMIT_S)
        wait_until(lambda: self._is_current(self.gui), "the core publishes")

    def zone(self, name: str) -> ZoneState:
        """A zone in the panels' message, as it is now."""
        self._wait_newer("gui", time.time())
        return self.last_zone(name)

    def last_zone(self, name: str) -> ZoneState:
        """A zone in the last message for panels, which may be older than the last command."""
        return next(zone for zone in self.gui.zones if zone.zone == name)

    def robot(self, team: str):
        """The first active robot of a team in the last message; None: there is none."""
        return next((robot for robot in self.gui.active_robots if robot.team == team), None)

    def wait_zone(self, name: str, condition: Callable[[ZoneState], T], what: str, limit_s: float = LIMIT_S) -> T:
        """Wait until a condition on a zone's state holds; fails with that state."""
        return wait_until(
            lambda: self._is_current(self.gui) and condition(self.last_zone(name)),
            lambda: f"{what}; the zone is:\n{self.last_zone(name)}", limit_s,
        )

    def _is_current(self, message: Optional[CoreToGui]) -> bool:
        return message is not None and message.clock.to_sec() >= DoorClient._commanded

    def _wait_newer(self, topic: str, utc: float) -> None:
        wait_until(lambda: getattr(self, topic).clock.to_sec() >= utc, f"the core publishes {topic}")

    def wait_text(self, zone: str, text: str) -> None:
        """Wait until the zone's state text contains a text."""
        self.wait_zone(zone, lambda z: text in z.state, f"the zone's state says '{text}'")

    # -- commands -----------------------------------------------------------------------------------

    def call(self, service: str, kind: type, *request: object) -> Any:
        """Call /core/SERVICE and return its answer; raises `Refusal` or `NoAnswer`."""
        name = f"{self._prefix}/core/{service}"
        rospy.wait_for_service(name, LIMIT_S)
        try:
            return rospy.ServiceProxy(name, kind)(*request)
        except rospy.ServiceException as error:
            if not messages.was_answered(str(error)):
                raise NoAnswer(f"{name} did not answer: {error}") from None
            raise Refusal(messages.reason(str(error))) from None
        finally:
            DoorClient._commanded = time.time()

    def command(self, command: str, zone: str, **given: object) -> None:
        """Give a command to a zone; raises `Refusal`. Those that hit a team name the one that is shown."""
        action = ACTIONS.get(command)
        if action is None or action.is_original:
            self.call(command, ZoneRequest, zone)
        else:
            super().command(command, zone, **given)

    def set_score(self, zone: str, group: str, desc: str, value: int) -> None:
        """Mark a scoring item; raises `Refusal`."""
        self.call("set_score", ZoneScore, zone, Score(group, desc, value))

    # -- ways that most tests go --------------------------------------------------------------------

    def connect(self, zone: str, meanwhile: Callable[[], object] = lambda: None, again: bool = False) -> int:
        """Connect as soon as the button is on; returns the private port once it is known.

        `meanwhile` is called again and again while the button is off. `again`: also where a result is signed off.
        """
        old = self.zone_details(zone).port
        if again and SIGNED_OFF in self.wait_zone(
                zone, lambda z: (meanwhile(), z.connect_enabled or SIGNED_OFF in z.state)[1] and z, "connect").state:
            self._press("connect_again", zone, lambda z: (meanwhile(), True)[1])
        else:
            self._press("connect", zone, lambda z: (meanwhile(), z.connect_enabled)[1])
        return self.wait_details(zone, lambda d: d.port != old and d.port, "the run has a port")

    def start(self, zone: str, meanwhile: Callable[[], object] = lambda: None) -> None:
        """Start as soon as the button is on; `meanwhile`: see `connect`."""
        self._press("start", zone, lambda z: (meanwhile(), z.start_enabled)[1])

    def _press(self, command: str, zone: str, is_on: Callable[[ZoneState], bool]) -> None:
        """Give a command as soon as its button is on.

        Since the message that showed the button, a robot or a module may have fallen silent. Then the command is
        refused, and the button is off in the core's next message. It is pressed when it is on again.
        """
        deadline = time.monotonic() + LIMIT_S
        while True:
            self.wait_zone(zone, is_on, f"{command} is on")
            try:
                self.command(command, zone)
                return
            except Refusal as refused:
                if not PASSING.search(str(refused)) or time.monotonic() > deadline:
                    raise

    def scores(self, zone: str) -> List[tuple]:
        """All scoring items in the last message: (group, item, type, value)."""
        return [
            (group.group_name, desc, kind, value)
            for group in self.last_zone(zone).scoring
            for desc, kind, value in zip(group.descriptions, group.types, group.current_values)
        ]

    def wait_scored(self, zone: str, *items: tuple) -> None:
        """Wait until these are among the scoring items."""
        self.wait_zone(zone, lambda z: set(items) <= set(self.scores(zone)), f"the sheet has {items}")
