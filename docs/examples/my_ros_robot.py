#!/usr/bin/env python3
"""A short robot with ROS: beside the comm node it takes part in every run."""

import queue

import rospy
from geometry_msgs.msg import Pose2D
from std_msgs.msg import UInt32
from std_srvs.srv import Empty

from roah_rsbb.msg import Benchmark, BenchmarkState
from roah_rsbb.srv import ResultHOPF, ResultHPPF, String

WORK_S = 1.0  # seconds that this robot waits instead of working
NAMES = {number: name for name, number in vars(Benchmark).items() if name.isupper()}


def call(name, kind, *arguments):
    """Call a service of the comm node, which appears a moment after its state."""
    rospy.wait_for_service(f"/roah_rsbb/{name}", 5.0)
    rospy.ServiceProxy(f"/roah_rsbb/{name}", kind)(*arguments)


class MyRobot:
    def __init__(self):
        self.benchmark = "NONE"
        self.states = queue.Queue()  # callbacks only add states, so that a stop never waits for work
        self.saved = rospy.Publisher("/roah_rsbb/messages_saved", UInt32, queue_size=1, latch=True)
        rospy.Subscriber("/roah_rsbb/benchmark", Benchmark, self.on_benchmark)
        rospy.Subscriber("/roah_rsbb/benchmark/state", BenchmarkState, lambda m: self.states.put(m.benchmark_state))

    def on_benchmark(self, message):
        self.benchmark = NAMES.get(message.benchmark, "HOMF")

    def works(self, seconds=WORK_S):
        """Work for a while. False: a new state came, so stop working at once."""
        until = rospy.get_time() + seconds
        while rospy.get_time() < until and self.states.empty() and not rospy.is_shutdown():
            rospy.sleep(0.02)
        return self.states.empty() and not rospy.is_shutdown()

    def prepare(self):
        while self.benchmark == "NONE":  # it is on a topic of its own, so it may come after the state
            if not self.works(0.02):
                return
        print(f"{self.benchmark}: preparing", flush=True)
        self.saved.publish(1)  # offline data is being recorded: the box stops a run without it
        if self.works():
            call("end_prepare", Empty)

    def execute(self):
        goal = rospy.wait_for_message("/roah_rsbb/goal", Pose2D, 5.0) if self.benchmark == "HNF" else None
        print(f"{self.benchmark}: executing", "" if goal is None else f"{goal.x} {goal.y} {goal.theta}", flush=True)
        if self.benchmark == "HWV":
            call("notifications", String, "going to the door")
        if self.benchmark == "HPFF" or not self.works():
            return  # HPFF: follow the person until the box stops us
        if self.benchmark == "HOPF":
            call("end_execute", ResultHOPF, "cups", "red_cup", Pose2D(0.42, 0.17, 1.57))
        elif self.benchmark == "HPPF":
            call("end_execute", ResultHPPF, "Annie", Pose2D(1.2, 0.8, 3.14))
        else:
            call("end_execute", Empty)

    def run(self):
        does = {BenchmarkState.PREPARE: self.prepare, BenchmarkState.EXECUTE: self.execute}
        while not rospy.is_shutdown():
            try:
                does.get(self.states.get(timeout=0.1), lambda: print("stopped", flush=True))()
            except queue.Empty:
                pass
            except (rospy.ROSException, rospy.ServiceException) as error:
                rospy.logwarn("%s", error)  # the run has ended


if __name__ == "__main__":
    rospy.init_node("my_robot")
    MyRobot().run()
