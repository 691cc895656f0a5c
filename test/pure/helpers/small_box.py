"""A small box on real loopback sockets, for the tests of robots: one robot, one run, goals in a row."""

import asyncio
import contextlib
import itertools
from collections import defaultdict
from typing import Iterator

from helpers import slots
from helpers.box_beacon import box_beacon
from helpers.waiting import News
from roah_rsbb.comm.channels import Network, PrivateChannel, PublicChannel
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.registry import STRINGS

BOX, ROBOT, BROADCAST = "127.0.0.1", "127.0.0.2", "127.255.255.255"
TEAM, NAME, PASSWORD = "Team", "Robot", "PASSWORD"
TIMEOUT_S = 20.0
TICK_S = 0.02

# The ports of one slot, five at a time; the slot is this process's until it ends.
_slot = contextlib.ExitStack()
_bases: Iterator[int] = iter(())


def free_ports() -> int:
    """Return an unused public port with four unused ports above it for private channels."""
    global _bases
    first = next(_bases, None)
    if first is None:
        start = slots.first_port(_slot.enter_context(slots.free_slot()))
        _bases = itertools.cycle(range(start, start + slots.PORTS_OF_A_SLOT - 5, 5))
        first = next(_bases)
    return first if all(map(slots.is_free, range(first, first + 5))) else free_ports()


@contextlib.asynccontextmanager
async def running(client):
    """Run a client in a `with` block."""
    task = asyncio.get_event_loop().create_task(client.run())
    try:
        yield client
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task


class SmallBox:
    """Lists the robot while `listed`, and takes it through `goals` once `start` was called.

    A goal is a dict of BenchmarkState fields; an empty one is a benchmark without explicit goals. It
    sends everything every 20 ms, and follows the box's table (docs/protocol.md, "State machines").
    """

    def __init__(self, code="HGTKMH", goals=({},), password=PASSWORD):
        self.code = code
        self.goals = list(goals)
        self.port = free_ports()
        self.private_port = self.port + 1
        self.listed = True
        self.state = BoxState.STOP
        self.finished = []  # the robot's message at the end of each goal
        self.received = []  # RobotStates, the fresh ones
        self.beacons = []  # RobotBeacons
        self.logged = defaultdict(list)  # repeated strings, by field
        self.beacon_fields = {}
        self._key = Key(password)
        self._news = None

    async def __aenter__(self):
        loop = asyncio.get_event_loop()
        self._news = News()
        network = Network(BROADCAST, self.port, BOX)
        self._public = PublicChannel(loop, network, self._on_public, self._reported)
        self._private = PrivateChannel(
            loop, network, self.private_port, self._key, self._on_robot, self._reported)
        self._private.remote = ROBOT
        self._public.open()
        self._private.open()
        self._ticking = loop.create_task(self._tick())
        return self

    async def __aexit__(self, *_):
        self._ticking.cancel()
        self._public.close()
        self._private.close()

    async def until(self, condition):
        """Wait until `condition()` holds. It is checked with each datagram, and every 20 ms."""
        await self._news.until(condition)

    async def run_through(self):
        """Start, and wait until the robot has completed all goals and stopped."""
        await self.until(lambda: self.received)
        self.start()
        await self.until(lambda: self.state is BoxState.STOP and self.robot_state is RobotState.STOP)

    def start(self):
        """The referee starts the run."""
        self.state = BoxState.PREPARE

    def stop(self):
        """The referee stops the run."""
        self.state = BoxState.STOP

    @property
    def robot_state(self):
        """The state in the robot's last message."""
        return RobotState(self.received[-1].robot_state) if self.received else None

    async def _tick(self):
        while True:
            self._public.send(self._beacon())
            self._send_state()
            self._news.set()
            await asyncio.sleep(TICK_S)

    def _beacon(self):
        listed = [(TEAM, NAME, self.private_port)] if self.listed else []
        return box_beacon(*listed, **self.beacon_fields)

    def _send_state(self):
        if self.listed:
            goal = self.goals[0] if self.state is BoxState.GOAL_TX else {}
            message = pb.BenchmarkState(benchmark_type=self.code, benchmark_state=int(self.state), **goal)
            if self.received:
                message.acknowledgement.CopyFrom(self.received[-1].time)
            self._private.send(message)

    def _on_public(self, message, _sender):
        if isinstance(message, pb.RobotBeacon):
            self.beacons.append(message)
        self._news.set()

    def _on_robot(self, message, _sender):
        if self.received:
            last = self.received[-1]
            if (message.time.sec, message.time.nsec) <= (last.time.sec, last.time.nsec):
                return
        for field in STRINGS:
            before = getattr(self.received[-1], field) if self.received else ()
            self.logged[field] += [text for text in getattr(message, field) if text not in before]
        self.received.append(message)
        self._step(self.robot_state, message)
        self._news.set()

    def _step(self, robot_state, message):
        before = self.state
        if self.state is BoxState.STOP:
            return
        if robot_state is RobotState.WAITING_GOAL and self.state is BoxState.PREPARE:
            self.state = BoxState.GOAL_TX if self.goals[0] else BoxState.WAITING_RESULT
        elif self.state is not BoxState.PREPARE and robot_state is RobotState.EXECUTING:
            self.state = BoxState.WAITING_RESULT
        elif self.state is not BoxState.PREPARE and robot_state is RobotState.RESULT_TX:
            self.finished.append(message)
            self.next_goal()
        elif robot_state in (RobotState.STOP, RobotState.PREPARING):
            self.state = BoxState.PREPARE
        if self.state is not before:
            self._send_state()

    def next_goal(self):
        """The present goal is over: the next one, or the end."""
        del self.goals[0]
        self.state = BoxState.PREPARE if self.goals else BoxState.STOP

    def _reported(self, text):
        self._news.set()
