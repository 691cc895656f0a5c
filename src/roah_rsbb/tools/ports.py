"""The IPv4 interfaces of this computer, and the TCP ports on which it accepts connections.

Ports are read from /proc, as far as this user may read it.
"""

import contextlib
import os
import pathlib
import socket
import struct
from typing import Dict, Iterator, List, NamedTuple

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


_LISTEN = "0A"
_EVERYWHERE = ("0.0.0.0", "::")


class Listener(NamedTuple):
    """A TCP port on which a program accepts connections."""

    address: str
    port: int
    program: str  # empty: of another user

    def __str__(self) -> str:
        return f"{self.port} ({self.program})" if self.program else str(self.port)


def listeners() -> List[Listener]:
    """Return all TCP ports on which this computer accepts connections."""
    programs = _programs()
    return [
        Listener(_address(address), int(port, 16), programs.get(inode, ""))
        for name in ("tcp", "tcp6")
        for address, port, inode in _sockets(f"/proc/net/{name}")
    ]


def command_that_shows(protocol: str, port: int) -> str:
    """Return the command that shows which program uses a port. `protocol`: tcp or udp."""
    return f"ss -{protocol[0]}lpn sport = :{port}"


def open_to(found: List[Listener], address: str) -> List[Listener]:
    """Return the listeners that can be reached at an address of this computer, by port, without duplicates."""
    reached = {listener.port: listener for listener in found if listener.address in (*_EVERYWHERE, address)}
    return [reached[port] for port in sorted(reached)]


def _sockets(path: str) -> Iterator[tuple]:
    try:
        lines = pathlib.Path(path).read_text("ascii").splitlines()[1:]
    except OSError:
        return
    for line in lines:
        fields = line.split()
        if fields[3] == _LISTEN:
            address, _, port = fields[1].partition(":")
            yield address, port, fields[9]


def _address(text: str) -> str:
    """Convert an address as the kernel prints it: words of 32 bits in this computer's byte order."""
    words = [int(text[i:i + 8], 16) for i in range(0, len(text), 8)]
    packed = struct.pack(f"={len(words)}I", *words)
    if packed.startswith(b"\0" * 10 + b"\xff\xff"):  # an IPv4 address in IPv6 form
        packed = packed[12:]
    return socket.inet_ntop(socket.AF_INET if len(packed) == 4 else socket.AF_INET6, packed)


def _programs() -> Dict[str, str]:
    """Return the program's name by the inode of each socket that this user may see."""
    found: Dict[str, str] = {}
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            name = (process / "comm").read_text("utf-8", "replace").strip()
            for handle in (process / "fd").iterdir():
                with contextlib.suppress(OSError):
                    target = os.readlink(str(handle))
                    if target.startswith("socket:["):
                        found[target[8:-1]] = name
    return found
