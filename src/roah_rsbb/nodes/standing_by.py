"""Nodes of a box that was started in advance on the standby wait here until it takes over (docs/standby.md)."""

import sys
import time

import rospy

from roah_rsbb.standby.partners import is_standby

# Name of the core's node.
CORE = "roah_rsbb_core"
WAITING = "This computer is a standby: waiting for a takeover"
LOOK_S = 0.02


def wait_for_takeover(log_dir: str) -> None:
    """Return when this computer is the box. Ends the process if it is interrupted before."""
    if not is_standby(log_dir):
        return
    rospy.loginfo("%s", WAITING)
    try:
        while is_standby(log_dir):
            if rospy.is_shutdown():
                sys.exit(0)
            time.sleep(LOOK_S)
    except KeyboardInterrupt:
        sys.exit(0)
