"""Node roah_rsbb_core: the box itself (docs/ros_interface.md, "Core node").

Parameters (private; docs/ros_interface.md, "Parameters" explains them): rsbb_host, rsbb_port, bind_host,
benchmarks_file, schedule_file, passwords_file, log_dir, resume, public_results, public_provisional, public_robot_texts,
standings_file, rsbb_cypher, private_mode, robot_timeout, allowed_skew, after_stop_duration, check_messages_saved,
check_messages_saved_timeout, auto_next, display_log_size, max_datagram, listen_duration, take_over, backup_dir,
standby_port, end_launch. Of its neighbours: bell_ring_command, timeout_ring_command; modules, modules_dir and
benchmarks (codes with blanks between them; default: all); web, web_port, web_host, web_names, web_cert, web_key,
web_logos, title, team_pages; tablet, tablet_port, tablet_host, map_file; devices. Of the devices: smartif_host,
smartif_port (TCP), which are those of roah_devices.
"""

import asyncio
import json
import logging
import signal
import sys
import threading
from typing import TYPE_CHECKING, Dict, Optional

from roah_rsbb import platform
from roah_rsbb.box.calls import exit_call
from roah_rsbb.box.parameters import read_parameters
from roah_rsbb.box.program.main import log_to_terminal
from roah_rsbb.box.program.parts import ControlledDevices, DrivenModules, Sounds, WebParts
from roah_rsbb.box.program.supervisor import CopyingProcess
from roah_rsbb.box.running import Peripherals, RunningBox
from roah_rsbb.box.standing_by import wait_for_journal, wait_for_takeover
from roah_rsbb.copies.settings import copy_settings
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.document.calls import EXIT, InThread
from roah_rsbb.durable import close_to_others
from roah_rsbb.in_loop import call_in_loop
from roah_rsbb.journal.file import DamagedJournal
from roah_rsbb.nodes.core.door_place import DoorHosts, PublishedDoor
from roah_rsbb.params import BadParams, KnownParams, Params
from roah_rsbb.rulebook import config
from roah_rsbb.signs_of_life import DOORS, ROS_START, Lifeline

if TYPE_CHECKING:
    from roah_rsbb.nodes.core.ros_side import RosSide

# Until referees are warned, if the node is not registered at the ROS master. On a slow computer, rospy takes seconds.
MASTER_S = 10.0
LOOK_S = 1.0
# The program with the benchmarking modules. It is not imported: the box does not wait for rospy.
MODULES = (sys.executable, "-m", "roah_rsbb.nodes.modules.of_box")
NO_MASTER = ("The ROS master does not answer, or not completely: robots, pages and terminals are served, but no node "
             "of ROS. Check roscore or the roslaunch that started it")
MASTER_ANSWERS = "The ROS master answers again"

_log = logging.getLogger(__name__)


class CoreNode:
    """The node, from its parameters to its end. The box does not wait for ROS: what needs it is made beside it.

    Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or OSError at the start."""

    def __init__(self, params: Params, run_id: str, hosts: DoorHosts, lifeline: Lifeline) -> None:
        """`run_id`: of the launch. rospy need not be initialised."""
        found = read_parameters(params)
        self._sounds = Sounds(params)
        copying = copy_settings(params)
        self._copying = CopyingProcess(lambda: copying)
        lifeline.use(found.log_dir)

        def is_ended() -> bool:
            lifeline.wait()
            rospy = sys.modules.get("rospy")
            return rospy is not None and bool(rospy.is_shutdown())

        wait_for_takeover(found.log_dir, is_ended)
        lock = wait_for_journal(found.log_dir, is_ended)
        self.loop = asyncio.new_event_loop()
        self.running = running = RunningBox(
            self.loop, found, run_id, lock,
            Peripherals(self._ring, self._publish_module_runs, self._set_device), lifeline)
        self._devices = ControlledDevices(self.loop, params, found.log_dir, self._sounds.ring_bell, run_id)
        params.done()
        running.door.add_calls({EXIT: exit_call(running.door.publish, lambda: InThread(_exit))})
        self._web = WebParts(self.loop, params, running, address=hosts.address)
        self._published = PublishedDoor(
            running.door, hosts, json.loads(lifeline.kept.get(DOORS, "[]")),
            lambda paths: self.loop.call_soon_threadsafe(lifeline.keep, DOORS, json.dumps(paths)), found.log_dir)
        self._is_supervised = lifeline.has_supervisor
        self._ros: Optional[RosSide] = None
        self._modules: Optional[DrivenModules] = None
        if params.flag("modules", False):
            self._modules = DrivenModules(self.loop, params, program=MODULES)
        params.done()
        self._rang = False
        self._wishes: Dict[str, SetDevice] = {}  # of robots, for the devices of another node
        self._is_warned, self._why = False, "shutdown"

    def run(self) -> None:
        """Run until shut down."""
        asyncio.set_event_loop(self.loop)
        self.loop.run_until_complete(self.running.ask())
        self.running.start()
        self._devices.start(self.running)
        if self._modules is not None:
            self._modules.start(self.running)
        self._web.start()
        self.loop.call_soon(self._published.open)  # it serves in the loop that is running
        threading.Thread(target=self._join_ros, name="ROS", daemon=True).start()
        self.loop.call_later(MASTER_S, self._warn)
        if not self._is_supervised:
            self._keep_copying()
        for number in (signal.SIGINT, signal.SIGTERM):
            self.loop.add_signal_handler(number, self._stop, f"signal {number}")
        self.loop.run_forever()
        self._web.close()
        self._published.close()
        if self._ros is not None:
            self._ros.close_services()
        if self._modules is not None:
            self._modules.close()
        self._devices.close()
        self._sounds.close()
        self.running.close()
        self._copying.end()
        if self._ros is not None:
            self._ros.close(self._why)
        else:
            platform.end_loop(self.loop)

    def _keep_copying(self) -> None:
        """Copy the journal; of a node with a supervisor, that one does."""
        self.loop.call_later(LOOK_S, self._keep_copying)
        self._copying.look()

    def _stop(self, why: str) -> None:
        self._why = why
        self.loop.stop()

    def _join_ros(self) -> None:
        try:
            from roah_rsbb.nodes.core import ros_side

            ros_side.join()
            side = ros_side.RosSide(self.loop, self.running, self._devices, self._sounds.ring_bell)
            call_in_loop(self.loop, lambda: self._use(side))
            self._published.publish()
            self._published.publish_pages({"url": self._web.url, "tablet_url": self._web.tablet_url})
        except Exception:
            _log.exception("No node of ROS can use this box. Between two runs, end it and start it again")

    def _use(self, side: "RosSide") -> None:
        self._ros = side
        side.use()
        if self._rang:
            side.publish_timeout()
        for wish in self._wishes.values():
            self._set_device(wish)
        if self._is_warned:
            self.running.event(self.running.box.on_repaired, NO_MASTER, MASTER_ANSWERS)

    def _warn(self) -> None:
        if self._ros is None:
            self._is_warned = True
            self.running.event(self.running.box.on_trouble, NO_MASTER)

    def _ring(self) -> None:
        self._sounds.ring_timeout()
        self._rang = self._ros is None
        if self._ros is not None:
            self._ros.publish_timeout()

    def _set_device(self, wish: SetDevice) -> None:
        if self._devices.home is not None:
            self._devices.set(wish)
        elif self._ros is not None:
            self._ros.others.set_device(wish)
        else:
            self._wishes[wish.device] = wish

    def _publish_module_runs(self) -> None:
        if self._modules is not None:
            self._modules.publish_runs()
        if self._ros is not None:
            self._ros.others.publish_module_runs()


def _exit() -> None:
    """End the launch, in a thread: its node may hang, or the master. Raises `Refused`."""
    from roah_rsbb.nodes.core import ros_side

    ros_side.exit_launch()


def main() -> None:
    """Run the node. One that follows another one has its parameters from the supervisor, and asks no master."""
    close_to_others()
    lifeline = Lifeline()
    status, kept = 0, lifeline.kept.get(ROS_START, "")
    try:
        if kept:
            log_to_terminal()
            values, run_id, hosts = json.loads(kept)
            params: Params = KnownParams(values)
        else:
            from roah_rsbb.nodes.core import ros_side
            from roah_rsbb.ros.command_line import explain

            explain(str(__doc__))
            ros_side.join(lifeline.wait)
            params = ros_side.CoreParams()
            run_id, hosts = ros_side.start_of_node()
        node = CoreNode(params, run_id, DoorHosts(*hosts), lifeline)
        if not kept:
            lifeline.keep(ROS_START, json.dumps([params.values, run_id, hosts]))
        node.run()
    except (BadParams, config.ConfigErrors, DamagedJournal, OSError) as error:
        for line in str(error).splitlines():
            _log.critical("%s", line)
        status = 1
        if not kept:  # otherwise robots may execute: the supervisor tries again, and stops them
            from roah_rsbb.nodes.core import ros_side

            ros_side.join(lifeline.wait)
            ros_side.end_launch()
    # End the process now: roslaunch interrupts all its nodes, which would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
