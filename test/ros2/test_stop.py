"""STOP reaches a robot's program while its executor is blocked (`make bench BENCH=comm` measures how fast)."""

import threading

import pytest
import rclpy
from probe import LATCHED
from programs import comm, free_port
from rclpy.executors import SingleThreadedExecutor
from roah_rsbb_msgs.msg import BenchmarkState
from roah_rsbb_msgs.srv import Override
from support.waiting import happened, wait_until


@pytest.fixture
def blocked():
    """A team's node whose callback blocks its executor, and the states that a node in a thread of its own receives."""
    nodes = [rclpy.create_node(name) for name in ("blocked", "urgent")]
    release, begun, states = threading.Event(), threading.Event(), []

    def block():
        begun.set()
        release.wait()

    def hear(message):
        states.append(message.benchmark_state)
        happened()

    nodes[0].create_timer(0.01, block)
    nodes[1].create_subscription(BenchmarkState, "/roah_rsbb/benchmark/state", hear, LATCHED)
    executors = [SingleThreadedExecutor() for _ in nodes]
    threads = []
    for node, executor in zip(nodes, executors):
        executor.add_node(node)
        threads.append(threading.Thread(target=executor.spin, daemon=True))
        threads[-1].start()
    assert begun.wait(60.0)
    yield states
    assert not release.is_set()
    release.set()
    for executor in executors:
        executor.shutdown(timeout_sec=5.0)
    for thread, node in zip(threads, nodes):
        thread.join(5.0)
        node.destroy_node()


def test_stop_comes_in_a_thread_of_its_own(running, probe, blocked):
    running(comm(free_port()))
    for state, shown in ((1, BenchmarkState.PREPARE), (0, BenchmarkState.STOP)):
        assert probe.call("override", Override, benchmark_type=1, benchmark_state=state).success
        wait_until(lambda shown=shown: blocked and blocked[-1] == shown, f"the blocked node hears {shown}")
