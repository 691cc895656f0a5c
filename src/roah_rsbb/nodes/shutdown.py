"""Nodes roah_rsbb_core_shutdown and roah_rsbb_shutdown: when one ends, its launch ends.

Launch files start one of them as *required*. Its service `roah_rsbb_shutdown` (in the node's namespace) ends the node,
and with it the whole RSBB, or only one client (docs/ros_interface.md, "Core node").

The node also ends when roslaunch was killed. A killed roslaunch leaves its nodes running, and the service could no
longer end them.
"""

import os
import threading

import rospy
from std_srvs.srv import Empty, EmptyResponse

from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain

# Delay of the shutdown, so that the caller gets its answer.
ANSWER_S = 0.2
# How often to check that roslaunch is still running, in seconds.
LOOK_S = 0.5


def _on_call(_request: object) -> EmptyResponse:
    rospy.loginfo("roah_rsbb_shutdown was called: ending this launch")
    threading.Timer(ANSWER_S, rospy.signal_shutdown, ["roah_rsbb_shutdown was called"]).start()
    return EmptyResponse()


def main() -> None:
    """Entry point of the node."""
    explain(__doc__)
    parent = os.getppid()
    connections.init_node("roah_rsbb_shutdown")
    rospy.Service("roah_rsbb_shutdown", Empty, _on_call)
    while not rospy.is_shutdown():
        if os.getppid() != parent:
            rospy.signal_shutdown("the process that started this node is gone")
        rospy.rostime.wallsleep(LOOK_S)
