"""The SmartIF protocol: bytes to messages and back (docs/devices.md, "The SmartIF protocol"). No I/O.

Strings are a uint16 length and the bytes; integers are big endian. There is no frame around a message: after a
byte that begins none, nothing that follows can be trusted, and the connection has to be made anew.
"""

import struct
from typing import Callable, Dict, List, NamedTuple, Union

# Ids and addresses are a few bytes: a longer string is a sign of garbage, and is not waited for.
MAX_STRING = 1024
KINDS = b"NED"

_U16, _U32 = struct.Struct(">H"), struct.Struct(">I")


class Garbage(Exception):
    """What arrived is not this protocol; the text says what was found where what was expected."""


class Set(NamedTuple):
    """To the controller: set a device."""

    device_id: str
    value: int  # uint32


class Busy(NamedTuple):
    """From the controller: another client is connected, at this address."""

    address: str


class Changed(NamedTuple):
    """From the controller: something changed; informative."""

    device_id: str
    first: int
    second: int


class Event(NamedTuple):
    """From the controller: an event of a device. Kind E (edit), device 47 and value 1 is a ring of the bell."""

    kind: str  # N new, E edit, D delete
    device_id: str
    value: str


Message = Union[Set, Busy, Changed, Event]


def encode(message: Message) -> bytes:
    """The bytes of a message. ValueError where a text or number does not fit."""
    try:
        if isinstance(message, Set):
            return b"I" + _string(message.device_id) + _U32.pack(message.value)
        if isinstance(message, Busy):
            return b"E" + _string(message.address)
        if isinstance(message, Changed):
            return b"1" + _string(message.device_id) + _U32.pack(message.first) + _U32.pack(message.second)
        return b"2" + message.kind.encode("ascii") + _string(message.device_id) + _string(message.value)
    except struct.error as error:
        raise ValueError(f"{message} cannot be sent: {error}") from None


def _string(text: str) -> bytes:
    data = text.encode("utf-8")
    if len(data) > MAX_STRING:
        raise ValueError(f"a text of {len(data)} bytes: SmartIF takes {MAX_STRING} here")
    return _U16.pack(len(data)) + data


class _Incomplete(Exception):
    """The rest of the message has not arrived."""


class _Reader:
    """Reads the fields of one message, from the start of a buffer."""

    def __init__(self, data: bytearray) -> None:
        self._data = data
        self.used = 0

    def take(self, count: int) -> bytes:
        if len(self._data) - self.used < count:
            raise _Incomplete
        self.used += count
        return bytes(self._data[self.used - count:self.used])

    def number(self) -> int:
        return _U32.unpack(self.take(4))[0]

    def string(self) -> str:
        length = _U16.unpack(self.take(2))[0]
        if length > MAX_STRING:
            raise Garbage(f"a text of {length} bytes is announced, at most {MAX_STRING} can be meant")
        return self.take(length).decode("utf-8", errors="replace")

    def kind(self) -> str:
        kind = self.take(1)
        if kind not in KINDS:
            raise Garbage(f"an event of kind {kind!r}: there is N, E and D")
        return kind.decode("ascii")


_Parse = Callable[[_Reader], Message]
FROM_CONTROLLER: Dict[bytes, _Parse] = {
    b"E": lambda reader: Busy(reader.string()),
    b"1": lambda reader: Changed(reader.string(), reader.number(), reader.number()),
    b"2": lambda reader: Event(reader.kind(), reader.string(), reader.string()),
}
TO_CONTROLLER: Dict[bytes, _Parse] = {b"I": lambda reader: Set(reader.string(), reader.number())}


class Decoder:
    """Takes bytes as they come, in pieces of any size, and gives the messages that are complete.

    `parsers`: FROM_CONTROLLER or TO_CONTROLLER. It keeps less than one message: a length is checked before
    anything is waited for.
    """

    def __init__(self, parsers: Dict[bytes, _Parse]) -> None:
        self._parsers = parsers
        self._data = bytearray()

    @property
    def pending(self) -> int:
        """Bytes of a message that is not complete."""
        return len(self._data)

    def feed(self, data: bytes) -> List[Message]:
        """The messages that these bytes complete. What is before garbage still counts: `Garbage` is raised by
        this call if it brings no message, and by the next one otherwise."""
        self._data += data
        messages: List[Message] = []
        begin = 0
        try:
            while begin < len(self._data):
                reader = _Reader(self._data[begin:begin + 2 * MAX_STRING + 16])
                messages.append(self._parse(reader))
                begin += reader.used
        except _Incomplete:
            pass
        except Garbage:
            if not messages:
                raise
        del self._data[:begin]
        return messages

    def _parse(self, reader: _Reader) -> Message:
        first = reader.take(1)
        parse = self._parsers.get(first)
        if parse is None:
            known = ", ".join(repr(byte.decode("ascii")) for byte in self._parsers)
            raise Garbage(f"a message that begins with {first!r}: there is {known}")
        return parse(reader)
