"""What dummy robots say, in their node's log."""

import logging

import rospy

# The dummy's own words, and what the client that carries it has to tell of the network.
_SPEAKERS = ("dummy_robot", "roah_rsbb.robot")


class _ToRos(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        (rospy.logwarn if record.levelno >= logging.WARNING else rospy.loginfo)("%s", record.getMessage())


def log_to_ros() -> None:
    """From now on the dummies of this process speak in the node's log. Call after `rospy.init_node`."""
    for name in _SPEAKERS:
        speaker = logging.getLogger(name)
        speaker.setLevel(logging.INFO)
        speaker.propagate = False
        speaker.addHandler(_ToRos())
