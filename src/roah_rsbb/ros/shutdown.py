"""Nodes roah_rsbb_core_shutdown and roah_rsbb_shutdown: they end the launch that started them, when asked to.

Their service `roah_rsbb_shutdown` (in the node's namespace) ends the whole RSBB, or only one client
(docs/ros_interface.md, "Core node"). It interrupts roslaunch, as Ctrl-C does. A node that ends in another way is
started again, and ends nothing.

The node ends when roslaunch was killed. A killed roslaunch leaves its nodes running, and the service could no longer
end them.
"""

import contextlib
import os
import signal
import threading

import rospy
from std_srvs.srv import Empty, EmptyResponse

from roah_rsbb.ros import connections
from roah_rsbb.ros.node import explain

# Delay of the shutdown, so that the caller gets its answer.
ANSWER_S = 0.2
# How often it looks whether roslaunch is there.
LOOK_S = 0.1


def _end(launch: int) -> None:
    """Interrupt roslaunch, unless another process has its number by now."""
    if os.getppid() == launch:
        with contextlib.suppress(ProcessLookupError):
            os.kill(launch, signal.SIGINT)


def main() -> None:
    """Entry point of the node."""
    explain(__doc__)
    launch = os.getppid()

    def on_call(_request: object) -> EmptyResponse:
        rospy.loginfo("roah_rsbb_shutdown was called: ending this launch")
        threading.Timer(ANSWER_S, _end, [launch]).start()
        return EmptyResponse()

    connections.init_node("roah_rsbb_shutdown")
    rospy.Service("roah_rsbb_shutdown", Empty, on_call)
    while not rospy.is_shutdown():
        if os.getppid() != launch:
            rospy.signal_shutdown("the process that started this node is gone")
        rospy.rostime.wallsleep(LOOK_S)
