"""STOP reaches a robot's program while its executor is blocked (`make bench BENCH=comm` measures how fast)."""

import threading

import pytest
import rclpy
from probe import LATCHED
from programs import comm, free_port
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from roah_rsbb_msgs.msg import BenchmarkState
from roah_rsbb_msgs.srv import Override
from support.waiting import happened, wait_until


@pytest.fixture
def blocked():
    """A node of a team whose only callback group is blocked, and the states that a group of its own receives."""
    node = rclpy.create_node("blocked")
    release, begun, states = threading.Event(), threading.Event(), []

    def block():
        begun.set()
        release.wait()

    def hear(message):
        states.append(message.benchmark_state)
        happened()

    node.create_timer(0.01, block)
    node.create_subscription(BenchmarkState, "/roah_rsbb/benchmark/state", hear, LATCHED,
                             callback_group=MutuallyExclusiveCallbackGroup())
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    assert begun.wait(60.0)
    yield states
    assert not release.is_set()
    release.set()
    executor.shutdown(timeout_sec=5.0)
    thread.join(5.0)
    node.destroy_node()


def test_stop_comes_in_a_callback_group_of_its_own(running, probe, blocked):
    running(comm(free_port()))
    for state, shown in ((1, BenchmarkState.PREPARE), (0, BenchmarkState.STOP)):
        assert probe.call("override", Override, benchmark_type=1, benchmark_state=state).success
        wait_until(lambda shown=shown: blocked and blocked[-1] == shown, f"the blocked node hears {shown}")
