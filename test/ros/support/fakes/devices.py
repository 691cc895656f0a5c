"""A devices node for tests of panels: real ROS messages and services, no controller."""

import threading
import time
from typing import List, Optional

import rospy
from std_srvs.srv import Empty

from roah_rsbb.msg import DevicesState, DevicesStatus
from roah_rsbb.srv import Bool, Percentage

SWITCHES = ("switch_1", "switch_2", "switch_3")
PERCENTAGES = ("dimmer", "blinds")


class FakeDevices:
    """Holds the values that it receives, and publishes them. Tests change its attributes at any time."""

    def __init__(self) -> None:
        self.state = DevicesState()
        self.calls: List[tuple] = []  # (device, value)
        self.refuse: Optional[str] = None  # reason with which every service fails
        self.answer_gate = threading.Event()  # cleared: services do not answer
        self.answer_gate.set()
        self._state = rospy.Publisher("/devices/state", DevicesState, queue_size=10, latch=True)
        self._status = rospy.Publisher("/devices/status", DevicesStatus, queue_size=10, latch=True)
        services = {f"{switch}/set": Bool for switch in SWITCHES}
        services.update({f"{device}/set": Percentage for device in PERCENTAGES})
        services["door_win_detect/mock"] = Bool
        self._services = [
            rospy.Service(f"/devices/{name}", kind, lambda request, name=name: self._on_set(name, request))
            for name, kind in services.items()
        ]
        self._services.append(rospy.Service("/devices/bell/mock", Empty, self._on_ring))
        self.connect(True, "connected to the SmartIF controller at 127.0.0.1:6665")
        self.publish()

    def close(self) -> None:
        """End: topics and services are gone."""
        self.answer_gate.set()
        for service in self._services:
            service.shutdown()
        self._state.unregister()
        self._status.unregister()

    def publish(self, **values: object) -> None:
        """Publish the state, with other values."""
        for name, value in values.items():
            setattr(self.state, name, value)
        self._state.publish(self.state)

    def connect(self, connected: bool, text: str) -> None:
        """The controller is reached, or not."""
        self._status.publish(DevicesStatus(connected, text))

    def _on_set(self, name: str, request: object) -> list:
        device = name.partition("/")[0]
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
