"""A program of a team: its types are those of the package roah_rsbb_comm_ros that is first on PYTHONPATH."""

import queue

import rospy
from roah_rsbb_comm_ros.msg import Benchmark, BenchmarkState, DevicesState
from std_msgs.msg import UInt32
from std_srvs.srv import Empty


def call(name: str) -> None:
    rospy.wait_for_service(name, 20.0)
    rospy.ServiceProxy(name, Empty)()


def main() -> None:
    rospy.init_node("generation_robot")
    states: queue.Queue[int] = queue.Queue()
    saved = rospy.Publisher("/roah_rsbb/messages_saved", UInt32, queue_size=1, latch=True)
    rospy.Subscriber("/roah_rsbb/benchmark", Benchmark,
                     lambda m: print("HGTKMH" if m.benchmark == Benchmark.HGTKMH else m.benchmark, flush=True))
    rospy.Subscriber("/roah_rsbb/devices/state", DevicesState, lambda m: print(f"dimmer {m.dimmer}", flush=True))
    rospy.Subscriber("/roah_rsbb/benchmark/state", BenchmarkState, lambda m: states.put(m.benchmark_state))
    while not rospy.is_shutdown():
        try:
            state = states.get(timeout=0.1)
        except queue.Empty:
            continue
        if state == BenchmarkState.PREPARE:
            saved.publish(1)
            call("/roah_rsbb/end_prepare")
        elif state == BenchmarkState.EXECUTE:
            call("/roah_rsbb/end_execute")


main()
