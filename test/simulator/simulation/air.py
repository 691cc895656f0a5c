"""The network: carries datagrams between the peers of all processes, loses, delays, doubles and forges them."""

import collections
import errno
import functools

from roah_rsbb.comm import sockets
from roah_rsbb.comm.sockets import OpenError

BROADCAST, PUBLIC_PORT = "10.255.255.255", 6666
AT_ONCE_S, SHORTEST_S, SHORT_S = 0.0002, 0.0005, 0.003
# Datagrams that wait at a socket. The kernel drops more.
MOST_WAITING = 100
KEPT = 5000


class Weather:
    """How the network is now, for one host or for all."""

    def __init__(self):
        self.loss = self.late = self.double = 0.0  # probabilities
        self.longest_s = 0.5  # of late datagrams
        self.is_cut = False

    @property
    def is_good(self):
        """Whether datagrams arrive."""
        return not self.is_cut and self.loss < 0.3


class Air:
    """All hosts. `weather` by host; a datagram passes through that of its sender and that of its receiver."""

    def __init__(self, scheduler, random, trace):
        self.scheduler = scheduler
        self.random = random
        self.weather = collections.defaultdict(Weather)
        self.sent = collections.deque(maxlen=KEPT)  # (host, port, datagram, receiver) of datagrams lately
        self.watchers = []  # called with (source host, port, datagram, receiver's host)
        # Called with (receiver's host, port, datagram, source host, is_forged) when a computer receives it, and when a
        # program reads it.
        self.arrived, self.readers = [], []
        self.relays = {}  # from which host somebody sends again at once what a host sends to a port
        self._trace = trace
        self._peers = collections.defaultdict(list)  # by port

    def peer_maker(self, process):
        """Return what stands for `Peer` in a process."""
        def make(loop, rsbb_host, port, on_datagram, on_complaint, bind_host=sockets.ANY_HOST, max_datagram=1024,
                 shared=True, apart=False):
            peer = Peer(self, process, rsbb_host, port, on_datagram, on_complaint, max_datagram, shared)
            process.on_end.append(peer.close)
            return peer
        return make

    def send(self, source, port, datagram, host, is_forged=True):
        """A datagram leaves the host `source`, or seems to."""
        self._trace.datagram(source, port, datagram, host)
        if not is_forged:
            self.sent.append((source, port, datagram, host))
            for watch in self.watchers:
                watch(source, port, datagram, host)
        for peer in self._peers[port]:
            if peer.host != source and host in (peer.host, BROADCAST):
                if (source, port) in self.relays and not is_forged and not self.weather[peer.host].is_cut:
                    self.scheduler.after(AT_ONCE_S, functools.partial(
                        peer.arrive, datagram, (self.relays[source, port], port), True))
                for delay in self._delays(source, peer.host):
                    self.scheduler.after(delay, functools.partial(peer.arrive, datagram, (source, port), is_forged))

    def _delays(self, source, host):
        random, delays = self.random, [0.0]
        for weather in (self.weather[source], self.weather[host]):
            if weather.is_cut or random.random() < weather.loss:
                return []
            if random.random() < weather.double:
                delays.append(0.0)
        late = max(self.weather[source].late, self.weather[host].late)
        longest_s = max(self.weather[source].longest_s, self.weather[host].longest_s)
        return [random.uniform(SHORTEST_S, longest_s if late and random.random() < late else SHORT_S) for _ in delays]

    def opened(self, peer):
        """A peer begins to receive. Raises OSError."""
        others = [other for other in self._peers[peer.port] if other.host == peer.host]
        if others and not peer.shared:
            raise OpenError(errno.EADDRINUSE, f"cannot open UDP {peer.host}:{peer.port}: in use by another program")
        self._peers[peer.port].append(peer)

    def closed(self, peer):
        """A peer does not receive any more."""
        self._peers[peer.port].remove(peer)


class Peer:
    """Stands for `roah_rsbb.comm.peer.Peer`."""

    def __init__(self, air, process, rsbb_host, port, on_datagram, on_complaint, max_datagram, shared):
        self.rsbb_host, self.port, self.host, self.shared = rsbb_host, port, process.computer.host, shared
        self.received_utc = None
        self.is_open = False
        self._air, self._process = air, process
        self._on_datagram, self._on_complaint, self._max_datagram = on_datagram, on_complaint, max_datagram
        self._waiting = collections.deque()
        self._is_reading = False

    def open(self):
        if not self.is_open:
            self._air.opened(self)
            self.is_open = True

    def close(self):
        if self.is_open:
            self.is_open = False
            self._air.closed(self)

    def send(self, datagram, host):
        if not self.is_open:
            return False
        if len(datagram) > self._max_datagram:
            self._on_complaint(f"could not send a datagram to {host}:{self.port}: it has {len(datagram)} bytes")
            return False
        self._air.send(self.host, self.port, datagram, host, is_forged=False)
        return True

    def arrive(self, datagram, sender, is_forged):
        """The kernel has received a datagram."""
        if self.is_open and len(self._waiting) < MOST_WAITING:
            for see in self._air.arrived:
                see(self.host, self.port, datagram, sender[0], is_forged)
            self._waiting.append((datagram, sender, is_forged, self._process.computer.utc()))
            if not self._is_reading:
                self._is_reading = True
                self._process.soon(self._read)

    def wait(self, seconds):
        """Wait, without the loop, for datagrams, and read them; returns after `seconds` at the latest."""
        self._process.wait(seconds, lambda: bool(self._waiting))
        self._read()

    def _read(self):
        self._is_reading = False
        while self._waiting and self.is_open:
            datagram, sender, is_forged, self.received_utc = self._waiting.popleft()
            for read in self._air.readers:
                read(self.host, self.port, datagram, sender[0], is_forged)
            self._on_datagram(datagram, sender)
