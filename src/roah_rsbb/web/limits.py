"""Limits for whoever reaches the gateway: which names it has, how much an address may ask, who may watch. No I/O."""

import collections
import ipaddress
import re
import socket
from typing import Callable, Dict, FrozenSet, Generic, Iterable, List, Optional, Tuple, TypeVar

T = TypeVar("T")

# A page takes about ten requests. A hall behind one address may open many pages at once.
REQUESTS_A_SECOND = 100.0
REQUESTS_AT_ONCE = 1000.0
MAX_ADDRESSES = 4096
# Pages and programs that watch at the same time.
MAX_VIEWERS = 400
# A reader that has not taken a message for so long is gone, or does not read.
STUCK_S = 20.0
# Connections that wait for a request, or for the end of one. A browser opens up to six.
MAX_CONNECTIONS = 200
# Addresses of paired devices.
MAX_KNOWN = 256


def own_names(further: Iterable[str] = ()) -> FrozenSet[str]:
    """Return the names by which browsers may call this computer, besides its addresses."""
    name = socket.gethostname().lower()
    return frozenset(["localhost", name, name.partition(".")[0], f"{name.partition('.')[0]}.local", *further])


def is_own_host(host: str, names: FrozenSet[str]) -> bool:
    """Whether the header Host of a request names this computer: an address, or one of its names.

    A page of another site can let its own name point to this computer and so pretend that our pages are its own (DNS
    rebinding). It cannot do so with an address.
    """
    name = host.lower()
    in_brackets = re.fullmatch(r"\[(.*)\](?::\d*)?", name)
    if in_brackets:
        name = in_brackets.group(1)
    elif name.count(":") == 1:
        name = name.partition(":")[0]
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return name.rstrip(".") in names
    return True


class Rates:
    """How many requests each address may make: a bucket of tokens for each, which fills again with time."""

    def __init__(self, a_second: float = REQUESTS_A_SECOND, at_once: float = REQUESTS_AT_ONCE) -> None:
        self._a_second = a_second
        self._at_once = at_once
        self._buckets: collections.OrderedDict[str, Tuple[float, float]] = collections.OrderedDict()

    def allows(self, mono: float, address: str) -> bool:
        """Take a request of an address into account; returns whether it may be answered."""
        left, since = self._buckets.pop(address, (self._at_once, mono))
        left = min(self._at_once, left + (mono - since) * self._a_second)
        is_allowed = left >= 1.0
        self._buckets[address] = (left - is_allowed, mono)
        while len(self._buckets) > MAX_ADDRESSES:
            self._buckets.popitem(last=False)
        return is_allowed

    def give_back(self, address: str) -> None:
        """Do not count the last request of an address."""
        left, since = self._buckets[address]
        self._buckets[address] = (left + 1.0, since)


class Places(Generic[T]):
    """The places of viewers. If all are taken, the address with the most viewers loses its oldest one.

    So a single computer that takes all places cannot keep others out.
    """

    def __init__(self, close: Callable[[T], None], most: int = MAX_VIEWERS) -> None:
        """`close` ends a viewer that loses its place."""
        self._close = close
        self._most = most
        self._viewers: Dict[T, str] = {}  # to its address, oldest first

    def __iter__(self):
        return iter(list(self._viewers))

    def __len__(self) -> int:
        return len(self._viewers)

    def __contains__(self, viewer: object) -> bool:
        return viewer in self._viewers

    def add(self, viewer: T, address: str) -> None:
        """Give a viewer a place."""
        self._viewers[viewer] = address
        loser = self._loser()
        if loser is not None:
            self.remove(loser)
            self._close(loser)

    def remove(self, viewer: T) -> None:
        """Free the place of a viewer; has no effect if it has none."""
        self._viewers.pop(viewer, None)

    def _loser(self) -> Optional[T]:
        if len(self._viewers) <= self._most:
            return None
        addresses: List[str] = list(self._viewers.values())
        crowded = collections.Counter(addresses).most_common(1)[0][0]
        return next(viewer for viewer, address in self._viewers.items() if address == crowded)


class ConnectionPlaces(Generic[T]):
    """The places of connections. Those from addresses of paired devices have places of their own, so that no number of
    other computers can keep a referee out."""

    def __init__(self, close: Callable[[T], None]) -> None:
        """`close` ends a connection that loses its place."""
        self._places: Dict[bool, Places[T]] = {of_device: Places(close, MAX_CONNECTIONS) for of_device in (False, True)}
        self._known: collections.OrderedDict[str, None] = collections.OrderedDict()  # oldest first

    def __iter__(self):
        return iter([*self._places[False], *self._places[True]])

    def add(self, connection: T, address: str) -> None:
        """Give a connection a place."""
        self._places[address in self._known].add(connection, address)

    def remove(self, connection: T) -> None:
        """Free the place of a connection; has no effect if it has none."""
        for places in self._places.values():
            places.remove(connection)

    def take(self) -> Optional[T]:
        """Free the place of the next one, those of paired devices first, and return it; None: there is none."""
        connection = next(iter([*self._places[True], *self._places[False]]), None)
        if connection is not None:
            self.remove(connection)
        return connection

    def know(self, connection: Optional[T], address: str) -> None:
        """Note that a paired device is at this address, and what it uses at the moment."""
        self._known[address] = None
        self._known.move_to_end(address)
        if len(self._known) > MAX_KNOWN:
            self._known.popitem(last=False)
        if connection in self._places[False]:
            self._places[False].remove(connection)
            self._places[True].add(connection, address)
