"""A robot's program with ROS 1: prints when its callback gets a state, and calls end_prepare (comm_nodes.py)."""

import threading
import time

import rospy
from std_srvs.srv import Empty

from roah_rsbb.msg import BenchmarkState
from roah_rsbb.ros import connections


def prepare() -> None:
    """Call the service, once it is there."""
    rospy.wait_for_service("/roah_rsbb/end_prepare")
    end = rospy.ServiceProxy("/roah_rsbb/end_prepare", Empty)
    print("call", time.monotonic_ns(), flush=True)
    end()


def hear(message: BenchmarkState) -> None:
    """Print first, and work elsewhere."""
    print("state", message.benchmark_state, time.monotonic_ns(), flush=True)
    if message.benchmark_state == BenchmarkState.PREPARE:
        threading.Thread(target=prepare, daemon=True).start()


connections.init_node("listener")
rospy.Subscriber("/roah_rsbb/benchmark/state", BenchmarkState, hear)
print("ready", flush=True)
rospy.spin()
