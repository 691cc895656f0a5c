"""The SmartIF protocol: bytes to messages and back (docs/devices.md, "The SmartIF protocol"). No I/O.

Strings are a uint16 length and the bytes; integers are big endian. Messages have no frame: after an
unexpected byte, nothing that follows can be interpreted, and a new connection is necessary.
"""

import struct
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.model.messages import NEVER, DevicesState
from roah_rsbb.protocol import SWITCHES, WireTime

# Longest string (bytes). Ids and addresses are short, so a longer string is garbage.
MAX_STRING = 1024
KINDS = b"NED"

_U16, _U32 = struct.Struct(">H"), struct.Struct(">I")


class Garbage(Exception):
    """The data is not SmartIF. The text says what was found and what was expected."""


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


class DeviceEvent(NamedTuple):
    """From the controller: an event of a device. Kind E (edit), device 47 and value 1 mean a ring of the bell."""

    kind: str  # N new, E edit, D delete
    device_id: str
    value: str


Message = Union[Set, Busy, Changed, DeviceEvent]


def encode(message: Message) -> bytes:
    """Encode a message. ValueError if a text or number is too large."""
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
        raise ValueError(f"a text of {len(data)} bytes: SmartIF allows {MAX_STRING}")
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
            raise Garbage(f"a text of {length} bytes: at most {MAX_STRING} are allowed")
        return self.take(length).decode("utf-8", errors="replace")

    def kind(self) -> str:
        kind = self.take(1)
        if kind not in KINDS:
            raise Garbage(f"an event of kind {kind!r}: expected N, E or D")
        return kind.decode("ascii")


_Parse = Callable[[_Reader], Message]
FROM_CONTROLLER: Dict[bytes, _Parse] = {
    b"E": lambda reader: Busy(reader.string()),
    b"1": lambda reader: Changed(reader.string(), reader.number(), reader.number()),
    b"2": lambda reader: DeviceEvent(reader.kind(), reader.string(), reader.string()),
}
TO_CONTROLLER: Dict[bytes, _Parse] = {b"I": lambda reader: Set(reader.string(), reader.number())}


class SmartIfDecoder:
    """Decodes messages from bytes in pieces of any size.

    `parsers`: FROM_CONTROLLER or TO_CONTROLLER. It stores less than one message, because lengths are checked first.
    """

    def __init__(self, parsers: Dict[bytes, _Parse]) -> None:
        self._parsers = parsers
        self._data = bytearray()

    @property
    def pending(self) -> int:
        """The number of bytes of an incomplete message."""
        return len(self._data)

    def feed(self, data: bytes) -> List[Message]:
        """Return the messages that these bytes complete.

        Messages before garbage still count: `Garbage` is raised by this call if there are none, else by the next call.
        """
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
            raise Garbage(f"a message that begins with {first!r}: expected {known}")
        return parse(reader)


# -- the devices of a home ----------------------------------------------------------------------------

# The state of the hardware cannot be read. The values here are authoritative, and are sent again after each connection.

BELL_ID = "47"
RING = DeviceEvent("E", BELL_ID, "1")


class OutputDevice(NamedTuple):
    """A device that can be set."""

    device_id: str
    highest: int  # values start at 0; per cent, or 1 for a switch
    scale: int = 1  # factor from the value to the controller's value


OUTPUTS: Dict[str, OutputDevice] = {
    "switch_1": OutputDevice("11", 1),
    "switch_2": OutputDevice("33", 1),
    "switch_3": OutputDevice("40", 1),
    "dimmer": OutputDevice("58", 100),
    "blinds": OutputDevice("77", 100, scale=100),
}
BY_ID = {output.device_id: name for name, output in OUTPUTS.items()}


class BadSetting(ValueError):
    """The device does not accept this value."""


class Home:
    """The present values. Times are exact (sec, nsec) pairs of UTC."""

    def __init__(self) -> None:
        self.values: Dict[str, int] = dict.fromkeys(OUTPUTS, 0)
        self.bell: WireTime = NEVER  # last ring
        self.door: bool = False

    def set(self, device: str, value: int) -> Set:
        """Set a value; returns the message to the controller. Raises `BadSetting`."""
        highest = OUTPUTS[device].highest
        if not 0 <= value <= highest:
            unit = "per cent" if highest == 100 else "(off or on)"
            raise BadSetting(f"{device} cannot be set to {value}: it takes 0 to {highest} {unit}")
        self.values[device] = int(value)
        return self._message(device)

    def all(self) -> Tuple[Set, ...]:
        """The messages to a controller after connecting: all values."""
        return tuple(self._message(device) for device in OUTPUTS)

    def _message(self, device: str) -> Set:
        output = OUTPUTS[device]
        return Set(output.device_id, self.values[device] * output.scale)

    def saved(self) -> Dict[str, object]:
        """All values as numbers and texts, for `restore`."""
        return {"values": dict(self.values), "bell": [str(part) for part in self.bell], "door": self.door}

    def restore(self, saved: object) -> bool:
        """Restore saved values; returns False, without changes, if they are invalid."""
        restored = _restored(saved)
        if restored is None:
            return False
        self.values, self.bell, self.door = restored.values, restored.bell, restored.door
        return True


def devices_state(home: Home) -> DevicesState:
    """The values as the box and the robots receive them."""
    values = {name: bool(value) if name in SWITCHES else value for name, value in home.values.items()}
    return DevicesState(bell=home.bell, door_win_detect=home.door, **values)


def is_ring(message: Message) -> bool:
    """Whether a message of the controller reports a ring of the bell."""
    return message == RING


def device_of(message: Set) -> Optional[Tuple[str, int]]:
    """The device and value in a message to a controller; None if unknown."""
    name = BY_ID.get(message.device_id)
    if name is None:
        return None
    output = OUTPUTS[name]
    value, rest = divmod(message.value, output.scale)
    return (name, value) if rest == 0 and value <= output.highest else None


def _restored(saved: object) -> Optional[Home]:
    home = Home()
    try:
        for device, value in saved["values"].items():
            home.set(device, int(value))
        sec, nsec = (int(part) for part in saved["bell"])
        home.bell, home.door = (sec, nsec), bool(saved["door"])
    except (TypeError, KeyError, AttributeError, ValueError, OverflowError):
        return None
    return home if 0 <= sec < 2**32 and 0 <= nsec < 10**9 else None
