"""The home devices in ROS: those of this box, as the node roah_devices had them, or those of another node.

The core controls the devices. `rosnode list` shows roah_devices all the same, so that whoever looks for it finds its
services. To shut it down alone is refused.

A service call to another node may take long, or hang with it. So each device has its own thread, off the core's loop.
During a call only the latest command waits; commands that it replaces are never carried out.
"""

import contextlib
import os
import threading
from typing import Any, Callable, Dict, List, Optional, Tuple

import rosgraph
import rospy
from rosgraph.xmlrpc import XmlRpcHandler, XmlRpcNode
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.box.program.neighbours import ControlledDevices
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.runs.reported import FIELDS
from roah_rsbb.devices.devices import HomeDevices
from roah_rsbb.devices.smartif import OUTPUTS, BadSetting, Home, devices_state
from roah_rsbb.model.messages import DevicesState
from roah_rsbb.msg import DevicesState as DevicesStateMsg
from roah_rsbb.msg import DevicesStatus
from roah_rsbb.protocol import PERCENTAGES, SWITCHES, WireTime
from roah_rsbb.ros import messages
from roah_rsbb.ros.core.original import publish
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.messages import ros_wire_time
from roah_rsbb.srv import Bool, Percentage

NODE = "/roah_devices"
SHOWN_S = 20.0
# The devices node answers within milliseconds. After this time the referee is warned.
ANSWER_TIMEOUT_S = 3.0
Refused = Callable[[SetDevice, str], None]


class DevicesInRos:
    """Topics and services. Make it after `rospy.init_node`; call everything else in the loop's thread."""

    def __init__(self, services: LoopServices, devices: ControlledDevices, home: HomeDevices) -> None:
        self._devices, self._services = devices, services
        self._state = rospy.Publisher("/devices/state", DevicesStateMsg, queue_size=10, latch=True)
        self._bell = rospy.Publisher("/devices/bell", Empty, queue_size=10)
        self._status = rospy.Publisher("/devices/status", DevicesStatus, queue_size=10, latch=True)
        self._master = rosgraph.Master(NODE)
        self._uri = _show_node()
        self._served: List[rospy.Service] = []
        for device in SWITCHES:
            self._serve_device(home, device, Bool, "on", "off")
        for device in PERCENTAGES:
            self._serve_device(home, device, Percentage, "max", "min")
        self._serve("bell/mock", EmptySrv, lambda r: home.ring())
        self._serve("door_win_detect/mock", Bool, lambda r: home.set_door(r.data))

    def use(self) -> None:
        """Begin to publish."""
        self._devices.follow(self._publish, lambda: publish(self._bell, Empty()), lambda connected, text: publish(
            self._status, DevicesStatus(connected, text)))

    def close(self) -> None:
        """Take roah_devices off the master's list."""
        with contextlib.suppress(OSError, rosgraph.MasterException):  # the master may be gone
            for service in self._served:
                self._master.unregisterService(service.resolved_name, service.uri)

    def _publish(self, home: Home) -> None:
        values = devices_state(home)._asdict()
        publish(self._state, DevicesStateMsg(**{**values, "bell": ros_wire_time(home.bell)}))

    def _serve_device(self, home: HomeDevices, device: str, kind: type, highest: str, lowest: str) -> None:
        for name, value in ((highest, OUTPUTS[device].highest), (lowest, 0)):
            self._serve(f"{device}/{name}", EmptySrv, lambda r, value=value: home.set(device, value))
        self._serve(f"{device}/set", kind, lambda r: home.set(device, int(r.data)))

    def _serve(self, name: str, kind: Any, do: Callable[[Any], object]) -> None:
        def handle(request: Any) -> object:
            try:
                do(request)
            except BadSetting as error:
                raise rospy.ServiceException(str(error)) from None
            return kind._response_class()

        added = self._services.add(f"/devices/{name}", kind, handle)
        self._master.registerService(added.resolved_name, added.uri, self._uri)
        self._served.append(added)


def _show_node() -> str:
    """Serve what programs ask a node, and return its address. Raises `OSError` without one after `SHOWN_S`."""
    shown = _Shown()
    XmlRpcNode(0, shown).start()  # in a thread of its own, which makes the address
    if not shown.is_ready.wait(SHOWN_S):
        raise OSError("This computer opens no port for the node roah_devices")
    return shown.uri


class _Shown(XmlRpcHandler):
    """What programs such as rosnode ask a node."""

    def __init__(self) -> None:
        self.is_ready, self.uri = threading.Event(), ""

    def _ready(self, uri: str) -> None:
        self.uri = uri
        self.is_ready.set()

    def getPid(self, _caller: str) -> Tuple[int, str, int]:
        """Return the process."""
        return 1, "", os.getpid()

    def getBusInfo(self, _caller: str) -> Tuple[int, str, List[Any]]:
        """Return the connections of its topics: the core has them."""
        return 1, "", []

    def shutdown(self, _caller: str, _why: str = "") -> Tuple[int, str, int]:
        """Refuse it: the core has the devices."""
        return 0, "roah_devices is a part of roah_rsbb_core: start the box with devices:=false", 0


class DeviceCalls:
    """Carries out the effect `SetDevice`. `refused(wish, reason)` is called in another thread."""

    def __init__(self, refused: Refused) -> None:
        self._callers: Dict[str, _Caller] = {
            device: _Caller(device, refused) for device in FIELDS if device != "display_map"
        }

    def set(self, wish: SetDevice) -> None:
        """Carry out a command soon; returns immediately."""
        rospy.loginfo("zone %s: the robot sets %s to %d", wish.zone, wish.device, wish.value)
        self._callers[wish.device].set(wish)


class _Caller:
    """Calls the service of one device, in its own thread."""

    def __init__(self, device: str, refused: Refused) -> None:
        self._name = f"/devices/{device}/set"
        self._kind = Bool if device in SWITCHES else Percentage
        self._refused = refused
        self._news = threading.Condition()
        self._next: Optional[SetDevice] = None
        threading.Thread(target=self._run, name=self._name, daemon=True).start()

    def set(self, wish: SetDevice) -> None:
        with self._news:
            self._next = wish
            self._news.notify()

    def _run(self) -> None:
        while True:
            with self._news:
                while self._next is None:
                    self._news.wait()
                wish, self._next = self._next, None
            self._call(wish)

    def _call(self, wish: SetDevice) -> None:
        late = f"{self._name} has not answered within {ANSWER_TIMEOUT_S:.0f} s: check the devices node"
        watch = threading.Timer(ANSWER_TIMEOUT_S, self._refused, (wish, late))
        watch.daemon = True
        watch.start()
        try:
            value = bool(wish.value) if self._kind is Bool else wish.value
            rospy.ServiceProxy(self._name, self._kind)(value)
        except Exception as error:  # a broken connection must not end this thread
            if rospy.is_shutdown():
                return
            text = str(error)
            answered = messages.was_answered(text)
            self._refused(wish, messages.reason(text) if answered else f"no devices node answers ({text})")
        finally:
            watch.cancel()


def devices_of(message: DevicesStateMsg) -> DevicesState:
    """Convert the devices' state to the core's value."""
    bell: WireTime = (message.bell.secs, message.bell.nsecs)
    return DevicesState(
        bell, message.switch_1, message.switch_2, message.switch_3, message.dimmer, message.blinds,
        message.door_win_detect,
    )
