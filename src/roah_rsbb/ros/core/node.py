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
from typing import TYPE_CHECKING, Any, Dict, List, Optional

from roah_rsbb.box.program.main import log_to_terminal, serve
from roah_rsbb.box.program.program import BoxProgram, Bridge
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.document.calls import InThread
from roah_rsbb.ground.durable import close_to_others
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.ground.params import KnownParams, Params
from roah_rsbb.ground.signs_of_life import ROS_START, Lifeline

if TYPE_CHECKING:
    from roah_rsbb.ros.core.ros_side import RosSide

# Until referees are warned, if the node is not registered at the ROS master. On a slow computer, rospy takes seconds.
MASTER_S = 10.0
NO_MASTER = ("The ROS master does not answer, or not completely: robots, pages and terminals are served, but no node "
             "of ROS. Check roscore or the roslaunch that started it")
MASTER_ANSWERS = "The ROS master answers again"

_log = logging.getLogger(__name__)


class RosBridge(Bridge):
    """What the box has of ROS. The box does not wait for it: it is made beside the running box."""

    is_there = True
    # Not imported: the box does not wait for rospy.
    modules = (sys.executable, "-m", "roah_rsbb.ros.modules.tf_frames")

    def __init__(self, place: List[str]) -> None:
        """`place`: `NodePlace`."""
        self._place = place
        self.address = place[-1]
        self._ros: Optional[RosSide] = None
        self._rang = False
        self._wishes: Dict[str, SetDevice] = {}  # of robots, for the devices of another node
        self._is_warned = False

    def is_ended(self) -> bool:
        """See `Bridge`."""
        rospy = sys.modules.get("rospy")
        return rospy is not None and bool(rospy.is_shutdown())

    def begin(self, program: BoxProgram) -> None:
        """See `Bridge`."""
        threading.Thread(target=self._join, args=[program], name="ROS", daemon=True).start()
        program.loop.call_later(MASTER_S, self._warn, program)

    def exit(self) -> Any:
        """See `Bridge`."""
        return InThread(_exit)

    def ring_timeout(self) -> None:
        """See `Bridge`."""
        self._rang = self._ros is None
        if self._ros is not None:
            self._ros.publish_timeout()

    def publish_module_runs(self) -> None:
        """See `Bridge`."""
        if self._ros is not None:
            self._ros.publish_module_runs()

    def set_device(self, wish: SetDevice) -> bool:
        """See `Bridge`."""
        if self._ros is not None:
            return self._ros.set_device(wish)
        self._wishes[wish.device] = wish
        return True

    def close(self) -> None:
        """See `Bridge`."""
        if self._ros is not None:
            self._ros.close()

    def _join(self, program: BoxProgram) -> None:
        try:
            from roah_rsbb.ros.core import ros_side

            ros_side.join()
            side = ros_side.RosSide(program)
            call_in_loop(program.loop, lambda: self._use(program, side))
            side.publish_places(self._place)
        except Exception:
            _log.exception("No node of ROS can use this box. Between two runs, end it and start it again")

    def _use(self, program: BoxProgram, side: "RosSide") -> None:
        self._ros = side
        side.use()
        if self._rang:
            side.publish_timeout()
        for wish in self._wishes.values():
            program.set_device(wish)
        if self._is_warned:
            program.event(program.box.watches.repaired, NO_MASTER, MASTER_ANSWERS)

    def _warn(self, program: BoxProgram) -> None:
        if self._ros is None:
            self._is_warned = True
            program.event(program.box.watches.trouble, NO_MASTER)


def _exit() -> None:
    """End the launch, in a thread: its node may hang, or the master. Raises `Refused`."""
    from roah_rsbb.ros.core import ros_side

    ros_side.exit_launch()


def main() -> None:
    """Run the node. One that follows another one has its parameters from the supervisor, and asks no master."""
    close_to_others()
    lifeline = Lifeline()
    kept = lifeline.kept.get(ROS_START, "")
    if kept:
        log_to_terminal()
        values, run_id, place = json.loads(kept)
        params: Params = KnownParams(values)
    else:
        from roah_rsbb.ros.core import ros_side
        from roah_rsbb.ros.node import explain

        explain(str(__doc__))
        ros_side.join(lifeline.wait)
        params = ros_side.CoreParams()
        run_id, place = ros_side.start_of_node()

    def make(loop: asyncio.AbstractEventLoop) -> BoxProgram:
        program = BoxProgram(loop, params, run_id, bridge=RosBridge(place), lifeline=lifeline)
        if not kept:
            lifeline.keep(ROS_START, json.dumps([params.values, run_id, place]))
        return program

    async def work(program: BoxProgram) -> int:
        host, _, door_file, _ = place
        await program.start(door_file, host)
        await asyncio.get_event_loop().create_future()
        return 0

    status = serve(make, work)
    if status and not kept:  # otherwise robots may execute: the supervisor tries again, and stops them
        from roah_rsbb.ros.core import ros_side

        ros_side.join(lifeline.wait)
        ros_side.end_launch()
    # End the process now: roslaunch interrupts all its nodes, which would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
