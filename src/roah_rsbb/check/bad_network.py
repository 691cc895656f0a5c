"""A network that the check makes worse on purpose: it loses, duplicates and delays datagrams in both directions.

What happens to each datagram depends on the seed and on the datagram's number only.
"""

import asyncio
import random
from typing import Any, Callable, Dict, List, NamedTuple, Optional

from roah_rsbb.comm.channels import MakePeer
from roah_rsbb.comm.peer import Address, Peer


class Impairment(NamedTuple):
    """How datagrams are treated. Shares from 0 to 1; seconds."""

    loss: float = 0.0
    duplicate: float = 0.0
    late: float = 0.0  # share that is delayed by `late_s`, so that others overtake them
    late_s: float = 0.0


PERFECT = Impairment()
MUTE = Impairment(loss=1.0)
# Real wireless networks in a hall are better than this.
BAD = Impairment(loss=0.2, duplicate=0.2, late=0.2, late_s=0.15)


class BadNetwork:
    """All peers of the check. `out` and `back` impair what the box sends, and what it receives."""

    def __init__(self, loop: asyncio.AbstractEventLoop, seed: int, make_peer: Optional[MakePeer] = None) -> None:
        self.out = self.back = PERFECT
        self.largest = 0  # bytes of the largest datagram that was received
        self.sent: List[bytes] = []  # datagrams on private channels, while `keep` is set
        self.keep = False
        self._peers: Dict[int, BadPeer] = {}  # the latest by port
        self._loop = loop
        self._random = random.Random(seed)
        self._make_peer = make_peer or Peer

    def peer(
        self, loop: asyncio.AbstractEventLoop, rsbb_host: str, port: int,
        on_datagram: Callable[[bytes, Address], None], *args: Any, **kwargs: Any,
    ) -> "BadPeer":
        """Make a peer, with the arguments of `Peer`."""
        is_private = not kwargs.get("shared", True)

        def receive(datagram: bytes, sender: Address) -> None:
            self.largest = max(self.largest, len(datagram))
            # What this network adds is a delay on the way.
            received_utc = made.real_received_utc if self.back is PERFECT else None

            def deliver() -> None:
                made.received_utc = received_utc
                on_datagram(datagram, sender)

            self.treat(self.back, deliver)

        made = BadPeer(self, self._make_peer(loop, rsbb_host, port, receive, *args, **kwargs), is_private)
        if self._peers.get(port) is None or not self._peers[port].is_open:
            self._peers[port] = made
        return made

    def resend(self, port: int, datagram: bytes, host: str) -> None:
        """Send any bytes from the box's socket on a port."""
        self._peers[port].send(datagram, host)

    def treat(self, how: Impairment, deliver: Callable[[], Any]) -> None:
        """Deliver a datagram not at all, once or twice, now or later."""
        if how is PERFECT:
            deliver()
            return
        lost, doubled, *late = (self._random.random() for _ in range(4))
        if lost < how.loss:
            return
        for one in late[:1 + (doubled < how.duplicate)]:
            if one < how.late:
                self._loop.call_later(how.late_s, deliver)
            else:
                deliver()


class BadPeer:
    """A `Peer` on a bad network."""

    def __init__(self, network: BadNetwork, peer: Peer, is_private: bool) -> None:
        self._network = network
        self._peer = peer
        self._is_private = is_private
        self.received_utc: Optional[float] = None  # see `Peer`

    @property
    def real_received_utc(self) -> Optional[float]:
        """When the system received the datagram that is being read, in UTC seconds; None: unknown."""
        return self._peer.received_utc

    def __getattr__(self, name: str) -> Any:
        return getattr(self._peer, name)

    def send(self, datagram: bytes, host: str) -> bool:
        """Send like `Peer.send`. A datagram that the bad network loses counts as sent."""
        if self._is_private and self._network.keep:
            self._network.sent.append(datagram)
        self._network.treat(self._network.out, lambda: self._peer.send(datagram, host))
        return True
