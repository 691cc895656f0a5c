"""The ROS node of a program with windows."""

import sys

import rosgraph
import rospy

from roah_rsbb.ros import connections, display
from roah_rsbb.rqt.app import application
from roah_rsbb.rqt.host import WindowHost

# A parameter in the client's namespace (launch/roah_rsbb_client.launch).
TIMES_IN_UTC = "times_in_utc"


class WindowNode(WindowHost):
    """A node. In rqt, whose node it is, `begin` is not called."""

    @property
    def node(self) -> str:
        return str(rospy.get_name())

    def begin(self, name: str) -> None:
        """Start the ROS node. While it waits for a master, it prints this. A signal then ends the program.

        Signals are watched first: a signal that ended the program just after the node registered would leave its name
        registered at the master.
        """
        if not display.has_display():
            sys.exit(display.NO_DISPLAY)
        application.end_at_signals(self, application.ORDERLY_S)
        if not rosgraph.is_master_online():
            print(f"Waiting for the ROS master at {rosgraph.get_master_uri()}: start roah_rsbb.launch",
                  file=sys.stderr)
            while not rosgraph.is_master_online():
                if application.must_end.wait(application.LOOK_MS / 1000):
                    application.leave(self, 0)
        connections.init_node(name, anonymous=True, disable_signals=True)

    @property
    def has_ended(self) -> bool:
        return bool(rospy.is_shutdown())

    def end(self) -> None:
        """Remove the node from the master."""
        rospy.signal_shutdown("the program ends")

    def times_in_utc(self) -> bool:
        return bool(rospy.get_param(TIMES_IN_UTC, False))
