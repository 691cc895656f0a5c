"""An asyncio loop in simulated time, and a network of peers in it: programs with sockets run in milliseconds."""

import asyncio
import contextlib
import selectors

from roah_rsbb.comm import sockets
from roah_rsbb.comm.sockets import OpenError

DELAY_S = 0.001
# A check of all scenarios needs fewer.
MOST_SELECTS = 500_000
MONO0, UTC0 = 1000.0, 1_800_000_000.0


class _NoFiles(selectors.SelectSelector):
    """Waits for no file: the time passes instead."""

    def __init__(self, advance):
        super().__init__()
        self._advance = advance
        self._selects = 0

    def select(self, timeout=None):
        if timeout is None:
            raise AssertionError("nothing is due: the programs wait for something that never comes")
        self._selects += 1
        if self._selects > MOST_SELECTS:
            raise AssertionError("the programs are busy without an end")
        self._advance(max(timeout, 0.0))
        return []


class SimulatedLoop(asyncio.SelectorEventLoop):
    """Its time jumps to whatever is due next."""

    def __init__(self):
        self._mono = MONO0
        super().__init__(_NoFiles(self._pass))

    def _pass(self, seconds):
        self._mono += seconds

    def time(self):
        return self._mono

    def utc(self):
        """The true time."""
        return UTC0 + self._mono - MONO0

    def stall(self, seconds):
        """The machine does something else for a while."""
        self._mono += seconds


class Air:
    """Carries datagrams between the peers of a loop."""

    def __init__(self, loop):
        self.loop = loop
        self.peers = []
        self._arrival = 0.0
        self.taken = set()  # (host, port) that another program uses

    def peer(self, loop, rsbb_host, port, on_datagram, on_complaint, bind_host=sockets.ANY_HOST, max_datagram=1024,
             shared=True, apart=False):
        """Stands for `Peer`."""
        return _Peer(self, rsbb_host, port, on_datagram, bind_host, max_datagram, shared)

    def deliver(self, source, datagram, host):
        # Timers of one moment have no order, but a wire has.
        self._arrival = max(self.loop.time() + DELAY_S, self._arrival + 1e-7)
        for peer in list(self.peers):
            is_there = peer.port == source.port and peer is not source
            if is_there and host in (peer.bind_host, sockets.LOOPBACK_BROADCAST):
                self.loop.call_at(self._arrival, self._arrive, peer, datagram, (source.bind_host, source.port))

    def _arrive(self, peer, datagram, sender):
        if peer in self.peers:
            peer.on_datagram(datagram, sender)


class _Peer:
    def __init__(self, air, rsbb_host, port, on_datagram, bind_host, max_datagram, shared):
        self.rsbb_host, self.port, self.bind_host = rsbb_host, port, bind_host
        self.on_datagram = on_datagram
        self.received_utc = None
        self._air, self._max_datagram, self._shared = air, max_datagram, shared

    @property
    def is_open(self):
        return self in self._air.peers

    def open(self):
        used = {(peer.bind_host, peer.port) for peer in self._air.peers} | self._air.taken
        if not self._shared and (self.bind_host, self.port) in used:
            raise OpenError(98, f"cannot open UDP {self.bind_host}:{self.port}: in use by another program")
        self._air.peers.append(self)

    def close(self):
        with contextlib.suppress(ValueError):
            self._air.peers.remove(self)

    def send(self, datagram, host):
        if not self.is_open or len(datagram) > self._max_datagram:
            return False
        self._air.deliver(self, datagram, host)
        return True
