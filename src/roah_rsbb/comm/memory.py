"""A network in memory: carries datagrams between the participants of one process, as UDP does between computers. They
may be in the loops of several threads."""

import asyncio
import contextlib
import errno
from typing import Callable, List, Optional, Set, Tuple

from roah_rsbb.comm import sockets
from roah_rsbb.comm.peer import Address
from roah_rsbb.comm.sockets import OpenError

DELAY_S = 0.001


class MemoryAir:
    """Carries the datagrams. Its `peer` stands for `Peer`."""

    def __init__(self) -> None:
        self.peers: List[MemoryPeer] = []
        self.taken: Set[Tuple[str, int]] = set()  # addresses and ports that another program uses
        self._arrival_mono = 0.0

    def peer(
        self, loop: asyncio.AbstractEventLoop, rsbb_host: str, port: int, on_datagram: Callable[[bytes, Address], None],
        on_complaint: Callable[[str], None], bind_host: str = sockets.ANY_HOST, max_datagram: int = 1024,
        shared: bool = True, apart: bool = False,
    ) -> "MemoryPeer":
        """Return a participant; for the arguments see `Peer`."""
        return MemoryPeer(self, loop, rsbb_host, port, on_datagram, bind_host, max_datagram, shared)

    def deliver(self, source: "MemoryPeer", datagram: bytes, host: str) -> None:
        """Carry a datagram to whom it is addressed, or with the broadcast address to all others."""
        # Timers of one moment have no order, but a wire has.
        self._arrival_mono = max(source.loop.time() + DELAY_S, self._arrival_mono + 1e-7)
        for peer in list(self.peers):
            is_there = peer.port == source.port and peer is not source
            if is_there and host in (peer.bind_host, sockets.LOOPBACK_BROADCAST):
                arrived = self._arrive, peer, datagram, (source.bind_host, source.port)
                if peer.loop is source.loop:
                    peer.loop.call_at(self._arrival_mono, *arrived)
                else:
                    with contextlib.suppress(RuntimeError):  # its loop has ended
                        peer.loop.call_soon_threadsafe(*arrived)

    def _arrive(self, peer: "MemoryPeer", datagram: bytes, sender: Address) -> None:
        if peer in self.peers:
            peer.on_datagram(datagram, sender)


class MemoryPeer:
    """A participant on one port of a network in memory: what `Peer` is with UDP."""

    def __init__(
        self, air: MemoryAir, loop: asyncio.AbstractEventLoop, rsbb_host: str, port: int,
        on_datagram: Callable[[bytes, Address], None], bind_host: str, max_datagram: int, shared: bool,
    ) -> None:
        self.rsbb_host, self.port, self.bind_host = rsbb_host, port, bind_host
        self.loop, self.on_datagram = loop, on_datagram
        self.received_utc: Optional[float] = None  # the moment is the present one
        self._air, self._max_datagram, self._shared = air, max_datagram, shared

    @property
    def is_open(self) -> bool:
        """Whether it receives."""
        return self in self._air.peers

    def open(self) -> None:
        """Begin to receive; has no effect if it is open. Raises OpenError."""
        used = {(peer.bind_host, peer.port) for peer in self._air.peers} | self._air.taken
        if not self._shared and (self.bind_host, self.port) in used:
            raise OpenError(errno.EADDRINUSE,
                            f"cannot open UDP {self.bind_host}:{self.port}: in use by another program")
        if not self.is_open:
            self._air.peers.append(self)

    def close(self) -> None:
        """Stop to receive."""
        with contextlib.suppress(ValueError):
            self._air.peers.remove(self)

    def send(self, datagram: bytes, host: str) -> bool:
        """See `Peer.send`."""
        if not self.is_open or len(datagram) > self._max_datagram:
            return False
        self._air.deliver(self, datagram, host)
        return True
