"""Listens to the channels passively, so that no participant loses a datagram.

A raw socket (Linux, root or CAP_NET_RAW) hears everything on the interfaces, including unicast datagrams of private
channels, whichever program has bound the ports. Plain sockets hear broadcasts only: they are bound to the broadcast
address, because a socket on 0.0.0.0 would take unicast datagrams from other programs.
"""

import ctypes
import errno
import ipaddress
import os
import socket
import struct
import sys
import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Set, Tuple, Union

from roah_rsbb.capture.decoding import Datagram, Decoder
from roah_rsbb.comm import sockets
from roah_rsbb.comm.sockets import OpenError

_IP = struct.Struct(">BxHxxHxBxx4s4s")  # version and header words, length, fragment, protocol, addresses
_UDP = struct.Struct(">HHHxx")  # ports, length
_MORE_FRAGMENTS, _OFFSET = 0x2000, 0x1FFF


class Fragment(NamedTuple):
    """The first fragment of a datagram. Later fragments have no ports and are ignored."""

    src: str
    dport: int
    size: int  # bytes of the complete datagram


def parse_packet(packet: bytes, time: float) -> Union[Datagram, Fragment, None]:
    """Extract the UDP datagram from an IPv4 packet received at `time`; None for other packets and later fragments."""
    if len(packet) < _IP.size:
        return None
    version_words, length, fragment, protocol, src, dst = _IP.unpack_from(packet)
    start = version_words % 16 * 4
    if version_words // 16 != 4 or start < _IP.size or protocol != socket.IPPROTO_UDP or fragment & _OFFSET:
        return None
    if not start + _UDP.size <= length <= len(packet):
        return None
    sport, dport, udp_length = _UDP.unpack_from(packet, start)
    if fragment & _MORE_FRAGMENTS:
        return Fragment(socket.inet_ntoa(src), dport, max(0, udp_length - _UDP.size))
    data = _udp_content(packet[start + _UDP.size:length], udp_length)
    if data is None:
        return None
    return Datagram(time, socket.inet_ntoa(src), sport, socket.inet_ntoa(dst), dport, data)


def _udp_content(content: bytes, udp_length: int) -> Optional[bytes]:
    """The datagram's bytes. A packet may be longer than its content, but not shorter."""
    size = udp_length - _UDP.size
    return content[:size] if 0 <= size <= len(content) else None


# The network of this Linux machine, from the tables in /proc.


LOOPBACK = "lo"


def interfaces_to(rsbb_host: str) -> List[str]:
    """Return the interfaces that the channels use: the loopback, and the one that leads to `rsbb_host`.

    Raises OpenError, whose text names the remedy, if no interface leads there.
    """
    if ipaddress.IPv4Address(rsbb_host).is_loopback:
        return [LOOPBACK]
    interface = route(rsbb_host, _read_table("/proc/net/route"))
    if interface is None:
        raise OpenError(0, f"--host {rsbb_host} is not in a network of this machine: give the broadcast address of the "
                           "network with the robots ('ip -4 addr' shows it as brd)")
    return [LOOPBACK, interface]


def route(host: str, table: str) -> Optional[str]:
    """Find the interface to `host` in the text of /proc/net/route; None if `host` is not in a local network."""
    address = int(ipaddress.IPv4Address(host))
    best, interface = -1, None
    for line in table.splitlines()[1:]:
        columns = line.split()
        destination, gateway, mask = (_address(columns[index]) for index in (1, 2, 7))
        if address & mask == destination and mask > best:
            best, interface = mask, None if gateway else columns[0]
    return interface


def udp_sockets(port: int, table: str) -> Set[int]:
    """Find the inodes of the sockets that are bound to a UDP port in the text of /proc/net/udp."""
    rows = (line.split() for line in table.splitlines()[1:])
    return {int(columns[9]) for columns in rows if int(columns[1].split(":")[1], 16) == port}


def others_use(port: int, own: List[socket.socket]) -> bool:
    """Whether another program on this machine uses a UDP port."""
    return bool(udp_sockets(port, _read_table("/proc/net/udp")) - {os.fstat(one.fileno()).st_ino for one in own})


def broadcast_address(rsbb_host: str) -> str:
    """Return `rsbb_host` if it is a broadcast address of this machine; else raise OpenError, which names the remedy."""
    if not sockets.is_broadcast(rsbb_host):
        raise OpenError(0, f"--host {rsbb_host} is not a broadcast address of this machine: give the one of the "
                           "network with the robots ('ip -4 addr' shows it as brd)")
    return rsbb_host


def _address(hexadecimal: str) -> int:
    """Convert an address of /proc/net, which is in the byte order of this processor."""
    return int.from_bytes(int(hexadecimal, 16).to_bytes(4, sys.byteorder), "big")


def _read_table(path: str) -> str:
    try:
        with open(path, encoding="ascii", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


# -- listeners --------------------------------------------------------------------------------------

_LARGEST_PACKET = 65536
_MAX_READS_PER_WAKE_UP = 100
_ETH_P_ALL, _ETH_P_IP = 3, 0x0800
_PACKET_OUTGOING = 4
_SO_ATTACH_FILTER = 26
# A packet filter for the kernel: pass complete IPv4 packets with UDP, drop all others. This program then spends no
# time on the other packets of a busy machine.
_ONLY_UDP = ((0x30, 0, 0, 9), (0x15, 0, 1, socket.IPPROTO_UDP), (0x06, 0, 0, _LARGEST_PACKET), (0x06, 0, 0, 0))


class DatagramListener:
    """Reads from sockets what may be datagrams of the channels."""

    what = ""
    """A description of what is heard."""

    def __init__(self, decoder: Decoder, notice: Callable[[str], None]) -> None:
        self.sockets: List[socket.socket] = []
        """The sockets to wait for."""
        self._decoder = decoder
        self._notice = notice

    def read(self, endpoint: socket.socket) -> List[Datagram]:
        """Read the available datagrams."""
        heard = []
        for _ in range(_MAX_READS_PER_WAKE_UP):
            try:
                received, sender = endpoint.recvfrom(_LARGEST_PACKET)
            except (BlockingIOError, InterruptedError):
                break
            except OSError as error:
                if error.errno == errno.ENETDOWN:  # reported once; continues when the network is back
                    self._notice("a network interface is down")
                    break
                raise
            datagram = self._datagram(endpoint, received, sender)
            if datagram is not None:
                heard.append(datagram)
        return heard

    def follow(self) -> None:
        """Called after decoding: open the ports of channels that the box lists now, and close the others."""

    def close(self) -> None:
        """Stop listening."""
        for endpoint in self.sockets:
            endpoint.close()

    def _datagram(self, endpoint: socket.socket, received: bytes, sender: Tuple[Any, ...]) -> Optional[Datagram]:
        """Return the datagram in what was received, if it concerns the channels."""
        raise NotImplementedError


class RawListener(DatagramListener):
    """Hears all datagrams of the channels on the loopback and on the network's interface."""

    def __init__(self, decoder: Decoder, rsbb_host: str, notice: Callable[[str], None]) -> None:
        """Raises PermissionError without the right, or OpenError, whose text names the remedy."""
        super().__init__(decoder, notice)
        interfaces = interfaces_to(rsbb_host)
        self.what = f"UDP {decoder.rsbb_port} and private channels, all datagrams on {' and '.join(interfaces)}"
        try:
            for interface in interfaces:
                self.sockets.append(_raw_socket(interface))
        except OSError:
            self.close()
            raise

    def _datagram(self, endpoint: socket.socket, received: bytes, sender: Tuple[Any, ...]) -> Optional[Datagram]:
        interface, protocol, kind = sender[:3]
        # The loopback delivers each packet twice, outgoing and incoming.
        if protocol != _ETH_P_IP or (kind == _PACKET_OUTGOING and interface == LOOPBACK):
            return None
        datagram = parse_packet(received, time.time())
        if isinstance(datagram, Fragment):
            self._report_fragment(datagram)
            return None
        return datagram if datagram is not None and self._decoder.concerns(datagram) else None

    def _report_fragment(self, fragment: Fragment) -> None:
        if fragment.dport == self._decoder.rsbb_port or fragment.dport in self._decoder.listed:
            self._notice(f"{fragment.src} sent {fragment.size} bytes to port {fragment.dport}, which were fragmented "
                         "and are not shown: robots read at most 1024 bytes")


def _raw_socket(interface: str) -> socket.socket:
    endpoint = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, 0)  # receives nothing until it is bound
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


class PlainListener(DatagramListener):
    """Hears broadcasts on the public channel and, if no other program here needs the ports, on private ones.

    Only one program can bind a private port. If this program bound it, a robot or box on this machine could not open
    it. Therefore private ports stay closed while another program here uses the public port.
    """

    def __init__(self, decoder: Decoder, rsbb_host: str, notice: Callable[[str], None]) -> None:
        """Raises OpenError, whose text names the remedy."""
        super().__init__(decoder, notice)
        self._host = broadcast_address(rsbb_host)
        self.what = f"UDP {decoder.rsbb_port}, broadcasts to {self._host} only"
        self._private: Dict[int, socket.socket] = {}
        self.sockets = [sockets.listen(self._host, decoder.rsbb_port, shared=True)]

    def _datagram(self, endpoint: socket.socket, received: bytes, sender: Tuple[Any, ...]) -> Optional[Datagram]:
        return Datagram(time.time(), *sender, self._host, endpoint.getsockname()[1], received)

    def follow(self) -> None:
        """See `DatagramListener`."""
        wanted = set(self._decoder.listed)
        if wanted and others_use(self._decoder.rsbb_port, self.sockets[:1]):
            self._notice("private channels are not heard: a box or robot on this machine may need their ports")
            wanted = set()
        for port in set(self._private) - wanted:
            self._private.pop(port).close()
        for port in wanted - set(self._private):
            try:
                self._private[port] = sockets.listen(self._host, port, shared=True)
            except OSError as error:
                self._notice(f"private channel {port} is not heard: {error}")
        self.sockets[1:] = self._private.values()
