"""The ROS node of a program with windows: the parameter that is its zone, the topics and services of the home devices,
and the service that ends the launch.

rospy calls back in its own threads, and the master may not answer: nothing here makes Qt's thread wait.
"""

import contextlib
import queue
import sys
import threading
from typing import Any, Callable, Dict, NamedTuple, Optional

import rosgraph
import rospy
from std_srvs.srv import Empty

from roah_rsbb.document.calls import DOOR, RING
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.protocol import PERCENTAGES
from roah_rsbb.ros import connections, messages
from roah_rsbb.rqt.calls import CallFailed, Calls, Done, missing
from roah_rsbb.wording.language import tr, tr_later, tr_said

# Parameters in the client's namespace (launch/roah_rsbb_client.launch).
TIMES_IN_UTC, ENDS_RSBB = "times_in_utc", "exit_ends_rsbb"
SHUTDOWN = "roah_rsbb_shutdown"
# How often a start that waits for a master looks for it, seconds.
LOOK_S = 0.2


class WindowNode:
    """The node. In rqt, whose node it is, `begin` is not called."""

    def __init__(self) -> None:
        self.zone, self.devices = ZoneParameter(), DevicesNodeAfar()

    @property
    def name(self) -> str:
        """The name of this program, for the box's records."""
        return str(rospy.get_name())

    def begin(self, name: str, must_end: threading.Event) -> bool:
        """Start the ROS node. While it waits for a master, it prints this. Returns whether it has begun: not if
        `must_end` is set meanwhile."""
        if not rosgraph.is_master_online():
            print(f"Waiting for the ROS master at {rosgraph.get_master_uri()}: start roah_rsbb.launch",
                  file=sys.stderr)
            while not rosgraph.is_master_online():
                if must_end.wait(LOOK_S):
                    return False
        connections.init_node(name, anonymous=True, disable_signals=True)
        return True

    @property
    def has_ended(self) -> bool:
        """Whether the program must end, because its node has."""
        return bool(rospy.is_shutdown())

    def end(self) -> None:
        """Remove the node from the master, in any thread; then `has_ended`."""
        rospy.signal_shutdown("the program ends")

    def times_in_utc(self) -> bool:
        """Whether windows show times in UTC."""
        return bool(rospy.get_param(TIMES_IN_UTC, False))

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


CURRENT_ZONE = "current_zone"
POLL_S = 0.5


class ZoneParameter:
    """The zone that a client shows: a parameter in its namespace. All panels of a client follow it, also those in other
    processes. A thread reads and writes it, from `start` to `stop`."""

    def __init__(self) -> None:
        self._value = ""
        self._unwritten: Optional[str] = None
        self._lock = threading.Lock()
        self._wake: queue.Queue[bool] = queue.Queue()  # True: write now, False: end
        self._worker = threading.Thread(target=self._work, name=CURRENT_ZONE, daemon=True)

    @property
    def value(self) -> str:
        """The zone's name; empty while none is chosen."""
        return self._value

    def start(self) -> None:
        """Follow the parameter, in the background."""
        self._worker.start()

    def stop(self, timeout_s: float = 2.0) -> None:
        """Stop, after writing the last choice if the master answers."""
        self._wake.put(False)
        self._worker.join(timeout_s)

    def choose(self, zone: str) -> None:
        """Set the parameter: at once for this process, soon for others."""
        with self._lock:
            self._value = self._unwritten = zone
        self._wake.put(True)

    def _work(self) -> None:
        continues = True
        while continues:
            self._try_exchange()
            with contextlib.suppress(queue.Empty):
                continues = self._wake.get(timeout=POLL_S)
        self._try_exchange()

    def _try_exchange(self) -> None:
        try:
            self._exchange()
        except Exception as e:  # the master is gone: the next try is soon
            rospy.logdebug("parameter %s: %s", CURRENT_ZONE, e)

    def _exchange(self) -> None:
        """Write the last choice, or else read. A choice made meanwhile takes precedence over the value read."""
        with self._lock:
            unwritten = self._unwritten
        if unwritten is not None:
            rospy.set_param(CURRENT_ZONE, unwritten)
            with self._lock:
                if self._unwritten == unwritten:
                    self._unwritten = None
            return
        read = rospy.get_param(CURRENT_ZONE, None)
        with self._lock:
            if self._unwritten is not None:
                return
            if read is None and self._value:  # the master was restarted, and lost it
                self._unwritten = self._value
                self._wake.put(True)
            else:
                self._value = "" if read is None else str(read)


STATE_TOPIC, STATUS_TOPIC = "/devices/state", "/devices/status"
NOT_THERE = tr_later("Nothing controls the home devices: the box is not running, or not with devices:=true")


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
        self._newest: Dict[str, Any] = {}  # by topic; rospy's threads only add to it
        self._subscribers: Dict[str, rospy.Subscriber] = {}
        self._wishes: queue.Queue[bool] = queue.Queue()  # True: subscribe (again), False: end
        # Registering with the master blocks while the master cannot be reached.
        self._worker = threading.Thread(target=self._work, name="devices", daemon=True)

    @property
    def why_missing(self) -> str:
        """Why nothing controls them now, for the referee; empty: something does. The topics are published on change
        only, so silence means nothing."""
        subscriber = self._subscribers.get(STATE_TOPIC)
        # rospy keeps broken connections in its list to reconnect them. Only a connection with a socket counts.
        impl = None if subscriber is None else subscriber.impl
        is_published = impl is not None and any(connection.socket is not None for connection in impl.connections)
        return "" if self.state is not None and is_published else tr(NOT_THERE)

    def start(self) -> None:
        """Begin to follow them, in the background."""
        self._wishes.put(True)
        self._worker.start()

    def stop(self, timeout_s: float = 2.0) -> None:
        """Follow them no longer. Does not wait for a master that does not answer."""
        self._wishes.put(False)
        self._worker.join(timeout_s)

    def renew(self) -> None:
        """Look for them again, in the background: the box has been silent for long.

        Only this finds a node again whose computer lost its power (its connections stay half open), or whose master
        was restarted (it has no record of this subscriber).
        """
        if self._wishes.empty():
            self._wishes.put(True)

    def look(self) -> None:
        """Take the news, several times a second."""
        state, status = (self._newest.pop(topic, None) for topic in (STATE_TOPIC, STATUS_TOPIC))
        if state is not None:
            values = {name: getattr(state, name) for name in DevicesState._fields}
            self.state = DevicesState(**{**values, RING: (state.bell.secs, state.bell.nsecs)})
        if status is not None:
            self.status = ControllerStatus(status.connected, status.text)

    def _work(self) -> None:
        from roah_rsbb import msg  # late: what is generated is not needed to begin a node

        wish = True
        while wish:
            wish = self._wishes.get()
            try:
                for subscriber in self._subscribers.values():
                    subscriber.unregister()
                kinds = ((STATE_TOPIC, msg.DevicesState), (STATUS_TOPIC, msg.DevicesStatus)) if wish else ()
                self._subscribers = {topic: self._subscribe(topic, kind) for topic, kind in kinds}
            except Exception as e:  # the master is gone; `renew` is called while the box is silent
                rospy.logdebug("subscribing to the devices failed: %s", e)

    def _subscribe(self, topic: str, kind: type) -> rospy.Subscriber:
        return rospy.Subscriber(topic, kind, lambda message: self._newest.update({topic: message}), queue_size=1,
                                tcp_nodelay=True)

    def set(self, calls: Calls, owner: object, device: str, value: int, done: Done) -> None:
        """Set a device to a value, or ring (`RING`)."""
        from roah_rsbb.srv import Bool, Percentage  # late, see above

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
