"""Whole runs of robots with ROS 2, with the real box."""

import asyncio
import time

import pytest
from probe import Probe
from programs import BROADCAST, comm, example, ros2
from roah_rsbb_msgs.msg import Benchmark, BenchmarkState
from roah_rsbb_msgs.srv import ResultHOPF, String
from std_msgs.msg import UInt32
from std_srvs.srv import SetBool, Trigger
from support.waiting import wait_until

from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

CODES = "HGTKMH HWV HCFGAC HOPF HNF HSUF HPPF HPFF HGMF HOMF STB".split()
ZONE = "Testing"


@pytest.fixture
def robot(box, running):
    """Comm node and dummy robot, as processes."""
    running(comm(box.port))
    return running(ros2("dummy", prepare_duration=0.2, execute_duration=0.3))


def test_the_dummy_completes_all_benchmarks_with_the_action(box, robot, probe):
    probe.wait_heard_by()
    for code in CODES:
        box.completes(ZONE, code)
        robot.wait_printed(f"{code}: executing")
    names, poses, switches = [], [], []

    def is_heard() -> bool:
        names[:] = [message.data for message in probe.heard["benchmark/name"] if message.data]
        poses[:] = [(pose.x, pose.y) for pose in probe.heard["goal/waypoint"]]
        switches[:] = [list(goal.switches) for goal in probe.heard["goal/switches"]]
        return ((names, poses, switches) == (CODES, [(1.0, 0.5), (2.0, 1.5), (0.5, 2.0)], [[1, 3, 5], [2, 1]])
                and any(goal.object_type for goal in probe.heard["goal/placement"])
                # The dummy has switched the real devices of the box in HCFGAC.
                and any(state.switch_1 and state.dimmer == 70 for state in probe.heard["devices/state"])
                and any(state.display_map for state in probe.heard["tablet/state"]))

    others = ("goal/placement", "devices/state", "tablet/state")
    wait_until(is_heard, lambda: f"all of it is published: {names}, {poses}, {switches}, "
                                 f"{[probe.heard[topic][-3:] for topic in others]}")
    probe.wait("benchmark", lambda message: message.benchmark == Benchmark.NONE)
    assert "[ERROR]" not in robot.text
    assert "[WARN]" not in robot.text


@pytest.mark.parametrize("code", ["HWV", "HOPF", "HNF"])
def test_the_example_completes_benchmarks_with_topics_and_services(box, running, code):
    running(comm(box.port))
    robot = running(example("my_ros2_robot.py"))
    box.completes(ZONE, code)
    robot.wait_printed(f"{code}: executing")
    assert "[WARN]" not in robot.text


def test_a_benchmark_of_the_competition(box, running, probe):
    node = running(comm(box.port))
    run = running(box.referee("run", ZONE, "--benchmark", "SetTable"))
    probe.wait("benchmark/name", lambda message: message.data == "SetTable")
    probe.wait("benchmark", lambda message: message.benchmark == Benchmark.OTHER)
    probe.wait_state(BenchmarkState.PREPARE)
    saved = probe.node.create_publisher(UInt32, "roah_rsbb/messages_saved", 1)  # not latched
    timer = probe.node.create_timer(0.2, lambda: saved.publish(UInt32(data=3)))
    assert probe.call("end_prepare", Trigger).success
    probe.wait_state(BenchmarkState.EXECUTE)
    probe.wait("goal/text", lambda message: message.data == "")
    assert probe.call("notifications", String, data="the table is set").success
    assert probe.call("devices/switch_2/set", SetBool, data=True).success
    probe.wait("devices/state", lambda state: state.switch_2)
    refused = probe.call("end_execute/object", ResultHOPF)
    assert not refused.success
    assert "call end_execute/text" in refused.message
    assert probe.call("end_execute/text", String, data="{plates: 4}").success
    assert run.wait_ended() == 0, run.text
    timer.cancel()
    assert "internal error" not in node.text


def test_two_robots_with_namespaces(box, running):
    robots = []
    for number, (team, namespace) in enumerate((("TestingTeam", "/left"), ("SecondTeam", "/right")), 2):
        running(comm(box.port, team, number, namespace))
        robots.append(running(ros2("dummy", "--ros-args", "-r", f"__ns:={namespace}", prepare_duration=0.2,
                                   execute_duration=0.2)))
    runs = [running(box.referee("run", zone, "--benchmark", "HGTKMH")) for zone in (ZONE, "Second")]
    for run, robot in zip(runs, robots):
        assert run.wait_ended() == 0, run.text
        robot.wait_printed("HGTKMH: executing")
        assert robot.text.count("HGTKMH: executing") == 1, robot.text


def test_bell_and_tablet(box, running, probe):
    running(comm(box.port))
    probe.wait("devices/state", lambda _: True)
    probe.wait_heard_by()
    assert running(box.run("rosservice", "call", "/roah_devices_dummy/ring")).wait_ended() == 0
    probe.wait("devices/bell", lambda _: True)
    _touch_tablet(box.port, probe)
    position = probe.heard["tablet/position"][-1]
    assert (position.x, position.y) == (1.5, 2.5)
    assert len(probe.heard["tablet/call"]) == 1


def _touch_tablet(port: int, probe: Probe) -> None:
    """Send beacons of a tablet until the robot has heard of its call."""
    async def send() -> None:
        channel = PublicChannel(asyncio.get_event_loop(), Network(BROADCAST, port, "127.46.0.9"), lambda *_: None,
                                print, apart=True)
        channel.open()
        never, now = pb.Time(sec=0, nsec=0), pb.Time(sec=int(time.time()), nsec=0)
        for _ in range(3):  # what was before the first beacon is no call
            channel.send(pb.TabletBeacon(last_call=never, last_pos=never, x=0.0, y=0.0))
            await asyncio.sleep(1.0)
        for _ in range(60):
            channel.send(pb.TabletBeacon(last_call=now, last_pos=now, x=1.5, y=2.5))
            await asyncio.sleep(0.5)
            if probe.heard["tablet/call"] and probe.heard["tablet/position"]:
                break
        channel.close()

    asyncio.run(send())
    assert probe.heard["tablet/position"]
