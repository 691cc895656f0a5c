"""What the core exchanges with other nodes: benchmarking modules, and home devices that this box does not control."""

from typing import Callable, Optional

import rospy
from std_msgs.msg import Empty

from roah_rsbb.box.running import RunningBox
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.modules import MAX_NODES
from roah_rsbb.msg import DevicesState, DevicesStatus, ModuleRuns, ModulesState
from roah_rsbb.nodes.core.device_calls import DeviceCalls, devices_of
from roah_rsbb.nodes.core.original_topics import publish
from roah_rsbb.nodes.modules import convert
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.newest import Newest


class OtherNodes:
    """The topics of the other nodes. What they say becomes events of the box."""

    def __init__(self, ros: RosLoop, on_bell: Callable[[], object]) -> None:
        """`on_bell` is called in a thread of rospy when the bell rings."""
        self._ros, self._on_bell = ros, on_bell
        self._running: Optional[RunningBox] = None
        self._devices: Optional[DeviceCalls] = None

    def open(self, running: RunningBox, has_devices: bool) -> None:
        """Create the topics. `has_devices`: this box controls the home devices."""
        self._running, self._core, self._box, self._event = running, running.core, running.box, running.event
        self._modules = Newest(self._ros.post, self._take_modules, MAX_NODES)
        self._module_runs = rospy.Publisher("/core/module_runs", ModuleRuns, queue_size=1, latch=True)
        rospy.Subscriber("/modules/state", ModulesState, self._on_modules, queue_size=10, tcp_nodelay=True)
        if not has_devices:
            self._devices = DeviceCalls(self._on_device_refused)
            rospy.Subscriber("/devices/state", DevicesState, self._on_devices, queue_size=10)
            rospy.Subscriber("/devices/bell", Empty, lambda _: self._on_bell(), queue_size=10)
            rospy.Subscriber("/devices/status", DevicesStatus, self._on_devices_status, queue_size=10)

    def set_device(self, wish: SetDevice) -> None:
        """Carry out a robot's command for a home device."""
        assert self._devices is not None, "another node controls the devices"
        self._devices.set(wish)

    def publish_module_runs(self) -> None:
        """Publish the runs that have a benchmarking module."""
        if self._running is not None:
            self._publish(self._module_runs, convert.runs_message(self._running.uuid, self._box.modules.runs()))

    def _publish(self, topic: rospy.Publisher, message: object) -> None:
        self._core.fence.check()
        publish(topic, message)

    def _on_devices(self, message: DevicesState) -> None:
        devices = devices_of(message)
        self._ros.post(lambda: self._event(self._box.on_devices, devices))

    def _on_devices_status(self, message: DevicesStatus) -> None:
        self._ros.post(lambda: self._event(self._box.on_devices_status, message.connected, message.text))

    def _on_device_refused(self, wish: SetDevice, reason: str) -> None:
        self._ros.post(lambda: self._event(self._box.on_device_refused, wish.zone, wish.device, wish.value, reason))

    def _take_modules(self, state: object) -> None:
        self._event(self._box.modules.on_modules, state)

    def _on_modules(self, message: ModulesState) -> None:
        state = convert.modules_state_of(message)
        self._modules.put(state.node, state)
