#!/usr/bin/env python3
"""A short robot with ROS 2: beside the comm node it takes part in every run. Ctrl-C ends it."""

import queue
import threading
import time

import rclpy
from geometry_msgs.msg import Pose2D
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from roah_rsbb_msgs.msg import BenchmarkState
from roah_rsbb_msgs.srv import ResultHOPF, ResultHPPF, String
from std_msgs.msg import String as StringMsg
from std_msgs.msg import UInt32
from std_srvs.srv import Trigger

WORK_S = 1.0  # seconds that this robot waits instead of working
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for topics with a state


class MyRobot(Node):
    def __init__(self):
        super().__init__("my_robot")
        self.benchmark, self.waypoint = "", None
        self.states = queue.Queue()  # callbacks only add states, so that a stop never waits for work
        self.create_subscription(BenchmarkState, "roah_rsbb/benchmark/state", self.on_state, LATCHED)
        self.create_subscription(StringMsg, "roah_rsbb/benchmark/name", self.on_name, LATCHED)
        self.create_subscription(Pose2D, "roah_rsbb/goal/waypoint", self.on_waypoint, LATCHED)
        self.saved = self.create_publisher(UInt32, "roah_rsbb/messages_saved", LATCHED)
        kinds = {"end_prepare": Trigger, "end_execute": Trigger, "end_execute/object": ResultHOPF,
                 "end_execute/person": ResultHPPF, "notifications": String}
        self.calls = {name: self.create_client(kind, f"roah_rsbb/{name}") for name, kind in kinds.items()}

    def on_state(self, message):
        self.states.put(message.benchmark_state)

    def on_name(self, message):
        self.benchmark = message.data

    def on_waypoint(self, message):
        self.waypoint = message

    def call(self, name, **fields):
        """Call a service of the comm node. It answers with a reason if it refuses."""
        client = self.calls[name]
        if not client.wait_for_service(5.0):
            self.get_logger().error(f"{client.srv_name} is missing: start the comm node")
            return
        answer = client.call(client.srv_type.Request(**fields))
        if not answer.success:
            self.get_logger().warning(answer.message)

    def works(self, seconds=WORK_S, until=lambda: False):
        """Work for a while. False: a new state came, so stop working at once."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until() and self.states.empty() and rclpy.ok():
            time.sleep(0.01)
        return self.states.empty() and rclpy.ok()

    def prepare(self):
        self.waypoint = None
        if not self.works(5.0, until=lambda: self.benchmark):  # it is on a topic of its own, so it may come later
            return
        print(f"{self.benchmark}: preparing", flush=True)
        self.saved.publish(UInt32(data=1))  # offline data is being recorded: the box stops a run without it
        if self.works():
            self.call("end_prepare")

    def execute(self):
        if self.benchmark == "HNF" and not self.works(5.0, until=lambda: self.waypoint):
            return
        print(f"{self.benchmark}: executing {self.waypoint or ''}", flush=True)
        if self.benchmark == "HWV":
            self.call("notifications", data="going to the door")
        if self.benchmark == "HPFF" or not self.works():
            return  # HPFF: follow the person until the box stops us
        if self.benchmark == "HOPF":
            self.call("end_execute/object", object_class="cups", object_name="red_cup",
                      object_pose=Pose2D(x=0.42, y=0.17, theta=1.57))
        elif self.benchmark == "HPPF":
            self.call("end_execute/person", person_name="Annie", person_pose=Pose2D(x=1.2, y=0.8, theta=3.14))
        else:
            self.call("end_execute")

    def run(self):
        does = {BenchmarkState.PREPARE: self.prepare, BenchmarkState.EXECUTE: self.execute}
        while rclpy.ok():
            try:
                does.get(self.states.get(timeout=0.1), lambda: print("stopped", flush=True))()
            except queue.Empty:
                continue


def main():
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # Ctrl-C interrupts the work
    robot = MyRobot()
    executor = SingleThreadedExecutor()
    executor.add_node(robot)
    # The callbacks have this thread for themselves and never block, so that a stop comes at once.
    threading.Thread(target=executor.spin, daemon=True).start()
    try:
        robot.run()
    except KeyboardInterrupt:
        pass
    finally:
        executor.shutdown()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
