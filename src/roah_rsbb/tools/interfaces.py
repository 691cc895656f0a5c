"""Finds the IPv4 interfaces of this computer."""

import fcntl
import socket
import struct
from typing import List, NamedTuple

from roah_rsbb.comm import sockets

_SIOCGIFADDR, _SIOCGIFBRDADDR = 0x8915, 0x8919


class Interface(NamedTuple):
    """An IPv4 interface of this computer."""

    name: str
    address: str
    broadcast: str  # empty: no broadcast address


def interfaces() -> List[Interface]:
    """Return the interfaces of this computer that have an IPv4 address."""
    found = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        for _, name in socket.if_nameindex():
            address = _ask(asking, name, _SIOCGIFADDR)
            if address:
                broadcast = _ask(asking, name, _SIOCGIFBRDADDR)
                if address.startswith("127."):
                    broadcast = sockets.LOOPBACK_BROADCAST
                found.append(Interface(name, address, "" if broadcast == "0.0.0.0" else broadcast))
    return found


def _ask(asking: socket.socket, name: str, what: int) -> str:
    try:
        answer = fcntl.ioctl(asking.fileno(), what, struct.pack("256s", name.encode()[:15]))
    except OSError:
        return ""
    return socket.inet_ntoa(answer[20:24])
