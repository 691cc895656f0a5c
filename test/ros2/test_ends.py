"""Ends of programs: Ctrl-C, kills, wrong parameters."""

import signal
import sys

import pytest
from probe import LATCHED
from programs import BROADCAST, Program, comm, free_port, ros2
from roah_rsbb_msgs.msg import BenchmarkState
from std_msgs.msg import UInt32
from std_srvs.srv import Trigger
from support.waiting import wait_until


def test_an_interrupted_node_ends_without_a_traceback(running, probe):
    node = running(comm(free_port()))
    dummy = running(ros2("dummy"))
    assert probe.call("end_prepare", Trigger).message
    wait_until(lambda: "dummy_robot" in probe.node.get_node_names(), "the dummy has started")
    for program in (node, dummy):
        assert program.close() == 0, program.text
        assert "Traceback" not in program.text


def test_wrong_parameters_end_the_node_with_the_remedy(running):
    node = running(ros2("comm", rsbb_host=BROADCAST))
    assert node.wait_ended() == 1
    assert "set the parameter team_name" in node.text
    other = running(comm(free_port(), rsbb_cypher="rot13"))
    assert other.wait_ended() == 1
    assert "found rot13, expected one of aes-128-ecb" in other.text
    missing = running(comm(free_port(), rsbb_key_file="/nowhere/key"))
    assert missing.wait_ended() == 1
    assert "/nowhere/key" in missing.text
    crash = running(ros2("dummy", crash_in="dance"))
    assert crash.wait_ended() == 1
    assert not any("Traceback" in program.text for program in (node, other, missing, crash))


FAILING = """
from rclpy.executors import SingleThreadedExecutor
from roah_rsbb_comm.node_loop import NodeLoop, run_node

class Part:
    def __init__(self, node):
        self.ros = NodeLoop(node, SingleThreadedExecutor())
        {fails}

    def run(self):
        status = self.ros.run()
        self.ros.close()
        return status

run_node("failing", Part)
"""


@pytest.mark.parametrize("fails", ["node.create_timer(0.01, lambda: 1 / 0)", "self.ros.loop.call_soon(lambda: 1 / 0)"])
def test_a_failure_in_either_thread_ends_a_node_with_a_message(running, fails):
    node = running(Program(sys.executable, "-c", FAILING.format(fails=fails)))
    assert node.wait_ended() == 1
    assert "[FATAL]" in node.text
    assert "please report it" in node.text
    assert "division by zero" in node.text


BUSY = """
import threading, time
from roah_rsbb_comm import node_loop
node_loop.ANSWER_S = 0.1  # of earlier versions

class Part:
    def __init__(self, node):
        self.ros = node_loop.NodeLoop(node, node_loop.rclpy.executors.SingleThreadedExecutor())
        node.create_timer(0.01, self.ask)

    def ask(self):
        asked = threading.Event()
        self.ros.post(lambda: asked.set() or time.sleep(0.5))
        asked.wait()
        print("answered", self.ros.call(lambda: 42), flush=True)

    def run(self):
        return self.ros.run()

node_loop.run_node("busy", Part)
"""


def test_a_busy_computer_ends_no_node(running):
    node = running(Program(sys.executable, "-c", BUSY))
    node.wait_printed("answered 42", times=2)


def test_an_impossible_address_ends_the_node_with_the_remedy(running):
    node = running(comm(free_port(), number=300))
    assert node.wait_ended() == 1
    assert "127.46.0.300" in node.text
    assert "Traceback" not in node.text


def test_a_run_survives_a_killed_box_and_a_killed_node(box, running, probe):
    saved = probe.node.create_publisher(UInt32, "roah_rsbb/messages_saved", LATCHED)
    saved.publish(UInt32(data=1))
    node = running(comm(box.port))
    run = running(box.referee("run", "Testing", "--benchmark", "HGTKMH"))
    probe.wait_state(BenchmarkState.PREPARE)
    box.kill_core()
    assert probe.call("end_prepare", Trigger).success
    probe.wait_state(BenchmarkState.EXECUTE)
    node.signal(signal.SIGKILL)
    assert node.wait_ended() == -signal.SIGKILL
    probe.heard["benchmark/state"].clear()
    running(comm(box.port))
    # After its own restart, the box cannot know why the robot reports STOP. Until it does, the command is refused.
    assert any(running(box.referee("continue", "Testing")).wait_ended() == 0 for _ in range(60))
    # The box starts again with PREPARE. The latched count of saved data is received again.
    probe.wait_state(BenchmarkState.PREPARE)
    assert probe.call("end_prepare", Trigger).success
    probe.wait_state(BenchmarkState.EXECUTE)
    assert probe.call("end_execute", Trigger).success
    assert run.wait_ended(120.0) == 0, run.text


def test_a_killed_dummy_gets_its_goal_again(box, running, probe):
    running(comm(box.port))
    first = running(ros2("dummy", prepare_duration=0.2, never_end=True))
    run = running(box.referee("run", "Testing", "--benchmark", "HGTKMH"))
    first.wait_printed("HGTKMH: executing")
    first.signal(signal.SIGKILL)
    assert first.wait_ended() == -signal.SIGKILL
    second = running(ros2("dummy", prepare_duration=0.2, execute_duration=0.2))
    second.wait_printed("HGTKMH: executing")
    assert run.wait_ended() == 0, run.text
