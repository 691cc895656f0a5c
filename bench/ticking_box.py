#!/usr/bin/python3
"""A box that behaves like the original one: it sends its state only every 200 ms.

For comparison only: one robot, no referee, no rules except the table of states. It reads the referee's commands, start
and stop, from standard input.
"""

import asyncio
import sys

from addresses import BOX_HOST, BROADCAST

from roah_rsbb.comm.channels import PrivateChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.core.runs.machine import Reaction, react
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

PERIOD_S = 0.2
FOLLOWS = {
    Reaction.EXECUTE: BoxState.WAITING_RESULT, Reaction.RETRY: BoxState.PREPARE, Reaction.GOAL_DONE: BoxState.STOP,
}
COMMANDS = {"start": BoxState.PREPARE, "stop": BoxState.STOP}


class TickingBox:
    """One private channel."""

    def __init__(self, loop: asyncio.AbstractEventLoop, port: int, password: str) -> None:
        self._loop = loop
        self._message = pb.BenchmarkState(
            benchmark_type="HWV", benchmark_state=int(BoxState.STOP), initial_state=False, switches=0)
        self._message.acknowledgement.sec = self._message.acknowledgement.nsec = 0
        self._channel = PrivateChannel(
            loop, BROADCAST, port, Key(password), self._on_robot, print, bind_host=BOX_HOST)

    def run(self) -> None:
        """Run until standard input ends."""
        self._channel.open()
        self._loop.add_reader(sys.stdin.fileno(), self._on_command)
        print("ready", flush=True)
        self._tick()
        self._loop.run_forever()

    def _tick(self) -> None:
        self._loop.call_later(PERIOD_S, self._tick)
        self._channel.send(self._message)

    def _on_robot(self, message: pb.RobotState, address) -> None:
        self._channel.remote = address[0]
        self._message.acknowledgement.CopyFrom(message.time)
        now = BoxState(self._message.benchmark_state)
        found = react(now, RobotState(message.robot_state), explicit_goal=False)
        self._message.benchmark_state = int(FOLLOWS.get(found, now))

    def _on_command(self) -> None:
        line = sys.stdin.readline()
        if not line:
            self._loop.stop()
        elif line.strip() in COMMANDS:
            self._message.benchmark_state = int(COMMANDS[line.strip()])


if __name__ == "__main__":
    TickingBox(asyncio.new_event_loop(), int(sys.argv[1]), sys.argv[2]).run()
