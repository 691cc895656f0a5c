"""Node roah_rsbb_core: the box itself (docs/ros_interface.md, "Core node").

The only place where the core meets rospy.

Parameters (private; docs/ros_interface.md, "Parameters" explains them): rsbb_host, rsbb_port, bind_host,
benchmarks_file, schedule_file, passwords_file, log_dir, resume, public_results, public_provisional, public_robot_texts,
standings_file, rsbb_cypher, private_mode, robot_timeout, allowed_skew, after_stop_duration, check_messages_saved,
check_messages_saved_timeout, auto_next, display_log_size, max_datagram, listen_duration, take_over, backup_dir,
standby_port, end_launch.
"""

import json
import signal
import sys
import threading
from typing import Callable, List

import rospy
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.box.calls import exit_call
from roah_rsbb.box.parameters import read_parameters
from roah_rsbb.box.running import PERIOD_S, Peripherals, RunningBox
from roah_rsbb.box.standing_by import wait_for_journal, wait_for_takeover
from roah_rsbb.document.calls import EXIT, InThread
from roah_rsbb.durable import close_to_others
from roah_rsbb.journal.file import DamagedJournal
from roah_rsbb.model.referee import Refused
from roah_rsbb.nodes.core.door_place import PublishedDoor
from roah_rsbb.nodes.core.original_topics import OriginalTopics, TimeoutBell
from roah_rsbb.nodes.core.other_nodes import OtherNodes
from roah_rsbb.nodes.core.services import CoreServices
from roah_rsbb.params import BadParams
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.live_core import CORE, wait_for_other_core
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.rulebook import config
from roah_rsbb.signs_of_life import DOORS, Lifeline
from roah_rsbb.wording.whole_box.ending import NOT_LAUNCHED

# Seconds between the messages for panels of the original, and for its public display.
GUI_PERIOD_S, PUBLIC_PERIOD_S = 0.1, 0.5

SHUTDOWN = "roah_rsbb_shutdown"  # the service of the node that ends the launch
# Seconds. The node that ends the launch may still be starting, and ending takes some time.
END_LAUNCH_S = 10.0


class CoreNode:
    """The node, from its parameters to its end. Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or OSError at the
    start."""

    def __init__(self, lifeline: Lifeline) -> None:
        params = read_parameters(NodeParams())
        lifeline.use(params.log_dir)

        def is_ended() -> bool:
            lifeline.wait()
            return bool(rospy.is_shutdown())

        wait_for_takeover(params.log_dir, is_ended)
        lock = wait_for_journal(params.log_dir, is_ended)
        self._ros = ros = RosLoop()
        self._public_due = 0.0  # monotonic (s)
        self._bell = TimeoutBell(ros.loop, lambda: self._running.core.fence.check())
        self._others = OtherNodes(ros)
        self._running = running = RunningBox(
            ros.loop, params, rospy.get_param("/run_id", ""), lock,
            Peripherals(self._bell.ring, self._others.publish_module_runs, self._others.set_device), lifeline)
        self._services = LoopServices(ros.loop, running.core.fence.check)
        CoreServices(running.box, self._services, running.calls)
        running.door.add_calls({EXIT: exit_call(running.door.publish, lambda: InThread(_exit))})
        self._published = PublishedDoor(running.door, lambda path: ros.post(
            lambda: lifeline.keep(DOORS, json.dumps([path]))))

    def run(self) -> None:
        """Run until shut down."""
        running, ros = self._running, self._ros
        ros.loop.run_until_complete(running.ask())
        self._topics = OriginalTopics(ros, running.box, running.now, running.door.publish)
        running.look(self._look, lambda: GUI_PERIOD_S if self._topics.are_wanted else PERIOD_S)
        self._bell.open()
        self._others.open(running)
        running.start()
        self._others.publish_module_runs()
        ros.loop.call_soon(self._published.open)  # it serves in the loop that is running
        ros.run()
        self._published.close()
        self._services.close()
        running.close()
        ros.close()

    def _look(self) -> List[Callable[[], object]]:
        """What is published in each look."""
        todo: List[Callable[[], object]] = [self._topics.publish_to_gui]
        now_mono = self._ros.loop.time()
        if now_mono > self._public_due - GUI_PERIOD_S / 2:
            self._public_due = now_mono + PUBLIC_PERIOD_S
            todo.append(self._topics.publish_to_public)
        return todo


def _exit() -> None:
    """End the launch, in a thread: its node may hang. Raises `Refused`."""
    try:
        rospy.ServiceProxy(SHUTDOWN, EmptySrv)()
    except (rospy.ROSException, rospy.ServiceException) as error:
        raise Refused([NOT_LAUNCHED(error=error)]) from None


def _end_launch() -> None:
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


def main() -> None:
    """Run the node."""
    explain(__doc__)
    close_to_others()
    lifeline = Lifeline()
    wait_for_other_core(lifeline.wait)
    connections.init_node(CORE, disable_signals=True)
    status = 0
    try:
        CoreNode(lifeline).run()
    except (BadParams, config.ConfigErrors, DamagedJournal, OSError) as error:
        for line in str(error).splitlines():
            rospy.logfatal("%s", line)
        status = 1
        _end_launch()
    # End the process now: roslaunch interrupts all its nodes, which would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
