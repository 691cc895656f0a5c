"""Hears the box in every way while the standby keeps the copy, and decides on an automatic takeover.

It runs in a thread of its own. It answers the words of the pair, so that a box that starts again need not wait.
"""

import asyncio
import contextlib
import ipaddress
import json
import os
import socket
import struct
import subprocess
import threading
import time
from typing import Callable, Dict, List, NamedTuple, Optional

from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.standby.pair import BoxSilence, Side, Word, hashed, pair_name, seal, unseal
from roah_rsbb.standby.pairing import PairedBox

# -- the computer's network ---------------------------------------------------------------------------

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


# -- hearing the box ----------------------------------------------------------------------------------

LOOK_S = 0.25
# A takeover that is not possible is tried again after this time.
RETRY_S = 2.0
# This computer must have been connected for so long without hearing the box. It hears a box several times a second, but
# when its own cable is plugged in again, the witness may answer first.
CONNECTED_S = 1.0


class Automatic(NamedTuple):
    """When a standby takes over by itself."""

    silence_s: float
    witness: str = ""  # a third host that must answer; empty: the cable must be plugged in


class Ears:
    """Hears the box until `end` is called."""

    def __init__(
        self, box: PairedBox, network_of: Callable[[], Dict[str, str]], epoch_of: Callable[[], int],
        automatic: Optional[Automatic], on_silence: Callable[[], None], on_state: Callable[[str], None],
    ) -> None:
        """`network_of` returns where to listen, or nothing while it is unknown. `epoch_of` returns the epoch of the
        copy. `on_silence` is called when the standby shall take over, `on_state` with what prevents that."""
        self._secret = hashed(box.key)
        self._port = box.port
        self._network_of, self._epoch_of = network_of, epoch_of
        self._automatic, self._on_silence, self._on_state = automatic, on_silence, on_state
        self._silence = BoxSilence()
        self._last_mono = time.monotonic()  # when the box was heard, or this began
        self._is_heard = threading.Event()
        self._connected_mono: Optional[float] = None  # since when this computer is connected, while the box is silent
        self._state = ""  # the last one that was reported
        self._loop = asyncio.new_event_loop()
        self._peer: Optional[Peer] = None
        self._beacons: Optional[PublicChannel] = None
        self._thread = threading.Thread(target=self._run, name="ears", daemon=True)

    def start(self) -> None:
        """Start to listen."""
        self._thread.start()

    def end(self) -> None:
        """From any other thread: stop listening, and wait for it."""
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    def heard(self) -> None:
        """From any thread: the box was heard on the copy's connection."""
        self._loop.call_soon_threadsafe(self._hear_box)

    def wait_silent(self, seconds: float) -> bool:
        """From any other thread: wait until the box has been silent for that long, or is heard. Returns whether it is
        silent."""
        self._is_heard.clear()
        left = self._last_mono + seconds - time.monotonic()
        return left <= 0 or not self._is_heard.wait(left)

    # -- in the thread ------------------------------------------------------------------------------

    def _run(self) -> None:
        self._loop.call_soon(self._look)
        self._loop.run_forever()
        for channel in (self._peer, self._beacons):
            if channel is not None:
                channel.close()
        self._loop.close()

    def _hear_box(self) -> None:
        self._silence.hear(self._loop.time())
        self._last_mono = time.monotonic()
        self._is_heard.set()

    def _look(self) -> None:
        trouble = self._open() if self._peer is None else ""
        again, wanted = LOOK_S, self._automatic
        if wanted is not None:
            # To find out whether it is connected may take a while. What comes meanwhile is heard before the next look.
            if self._may_take_over(wanted):
                self._on_silence()
                return
            if not self._silence.lasts(self._loop.time(), wanted.silence_s - CONNECTED_S):
                self._connected_mono = None
            else:
                reason = self._why_not()
                trouble = trouble or reason
                if reason:
                    self._connected_mono, again = None, RETRY_S
                elif self._connected_mono is None:
                    self._connected_mono = self._loop.time()
        if trouble != self._state:
            self._state = trouble
            if trouble:
                self._on_state(trouble)
        self._loop.call_later(again, self._look)

    def _may_take_over(self, wanted: Automatic) -> bool:
        now = self._loop.time()
        return (self._silence.lasts(now, wanted.silence_s) and self._connected_mono is not None
                and now - self._connected_mono >= CONNECTED_S)

    def _why_not(self) -> str:
        """Return why an automatic takeover would be wrong: this computer may be the one that is cut off."""
        if self._beacons is None:
            return "the box is silent, but this standby does not know its network yet: no automatic takeover"
        if self._automatic.witness:
            return "" if answers(self._automatic.witness) else (
                f"the box is silent, but {self._automatic.witness} does not answer either: no automatic takeover. "
                "Check the cable of this computer")
        return "" if is_connected(self._beacons.addr) else (
            "the box is silent, but the cable of this computer is not plugged in: no automatic takeover")

    def _open(self) -> str:
        """Open both sockets, once the network is known; returns why this is not possible."""
        network = self._network_of()
        if not network:
            return ""
        host, bind_host = network["rsbb_host"], network["bind_host"]
        try:
            if self._beacons is None:
                beacons = PublicChannel(
                    self._loop, Network(host, int(network["rsbb_port"]), bind_host), self._on_public, lambda _: None)
                beacons.open()
                self._beacons = beacons
            peer = Peer(self._loop, host, self._port, self._on_word, lambda _: None, bind_host=bind_host)
            peer.open()
            self._peer = peer
        except OSError as error:
            return f"the box's network cannot be heard: {error}"
        return ""

    def _on_public(self, message: object, _sender: Address) -> None:
        if isinstance(message, pb.RoahRsbbBeacon):
            self._hear_box()

    def _on_word(self, datagram: bytes, sender: Address) -> None:
        heard = unseal({pair_name(self._secret): self._secret}, datagram)
        if heard is None or heard[1].side is not Side.BOX:
            return
        if heard[1].claims:
            self._hear_box()
        if heard[1].asks:
            self._peer.send(seal(self._secret, Word(Side.STANDBY, self._epoch_of(), claims=False)), sender[0])
