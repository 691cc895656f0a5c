"""UDP sockets for a peer, with errors that name the remedy. IPv4 only, like the protocol."""

import errno
import ipaddress
import os
import re
import socket
from typing import Optional

from roah_rsbb.ground import linux

ANY_HOST = "0.0.0.0"
LOOPBACK_BROADCAST = "127.255.255.255"
# In remedies: the name of the parameter, and that of the option of programs without ROS.
BIND_HOST = "bind_host (option --bind)"

# Bytes; Linux doubles it. It holds some seconds of a robot's datagrams, for times when the loop is busy. A flood fills
# it, and everything then waits until what is in it has been read: more would delay a robot's datagrams by seconds.
_RECEIVE_BUFFER_SIZE = 256 * 1024
_NUMBERS = re.compile(r"[\d.]+")
_PROBE_PORT = 9  # any port: connecting a UDP socket sends nothing


class OpenError(OSError):
    """A channel cannot be opened. The text, without the error number, names the remedy."""

    def __str__(self) -> str:
        return str(self.strerror)


def listen(host: str, port: int, shared: bool, parameter: str = BIND_HOST) -> socket.socket:
    """A non-blocking UDP socket on (host, port) that may send broadcasts.

    `shared`: other programs may bind the same address and port, if they also allow it. `parameter`: where `host` comes
    from. Raises OpenError whose text names the address and the remedy.
    """
    if not 1 <= port <= 65535:
        raise OpenError(errno.EINVAL, f"{port} is not a UDP port: choose an rsbb_port from 1 to 65535, "
                                      "with free ports above it for private channels")
    return _bound(host, port, shared, parameter)


def speak(host: str) -> socket.socket:
    """A socket as `listen` returns, on a port that the system chooses, for a participant that only sends."""
    return _bound(host, 0, False, BIND_HOST)


def _bound(host: str, port: int, shared: bool, parameter: str) -> socket.socket:
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        endpoint.setblocking(False)
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_SIZE)
        linux.set_up(endpoint, shared)
        endpoint.bind((host, port))
    except OSError as error:
        endpoint.close()
        remedy = _bind_remedy(error, host, port, parameter)
        raise OpenError(error.errno, f"cannot open UDP {host}:{port}: {remedy}") from error
    return endpoint


def _bind_remedy(error: OSError, host: str, port: int, parameter: str) -> str:
    if error.errno == errno.EADDRINUSE:
        return ("in use by another program, perhaps a second copy of this one: end it "
                f"('ss -ulpn sport = :{port}' shows it), or give each program its own {parameter}")
    if error.errno == errno.EADDRNOTAVAIL:
        return f"{host} is not an address of this machine ('ip -4 addr' lists them): correct {parameter}"
    if error.errno == errno.EACCES:
        return "not permitted: choose an rsbb_port above 1023"
    return os.strerror(error.errno or 0)


def resolve(host: str, parameter: str) -> str:
    """The IPv4 address of a host. Only host names need the name service, which may take a while.

    Raises OpenError, which names the parameter that `host` comes from.
    """
    try:
        return str(ipaddress.IPv4Address(host))
    except ValueError:
        pass
    try:
        if _NUMBERS.fullmatch(host):  # the name service takes 10.1 for 10.0.0.1
            raise ValueError(host)
        return socket.gethostbyname(host)
    except (OSError, ValueError) as error:  # ValueError: not a possible name
        raise OpenError(errno.EINVAL, f"{parameter} '{host}' is neither an IPv4 address nor a known host: "
                                      "use an address such as 192.168.1.255") from error


def is_broadcast(host: str) -> bool:
    """Whether this machine reaches `host` by broadcast on one of its networks."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((host, _PROBE_PORT))
        except PermissionError:
            return True  # the error for broadcast addresses without SO_BROADCAST
        except OSError:
            return False
    return False


def broadcast_host(bind_host: str, rsbb_host: str) -> Optional[str]:
    """The address at which a peer bound to `bind_host` receives broadcasts; None if unknown.

    rsbb_host may be the address of a participant (a team may use the box's). A socket bound to that would take the
    participant's datagrams if both run on one machine.
    """
    if is_broadcast(rsbb_host):
        return rsbb_host
    if ipaddress.IPv4Address(bind_host).is_loopback:
        return LOOPBACK_BROADCAST
    return None


def source_host(destination: str) -> Optional[str]:
    """The local address from which datagrams to `destination` are sent; None if there is no route."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            probe.connect((destination, _PROBE_PORT))
            return probe.getsockname()[0]
        except OSError:
            return None
