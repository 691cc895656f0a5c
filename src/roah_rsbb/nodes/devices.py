"""Node roah_devices: the home devices (docs/ros_interface.md, "Devices node"). It offers their calls to the box.

The node keeps all values, and sends them to the SmartIF controller immediately or after the next connection;
/devices/status (latched) has the state of the connection. After a crash, the node restores its values from the
parameter server.

Parameters (private): smartif_host, smartif_port (TCP).
"""

import rosgraph
import rospy
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv
from std_srvs.srv import EmptyResponse

from roah_rsbb.client.client import Client, Offer
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.devices.devices import HomeDevices
from roah_rsbb.devices.home import OUTPUTS, BadSetting, Home, devices_state
from roah_rsbb.document.calls import HELPER
from roah_rsbb.model.document import Document
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
        self._state = rospy.Publisher("/devices/state", DevicesState, queue_size=10, latch=True)
        self._bell = rospy.Publisher("/devices/bell", Empty, queue_size=10)
        self._status = rospy.Publisher("/devices/status", DevicesStatus, queue_size=10, latch=True)
        self._devices = HomeDevices(
            self._ros.loop, host, port, on_state=self._publish, on_bell=lambda: self._bell.publish(Empty()),
            on_status=lambda connected, text: self._status.publish(DevicesStatus(connected, text)),
            saved=rospy.get_param(SAVED, None), save=lambda values: rospy.set_param(SAVED, values))
        self._box: Client[Document] = Client(
            Document, DoorPlaces(rosgraph.get_master_uri()).find, loop=self._ros.loop, face=HELPER,
            offer=Offer(self._devices.calls(), rospy.get_name()))

    def run(self) -> None:
        """Run until shut down."""
        self._devices.start()
        self._box.start()
        self._serve()
        self._ros.run()
        self._box.close()
        self._devices.close()
        self._ros.close()

    def _publish(self, home: Home) -> None:
        values = devices_state(home)._asdict()
        self._state.publish(DevicesState(**{**values, "bell": ros_wire_time(home.bell)}))

    # -- services, in threads of rospy ----------------------------------------------------------------

    def _serve(self) -> None:
        for device in SWITCHES:
            self._serve_device(device, Bool, "on", "off")
        for device in PERCENTAGES:
            self._serve_device(device, Percentage, "max", "min")
        rospy.Service("/devices/bell/mock", EmptySrv, lambda _: self._call(EmptyResponse, self._devices.ring))
        rospy.Service(
            "/devices/door_win_detect/mock", Bool,
            lambda r: self._call(Bool._response_class, lambda: self._devices.set_door(r.data)),
        )

    def _serve_device(self, device: str, kind: type, highest: str, lowest: str) -> None:
        for name, value in ((highest, OUTPUTS[device].highest), (lowest, 0)):
            rospy.Service(
                f"/devices/{device}/{name}", EmptySrv,
                lambda _, value=value: self._call(EmptyResponse, lambda: self._devices.set(device, value)),
            )
        rospy.Service(
            f"/devices/{device}/set", kind,
            lambda r: self._call(kind._response_class, lambda: self._devices.set(device, int(r.data))),
        )

    def _call(self, response: type, do) -> object:
        try:
            self._ros.call(do)
        except BadSetting as error:
            raise rospy.ServiceException(str(error)) from None
        return response()


def main() -> None:
    """Entry point of the node."""
    run_node("roah_devices", __doc__, DevicesNode, disable_signals=True)
