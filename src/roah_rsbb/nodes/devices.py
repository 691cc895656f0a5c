"""Node roah_devices: the home devices (docs/ros_interface.md, "Devices node").

The node keeps all values, and sends them to the SmartIF controller immediately or after the next connection;
/devices/status (latched) has the state of the connection. After a crash, the node restores its values from the
parameter server.

Parameters (private): smartif_host, smartif_port (TCP).
"""

import concurrent.futures
import time

import rospy
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv
from std_srvs.srv import EmptyResponse

from roah_rsbb.devices.client import SmartIfClient
from roah_rsbb.devices.home import OUTPUTS, BadSetting, Home
from roah_rsbb.msg import DevicesState, DevicesStatus
from roah_rsbb.protocol import PERCENTAGES, SWITCHES
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.ros.times import ros_wire_time
from roah_rsbb.srv import Bool, Percentage

SAVED = "~held"


class DevicesNode:
    """The node. Raises `BadParams` at the start."""

    def __init__(self) -> None:
        params = NodeParams()
        host = params.text("smartif_host", "192.168.1.56")
        port = params.whole("smartif_port", 6665, 1, 65535)
        params.done()
        self._ros = RosLoop()
        self._saver = concurrent.futures.ThreadPoolExecutor(max_workers=1)
        self._home = Home()
        self._home.restore(rospy.get_param(SAVED, None))
        self._state = rospy.Publisher("/devices/state", DevicesState, queue_size=10, latch=True)
        self._bell = rospy.Publisher("/devices/bell", Empty, queue_size=10)
        self._status = rospy.Publisher("/devices/status", DevicesStatus, queue_size=10, latch=True)
        self._client = SmartIfClient(host, port, self._home, self._ring, self._on_status)
        text = f"connecting to the SmartIF controller at {host}:{port}"
        rospy.loginfo("%s", text)
        self._status.publish(DevicesStatus(False, text))

    def run(self) -> None:
        """Run until shut down."""
        self._publish()
        self._serve()
        self._connection = self._ros.loop.create_task(self._client.run())
        self._ros.run()
        self._saver.shutdown(wait=False)
        self._ros.close()

    # -- services, in threads of rospy ----------------------------------------------------------------

    def _serve(self) -> None:
        for device in SWITCHES:
            self._serve_device(device, Bool, "on", "off")
        for device in PERCENTAGES:
            self._serve_device(device, Percentage, "max", "min")
        rospy.Service("/devices/bell/mock", EmptySrv, lambda _: self._call(EmptyResponse, self._ring))
        rospy.Service(
            "/devices/door_win_detect/mock", Bool,
            lambda r: self._call(Bool._response_class, lambda: self._set_door(r.data)),
        )

    def _serve_device(self, device: str, kind: type, highest: str, lowest: str) -> None:
        for name, value in ((highest, OUTPUTS[device].highest), (lowest, 0)):
            rospy.Service(
                f"/devices/{device}/{name}", EmptySrv,
                lambda _, value=value: self._call(EmptyResponse, lambda: self._set(device, value)),
            )
        rospy.Service(
            f"/devices/{device}/set", kind,
            lambda r: self._call(kind._response_class, lambda: self._set(device, int(r.data))),
        )

    def _call(self, response: type, do) -> object:
        try:
            self._ros.call(do)
        except BadSetting as error:
            raise rospy.ServiceException(str(error)) from None
        return response()

    # -- in the loop's thread ---------------------------------------------------------------------------

    def _set(self, device: str, value: int) -> None:
        self._client.send(self._home.set(device, value))
        if not self._client.connected:
            rospy.logwarn("%s is set to %d, which the controller receives when it is connected", device, value)
        self._publish()

    def _set_door(self, opened: bool) -> None:
        self._home.door = bool(opened)
        self._publish()

    def _ring(self) -> None:
        rospy.loginfo("The bell rings")
        nsec = time.time_ns()
        self._home.bell = (nsec // 10**9, nsec % 10**9)
        self._publish()
        self._bell.publish(Empty())

    def _on_status(self, connected: bool, text: str) -> None:
        (rospy.loginfo if connected else rospy.logwarn)("%s", text)
        self._status.publish(DevicesStatus(connected, text))

    def _publish(self) -> None:
        home = self._home
        self._state.publish(DevicesState(bell=ros_wire_time(home.bell), door_win_detect=home.door, **home.values))
        self._saver.submit(_save, home.saved())


def _save(saved: object) -> None:
    """Save values in another thread, because the master may be slow or absent."""
    try:
        rospy.set_param(SAVED, saved)
    except Exception as error:
        rospy.logwarn_throttle(60.0, f"the values cannot be saved for a restart of this node: {error}")


def main() -> None:
    """Entry point of the node."""
    run_node("roah_devices", __doc__, DevicesNode, disable_signals=True)
