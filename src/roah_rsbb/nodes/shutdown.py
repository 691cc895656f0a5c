"""Nodes roah_rsbb_core_shutdown and roah_rsbb_shutdown: they end the launch that started them, when asked to.

Their service `roah_rsbb_shutdown` (in the node's namespace) ends the whole RSBB, or only one client
(docs/ros_interface.md, "Core node"). It interrupts roslaunch, as Ctrl-C does. A node that ends in another way is
started again, and ends nothing.

The node ends when roslaunch was killed. A killed roslaunch leaves its nodes running, and the service could no longer
end them.

The core's one also ends a core that hangs, so that roslaunch starts the next one, which continues its runs.

Parameter (private): log_dir: of the core that it watches (none: it watches no core).
"""

import contextlib
import os
import signal
import threading
import time

import rospy
from std_srvs.srv import Empty, EmptyResponse

from roah_rsbb.log_lines import LogLines
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.signs_of_life import LOOK_S, STARTING, SUPERVISOR, Signs, Watch, state_of

# Delay of the shutdown, so that the caller gets its answer.
ANSWER_S = 0.2


def _end(launch: int) -> None:
    """Interrupt roslaunch, unless another process has its number by now."""
    if os.getppid() == launch:
        with contextlib.suppress(ProcessLookupError):
            os.kill(launch, signal.SIGINT)


class Supervisor:
    """Ends a core that hangs. Call `look` every `LOOK_S`."""

    def __init__(self, log_dir: str) -> None:
        self._watch, self._signs = Watch(log_dir, SUPERVISOR, time.monotonic), Signs(log_dir)
        self._ended = 0  # the process that was ended last

    def look(self) -> None:
        """End the core if it has not answered for `HUNG_S`."""
        self._watch.look()
        if self._watch.is_gone:
            self._signs.send(STARTING)  # the standby is to wait for it
        pid = self._watch.silence.pid
        if self._watch.is_hung and pid != self._ended:
            why, self._ended = state_of(pid), pid
            self._watch.kill()
            rospy.logerr("The core (process %d) has not answered for %g s: %s. It is ended, and the next one continues "
                         "its runs", pid, self._watch.patience_s, why)

    def wait(self) -> None:
        """Wait for the next look."""
        self._watch.wait(LOOK_S)


def main() -> None:
    """Entry point of the node."""
    explain(__doc__)
    launch = os.getppid()

    def on_call(_request: object) -> EmptyResponse:
        rospy.loginfo("roah_rsbb_shutdown was called: ending this launch")
        threading.Timer(ANSWER_S, _end, [launch]).start()
        return EmptyResponse()

    connections.init_node("roah_rsbb_shutdown")
    params = NodeParams()
    log_lines = LogLines()  # the supervisor must not wait for the terminal
    log_dir = params.path_or_none("log_dir")
    supervisor = Supervisor(log_dir) if log_dir else None
    params.done()
    rospy.Service("roah_rsbb_shutdown", Empty, on_call)
    while not rospy.is_shutdown():
        if os.getppid() != launch:
            rospy.signal_shutdown("the process that started this node is gone")
        if supervisor is None:
            rospy.rostime.wallsleep(LOOK_S)
        else:
            supervisor.look()
            supervisor.wait()
    log_lines.close()
