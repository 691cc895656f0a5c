"""What a standby asks of the computer's network: whether it is connected, and the address of the lost box."""

import contextlib
import ipaddress
import json
import os
import socket
import struct
import subprocess
from typing import List

_ETHERTYPE_ARP = 0x0806
_BROADCAST = b"\xff" * 6
_ANNOUNCEMENTS = 3
_COMMAND_S = 5.0
PING = "ping"
# In the folder of the standby: the address that it took over.
TAKEN = "taken_address.json"


class NoAddress(Exception):
    """The address cannot be taken over. The text says why."""


def is_connected(host: str) -> bool:
    """Whether the network interface that leads to `host` has a link."""
    try:
        with open(f"/sys/class/net/{_interface(host)}/carrier", encoding="ascii") as file:
            return file.read().strip() == "1"
    except (NoAddress, OSError):  # an interface that is switched off cannot be read
        return False


def answers(host: str) -> bool:
    """Whether a host answers a ping."""
    try:
        return subprocess.run([PING, "-n", "-c", "1", "-W", "1", host], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, timeout=_COMMAND_S).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def is_own(host: str) -> bool:
    """Whether this computer has an address."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind((host, 0))
    except OSError:
        return False
    return True


def take_address(host: str, folder: str) -> str:
    """Add the address of the lost box to this computer, and announce it to all others; returns its interface.

    `folder`: of the standby, which notes the address. Raises `NoAddress`.
    """
    interface = _interface(host)
    own = _networks(interface)
    if any(str(network.ip) == host for network in own):
        return interface
    size = next((network.network.prefixlen for network in own if ipaddress.ip_address(host) in network.network), None)
    if size is None:
        raise NoAddress(f"{host} is not in a network of this computer")
    _ip("address", "add", f"{host}/{size}", "brd", "+", "dev", interface)
    with contextlib.suppress(OSError), open(os.path.join(folder, TAKEN), "w", encoding="ascii") as file:
        json.dump([f"{host}/{size}", interface], file)
    try:
        _announce(host, interface)
    except OSError as error:
        raise NoAddress(f"{host} was added to {interface}, but cannot be announced: {error.strerror}") from None
    return interface


def give_back_address(folder: str) -> str:
    """Remove the address that this computer took over; returns it, or nothing if there is none. Raises `NoAddress`."""
    path = os.path.join(folder, TAKEN)
    try:
        with open(path, encoding="ascii") as file:
            address, interface = map(str, json.load(file))
    except (OSError, ValueError, TypeError):
        return ""
    host = address.partition("/")[0]
    if any(str(network.ip) == host for network in _networks(interface)):
        _ip("address", "del", address, "dev", interface)
    with contextlib.suppress(OSError):
        os.remove(path)
    return host


def gratuitous_arp(host: str, mac: bytes) -> bytes:
    """Return the frame that announces to a network which computer has an address now (RFC 5227)."""
    address = socket.inet_aton(host)
    return (_BROADCAST + mac + struct.pack("!H", _ETHERTYPE_ARP)
            + struct.pack("!HHBBH", 1, 0x0800, 6, 4, 1) + mac + address + bytes(6) + address)


def _announce(host: str, interface: str) -> None:
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW) as raw:
        raw.bind((interface, 0))
        mac = raw.getsockname()[4]
        if len(mac) != 6 or not any(mac):
            return  # the loopback device has no neighbours
        for _ in range(_ANNOUNCEMENTS):
            raw.send(gratuitous_arp(host, mac))


def _interface(host: str) -> str:
    try:
        (route,) = json.loads(_ip("-json", "route", "get", host))
    except ValueError:
        raise NoAddress(f"there is no route to {host}") from None
    # An address of this computer is reached by the loopback device, but belongs to another one.
    if route.get("type") == "local":
        for link in json.loads(_ip("-json", "-4", "address", "show")):
            if any(found.get("local") == host for found in link.get("addr_info", ())):
                return str(link["ifname"])
    return str(route.get("dev", ""))


def _networks(interface: str) -> List[ipaddress.IPv4Interface]:
    links = json.loads(_ip("-json", "-4", "address", "show", "dev", interface))
    return [ipaddress.IPv4Interface(f"{found['local']}/{found['prefixlen']}")
            for link in links for found in link.get("addr_info", ()) if "local" in found]


def _ip(*arguments: str) -> str:
    try:
        found = subprocess.run(["ip", *arguments], capture_output=True, timeout=_COMMAND_S, text=True)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoAddress(f"the program ip cannot be run ({error}): install iproute2") from None
    if found.returncode:
        raise NoAddress(f"'ip {' '.join(arguments)}' failed: {found.stderr.strip()}. It needs the rights of root")
    return found.stdout
