"""One participant on one UDP port: receives and sends datagrams, and survives all errors."""

import asyncio
import contextlib
import errno
import logging
import os
import select
import socket
import time
from typing import Callable, List, Optional, Set, Tuple

from roah_rsbb.comm import sockets
from roah_rsbb.comm.complaints import OnceASecond
from roah_rsbb.comm.sockets import OpenError
from roah_rsbb.ground import linux

Address = Tuple[str, int]

_log = logging.getLogger(__name__)

# During a flood, timers, other sockets and a referee's STOP come after so many datagrams of each socket.
_MAX_READS_PER_WAKE_UP = 20
# A datagram that is read so soon (s) after its arrival is the only one, and to look for another one takes long.
_PROMPT_S = 0.001
_OWN_HOST_PERIOD_S = 1.0

_SEND_REMEDY = {
    errno.ENETUNREACH: "check the network cable or wireless, and rsbb_host ('ip -4 addr' shows it as brd)",
    errno.EHOSTUNREACH: "check the network cable or wireless, and that the host is on",
    errno.ENETDOWN: "the network interface is down: check the cable or wireless",
    errno.EPERM: "a firewall on this machine forbids it: allow UDP from rsbb_port upwards",
    errno.EACCES: "a firewall on this machine forbids it: allow UDP from rsbb_port upwards",
    errno.EMSGSIZE: "the datagram is larger than the network takes: lower max_datagram",
    errno.EWOULDBLOCK: "the network is too slow; the message is repeated soon",
    errno.ENOBUFS: "the network is too slow; the message is repeated soon",
    errno.EINVAL: "there is no route from bind_host: choose both in the same network",
}


class Peer:
    """Sends and receives datagrams on one port of one asyncio loop; all methods belong to its thread.

    On 0.0.0.0, one socket is enough. On a specific address, so that several participants can share a machine, the peer
    needs a second socket on the broadcast address, because a socket bound to one address receives no broadcasts. The
    peer ignores its own broadcasts.

    With `apart`, the peer shares the machine, and even the address, with another participant. It sends from a different
    port, because the other participant ignores datagrams from its own port. It receives only broadcasts, because only
    one of two sockets gets a unicast datagram.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        rsbb_host: str,
        port: int,
        on_datagram: Callable[[bytes, Address], None],
        on_complaint: Callable[[str], None],
        bind_host: str = sockets.ANY_HOST,
        max_datagram: int = 1024,
        shared: bool = True,
        apart: bool = False,
        deaf: bool = False,
    ) -> None:
        """`max_datagram`: size limit of sent datagrams (bytes). `deaf`: send only, from a port that is free.

        `shared`: other programs may use the same address and port, as on the public channel, where broadcasts reach all
        of them. Otherwise `open` fails if the port is in use, because only one program would get a unicast datagram.
        """
        self.rsbb_host = rsbb_host
        self.port = port
        # Within `on_datagram`: when the system received the datagram, in UTC seconds; None: unknown.
        self.received_utc: Optional[float] = None
        self._loop = loop
        self._on_datagram = on_datagram
        self._on_complaint = on_complaint
        self._bind_host = bind_host
        self._max_datagram = max_datagram
        self._shared = shared
        self._apart, self._deaf = apart, deaf
        self._source_port = port
        self._sockets: List[socket.socket] = []  # the first one is used for sending
        self._has_sent = False
        self._own_host: Optional[str] = None
        self._own_host_until_mono = float("-inf")
        self._send_errors = OnceASecond()
        self._read_errors = OnceASecond()
        self._bugs = OnceASecond()

    @property
    def is_open(self) -> bool:
        return bool(self._sockets)

    def open(self) -> None:
        """Bind and start to read; has no effect if open. Raises OSError whose text names the remedy."""
        if self._sockets:
            return
        self.rsbb_host = sockets.resolve(self.rsbb_host, "rsbb_host")
        self._bind_host = sockets.resolve(self._bind_host, "bind_host")
        if sockets.is_broadcast(self._bind_host):
            raise sockets.OpenError(
                errno.EINVAL, f"{sockets.BIND_HOST} {self._bind_host} is a broadcast address: give an address of this "
                              "machine ('ip -4 addr' lists them); only rsbb_host is a broadcast address")
        if self._apart or self._deaf:
            self._sockets.append(sockets.speak(self._bind_host))
            self._source_port = self._sockets[0].getsockname()[1]
        else:
            self._sockets.append(sockets.listen(self._bind_host, self.port, self._shared))
        try:
            if self._apart or (self._bind_host != sockets.ANY_HOST and not self._deaf):
                self._listen_to_broadcasts()
        except OSError:
            self._sockets.pop().close()
            raise
        for endpoint in self._sockets:
            self._loop.add_reader(endpoint.fileno(), self._read, endpoint)

    def _listen_to_broadcasts(self) -> None:
        host = sockets.broadcast_host(self._bind_host, self.rsbb_host)
        if host is not None:
            self._sockets.append(sockets.listen(host, self.port, shared=True))
            return
        text = (f"no broadcasts can be received on {self._bind_host}:{self.port}: {self.rsbb_host} is not a broadcast "
                "address of this machine. Set rsbb_host to one ('ip -4 addr' shows them as brd)")
        if self._apart:  # it could receive nothing
            raise sockets.OpenError(errno.EADDRNOTAVAIL, text)
        self._complain(f"{text}, or {sockets.BIND_HOST} to {sockets.ANY_HOST}")

    def close(self) -> None:
        """Stop reading and release the port; has no effect if closed."""
        closing, self._sockets = self._sockets, []
        for endpoint in closing:
            self._loop.remove_reader(endpoint.fileno())
            endpoint.close()

    def send(self, datagram: bytes, host: str) -> bool:
        """Send to `host`, an IPv4 address, at this peer's port.

        Never raises or blocks. Returns whether the datagram was sent; failures are reported at most once a second. A
        closed peer does nothing.
        """
        if not self._sockets:
            return False
        if len(datagram) > self._max_datagram:
            return self._not_sent(
                host, f"it has {len(datagram)} bytes, but receivers may only read {self._max_datagram}. "
                      "Remedy: send less, or raise max_datagram if all receivers read more")
        self._has_sent = True
        try:
            self._sockets[0].sendto(datagram, (host, self.port))
        except OSError as error:
            remedy = _SEND_REMEDY.get(error.errno or 0, "check the network")
            return self._not_sent(host, f"{os.strerror(error.errno or 0)}. Remedy: {remedy}")
        return True

    def wait(self, seconds: float) -> None:
        """Wait, without the loop, for datagrams, and read them; returns after `seconds` at the latest."""
        for endpoint in select.select(self._sockets, [], [], seconds)[0]:
            self._read(endpoint)

    def _not_sent(self, host: str, why: str) -> bool:
        self._send_errors.count()
        count = self._send_errors.take(self._loop.time())
        if count:
            what = "a datagram" if count == 1 else f"{count} datagrams"
            self._complain(f"could not send {what} to {host}:{self.port}: {why}")
        return False

    def _read(self, endpoint: socket.socket) -> None:
        for _ in range(_MAX_READS_PER_WAKE_UP):
            try:
                datagram, sender, self.received_utc = linux.receive(endpoint)
            except (BlockingIOError, InterruptedError):
                return
            except OSError as error:
                self._not_read(error)
                return
            # A peer's own broadcasts come from its own port. Before it sends, they are those of another program at the
            # same address, such as a second box on this computer.
            if not self._has_sent or sender[1] != self._source_port or sender[0] != self._source_host():
                try:
                    self._on_datagram(datagram, sender)
                except Exception:
                    # A mistake in a handler must not end the reading: the next datagram may be a referee's stop.
                    self._bug("a handler of datagrams failed")
                if endpoint not in self._sockets:
                    return  # the handler closed this peer
            if self.received_utc is not None and time.time() - self.received_utc < _PROMPT_S:
                return  # hardly another one is there, and the loop would say so

    def _not_read(self, error: OSError) -> None:
        self._read_errors.count()
        if self._read_errors.take(self._loop.time()):
            self._complain(f"could not read from UDP port {self.port}: {error.strerror}: check the network")

    def _complain(self, text: str) -> None:
        try:
            self._on_complaint(text)
        except Exception:
            self._bug("a handler of complaints failed")

    def _bug(self, what: str) -> None:
        self._bugs.count()
        count = self._bugs.take(self._loop.time())
        if count:
            _log.exception("%s on UDP port %d (%d times since the last report)", what, self.port, count)

    def _source_host(self) -> Optional[str]:
        """The address that this peer's broadcasts come from.

        A peer on 0.0.0.0 must ask the system, which has no answer while the network is down and may have a different
        one after a new lease. It asks again each second if necessary.
        """
        if self._bind_host != sockets.ANY_HOST:
            return self._bind_host
        now_mono = self._loop.time()
        if now_mono >= self._own_host_until_mono:
            self._own_host_until_mono = now_mono + _OWN_HOST_PERIOD_S
            self._own_host = sockets.source_host(self.rsbb_host) or self._own_host
        return self._own_host


# -- a network in memory ------------------------------------------------------------------------------

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
