"""What a program with windows needs of ROS (`with_ros/host.py`)."""

from typing import TYPE_CHECKING, NamedTuple, Optional

from roah_rsbb.model.messages import DevicesState

if TYPE_CHECKING:
    from roah_rsbb.client.client import Client
    from roah_rsbb.model.document import Document
    from roah_rsbb.rqt.model.calls import Calls, Done


class ControllerStatus(NamedTuple):
    """Whether the devices' controller is connected, and details or the reason."""

    connected: bool
    text: str


class DevicesAfar:
    """The home devices, as a window sees and operates them. Call everything in the Qt thread."""

    state: Optional[DevicesState] = None  # another object when it has changed; None: never heard
    status: Optional[ControllerStatus] = None
    why_missing = ""  # why nothing controls them now, for the referee; empty: something does

    def start(self, afar: "Client[Document]") -> None:
        """Begin to follow them. `afar`: the box."""

    def stop(self) -> None:
        """Follow them no longer."""

    def look(self) -> None:
        """Take the news, several times a second."""

    def renew(self) -> None:
        """Look for them again: the box has been silent for long."""

    def set(self, calls: "Calls", owner: object, device: str, value: int, done: "Done") -> None:
        """Set a device to a value, or ring (`RING`)."""
        raise NotImplementedError


class ZoneChoice:
    """The zone that the windows of a referee show."""

    @property
    def value(self) -> str:
        """Its name; empty: none is chosen."""
        raise NotImplementedError

    def start(self) -> None:
        """Begin to follow it."""

    def stop(self) -> None:
        """Follow it no longer; the last choice is kept."""

    def choose(self, zone: str) -> None:
        """Choose another zone."""
        raise NotImplementedError


class WindowHost:
    """The system in which a program with windows runs."""

    zone: ZoneChoice
    devices: DevicesAfar

    @property
    def node(self) -> str:
        """The name of this program, for the box's records."""
        raise NotImplementedError

    def begin(self, name: str) -> None:
        """Begin, before there is Qt's application. `name`: of this program. Where no window can be opened, or a signal
        comes meanwhile, the process ends."""

    @property
    def has_ended(self) -> bool:
        """Whether the program must end, because its host has."""
        return False

    def end(self) -> None:
        """End, in any thread; then `has_ended`."""

    def times_in_utc(self) -> bool:
        """Whether windows show times in UTC."""
        return False

    def ends_box(self) -> bool:
        """Whether `exit` ends the whole box, and not only this referee's windows. Called in a thread; may raise
        `CallFailed`."""
        return True

    def exit(self, calls: "Calls", owner: object, anyway: bool, done: "Done") -> None:
        """End what `ends_box` says. `anyway`: also while runs are in progress."""
        raise NotImplementedError
