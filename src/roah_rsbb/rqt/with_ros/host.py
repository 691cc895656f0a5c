"""What windows need of ROS: a parameter for their zone, and services to operate devices and to end the launch."""

from typing import Callable, NamedTuple, Optional

import rospy
from std_srvs.srv import Empty

from roah_rsbb.document.calls import DOOR, RING
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.msg import DevicesState as DevicesStateMsg
from roah_rsbb.msg import DevicesStatus as DevicesStatusMsg
from roah_rsbb.protocol import PERCENTAGES
from roah_rsbb.ros import messages
from roah_rsbb.rqt.model.calls import CallFailed, Calls, Done, missing
from roah_rsbb.rqt.with_ros.feed import Feed
from roah_rsbb.rqt.with_ros.node import WindowNode
from roah_rsbb.rqt.with_ros.zone_parameter import ZoneParameter
from roah_rsbb.srv import Bool, Percentage
from roah_rsbb.wording.language import tr, tr_later, tr_said

SHUTDOWN = "roah_rsbb_shutdown"
# A parameter in the client's namespace (launch/roah_rsbb_client.launch).
ENDS_RSBB = "exit_ends_rsbb"
STATE_TOPIC, STATUS_TOPIC = "/devices/state", "/devices/status"
NOT_THERE = tr_later("Nothing controls the home devices: the box is not running, or not with devices:=true")


class HostWithRos(WindowNode):
    """A node of ROS, with a parameter for its zone."""

    def __init__(self) -> None:
        self.zone, self.devices = ZoneParameter(), DevicesNodeAfar()

    def ends_box(self) -> bool:
        """Whether `exit` ends the whole box, and not only this referee's windows. Called in a thread; may raise
        `CallFailed`.

        A client's own shutdown node ends that client, unless the client was started together with the core
        (`exit_ends_rsbb`). Without a client, the core's shutdown node in the root namespace ends the whole RSBB."""
        return _service() == f"/{SHUTDOWN}" or bool(_called(lambda: rospy.get_param(ENDS_RSBB, False)))

    def exit(self, calls: Calls, owner: object, done: Done) -> None:
        """End what `ends_box` says."""
        call_service(calls, owner, _service(), Empty, (), done)


def _service() -> str:
    return str(rospy.resolve_name(SHUTDOWN))


class ControllerStatus(NamedTuple):
    """Whether the devices' controller is connected, and details or the reason."""

    connected: bool
    text: str


class DevicesNodeAfar:
    """The home devices of the node roah_devices: of the box, or with devices:=false of another program. Call everything
    in the Qt thread."""

    def __init__(self) -> None:
        self.state: Optional[DevicesState] = None  # another object when it has changed; None: never heard
        self.status: Optional[ControllerStatus] = None
        self._feed = Feed({STATE_TOPIC: DevicesStateMsg, STATUS_TOPIC: DevicesStatusMsg})

    @property
    def why_missing(self) -> str:
        """Why nothing controls them now, for the referee; empty: something does. The topics are published on change
        only, so silence means nothing."""
        return "" if self.state is not None and self._feed.has_publisher(STATE_TOPIC) else tr(NOT_THERE)

    def start(self) -> None:
        """Begin to follow them."""
        self._feed.start()

    def stop(self) -> None:
        """Follow them no longer."""
        self._feed.stop()

    def look(self) -> None:
        """Take the news, several times a second."""
        state, status = (self._feed.take(topic) for topic in (STATE_TOPIC, STATUS_TOPIC))
        if state is not None:
            values = {name: getattr(state.message, name) for name in DevicesState._fields}
            self.state = DevicesState(**{**values, RING: (state.message.bell.secs, state.message.bell.nsecs)})
        if status is not None:
            self.status = ControllerStatus(status.message.connected, status.message.text)

    def renew(self) -> None:
        """Look for them again: the box has been silent for long."""
        self._feed.renew()

    def set(self, calls: Calls, owner: object, device: str, value: int, done: Done) -> None:
        """Set a device to a value, or ring (`RING`)."""
        if device == RING:
            call_service(calls, owner, "/devices/bell/mock", Empty, (), done)
        else:
            what = "mock" if device == DOOR else "set"
            kind = Percentage if device in PERCENTAGES else Bool
            call_service(calls, owner, f"/devices/{device}/{what}", kind, (value,), done)


# -- calls --------------------------------------------------------------------------------------------


def call_service(calls: Calls, owner: object, name: str, kind: type, request: tuple, done: Done) -> None:
    """Call the ROS service `name` of type `kind` with the request's fields; `done` receives the outcome."""
    calls.run(owner, name, lambda: _called(lambda: rospy.ServiceProxy(name, kind)(*request)), done)


def _called(call: Callable[[], object]) -> object:
    """Return what a call of ROS returns. Raises `CallFailed`."""
    try:
        return call()
    except Exception as error:  # the referee reads any error beside the command
        raised = str(error)
        raise CallFailed(failure_text(raised) or type(error).__name__, messages.was_answered(raised)) from None


# How rospy begins to say that it did not reach a service.
_UNREACHED = ("unable to connect to service", "unable to contact master", "transport error")


def failure_text(raised: str) -> str:
    """Return the reasons of a service, or what to check if there was no answer."""
    if raised.endswith("unavailable") or raised.startswith(_UNREACHED):
        return tr("no answer: {why} ({error})", why=missing(), error=raised)
    return "; ".join(map(tr_said, messages.reasons(raised)))
