"""The ROS node of a program with windows."""

import sys
import threading

import rosgraph
import rospy

from roah_rsbb.ros import connections

# A parameter in the client's namespace (launch/roah_rsbb_client.launch).
TIMES_IN_UTC = "times_in_utc"
# How often a start that waits for a master looks for it, seconds.
LOOK_S = 0.2


class WindowNode:
    """A node. In rqt, whose node it is, `begin` is not called."""

    @property
    def node(self) -> str:
        """The name of this program, for the box's records."""
        return str(rospy.get_name())

    def begin(self, name: str, must_end: threading.Event) -> bool:
        """Start the ROS node. While it waits for a master, it prints this. Returns whether it has begun: not if
        `must_end` is set meanwhile."""
        if not rosgraph.is_master_online():
            print(f"Waiting for the ROS master at {rosgraph.get_master_uri()}: start roah_rsbb.launch",
                  file=sys.stderr)
            while not rosgraph.is_master_online():
                if must_end.wait(LOOK_S):
                    return False
        connections.init_node(name, anonymous=True, disable_signals=True)
        return True

    @property
    def has_ended(self) -> bool:
        """Whether the program must end, because its node has."""
        return bool(rospy.is_shutdown())

    def end(self) -> None:
        """Remove the node from the master, in any thread; then `has_ended`."""
        rospy.signal_shutdown("the program ends")

    def times_in_utc(self) -> bool:
        """Whether windows show times in UTC."""
        return bool(rospy.get_param(TIMES_IN_UTC, False))
