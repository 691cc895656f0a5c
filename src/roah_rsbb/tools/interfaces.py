"""Finds the IPv4 interfaces of this computer."""

from typing import List, NamedTuple

from roah_rsbb.comm import sockets
from roah_rsbb.ground import linux


class Interface(NamedTuple):
    """An IPv4 interface of this computer."""

    name: str
    address: str
    broadcast: str  # empty: no broadcast address


def interfaces() -> List[Interface]:
    """Return the interfaces of this computer that have an IPv4 address."""
    found = []
    for name, address, broadcast in linux.interfaces():
        if address:
            if address.startswith("127."):
                broadcast = sockets.LOOPBACK_BROADCAST
            found.append(Interface(name, address, "" if broadcast == sockets.ANY_HOST else broadcast))
    return found
