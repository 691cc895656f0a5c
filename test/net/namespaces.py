"""Hosts on a network of their own: network namespaces on one bridge, each way to a host as bad as a test wants it.

The namespaces have no names: each lives as long as the thread or process that is in it. So nothing is left over, also
not by a test that was killed; and nothing that is sent here can leave: the bridge has no other ports.
"""

import asyncio
import ctypes
import os
import subprocess
import threading
from typing import Any, Callable, Coroutine, Dict, List, NamedTuple, TypeVar

import wire

T = TypeVar("T")

NETWORK, BROADCAST = "10.77.0", "10.77.0.255"
INTERFACE = "eth0"
LIMIT_S = 30.0
_CLONE_NEWNET = 0x40000000
_libc = ctypes.CDLL(None, use_errno=True)


class NoRight(Exception):
    """This machine cannot create network namespaces."""


def address(number: int) -> str:
    """The address of the host with this number, 1 to 99; 100 more is its second one."""
    return f"{NETWORK}.{number}"


def other_address(number: int) -> str:
    """The address that this host may move to."""
    return address(number + 100)


def leave_network() -> None:
    """Put the calling thread into a new network namespace with only a loopback device."""
    if _libc.unshare(_CLONE_NEWNET):
        raise NoRight(f"no right to make network namespaces ({os.strerror(ctypes.get_errno())}): be root")
    run_ip("link set lo up")


def run_ip(*commands: str) -> None:
    """Commands of `ip`, in the calling thread's namespace."""
    found = subprocess.run(["ip", "-batch", "-"], input="\n".join(commands), capture_output=True, text=True)
    if found.returncode:
        raise OSError(f"ip: {found.stderr.strip()} in {commands}")


class Host:
    """A thread in a network namespace of its own, with an asyncio loop; all that happens on the host happens there."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._failure: List[Exception] = []
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()
        self._ready.wait()
        if self._failure:
            raise self._failure[0]

    def _run(self) -> None:
        try:
            leave_network()
        except (NoRight, OSError) as failure:
            self._failure.append(failure)
        finally:
            self._ready.set()
        if not self._failure:
            asyncio.set_event_loop(self.loop)
            self.loop.run_forever()

    @property
    def path(self) -> str:
        """The file that stands for the namespace."""
        return f"/proc/{os.getpid()}/task/{self._thread.native_id}/ns/net"

    def do(self, function: Callable[..., T], *arguments: Any) -> T:
        """Call a function there. Returns its result or raises its exception."""
        async def run() -> T:
            return function(*arguments)
        return self.begin(run()).result(LIMIT_S)

    def begin(self, work: "Coroutine[Any, Any, T]") -> Any:
        """Begin a coroutine there; returns its future (concurrent.futures)."""
        return asyncio.run_coroutine_threadsafe(work, self.loop)

    def close(self) -> None:
        """End the host, and with it its network."""
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join(LIMIT_S)


class Station(NamedTuple):
    """A host on the network."""

    number: int
    host: Host

    @property
    def address(self) -> str:
        """Its first address."""
        return address(self.number)


class Switch:
    """A bridge in a namespace of its own."""

    def __init__(self) -> None:
        """Raises `NoRight`."""
        self.host = Host("switch")
        self.host.do(run_ip, "link add br0 type bridge", "link set br0 addrgenmode none up")

    def plug(self, number: int, namespace: str) -> None:
        """Connect a host by a kernel's cable."""
        self.host.do(
            run_ip, f"link add port{number} type veth peer name {INTERFACE} netns {namespace}",
            f"link set port{number} master br0 addrgenmode none up")

    def station(self, number: int) -> Station:
        """A host with a kernel's cable."""
        station = Station(number, Host(f"host {number}"))
        self.plug(number, station.host.path)
        station.host.do(settle, number)
        return station

    def close(self) -> None:
        """End it."""
        self.host.close()


class Lan:
    """The switch and all hosts. The process that makes it becomes the box's host, for good.

    The box's cable is a kernel's (a veth pair), as good as can be and fast enough for a flood; so are those of
    `fast` hosts. All others have a `wire.Wire`.
    """

    def __init__(self, box: int, slow: List[int], fast: List[int], seed: int) -> None:
        """All hosts by their numbers. `seed`: of all impairments. Raises `NoRight`."""
        leave_network()
        self._seed = seed
        self.box = address(box)
        self._switch = Switch()
        self._wires: Dict[int, wire.Wire] = {}
        self._switch.plug(box, f"/proc/{os.getpid()}/ns/net")
        settle(box)
        self.stations: Dict[int, Station] = {number: self._switch.station(number) for number in fast}
        for number in slow:
            station = self.stations[number] = Station(number, Host(f"host {number}"))
            self._plug_slow(station)
            station.host.do(settle, number)

    def close(self) -> None:
        """End all hosts except the box's."""
        for station in self.stations.values():
            station.host.close()
        for each in self._wires.values():
            self._switch.host.do(each.close)
        self._switch.close()

    def wire(self, number: int) -> wire.Wire:
        """The cable of a slow host. Its `how` may be changed at any time."""
        return self._wires[number]

    def move(self, number: int, old: str, new: str) -> None:
        """Give a host another address."""
        self.stations[number].host.do(
            run_ip, f"address del {old}/24 dev {INTERFACE}", f"address add {new}/24 brd {BROADCAST} dev {INTERFACE}")

    def unplug(self, number: int, unplugged: bool) -> None:
        """Pull a host's cable, or plug it in again: other than in an outage, its system knows."""
        self.stations[number].host.do(run_ip, f"link set {INTERFACE} {'down' if unplugged else 'up'}")

    def _plug_slow(self, station: Station) -> None:
        number = station.number
        try:
            near = station.host.do(wire.open_tap, INTERFACE)
            far = self._switch.host.do(wire.open_tap, f"port{number}")
        except OSError as error:
            raise NoRight(f"no TAP devices (/dev/net/tun): {error}") from None
        self._switch.host.do(run_ip, f"link set port{number} master br0 addrgenmode none up")
        self._wires[number] = wire.Wire(near, far, f"{self._seed} {number}")
        self._switch.host.do(self._wires[number].open)


def settle(number: int) -> None:
    """Give the calling thread's host its address."""
    run_ip(f"link set {INTERFACE} addrgenmode none up",
           f"address add {address(number)}/24 brd {BROADCAST} dev {INTERFACE}")
