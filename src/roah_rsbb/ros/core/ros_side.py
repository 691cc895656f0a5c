"""What the node roah_rsbb_core has of ROS. The only place where the core meets rospy.

The box runs already, and never waits for it: all of this is made in a thread, which may wait for the ROS master. A part
that fails is missing, and the others work.
"""

import logging
import signal
import threading
import time
from typing import Callable, List, Optional, Tuple, TypeVar

import rosgraph
import rospy
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.box.program.program import PERIOD_S, BoxProgram
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.core.modules import MAX_NODES
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.model.reason import Refused
from roah_rsbb.msg import DevicesState, DevicesStatus, ModuleRuns, ModulesState
from roah_rsbb.ros import connections
from roah_rsbb.ros.core.devices import NODE, DeviceCalls, DevicesInRos, devices_of
from roah_rsbb.ros.core.original import CoreServices, OriginalTopics, publish
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.modules import convert
from roah_rsbb.ros.node import Newest, NodeParams, RosLoop
from roah_rsbb.ros.places import CORE, NodePlace, place_of_node, publish_door, publish_param, wait_for_other_core
from roah_rsbb.wording.whole_box import NOT_LAUNCHED

# Seconds between the messages for panels of the original, and for its public display.
GUI_PERIOD_S, PUBLIC_PERIOD_S = 0.1, 0.5

PAGES = "/roah_rsbb_web"  # the parameters with the addresses of web pages are below it
SHUTDOWN = "roah_rsbb_shutdown"  # the service of the node that ends the launch
# Seconds. The node that ends the launch may still be starting, and ending takes some time.
END_LAUNCH_S = 10.0
MASTER_LOOK_S = 0.5
# Seconds in which programs on a busy computer find the topics of a core that follows another one.
LISTENERS_S = 10.0

_log = logging.getLogger(__name__)
T = TypeVar("T")


def part(what: str, make: Callable[[], T]) -> Optional[T]:
    """Return a part of the core's side in ROS; None: it failed, and the log says so."""
    try:
        return make()
    except Exception:
        _log.exception("ROS: %s cannot be used. All else works. Between two runs, end the box and start it again", what)
        return None


def join(on_look: Callable[[], object] = lambda: None) -> None:
    """Register the node at the ROS master, unless it is. Waits for a master that does not answer, and while another
    core is there. `on_look` is called whenever it looks."""
    if rospy.core.is_initialized():
        return
    while not _master_answers():
        on_look()
        time.sleep(MASTER_LOOK_S)
    wait_for_other_core(on_look)
    connections.init_node(CORE, disable_signals=True)


def _master_answers() -> bool:
    try:
        rosgraph.Master("/roah_rsbb_core").getPid()
    except (OSError, rosgraph.MasterException):
        return False
    return True


def start_of_node() -> Tuple[str, List[str]]:
    """Return the launch's id, and `NodePlace` of this node."""
    return str(rospy.get_param("/run_id", "")), list(place_of_node())


class CoreParams(NodeParams):
    """The parameters of the core. Those of the home devices are in the place that they always had."""

    def full_name(self, name: str) -> str:
        """See `Params`."""
        return f"{NODE}/{name}" if name.startswith("smartif_") else super().full_name(name)


class RosSide:
    """Topics and services. Make it in a thread after `join`; call everything else in the loop's thread."""

    def __init__(self, program: BoxProgram) -> None:
        loop, devices = program.loop, program.devices
        self._ros = ros = RosLoop(loop)
        self._program = program
        self._public_due = 0.0  # monotonic (s)
        self._listeners_until = loop.time() + LISTENERS_S
        self._timeout = part("the topic of timeouts", lambda: rospy.Publisher("/timeout", Empty, queue_size=1))
        self._modules = part("modules in other nodes", lambda: ModuleNodes(ros, program))
        self._topics = part("the topics of the original's panels", lambda: OriginalTopics(
            ros, program.box, program.now, program.door.publish))
        self._services = services = part("all services", lambda: call_in_loop(
            loop, lambda: LoopServices(loop, program.game.fence.check)))
        self._devices: Optional[DevicesInRos] = None
        self._devices_node: Optional[DevicesNode] = None
        if services is not None:
            part("the original's services", lambda: CoreServices(program.box, services, program.calls))
        home = devices.home
        if home is None:
            self._devices_node = part("the node of the home devices", lambda: DevicesNode(ros, program))
        elif services is not None:
            self._devices = part("the home devices", lambda: DevicesInRos(services, devices, home))

    def use(self) -> None:
        """Begin to publish."""
        topics, devices = self._topics, self._devices
        if topics is not None:
            self._program.look(lambda: self._look(topics), lambda: GUI_PERIOD_S if topics.are_wanted else PERIOD_S)
        self.publish_module_runs()
        if devices is not None:
            part("the home devices", devices.use)
        rospy.core.add_preshutdown_hook(lambda reason: self._ros.post(self._program.on_exit))

    def publish_places(self, place: List[str]) -> None:
        """Say at the master where the door is, and the pages when they are served."""
        publish_door(NodePlace(*place), self._program.port, self._program.door.token)
        for name, url in (("url", self._program.web.url), ("tablet_url", self._program.web.tablet_url)):
            publish_param(f"{PAGES}/{name}", url.result)

    def publish_timeout(self) -> None:
        """A run timed out, maybe while the core was down: shortly after the start, wait for the first one to listen."""
        self._program.game.fence.check()
        loop = self._ros.loop
        if self._timeout is None:
            return
        if self._timeout.get_num_connections() > 0 or loop.time() > self._listeners_until:
            publish(self._timeout, Empty())
        else:
            loop.call_later(PERIOD_S, self.publish_timeout)

    def publish_module_runs(self) -> None:
        """Publish the runs that have a benchmarking module."""
        if self._modules is not None:
            self._modules.publish_runs()

    def set_device(self, wish: SetDevice) -> bool:
        """Let the node of the home devices carry out a robot's command. Returns whether that is possible."""
        if self._devices_node is not None:
            self._devices_node.set(wish)
        return self._devices_node is not None

    def close(self) -> None:
        """Take no more calls, and end the ROS node."""
        if self._services is not None:
            self._services.close()
        if self._devices is not None:
            self._devices.close()
        self._ros.end_node()

    def _look(self, topics: OriginalTopics) -> List[Callable[[], object]]:
        """What is published in each look."""
        todo: List[Callable[[], object]] = [topics.publish_to_gui]
        now_mono = self._ros.loop.time()
        if now_mono > self._public_due - GUI_PERIOD_S / 2:
            self._public_due = now_mono + PUBLIC_PERIOD_S
            todo.append(topics.publish_to_public)
        return todo


def exit_launch() -> None:
    """End the launch, in a thread: its node may hang. Raises `Refused`."""
    try:
        rospy.ServiceProxy(SHUTDOWN, EmptySrv)()
    except (rospy.ROSException, rospy.ServiceException, OSError) as error:
        raise Refused([NOT_LAUNCHED(error=error)]) from None


def end_launch() -> None:
    """End the whole launch, if this node was launched in one, because a restart cannot repair the error.

    Returns once roslaunch interrupts this process, too. If this process ended before that, roslaunch would restart it.
    """
    if not rospy.get_param("~end_launch", False):
        return
    interrupted = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: interrupted.set())
    try:
        rospy.wait_for_service(SHUTDOWN, timeout=END_LAUNCH_S)
        rospy.ServiceProxy(SHUTDOWN, EmptySrv)()
    except (rospy.ROSException, rospy.ServiceException) as error:
        rospy.logerr("the launch could not be ended (%s): end it with Ctrl-C", error)
    else:
        interrupted.wait(END_LAUNCH_S)


class ModuleNodes:
    """The nodes of benchmarking modules. What they say becomes events of the box."""

    def __init__(self, ros: RosLoop, program: BoxProgram) -> None:
        self._program = program
        self._states = Newest(ros.post, self._take, MAX_NODES)
        self._runs = rospy.Publisher("/core/module_runs", ModuleRuns, queue_size=1, latch=True)
        rospy.Subscriber("/modules/state", ModulesState, self._on_state, queue_size=10, tcp_nodelay=True)

    def publish_runs(self) -> None:
        """Publish the runs that have a benchmarking module."""
        self._program.game.fence.check()
        publish(self._runs, convert.runs_message(self._program.uuid, self._program.box.modules.runs()))

    def _take(self, state: object) -> None:
        self._program.event(self._program.box.modules.on_modules, state)

    def _on_state(self, message: ModulesState) -> None:
        state = convert.modules_state_of(message)
        self._states.put(state.node, state)


class DevicesNode:
    """The node of the home devices, if this box does not control them. What it says becomes events of the box."""

    def __init__(self, ros: RosLoop, program: BoxProgram) -> None:
        self._ros, self._box, self._event = ros, program.box, program.event
        self._calls = DeviceCalls(self._on_refused)
        self.set = self._calls.set
        rospy.Subscriber("/devices/state", DevicesState, self._on_state, queue_size=10)
        rospy.Subscriber("/devices/bell", Empty, lambda _: program.ring_bell(), queue_size=10)
        rospy.Subscriber("/devices/status", DevicesStatus, self._on_status, queue_size=10)

    def _on_state(self, message: DevicesState) -> None:
        devices = devices_of(message)
        self._ros.post(lambda: self._event(self._box.devices.on_state, devices))

    def _on_status(self, message: DevicesStatus) -> None:
        self._ros.post(lambda: self._event(self._box.devices.on_status, message.connected, message.text))

    def _on_refused(self, wish: SetDevice, reason: str) -> None:
        self._ros.post(lambda: self._event(self._box.devices.on_refused, wish.zone, wish.device, wish.value, reason))
