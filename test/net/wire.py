"""A bad cable: between a host's network device and the switch's, in user space, with a seed.

Linux has netem for this. But many kernels come without it, and `tc` cannot give it a seed; here the fate of the n-th
datagram in each direction depends on the seed and on nothing else. Both ends are TAP devices: what the system sends
through such a device is read from its file, and what is written to the file has arrived.
"""

import asyncio
import collections
import contextlib
import fcntl
import os
import random
import struct
from typing import Deque, Iterator, NamedTuple, Optional, Tuple

# linux/if_tun.h
_TUNSETIFF = 0x400454CA
_IFF_TAP, _IFF_NO_PI = 0x0002, 0x1000
_MAX_FRAME = 65536
_IPV4 = b"\x08\x00"
_READS = 50  # at most, before others have their turn
LATE_S = 1.0  # no network's queue is longer; a machine that stops would deliver all of them later
_HELD = 8  # datagrams that wait for another host's: the newest


class Impairment(NamedTuple):
    """How a cable treats datagrams in each direction. Shares from 0 to 1; seconds."""

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0  # these overtake the delayed ones
    delay_s: float = 0.0
    jitter_s: float = 0.0

    @property
    def longest_s(self) -> float:
        """The longest delay."""
        return self.delay_s + self.jitter_s


PERFECT = Impairment()
BAD = Impairment(loss=0.30, duplicate=0.20, reorder=0.25, delay_s=0.05, jitter_s=0.05)
GONE = Impairment(loss=1.0)


def open_tap(name: str) -> int:
    """Make a network device in the calling thread's namespace; returns its file. OSError: it cannot be."""
    file = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    try:
        fcntl.ioctl(file, _TUNSETIFF, struct.pack("16sH22x", name.encode(), _IFF_TAP | _IFF_NO_PI))
    except OSError:
        os.close(file)
        raise
    return file


class _Direction:
    """From one device to another one."""

    def __init__(self, wire: "Wire", source: int, target: int, seed: str) -> None:
        self._wire, self._source, self._target = wire, source, target
        self._fates = random.Random(seed)
        self.passed = self.lost = self.doubled = 0
        self._held: Optional[Deque[bytes]] = None
        self._followers: Tuple[Tuple[int, _Direction], ...] = ()  # each with a port

    def read(self) -> None:
        """Take the datagrams that the source sent."""
        with contextlib.suppress(BlockingIOError):
            for _ in range(_READS):
                self._take(os.read(self._source, _MAX_FRAME))

    def _take(self, frame: bytes) -> None:
        how = self._wire.how
        if frame[12:14] != _IPV4:  # questions for addresses: a wireless network would repeat them
            if how is not GONE:
                self._deliver(frame)
            return
        if self._held is not None:
            self._held.append(frame)
            return
        # The same number of draws for each datagram, so that each one's fate is its own.
        lost, doubled, overtakes, late, later = (self._fates.random() for _ in range(5))
        if lost < how.loss:
            self.lost += 1
            return
        self.passed += 1
        self._later(frame, 0.0 if overtakes < how.reorder else how.delay_s + how.jitter_s * (2 * late - 1))
        if doubled < how.duplicate:
            self.doubled += 1
            self._later(frame, how.delay_s + how.jitter_s * (2 * later - 1))

    def _later(self, frame: bytes, delay_s: float) -> None:
        if delay_s > 0.0:
            loop = asyncio.get_event_loop()
            due = loop.time() + delay_s
            loop.call_at(due, self._deliver_in_time, frame, due)
        else:
            self._deliver(frame)

    def _deliver_in_time(self, frame: bytes, due: float) -> None:
        if asyncio.get_event_loop().time() - due < LATE_S:
            self._deliver(frame)
        else:
            self.lost += 1

    def _deliver(self, frame: bytes) -> None:
        # A device that is down takes nothing, and that is what it is for.
        with contextlib.suppress(OSError):
            os.write(self._target, frame)
        for port, follower in self._followers:
            if _port(frame) == port:
                follower.release()

    def lead(self, port: int, follower: "_Direction") -> None:
        """After each datagram to `port`, release what `follower` holds."""
        follower._held = collections.deque(maxlen=_HELD)
        self._followers += ((port, follower),)

    def lead_no_more(self, follower: "_Direction") -> None:
        """Let `follower` deliver at once again."""
        self._followers = tuple(each for each in self._followers if each[1] is not follower)
        follower._held = None

    def release(self) -> None:
        """Deliver what is held."""
        while self._held:
            self.passed += 1
            self._deliver(self._held.popleft())


def _port(frame: bytes) -> int:
    """The UDP port that an IPv4 frame is for."""
    begin = 14 + 4 * (frame[14] & 0x0F) + 2
    return int.from_bytes(frame[begin:begin + 2], "big")


class Wire:
    """One cable. All of it happens in one asyncio loop, in which `open` must be called."""

    def __init__(self, near: int, far: int, seed: str) -> None:
        """`near`, `far`: files of the devices; `seed` makes all fates."""
        self.how = PERFECT
        self.out = _Direction(self, near, far, f"{seed} out")
        self.back = _Direction(self, far, near, f"{seed} back")
        self._ends = ((near, self.out), (far, self.back))

    def open(self) -> None:
        """Begin to carry."""
        for file, direction in self._ends:
            asyncio.get_event_loop().add_reader(file, direction.read)

    @contextlib.contextmanager
    def follows(self, other: "Wire", port: int) -> Iterator[None]:
        """Meanwhile, what this host sends arrives only right after a datagram from the other host to `port`."""
        other.out.lead(port, self.out)
        try:
            yield
        finally:
            other.out.lead_no_more(self.out)

    def close(self) -> None:
        """End, with both devices."""
        for file, _ in self._ends:
            asyncio.get_event_loop().remove_reader(file)
            os.close(file)
