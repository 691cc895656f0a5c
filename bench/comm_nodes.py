"""The comm nodes of ROS 1 and ROS 2 on a robot: STOP from the wire to a callback, a call from a program to the wire.

The bench plays the box. A program of the robot (comm_listener_ros1.py, comm_listener_ros2.py) prints when its callback
gets a state, and when it calls end_prepare. All clocks are this machine's monotonic clock.
"""

import asyncio
import os
import pathlib
import random
import subprocess
import sys
import threading
import time
from typing import Dict, List, Optional, Tuple

from processes import ROOT, free_port
from table import Results

from roah_rsbb.comm.channels import Network, PrivateChannel, PublicChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

HERE = pathlib.Path(__file__).resolve().parent
BROADCAST, BOX_HOST, ROBOT_HOST = "127.255.255.255", "127.46.1.1", "127.46.1.2"
TEAM, PASSWORD = "BenchTeam", "password"
INSTALL = ROOT / "build" / ".ros2" / "install"
CONNECT_S, STATE_S = 60.0, 10.0
# What the program's other executor does: nothing; it is blocked; the same while Python computes in one of its threads.
ROS2_LOADS = ("idle", "blocked", "computing")
TARGET_MS = 20.0


class Played:
    """A box with one robot in a run."""

    def __init__(self, loop: asyncio.AbstractEventLoop, port: int) -> None:
        self._loop = loop
        self._private_port = port + 1
        self._ack: Optional[pb.Time] = None
        self._robot = RobotState.STOP
        self._changed = asyncio.Event()
        self.reached: Dict[RobotState, int] = {}  # when the robot's message with a new state arrived, ns
        network = Network(BROADCAST, port, BOX_HOST)
        self._public = PublicChannel(loop, network, lambda *_: None, print)
        self._private = PrivateChannel(loop, network, self._private_port, Key(PASSWORD), self._hear, print)
        self._private.remote = ROBOT_HOST
        self._public.open()
        self._private.open()
        self._beacons = loop.create_task(self._beacon())

    def close(self) -> None:
        self._beacons.cancel()
        self._private.close()
        self._public.close()

    async def _beacon(self) -> None:
        never = pb.Time(sec=0, nsec=0)
        beacon = pb.RoahRsbbBeacon(
            devices_bell=never, devices_switch_1=False, devices_switch_2=False, devices_switch_3=False,
            devices_dimmer=0, devices_blinds=0, devices_door_win_detect=False, tablet_display_map=False,
            tablet_call_time=never, tablet_position_time=never, tablet_position_x=0.0, tablet_position_y=0.0)
        beacon.benchmarking_teams.add(team_name=TEAM, robot_name="Robot", rsbb_port=self._private_port)
        while True:
            self._public.send(beacon)
            await asyncio.sleep(1.0)

    def _hear(self, message: pb.RobotState, _sender: Tuple[str, int]) -> None:
        now_ns = time.monotonic_ns()
        if not isinstance(message, pb.RobotState):
            return
        self._ack = message.time
        if message.robot_state != self._robot:
            self._robot = RobotState(message.robot_state)
            self.reached[self._robot] = now_ns
        self._changed.set()

    def send(self, state: BoxState) -> int:
        """Send a state; returns when (ns)."""
        message = pb.BenchmarkState(benchmark_type="HGTKMH", benchmark_state=int(state))
        if self._ack is not None:
            message.acknowledgement.CopyFrom(self._ack)
        now_ns = time.monotonic_ns()
        self._private.send(message)
        return now_ns

    async def wait(self, state: RobotState, limit_s: float) -> None:
        """Wait until the robot is in a state."""
        async def reached() -> None:
            while self._ack is None or self._robot is not state:
                self._changed.clear()
                await self._changed.wait()
        await asyncio.wait_for(reached(), limit_s)


class Listener:
    """The robot's program. Its lines: `state NUMBER NS`, `call NS`."""

    def __init__(self, *command: object, **environment: str) -> None:
        self.states: Dict[int, int] = {}
        self.called_ns = 0
        self._news = threading.Condition()
        self._process = subprocess.Popen(
            [str(word) for word in command], stdout=subprocess.PIPE, text=True, start_new_session=True,
            env={**os.environ, **environment})
        self.is_ready = False
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self._process.stdout:
            words = line.split()
            with self._news:
                if words[0] == "state":
                    self.states[int(words[1])] = int(words[2])
                elif words[0] == "call":
                    self.called_ns = int(words[1])
                elif words[0] == "ready":
                    self.is_ready = True
                self._news.notify_all()

    def wait(self, condition, what: str, limit_s: float = STATE_S) -> None:
        """Wait for a line."""
        with self._news:
            if not self._news.wait_for(condition, limit_s):
                raise SystemExit(f"bench: after {limit_s:.0f} s still not: {what}")

    def close(self) -> None:
        self._process.kill()  # its blocked threads end in no other way
        self._process.wait(10.0)


async def _measured(port: int, listener: Listener, count: int) -> Tuple[List[float], List[float]]:
    """STOP from the wire to the callback, and the call of end_prepare to the wire; ms."""
    loop = asyncio.get_event_loop()
    box = Played(loop, port)

    async def heard(state: int, after_ns: int) -> int:
        await loop.run_in_executor(None, listener.wait, lambda: listener.states.get(state, 0) >= after_ns,
                                   f"the robot's program hears state {state}")
        return listener.states[state]

    stops, calls = [], []
    try:
        await box.wait(RobotState.STOP, CONNECT_S)
        await loop.run_in_executor(None, listener.wait, lambda: listener.is_ready, "the program is ready", CONNECT_S)
        for number in range(count + 1):
            sent = box.send(BoxState.PREPARE)
            await heard(1, sent)
            await box.wait(RobotState.WAITING_GOAL, STATE_S)
            call_ms = (box.reached[RobotState.WAITING_GOAL] - listener.called_ns) / 1e6
            await asyncio.sleep(random.uniform(0.02, 0.12))
            sent = box.send(BoxState.STOP)
            stop_ms = (await heard(0, sent) - sent) / 1e6
            if number:  # the first of each finds its connections
                stops.append(stop_ms)
                calls.append(call_ms)
            await box.wait(RobotState.STOP, STATE_S)
    finally:
        box.close()
    return stops, calls


def _run(results: Results, name: str, count: int, comm: List[object], listener: List[object], port: int,
         target: Dict[float, float], **environment: str) -> None:
    node = subprocess.Popen([str(word) for word in comm], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                            start_new_session=True, env={**os.environ, **environment, "ROAH_RSBB_KEY": PASSWORD})
    program = Listener(*listener, **environment)
    try:
        stops, calls = asyncio.run(_measured(port, program, count))
    finally:
        program.close()
        node.terminate()
        node.wait(10.0)
    results.add_spread(f"{name}: STOP on the wire to the program's callback", "ms", stops, target)
    results.add_spread(f"{name}: program's call to the wire", "ms", calls, {})


def ros1(results: Results, count: int) -> None:
    """The node of ROS 1, beside a ROS master."""
    port = free_port()
    _run(results, "comm node, ROS 1", count,
         [sys.executable, ROOT / "scripts" / "comm", f"_team_name:={TEAM}", f"_rsbb_key:={PASSWORD}",
          f"_rsbb_host:={BROADCAST}", f"_rsbb_port:={port}", f"_bind_host:={ROBOT_HOST}"],
         [sys.executable, HERE / "comm_listener_ros1.py"], port, {})


def ros2(results: Results, count: int) -> None:
    """The node of ROS 2, if ROS 2 can be had here."""
    built = subprocess.run([ROOT / "tools" / "with_ros2", "true"], check=False)
    if built.returncode == 3:
        print("comm node, ROS 2: ROS 2 is not here")
        return
    for load in ROS2_LOADS:
        port = free_port()
        _run(results, f"comm node, ROS 2, executor {load}", count,
             [ROOT / "tools" / "with_ros2", INSTALL / "roah_rsbb_comm/lib/roah_rsbb_comm/comm",
              "--ros-args", "-p", f"team_name:={TEAM}", "-p", f"rsbb_host:={BROADCAST}", "-p", f"rsbb_port:={port}",
              "-p", f"bind_host:={ROBOT_HOST}"],
             [ROOT / "tools" / "with_ros2", "python", HERE / "comm_listener_ros2.py", load], port,
             {0.99: TARGET_MS},
             ROAH_ROS2_INSTALL=str(INSTALL), ROS_DOMAIN_ID=str(1 + os.getpid() % 100))
