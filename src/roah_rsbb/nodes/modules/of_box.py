"""The process with the benchmarking modules of a box with ROS: as without (`box/program/modules_process.py`), but its
ground truth comes from tf. For that it is the node roah_rsbb_modules, as soon as the ROS master answers."""

import os
import signal
import sys
import threading

import rospy

from roah_rsbb.box.program import modules_process
from roah_rsbb.nodes.modules.tf_frames import TfFrames
from roah_rsbb.ros import connections

NAME = "roah_rsbb_modules"


def _join() -> None:
    connections.init_node(NAME, disable_signals=True)
    rospy.on_shutdown(lambda: os.kill(os.getpid(), signal.SIGTERM))  # the box starts the next one


def main() -> None:
    """Run the modules until the box ends this process."""
    threading.Thread(target=_join, name="ROS", daemon=True).start()
    modules_process.main(sys.argv[1:], TfFrames)


if __name__ == "__main__":
    main()
