"""A box as a client of its door sees it: its document, followed, and its calls. It needs no ROS."""

import re
import time
from typing import Any, Callable, ClassVar, Optional, Tuple, TypeVar

from helpers.commands import given_with
from roah_rsbb.client.client import Client
from roah_rsbb.client.places import DoorPlace
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.document import Document
from roah_rsbb.model.zone import AllRobots, RobotInRun, ZoneSeen
from support.waiting import LIMIT_S, happened, wait_until

T = TypeVar("T")

# Reasons that pass by themselves. Robots and modules of a test fall silent, or their datagrams are late, when its
# process stops for a few seconds.
PASSING = re.compile("No message from the robot|The robot has disappeared|Clock skew of|is active: none of its beacons"
                     "|module not connected")


class Refusal(Exception):
    """A service call failed; the text is the core's own."""


class NoAnswer(AssertionError):
    """The core was killed during a call, or hangs."""


class SeenZone:
    """A zone of the document (`model.zone.Zone`), with the fields of the robot, or the robots, in its run."""

    def __init__(self, zone: ZoneSeen) -> None:
        self._zone = zone

    def __getattr__(self, name: str) -> Any:
        parts = (self._zone, self._zone.robot or NO_ROBOT, self._zone.all_robots or NO_ROBOTS)
        return next(getattr(part, name) for part in parts if hasattr(part, name))

    def __repr__(self) -> str:
        return repr(self._zone)


NO_ROBOT, NO_ROBOTS = RobotInRun("", 0, ""), AllRobots(0, 0, 0, 0, ())


class DoorClient:
    """Follows one box and commands it. `document` is the last document; `zone_details` reads what is true now."""

    # UTC of the end of the last command of any client in this process: a later test case has another client.
    _commanded: ClassVar[float] = 0.0

    def __init__(self, find: Callable[[], DoorPlace], node: str = "") -> None:
        """`find`: see `Client`. `node`: the name of the test's node."""
        self._node = node
        self.on_document: Callable[[Document], object] = lambda document: None  # called in another thread
        self._client = Client(Document, find, self._on_document)
        self._client.start()

    def close(self) -> None:
        """Stop following."""
        self._client.close()

    def _on_document(self) -> None:
        if self.document is not None:
            self.on_document(self.document)
        happened()

    # -- looking ------------------------------------------------------------------------------------

    @property
    def document(self) -> Optional[Document]:
        """The last document; None: none has come yet."""
        return self._client.document

    @property
    def uuid(self) -> str:
        """Identity of the core; empty: it was not heard."""
        return "" if self.document is None else self.document.box.uuid

    @property
    def warnings(self) -> Tuple[str, ...]:
        """The last warnings for every referee."""
        return self.document.box.warnings

    def zone_details(self, name: str) -> SeenZone:
        """A zone of the document, as it is now."""
        self._synchronise(LIMIT_S)
        return self.last_details(name)

    def _synchronise(self, limit_s: float) -> None:
        """Wait until the document has everything that happened before this call."""
        def answered() -> bool:
            answer = self._client.call("act").result()  # it is refused; its answer has the number of the document
            return answer.is_answered and self._client.is_confirmed(answer.number)

        wait_until(answered, "the core answers", limit_s)

    def last_details(self, name: str) -> SeenZone:
        """A zone of the last document."""
        return SeenZone(self.document.zones[name])

    def wait_details(self, name: str, condition: Callable[[SeenZone], T], what: str, limit_s: float = LIMIT_S) -> T:
        """Wait until a condition on a zone of the document holds; fails with that zone."""
        self._synchronise(limit_s)
        return wait_until(
            lambda: name in self.document.zones and condition(self.last_details(name)),
            lambda: f"{what}; the zone is:\n{self.document.zones.get(name)}", limit_s,
        )

    def wait_phase(self, zone: str, phase: str) -> None:
        """Wait for idle, connected, running or ended."""
        self.wait_details(zone, lambda d: d.phase == phase, f"the zone is {phase}")

    # -- commands -----------------------------------------------------------------------------------

    def command(self, command: str, zone: str, **given: object) -> None:
        """Give a command to a zone; raises `Refusal`. Those that hit a team name the one that is shown."""
        action, shown = ACTIONS[command], self.zone_details(zone).event
        self._do(command, zone, "", shown.id if action.aims else "", {**given_with(command, shown.team), **given}, "")

    def act(self, action: str, zone: str, run: str = "", referee: str = "", **given: object) -> Any:
        """Do an action and return its answer; raises `Refusal`. `given`: the values of its fields."""
        return self._do(action, zone, run, "", given, referee)

    def _do(self, action: str, zone: str, run: str, event: str, given: Any, by: str) -> Any:
        return self.ask("act", action=action, zone=zone, run=run, event=event, given=given, by=by,
                        node=self._node)

    def ask(self, name: str, **arguments: Any) -> Any:
        """Make a call through the door and return its answer; raises `Refusal` or `NoAnswer`."""
        try:
            answer = self._client.call(name, timeout_s=LIMIT_S, **arguments).result()
        finally:
            DoorClient._commanded = time.time()
        if not answer.is_answered:
            raise NoAnswer(f"{name} was not answered: {self._client.why}")
        if answer.reasons:
            raise Refusal("; ".join(answer.reasons))
        return answer.answer

    def refusal(self, command: str, zone: str) -> str:
        """Give a command that must be refused. Returns the reason; AssertionError if it is accepted."""
        try:
            self.command(command, zone)
        except Refusal as refused:
            return str(refused)
        raise AssertionError(f"{command} in zone '{zone}' was not refused")
