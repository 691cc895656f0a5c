"""Everybody else on the network, in the test's own process, on loopback addresses of their own.

A test decides what they do: robots prepare and execute when they are let, a clock is put wrong, a tablet calls.
Everything on sockets happens in the one asyncio loop of a `Network`, in its own thread; the methods here may be
called from the test's thread.
"""

import asyncio
import contextlib
import os
import pathlib
import threading
import time
from typing import Any, Callable, Dict, List, Optional, Tuple, TypeVar

import yaml

from roah_rsbb.comm.channels import Network as WireNetwork
from roah_rsbb.comm.channels import PrivateChannel, PublicChannel
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.client import Behaviour, RobotClient
from roah_rsbb.robot.link import wire_time
from support.waiting import LIMIT_S, happened, wait_until

T = TypeVar("T")

BROADCAST, BOX = "127.255.255.255", "127.0.0.1"
# See README.md: each test has 100 UDP ports of its own.
RSBB_PORT = 20000 + 100 * int(os.environ.get("ROAH_TEST_SLOT", "0"))
CONFIG = pathlib.Path(__file__).resolve().parents[1] / "config"
# In the order of the file: it gives each team an address, too.
PASSWORDS: Dict[str, str] = yaml.safe_load((CONFIG / "passwords.yaml").read_text(encoding="utf-8"))


def host_of(team: str) -> str:
    """The address of a team's robot."""
    return f"127.0.1.{1 + list(PASSWORDS).index(team)}"


class Network:
    """The loop on which all participants of a test live. Use it as a context."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self.loop.run_forever, name="network", daemon=True)
        self._thread.start()

    def do(self, function: Callable[[], T]) -> T:
        """Run a function in the loop's thread. Returns its result or raises its exception."""
        async def run() -> T:
            return function()
        return asyncio.run_coroutine_threadsafe(run(), self.loop).result(LIMIT_S)

    def read_all(self) -> None:
        """Return when every datagram that had arrived before this call has been handled."""
        for _ in range(2):  # what has arrived is handled after the first call
            self.do(lambda: None)

    def close(self) -> None:
        """End the loop."""
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join(LIMIT_S)


class _Gated(Behaviour):
    """Prepares and executes for as long as the test wants, and records everything."""

    def __init__(self, robot: "Robot") -> None:
        self._robot = robot

    async def prepare(self, benchmark: str) -> None:
        self._robot.note(f"prepare {benchmark}")
        await self._robot.gate("prepare")

    async def execute(self, benchmark: str, goal: Any) -> Any:
        self._robot.goals.append(goal)
        self._robot.note(f"execute {benchmark}")
        await self._robot.gate("execute")
        return self._robot.result

    def stop(self, why: str) -> None:
        self._robot.note("stop")

    def on_devices(self, devices: fx.Devices) -> None:
        self._robot.devices = devices
        happened()

    def on_tablet(self, tablet: fx.TabletIs) -> None:
        self._robot.tablet = tablet
        happened()

    def on_report(self, report: fx.ProblemIs) -> None:
        self._robot.reports.append(report.problem)
        happened()


class Robot:
    """A robot of a team; `close` it at the end of the test.

    `skew`: its clock minus the true one, in seconds; may be changed at any time. Prepares at once if
    `prepares`, else when `let("prepare")` is called; completes its goal when `let("execute")` is.
    """

    def __init__(
        self, network: Network, team: str, name: str = "Robot", password: Optional[str] = None,
        skew: float = 0.0, messages_saved: int = 1, prepares: bool = True, cipher: Cipher = Cipher.AES_128_CBC,
    ) -> None:
        self.team, self.name = team, name
        self.skew = skew
        self.did: List[str] = []  # "prepare HWV", "execute HWV", "stop"
        self.goals: List[Any] = []  # of each execution; None: it was no explicit one
        self.result: Any = None  # that it will send
        self.reports: List[fx.Problem] = []
        self.devices: Optional[fx.Devices] = None
        self.tablet: Optional[fx.TabletIs] = None
        self._network = network
        self._prepares = prepares
        self._gates: Dict[str, asyncio.Future] = {}
        self.client = RobotClient(
            team, PASSWORDS[team] if password is None else password, _Gated(self), name, BROADCAST, RSBB_PORT,
            host_of(team), cipher, clock=lambda: time.time() + self.skew,
        )
        self.client.messages_saved = messages_saved
        self._running = asyncio.run_coroutine_threadsafe(self.client.run(), network.loop)

    def close(self) -> None:
        """Stop without a last message."""
        self._running.cancel()
        with contextlib.suppress(Exception):
            self._running.result(LIMIT_S)

    def request(self, method: str, *arguments: Any) -> None:
        """Call a method of the client, such as notify."""
        self._network.do(lambda: getattr(self.client, method)(*arguments))

    def save(self, messages_saved: int) -> None:
        """Report this amount of saved offline data from now on."""
        self._network.do(lambda: setattr(self.client, "messages_saved", messages_saved))

    def let(self, phase: str) -> None:
        """Let the robot end its activity: prepare or execute."""
        wait_until(lambda: phase in self._gates, lambda: f"the robot is at '{phase}'; it did {self.did}")
        self._network.do(lambda: self._gates.pop(phase).set_result(None))

    def wait_did(self, what: str, times: int = 1) -> None:
        """Wait until the robot has done something this many times."""
        wait_until(
            lambda: self.did.count(what) >= times, lambda: f"the robot did '{what}' {times} times; it did {self.did}"
        )

    def wait_said(self) -> None:
        """Wait until the box has acknowledged all of the robot's strings."""
        wait_until(lambda: self._network.do(lambda: self.client.strings_pending) == 0, "all strings are acknowledged")

    def wait_state(self, state: RobotState) -> None:
        """Wait until the robot is in a state."""
        wait_until(lambda: self.client.state is state, lambda: f"the robot is {state.name}; it did {self.did}")

    # -- for its behaviour, in the loop's thread ------------------------------------------------------

    def note(self, what: str) -> None:
        self.did.append(what)
        happened()

    async def gate(self, phase: str) -> None:
        if phase == "prepare" and self._prepares:
            return
        future = self._gates[phase] = asyncio.get_event_loop().create_future()
        happened()
        try:
            await future
        finally:
            self._gates.pop(phase, None)


class PublicParticipant:
    """Receives everything on the public channel, and sends what the test wants: a tablet, another box."""

    def __init__(self, network: Network, host: str, port: int = RSBB_PORT) -> None:
        self.heard: List[Tuple[Any, str]] = []  # message and address of its sender
        self._network = network
        self._channel = PublicChannel(
            network.loop, WireNetwork(BROADCAST, port, host), self._on_message, lambda text: None
        )
        network.do(self._channel.open)

    def close(self) -> None:
        """Close the sockets without a last message."""
        self._network.do(self._channel.close)

    def send(self, message: Any) -> None:
        """Broadcast a message."""
        self._network.do(lambda: self._channel.send(message))

    @property
    def beacon(self) -> Optional[pb.RoahRsbbBeacon]:
        """The last beacon of the box; None: none yet."""
        beacons = [m for m, host in list(self.heard) if isinstance(m, pb.RoahRsbbBeacon) and host == BOX]
        return beacons[-1] if beacons else None

    def wait_beacon(self, condition: Callable[[pb.RoahRsbbBeacon], Any], what: str) -> None:
        """Wait until the box's last beacon fulfils a condition."""
        wait_until(lambda: self.beacon and condition(self.beacon), lambda: f"{what}; the beacon is\n{self.beacon}")

    def _on_message(self, message: Any, sender: Tuple[str, int]) -> None:
        self.heard.append((message, sender[0]))
        happened()


def listed(beacon: pb.RoahRsbbBeacon) -> List[Tuple[str, str, int]]:
    """The robots that a beacon lists: team, name, port."""
    return [(robot.team_name, robot.robot_name, robot.rsbb_port) for robot in beacon.benchmarking_teams]


def wire(utc: float) -> pb.Time:
    """A wire time."""
    sec, nsec = wire_time(utc)
    return pb.Time(sec=sec, nsec=nsec)


class RawRobot:
    """A robot of which each datagram is the test's: no state machine, no repetition.

    It sends beacons only on request, and has a private channel once `open_private` was called.
    """

    def __init__(self, network: Network, team: str, name: str = "Robot") -> None:
        self.team, self.name = team, name
        self.received: List[pb.BenchmarkState] = []
        self._network = network
        self._public = PublicParticipant(network, host_of(team))
        self._private: Optional[PrivateChannel] = None

    def close(self) -> None:
        """Close the sockets without a last message."""
        if self._private is not None:
            self._network.do(self._private.close)
        self._public.close()

    def beacon(self) -> None:
        """Send one beacon on the public channel."""
        self._public.send(pb.RobotBeacon(team_name=self.team, robot_name=self.name, time=wire(time.time())))

    def open_private(self, port: int) -> None:
        """Open the private channel."""
        self._private = PrivateChannel(
            self._network.loop, WireNetwork(BROADCAST, bind_host=host_of(self.team)), port, Key(PASSWORDS[self.team]),
            self._on_state, lambda text: None,
        )
        self._private.remote = BOX
        self._network.do(self._private.open)

    def send(self, state: RobotState, age_s: float = 0.0, **fields: Any) -> pb.RobotState:
        """Send one RobotState now, whose time is `age_s` ago; returns it."""
        message = pb.RobotState(
            time=wire(time.time() - age_s), messages_saved=1, robot_state=int(state), **fields
        )
        self._network.do(lambda: self._private.send(message))
        return message

    def wait_sent(self, state: BoxState) -> pb.BenchmarkState:
        """Wait until the box's last message has this state; returns the message."""
        def last() -> Optional[pb.BenchmarkState]:
            message = self.received[-1] if self.received else None
            return message if message is not None and message.benchmark_state == state else None
        return wait_until(last, f"the box sends {state.name}")

    def _on_state(self, message: pb.BenchmarkState, _sender: Tuple[str, int]) -> None:
        self.received.append(message)
        happened()
