"""UDP datagrams in the IPv4 packets that a raw socket brings."""

import socket
import struct
from typing import NamedTuple, Optional, Union

from roah_rsbb.tools.capture.records import Datagram

_IP = struct.Struct(">BxHxxHxBxx4s4s")  # version and header words, length, fragment, protocol, addresses
_UDP = struct.Struct(">HHHxx")  # ports, length
_MORE_FRAGMENTS, _OFFSET = 0x2000, 0x1FFF


class Fragment(NamedTuple):
    """The first part of a datagram that the network had to cut: the rest has no ports, and cannot be found."""

    src: str
    dport: int
    size: int  # bytes of the whole datagram


def parse(packet: bytes, time: float) -> Union[Datagram, Fragment, None]:
    """The UDP datagram in an IPv4 packet that came at `time`; None if there is none, or only its end."""
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
    data = _content(packet[start + _UDP.size:length], udp_length)
    if data is None:
        return None
    return Datagram(time, socket.inet_ntoa(src), sport, socket.inet_ntoa(dst), dport, data)


def _content(content: bytes, udp_length: int) -> Optional[bytes]:
    """The datagram's bytes: a packet may be longer than what it holds, never shorter."""
    size = udp_length - _UDP.size
    return content[:size] if 0 <= size <= len(content) else None
