"""The two channels of the protocol: messages in and out, over UDP (docs/protocol.md, "Channels")."""

import asyncio
import ipaddress
import mmap
from typing import Any, Callable, NamedTuple, Optional, Tuple, Type

from google.protobuf.message import Message

from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.complaints import Complaints
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.comm.sockets import ANY_HOST

# -- copies of datagrams ------------------------------------------------------------------------------

# A sender encrypts each datagram with a new random initialisation vector, so only a copy has a known ciphertext: the
# network duplicated it, or somebody recorded it and sends it again. The protocol itself cannot distinguish a copy
# (docs/protocol.md, "Frame").
#
# This is a Bloom filter whose bits of one ciphertext are in one word, so that it touches little memory. It never
# forgets one of the last `bits // BITS_PER_ENTRY` ciphertexts. It mistakes some new ones for a copy, at most about one
# in 1,000, and that datagram counts as lost. Two filters take turns, so that neither fills up.

# Bits for each ciphertext in a full filter, which then mistakes one in 2,000 new ciphertexts for a copy.
BITS_PER_ENTRY = 32


class FilterPlace(NamedTuple):
    """Where a ciphertext is in a filter."""

    word: int
    bits: int


class Seen:
    """A set of ciphertexts of bounded size."""

    def __init__(self, bits: int = 2**26) -> None:
        """`bits`: size of each of the two filters, a power of two. Memory is used only as they fill."""
        self._bits = bits
        self._capacity = bits // BITS_PER_ENTRY
        self._count = 0
        self._filter = _words(bits)
        self._before: Optional[memoryview] = None  # the previous, full filter

    def place(self, ciphertext: bytes) -> FilterPlace:
        """Return the place of a ciphertext, for the other methods: five bits of one word."""
        # Python's hash of bytes has a secret of this process: nobody can choose ciphertexts that collide.
        number = hash(ciphertext)
        return FilterPlace((number >> 30) % len(self._filter), (
            1 << (number & 63) | 1 << (number >> 6 & 63) | 1 << (number >> 12 & 63) | 1 << (number >> 18 & 63)
            | 1 << (number >> 24 & 63)))

    def add(self, place: FilterPlace) -> None:
        """Remember a ciphertext."""
        if self._count >= self._capacity:
            self._before, self._filter = self._filter, _words(self._bits)
            self._count = 0
        self._filter[place.word] |= place.bits
        self._count += 1

    def __contains__(self, place: FilterPlace) -> bool:
        word, bits = place
        return self._filter[word] & bits == bits or (self._before is not None and self._before[word] & bits == bits)


def _words(bits: int) -> memoryview:
    # The system gives each page of it when a bit there is set first. A bytearray would write all of them at once.
    return memoryview(mmap.mmap(-1, bits // 8)).cast("Q")


# -- channels -----------------------------------------------------------------------------------------

OnDatagram = Callable[[bytes, Address], None]
OnMessage = Callable[[Any, Address], None]
OnComplaint = Callable[[str], None]
MakePeer = Callable[..., Peer]
_COPY = object()  # instead of a message that was accepted before


class Network(NamedTuple):
    """Parameters of the network."""

    rsbb_host: str  # broadcast address
    rsbb_port: int = 6666  # of the public channel
    bind_host: str = ANY_HOST  # own address
    cipher: Cipher = Cipher.AES_128_CBC  # for sending on private channels
    broadcast: bool = False  # private_mode: answer robots by broadcast, as the original did
    max_datagram: int = 1024  # bytes


class _Channel:
    """Common part of both channels: decode datagrams or complain, and refuse messages of the other channel."""

    def __init__(
        self,
        peer: Peer,
        name: str,
        types: Tuple[Type[Message], ...],
        decode: Callable[[bytes], Any],
        loop: asyncio.AbstractEventLoop,
        on_message: OnMessage,
        on_complaint: OnComplaint,
    ) -> None:
        self.complaints = Complaints()
        self.received_utc: Optional[float] = None
        """Within `on_message`: when the system received the datagram, in UTC seconds; None: unknown."""
        self._peer = peer
        self._name = name
        self._types = types
        self._decode = decode
        self._loop = loop
        self._on_message = on_message
        self._on_complaint = on_complaint

    @property
    def addr(self) -> str:
        """The rsbb_host of this channel."""
        return self._peer.rsbb_host

    @property
    def port(self) -> int:
        """The UDP port of this channel on both sides."""
        return self._peer.port

    @property
    def is_open(self) -> bool:
        return self._peer.is_open

    @property
    def stamp(self) -> Optional[float]:
        """When the system received the datagram that is being received, in UTC seconds; None: unknown."""
        return self._peer.received_utc

    def open(self) -> None:
        """Start to receive; has no effect if open. Raises OSError whose text names the remedy."""
        self._peer.open()

    def close(self) -> None:
        """Stop receiving and sending; has no effect if closed. May be called from `on_message`."""
        self._peer.close()

    def _check_type(self, message: Message) -> None:
        if not isinstance(message, self._types):
            raise ValueError(f"{type(message).__name__} does not belong on the {self._name}")

    def receive(self, datagram: bytes, sender: Address) -> None:
        """Take a datagram from the peer."""
        self.received_utc = self.stamp
        try:
            message = self._decode(datagram)
        except frame.BadDatagram as bad:
            self._complain(sender, bad)
            return
        self._hand_over(message, sender)

    def _complain(self, sender: Address, bad: frame.BadDatagram) -> None:
        text = self.complaints.add(self._loop.time(), self._name, sender, bad)
        if text is not None:
            self._on_complaint(text)

    def _hand_over(self, message: Any, sender: Address) -> None:
        self._on_message(message, sender)


class PublicChannel(_Channel):
    """Plain broadcast messages: beacons of box, robots and tablet."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, network: Network, on_message: OnMessage, on_complaint: OnComplaint,
        apart: bool = False, make_peer: Optional[MakePeer] = None,
    ) -> None:
        """Opens nothing yet: see `open`.

        `on_message(message, (host, port))` and `on_complaint(text)` are called in the loop's thread; their exceptions
        are logged. `apart`: for a second participant on the same machine, see `Peer`. `make_peer` replaces `Peer`, for
        another network.
        """
        peer = (make_peer or Peer)(
            loop, network.rsbb_host, network.rsbb_port, self.receive, on_complaint, network.bind_host,
            network.max_datagram, apart=apart)
        super().__init__(
            peer, "public channel", frame.PUBLIC_TYPES, frame.decode_public,
            loop, on_message, on_complaint)

    def send(self, message: Message) -> bool:
        """Broadcast a message; returns whether it was sent. Network errors do not raise: see `on_complaint`.

        ValueError for a message of the private channel, EncodeError for an incomplete one.
        """
        self._check_type(message)
        return self._peer.send(frame.encode(message), self._peer.rsbb_host)


class PrivateChannel(_Channel):
    """Encrypted messages between the box and one robot. The port number is the same on both sides."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, network: Network, port: int, key: Key, on_message: OnMessage,
        on_complaint: OnComplaint, *, read: Callable[[bytes], Any] = frame.private_message,
        seen: Optional[Seen] = None, on_copy: Callable[[Address], None] = lambda sender: None,
        make_peer: Optional[MakePeer] = None, on_datagram: Optional[OnDatagram] = None,
    ) -> None:
        """Like `PublicChannel`. ValueError if the network has no cipher; for receiving, all ciphers are accepted.

        `read` converts a decrypted payload to the argument of `on_message`, or raises `BadDatagram`. `seen`: what was
        remembered by `remember`; a copy of that is not read, and `on_copy` gets its sender. `on_datagram` gets each
        datagram instead of `receive`.
        """
        if network.cipher is Cipher.NONE:
            raise ValueError("a private channel must be encrypted: choose a cipher")
        peer = (make_peer or Peer)(
            loop, network.rsbb_host, port, on_datagram or self.receive, on_complaint, network.bind_host,
            network.max_datagram, shared=False)
        super().__init__(
            peer, f"private channel {port}", frame.PRIVATE_TYPES,
            self._decrypt, loop, on_message, on_complaint)
        self._key = key
        self._read = read
        self._seen = seen
        self._on_copy = on_copy
        self._place: Optional[FilterPlace] = None  # in `seen`, of the datagram that is being read
        self._cipher = network.cipher
        self._broadcast = network.broadcast
        self._remote: Optional[str] = None

    @property
    def remote(self) -> Optional[str]:
        """The other side's IPv4 address; None while it is unknown, then nothing is sent.

        Only the caller sets it. ValueError for anything but an IPv4 address.
        """
        return self._remote

    @remote.setter
    def remote(self, host: Optional[str]) -> None:
        # With a host name, each send would wait for the name service.
        self._remote = None if host is None else str(ipaddress.IPv4Address(host))

    def send(self, message: Message) -> bool:
        """Send a message to the other side; returns whether it was sent. Network errors do not raise.

        ValueError for a message of the public channel, EncodeError for an incomplete one.
        """
        self._check_type(message)
        host = self._peer.rsbb_host if self._broadcast else self._remote
        if host is None:
            return False
        return self._peer.send(frame.encode(message, self._cipher, self._key), host)

    def remember(self) -> None:
        """Within `on_message`: note that the message was accepted. Copies of it are not read from now on."""
        if self._seen is not None and self._place is not None:
            self._seen.add(self._place)

    def receive_late(
        self, ciphertext: bytes, read: Callable[[], Any], sender: Address, received_utc: Optional[float],
    ) -> None:
        """Take a datagram that was decrypted before; `read` returns the message. `received_utc`: when the system
        received it (s)."""
        self.received_utc = received_utc
        if self._is_copy(ciphertext):
            self._on_copy(sender)
        else:
            self._on_message(read(), sender)

    def _decrypt(self, datagram: bytes) -> Any:
        opened = frame.open_private(datagram)
        return _COPY if self._is_copy(opened.ciphertext) else self._read(frame.decrypt_frame(opened, self._key))

    def _is_copy(self, ciphertext: bytes) -> bool:
        """Whether this was remembered; it is what `remember` notes from now on."""
        if self._seen is None:
            return False
        self._place = self._seen.place(ciphertext)
        return self._place in self._seen

    def _hand_over(self, message: Any, sender: Address) -> None:
        if message is _COPY:
            self._on_copy(sender)
        else:
            super()._hand_over(message, sender)
