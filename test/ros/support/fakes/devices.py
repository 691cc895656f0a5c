"""A devices node for tests of panels: real ROS messages and services, no controller."""

import threading
import time
from typing import List, Optional

import rospy
from std_srvs.srv import Empty

from roah_rsbb.msg import DevicesState, DevicesStatus
from roah_rsbb.srv import Bool, Percentage
from support.fakes.node import FakeNode

SWITCHES = ("switch_1", "switch_2", "switch_3")
PERCENTAGES = ("dimmer", "blinds")
NODE_SERVICES = {
    **{f"/devices/{switch}/set": Bool for switch in SWITCHES},
    **{f"/devices/{device}/set": Percentage for device in PERCENTAGES},
    "/devices/door_win_detect/mock": Bool,
    "/devices/bell/mock": Empty,
}
NODE = FakeNode({"/devices/state": DevicesState, "/devices/status": DevicesStatus}, NODE_SERVICES)


class FakeDevices:
    """Holds the values that it receives, and publishes them. Tests change its attributes at any time."""

    def __init__(self) -> None:
        self.state = DevicesState()
        self.calls: List[tuple] = []  # (device, value)
        self.refuse: Optional[str] = None  # reason with which every service fails
        self.answer_gate = threading.Event()  # cleared: services do not answer
        self.answer_gate.set()
        setting = [name for name in NODE_SERVICES if name != "/devices/bell/mock"]
        NODE.begin(self, {
            **{name: lambda request, name=name: self._on_set(name, request) for name in setting},
            "/devices/bell/mock": self._on_ring,
        })
        self.connect(True, "connected to the SmartIF controller at 127.0.0.1:6665")
        self.publish()

    def close(self) -> None:
        """The test case is over."""
        self.answer_gate.set()
        NODE.end(self)

    def leave(self) -> None:
        """Topics and services are gone, as if the node's process had ended."""
        self.close()
        NODE.leave()

    def publish(self, **values: object) -> None:
        """Publish the state, with other values."""
        for name, value in values.items():
            setattr(self.state, name, value)
        NODE.publish(self, "/devices/state", self.state)

    def connect(self, connected: bool, text: str) -> None:
        """The controller is reached, or not."""
        NODE.publish(self, "/devices/status", DevicesStatus(connected, text))

    def _on_set(self, name: str, request: object) -> list:
        device = name.split("/")[2]
        self._take(device, request.data)
        self.publish(**{device: request.data})
        return []

    def _on_ring(self, _request: object) -> list:
        self._take("bell", None)
        self.publish(bell=rospy.Time.from_sec(time.time()))
        return []

    def _take(self, device: str, value: object) -> None:
        self.calls.append((device, value))
        self.answer_gate.wait()
        if self.refuse is not None:
            raise rospy.ServiceException(self.refuse)
