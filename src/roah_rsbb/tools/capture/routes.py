"""What this Linux machine's network looks like, from the tables in /proc."""

import ipaddress
import os
import socket
import sys
from typing import List, Optional, Set

from roah_rsbb.comm import sockets
from roah_rsbb.comm.sockets import OpenError

LOOPBACK = "lo"


def interfaces_to(rsbb_host: str) -> List[str]:
    """The interfaces on which datagrams of the channels pass: the loopback, and the one that leads to `rsbb_host`.

    Raises OpenError, whose text names the remedy, if there is none.
    """
    if ipaddress.IPv4Address(rsbb_host).is_loopback:
        return [LOOPBACK]
    interface = route(rsbb_host, _read("/proc/net/route"))
    if interface is None:
        raise OpenError(0, f"no network of this machine has --host {rsbb_host}: give the broadcast address of the "
                           "network with the robots ('ip -4 addr' shows it as brd)")
    return [LOOPBACK, interface]


def route(host: str, table: str) -> Optional[str]:
    """The interface to `host`, from the text of /proc/net/route; None if it is in no network of this machine."""
    address = int(ipaddress.IPv4Address(host))
    best, interface = -1, None
    for line in table.splitlines()[1:]:
        columns = line.split()
        destination, gateway, mask = (_address(columns[index]) for index in (1, 2, 7))
        if address & mask == destination and mask > best:
            best, interface = mask, None if gateway else columns[0]
    return interface


def udp_sockets(port: int, table: str) -> Set[int]:
    """The inodes of the sockets that are bound to a UDP port, from the text of /proc/net/udp."""
    rows = (line.split() for line in table.splitlines()[1:])
    return {int(columns[9]) for columns in rows if int(columns[1].split(":")[1], 16) == port}


def others_use(port: int, own: List[socket.socket]) -> bool:
    """Whether another program on this machine uses a UDP port beside our sockets."""
    return bool(udp_sockets(port, _read("/proc/net/udp")) - {os.fstat(one.fileno()).st_ino for one in own})


def broadcast_address(rsbb_host: str) -> str:
    """`rsbb_host`, if this machine can hear broadcasts to it; else OpenError, whose text names the remedy."""
    if not sockets.is_broadcast(rsbb_host):
        raise OpenError(0, f"--host {rsbb_host} is not a broadcast address of this machine: give that of the network "
                           "with the robots ('ip -4 addr' shows it as brd)")
    return rsbb_host


def _address(hexadecimal: str) -> int:
    """An address of /proc/net, which has the number that its bytes make on this processor."""
    return int.from_bytes(int(hexadecimal, 16).to_bytes(4, sys.byteorder), "big")


def _read(path: str) -> str:
    try:
        with open(path, encoding="ascii", errors="replace") as file:
            return file.read()
    except OSError:
        return ""
