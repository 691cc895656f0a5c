"""A robot's program with ROS 2: prints when its callback gets a state, and calls end_prepare (comm_nodes.py).

It hears states in a node and an executor of their own (docs/team_ros2.md, "STOP"). Argument: what its other executor
does: idle, blocked (callbacks of two groups wait for ever) or computing (one of them computes, without a pause).
"""

import sys
import threading
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from roah_rsbb_msgs.msg import BenchmarkState
from std_srvs.srv import Trigger

load = sys.argv[1]
rclpy.init()
node = rclpy.create_node("listener")
urgent = rclpy.create_node("listener_stop")
client = urgent.create_client(Trigger, "/roah_rsbb/end_prepare")


def prepare() -> None:
    print("call", time.monotonic_ns(), flush=True)
    client.call(Trigger.Request())


def hear(message: BenchmarkState) -> None:
    print("state", message.benchmark_state, time.monotonic_ns(), flush=True)
    if message.benchmark_state == BenchmarkState.PREPARE:
        threading.Thread(target=prepare, daemon=True).start()


def block() -> None:
    threading.Event().wait()


def compute() -> None:
    while True:
        sum(range(1000))


if load != "idle":
    for work in (block, compute if load == "computing" else block):
        node.create_timer(0.01, work, callback_group=MutuallyExclusiveCallbackGroup())
urgent.create_subscription(BenchmarkState, "/roah_rsbb/benchmark/state", hear,
                           QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
for each, executor in ((node, MultiThreadedExecutor(4)), (urgent, SingleThreadedExecutor())):
    executor.add_node(each)
    threading.Thread(target=executor.spin, daemon=True).start()
client.wait_for_service()
print("ready", flush=True)
threading.Event().wait()
