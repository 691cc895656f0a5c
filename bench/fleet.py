"""Robots on real sockets, in one thread. They record when datagrams were sent and received.

The kernel provides the time of arrival, so that a busy bench does not make the box look slow.
"""

import asyncio
import bisect
import collections
import socket
import struct
import threading
import time
from typing import Callable, Deque, List, NamedTuple, Optional, Tuple

from addresses import BOX_HOST, BROADCAST, PUBLIC_HOST, host_of

from roah_rsbb.comm import frame
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

# Linux's number of the option and of the data that comes with each datagram. Python 3.8 has no name for it.
SO_TIMESTAMPNS = 35
_TIMESPEC = struct.Struct("ll")
BEACON_PERIOD_S = 1.0
REGULAR_S = 1.0  # period of a robot whose state does not change
# Within this time, the box's messages must reflect a datagram.
LATE_NS = 50_000_000
REMEMBERED = 256
ANSWER_S = 10.0


class Awaited(NamedTuple):
    """A state that the box must send because of an event at `since_ns`."""

    state: BoxState
    since_ns: int
    done: Callable[[float], None]  # called with the milliseconds until the state was sent


class Robot:
    """One robot. Call its methods in the fleet's thread only. Any thread may read its values."""

    def __init__(self, loop: asyncio.AbstractEventLoop, index: int, password: str) -> None:
        self.team = f"Team{index}"
        self.port: Optional[int] = None
        self.state = RobotState.STOP
        self.box_state: Optional[BoxState] = None
        self.follows = True  # follows the box's states at once
        self.period_s = REGULAR_S
        self.note_bytes = 0  # of a new text in each datagram
        self.acknowledged_ns = 0
        self.sent_ns: Deque[int] = collections.deque(maxlen=REMEMBERED)
        self.sent = self.answers = self.late = self.unsent = 0
        self.awaited: Optional[Awaited] = None
        self._loop = loop
        self._host = host_of(index)
        self._key = Key(password)
        self._socket: Optional[socket.socket] = None
        self._timer: Optional[asyncio.TimerHandle] = None

    def open(self, port: int) -> None:
        """Open the private channel on `port`."""
        self.close()
        self.port = port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self._socket.bind((self._host, port))
        self._loop.add_reader(self._socket.fileno(), self._read)
        self.keep_sending(REGULAR_S)

    def close(self) -> None:
        """Close the private channel."""
        if self._timer is not None:
            self._timer.cancel()
        if self._socket is not None:
            self._loop.remove_reader(self._socket.fileno())
            self._socket.close()
        self._socket, self.port, self.box_state = None, None, None

    def beacon(self, public_port: int) -> None:
        """Send a beacon, from the robot's own address: the box bounds how many robots it lists at one address."""
        message = pb.RobotBeacon(team_name=self.team, robot_name="Robot")
        message.time.sec, message.time.nsec = divmod(time.time_ns(), 1_000_000_000)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            sender.bind((self._host, 0))
            sender.sendto(frame.encode(message), (BROADCAST, public_port))

    def send(self) -> None:
        """Send the state."""
        self._transmit(self._datagram())

    def _datagram(self) -> bytes:
        now_ns = time.time_ns()
        message = pb.RobotState(messages_saved=1, robot_state=int(self.state))
        message.time.sec, message.time.nsec = divmod(now_ns, 1_000_000_000)
        self.sent_ns.append(now_ns)
        if self.note_bytes:
            message.notifications.append(str(now_ns).ljust(self.note_bytes, "x"))
        return frame.encode(message, Cipher.AES_128_CBC, self._key)

    def _transmit(self, datagram: bytes) -> None:
        try:
            self._socket.sendto(datagram, (BOX_HOST, self.port))
            self.sent += 1
        except OSError:
            self.unsent += 1

    def keep_sending(self, period_s: float, first_s: float = 0.0) -> None:
        """Send with the given period in seconds. The first message leaves after `first_s`."""
        if self._timer is not None:
            self._timer.cancel()
        self.period_s = period_s
        self._timer = self._loop.call_later(first_s, self._tick, self._loop.time() + first_s)

    def report(self, state: RobotState, expects: BoxState, done: Callable[[float], None]) -> None:
        """Report a state that must change the box's state. `done` gets the milliseconds until the answer."""
        self.state = state
        datagram = self._datagram()
        self.awaited = Awaited(expects, time.time_ns(), done)
        self._transmit(datagram)

    def follow(self) -> None:
        """Follow the box's states from now on, beginning with the present one."""
        self.follows = True
        self._follow()

    def _tick(self, due: float) -> None:
        self.send()
        following = max(due + self.period_s, self._loop.time())
        self._timer = self._loop.call_at(following, self._tick, following)

    def _read(self) -> None:
        while self._socket is not None:
            try:
                datagram, ancillary, _flags, _sender = self._socket.recvmsg(2048, 64)
            except BlockingIOError:
                return
            self._take(frame.decode_private(datagram, self._key), _arrival_ns(ancillary))

    def _take(self, message: pb.BenchmarkState, arrived_ns: int) -> None:
        self.box_state = BoxState(message.benchmark_state)
        self.acknowledged_ns = message.acknowledgement.sec * 1_000_000_000 + message.acknowledgement.nsec
        self.answers += 1
        unknown = bisect.bisect_right(self.sent_ns, self.acknowledged_ns)
        if unknown < len(self.sent_ns) and arrived_ns - self.sent_ns[unknown] > LATE_NS:
            self.late += 1
        awaited = self.awaited
        if awaited is not None and awaited.state is self.box_state:
            self.awaited = None
            awaited.done((arrived_ns - awaited.since_ns) / 1e6)
        if self.follows:
            self._follow()

    def _follow(self) -> None:
        wanted = {BoxState.STOP: RobotState.STOP, BoxState.PREPARE: RobotState.WAITING_GOAL,
                  BoxState.WAITING_RESULT: RobotState.EXECUTING}.get(self.box_state, self.state)
        if wanted is not self.state:
            self.state = wanted
            self.send()


def _arrival_ns(ancillary: List[Tuple[int, int, bytes]]) -> int:
    for level, kind, data in ancillary:
        if (level, kind) == (socket.SOL_SOCKET, SO_TIMESTAMPNS):
            seconds, nanoseconds = _TIMESPEC.unpack(data[:_TIMESPEC.size])
            return seconds * 1_000_000_000 + nanoseconds
    return time.time_ns()


class Fleet:
    """All robots of a box, in their own thread. Use it as a context manager."""

    def __init__(self, count: int, public_port: int) -> None:
        """`public_port` of the box."""
        self.loop = asyncio.new_event_loop()
        self.robots = [Robot(self.loop, i, f"password {i}") for i in range(count)]
        self._by_team = {robot.team: robot for robot in self.robots}
        self._public_port = public_port
        self._public = PublicChannel(
            self.loop, Network(BROADCAST, public_port, PUBLIC_HOST, max_datagram=65000), self._on_public,
            lambda text: None)
        self._thread = threading.Thread(target=self.loop.run_forever, name="robots", daemon=True)

    def __enter__(self) -> "Fleet":
        self._thread.start()
        self.do(self._public.open)
        self.do(self._beacons)
        return self

    def __exit__(self, *_error: object) -> None:
        self.do(lambda: [robot.close() for robot in self.robots])
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join(ANSWER_S)
        self._public.close()
        self.loop.close()

    def do(self, function: Callable[[], object]) -> object:
        """Run a function in the fleet's thread and return its result."""
        async def run() -> object:
            return function()
        return asyncio.run_coroutine_threadsafe(run(), self.loop).result(ANSWER_S)

    def ask(self, act: Callable[[], object], robot: Robot, expects: BoxState) -> float:
        """Call `act` in this thread and return the milliseconds until the box sends the state."""
        arrived, taken = threading.Event(), []

        def done(ms: float) -> None:
            taken.append(ms)
            arrived.set()

        robot.awaited = Awaited(expects, time.time_ns(), done)
        act()
        return taken[0] if arrived.wait(ANSWER_S) else float("inf")

    def keep_sending(self, period_s: float) -> None:
        """Make all robots in runs send with this period in seconds, evenly spread."""
        def begin() -> None:
            for number, robot in enumerate(self.robots):
                if robot.port is not None:
                    robot.keep_sending(period_s, period_s * number / len(self.robots))
        self.do(begin)

    def _beacons(self) -> None:
        """Make robots without a run send beacons, evenly spread like real ones."""
        for number, robot in enumerate(self.robots):
            self.loop.call_later(BEACON_PERIOD_S * number / len(self.robots), self._beacon, robot)

    def _beacon(self, robot: Robot) -> None:
        if robot.port is None:
            robot.beacon(self._public_port)
        self.loop.call_later(BEACON_PERIOD_S, self._beacon, robot)

    def _on_public(self, message: object, _sender: Tuple[str, int]) -> None:
        if not isinstance(message, pb.RoahRsbbBeacon):
            return
        for listed in message.benchmarking_teams:
            robot = self._by_team.get(listed.team_name)
            if robot is not None and robot.port != listed.rsbb_port:
                robot.open(listed.rsbb_port)
