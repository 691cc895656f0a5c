"""Hears what passes on the channels, without being a participant: nobody may lose a datagram to it.

With a raw socket (Linux, root or CAP_NET_RAW) everything on the interfaces is heard, unicast of private
channels too, whoever owns the ports. Plain sockets hear broadcasts only: they are bound to the broadcast
address, since a socket on 0.0.0.0 would take other programs' unicast datagrams.
"""

import ctypes
import errno
import socket
import struct
import time
from typing import Callable, Dict, List

from roah_rsbb.comm import sockets
from roah_rsbb.tools.capture import packets, routes
from roah_rsbb.tools.capture.decoding import Decoder
from roah_rsbb.tools.capture.records import Datagram

_LARGEST_PACKET = 65536
_MAX_READS_PER_WAKE_UP = 100
_ETH_P_ALL, _ETH_P_IP = 3, 0x0800
_PACKET_OUTGOING = 4
_SO_ATTACH_FILTER = 26
# A program for the kernel: pass IPv4 packets whose protocol is UDP whole, drop the rest. So the many other
# packets of a busy machine cost nothing here.
_ONLY_UDP = ((0x30, 0, 0, 9), (0x15, 0, 1, socket.IPPROTO_UDP), (0x06, 0, 0, _LARGEST_PACKET), (0x06, 0, 0, 0))


class RawListener:
    """Hears every datagram of the channels on the loopback and on the interface of the network."""

    def __init__(self, decoder: Decoder, rsbb_host: str, notice: Callable[[str], None]) -> None:
        """PermissionError without the right; OpenError, whose text names the remedy."""
        self.sockets: List[socket.socket] = []
        """What to wait for."""
        self._decoder = decoder
        self._notice = notice
        self._interfaces = routes.interfaces_to(rsbb_host)
        try:
            for interface in self._interfaces:
                self.sockets.append(_raw_socket(interface))
        except OSError:
            self.close()
            raise

    @property
    def what(self) -> str:
        """What is heard, for people."""
        return f"UDP {self._decoder.rsbb_port} and private channels, all datagrams on {' and '.join(self._interfaces)}"

    def read(self, endpoint: socket.socket) -> List[Datagram]:
        """What came."""
        heard = []
        for _ in range(_MAX_READS_PER_WAKE_UP):
            try:
                packet, (interface, protocol, kind, *_) = endpoint.recvfrom(_LARGEST_PACKET)
            except (BlockingIOError, InterruptedError):
                break
            except OSError as error:
                if error.errno == errno.ENETDOWN:  # told once; it goes on when the network is back
                    self._notice("a network interface is down")
                    break
                raise
            # On the loopback each packet passes twice, out and in.
            if protocol != _ETH_P_IP or (kind == _PACKET_OUTGOING and interface == routes.LOOPBACK):
                continue
            datagram = packets.parse(packet, time.time())
            if isinstance(datagram, packets.Fragment):
                self._tell_fragment(datagram)
            elif datagram is not None and self._decoder.concerns(datagram):
                heard.append(datagram)
        return heard

    def follow(self) -> None:
        """Called when all that was read is decoded: there is nothing to open."""

    def close(self) -> None:
        """Hear no more."""
        for endpoint in self.sockets:
            endpoint.close()
        self.sockets = []

    def _tell_fragment(self, fragment: packets.Fragment) -> None:
        if fragment.dport == self._decoder.rsbb_port or fragment.dport in self._decoder.listed:
            self._notice(f"{fragment.src} sent {fragment.size} bytes to port {fragment.dport}, which came in fragments "
                         "and are not shown: robots read at most 1024 bytes")


def _raw_socket(interface: str) -> socket.socket:
    endpoint = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, 0)  # hears nothing until it is bound
    try:
        endpoint.setblocking(False)
        program = b"".join(struct.pack("HBBI", *instruction) for instruction in _ONLY_UDP)
        buffer = ctypes.create_string_buffer(program)
        pointer = struct.pack("HP", len(_ONLY_UDP), ctypes.addressof(buffer))
        endpoint.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, pointer)
        endpoint.bind((interface, _ETH_P_ALL))
    except OSError:
        endpoint.close()
        raise
    return endpoint


class PlainListener:
    """Hears broadcasts: those of the public channel and, where nobody here needs the ports, of private ones.

    A private port is owned by one program alone: had we bound it, a robot or box on this machine could not
    open it. So while another program here uses the public port, the private ones are left alone.
    """

    def __init__(self, decoder: Decoder, rsbb_host: str, notice: Callable[[str], None]) -> None:
        """OpenError, whose text names the remedy."""
        self._decoder = decoder
        self._host = routes.broadcast_address(rsbb_host)
        self._notice = notice
        self._public = sockets.listen(self._host, decoder.rsbb_port, shared=True)
        self._private: Dict[int, socket.socket] = {}

    @property
    def what(self) -> str:
        """What is heard, for people."""
        return f"UDP {self._decoder.rsbb_port}, broadcasts to {self._host} only"

    @property
    def sockets(self) -> List[socket.socket]:
        """What to wait for."""
        return [self._public, *self._private.values()]

    def read(self, endpoint: socket.socket) -> List[Datagram]:
        """What came."""
        heard = []
        port = endpoint.getsockname()[1]
        for _ in range(_MAX_READS_PER_WAKE_UP):
            try:
                data, (src, sport) = endpoint.recvfrom(_LARGEST_PACKET)
            except (BlockingIOError, InterruptedError):
                break
            heard.append(Datagram(time.time(), src, sport, self._host, port, data))
        return heard

    def follow(self) -> None:
        """Called when all that was read is decoded: open the ports that the box lists now, close the others."""
        wanted = set(self._decoder.listed)
        if wanted and routes.others_use(self._decoder.rsbb_port, [self._public]):
            self._notice("private channels are not heard: a box or robot on this machine may need their ports")
            wanted = set()
        for port in set(self._private) - wanted:
            self._private.pop(port).close()
        for port in wanted - set(self._private):
            try:
                self._private[port] = sockets.listen(self._host, port, shared=True)
            except OSError as error:
                self._notice(f"private channel {port} is not heard: {error}")

    def close(self) -> None:
        """Hear no more."""
        for endpoint in self.sockets:
            endpoint.close()
        self._private = {}
