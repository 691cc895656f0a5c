"""Datagrams to messages and back (docs/protocol.md, "Frame").

Encoding makes a frame of version 2. Decoding accepts any bytes, up to the largest UDP datagram, and either returns a
complete message of the channel or raises `BadDatagram`.
"""

import enum
import struct
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Type

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import Message

from roah_rsbb.comm.ciphers import BLOCK_SIZE, Cipher, Key
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

# -- before the protobuf library parses it ------------------------------------------------------------

# The implementations of the library (C++, upb, Python) and its versions treat invalid input differently: text that is
# not UTF-8 causes an exception, a `bytes` value, or a line on standard error for every datagram; a stray end-group tag
# truncates the message with a warning; nested groups exhaust Python's stack. This check rejects all such input in the
# same way and at bounded cost.

_VARINT, _FIXED_64, _LENGTH, _FIXED_32 = 0, 1, 2, 5
_MAX_VARINT_BYTES = 10
_MAX_TAG = 2**32 - 1

# What `check` inspects: tag -> the field's name (for a string), or the Texts of an inner message.
Texts = Dict[int, Any]


class Malformed(Exception):
    """The bytes are not a serialised message."""


class NotUtf8(Exception):
    """A string field's bytes are not UTF-8; the only argument is the field's name."""


class _TooMany(Exception):
    """There are more fields than a valid message has."""


def texts_of(descriptor: Descriptor) -> Texts:
    """Build the table that `check` needs for a type of message."""
    texts: Texts = {}
    for field in descriptor.fields:
        tag = field.number << 3 | _LENGTH
        if field.type == FieldDescriptor.TYPE_STRING:
            texts[tag] = field.name
        elif field.type == FieldDescriptor.TYPE_MESSAGE:
            texts[tag] = texts_of(field.message_type)
    return texts


def check(protobuf: bytes, texts: Texts, max_fields: int) -> None:
    """Raise Malformed or NotUtf8 unless `protobuf` is a sequence of complete fields with UTF-8 texts.

    `max_fields`, including those of inner messages, bounds the work for 65 kB. Unknown fields are not inspected,
    because the library keeps them as bytes.
    """
    budget = [max_fields]
    try:
        _check(protobuf, texts, budget)
    except _TooMany:
        raise Malformed(f"it has more than {max_fields} fields") from None
    except IndexError:
        raise Malformed("it ends within a field") from None


def _check(protobuf: bytes, texts: Texts, budget: List[int]) -> None:
    position, end = 0, len(protobuf)
    while position < end:
        budget[0] -= 1
        if budget[0] < 0:
            raise _TooMany
        tag, position = protobuf[position], position + 1
        if tag >= 0x80:
            tag, position = varint(protobuf, position - 1)
        # Field numbers have up to 29 bits. The C++ library accepts superfluous zero bytes at the end of a tag, which
        # no encoder writes; the Python library does not.
        if not 8 <= tag <= _MAX_TAG or not protobuf[position - 1]:
            raise Malformed("it has an impossible field number")
        wire_type = tag & 7
        if wire_type == _LENGTH:
            size, start = varint(protobuf, position)
            position = start + size
            if position > end:
                raise IndexError
            text = texts.get(tag)
            if text is not None:
                _check_text(protobuf[start:position], text, budget)
        elif wire_type == _VARINT:
            _, position = varint(protobuf, position)
        elif wire_type == _FIXED_64:
            position += 8
        elif wire_type == _FIXED_32:
            position += 4
        else:
            raise Malformed(f"it has a field of wire type {wire_type}, which no message uses")
    if position > end:
        raise IndexError


def _check_text(value: bytes, text: Any, budget: List[int]) -> None:
    if not isinstance(text, str):
        _check(value, text, budget)
        return
    try:
        value.decode("utf-8")
    except UnicodeDecodeError:
        raise NotUtf8(text) from None


def varint(protobuf: bytes, position: int) -> Tuple[int, int]:
    """Read the number at `position`; returns it and the next position.

    Raises IndexError at the end of the bytes, `Malformed` for a number that is too long.
    """
    byte = protobuf[position]
    if byte < 0x80:
        return byte, position + 1
    value, shift = byte & 0x7F, 7
    for index in range(position + 1, position + _MAX_VARINT_BYTES):
        byte = protobuf[index]
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, index + 1
        shift += 7
    raise Malformed(f"it has a number of more than {_MAX_VARINT_BYTES} bytes")


# -- frames -------------------------------------------------------------------------------------------

VERSION = 2
_HEADER = struct.Struct(">BB2xI")  # version, cipher, reserved, payload size
HEADER_SIZE = _HEADER.size
"""Bytes of the header of a frame; the initialisation vector and the payload follow."""
_IDS = struct.Struct(">HH")  # component id, message type
_SHOWN_FIELDS = 5
# Enough for a beacon that lists 200 robots.
_MAX_PUBLIC_FIELDS = 1000
# The 987 bytes of a robot's message have space for 329 strings, all of which the box records.
_MAX_PRIVATE_FIELDS = 400


class FrameFault(enum.Enum):
    """Why a datagram is invalid. The value is shown to the referee."""

    TOO_SHORT = "too short"
    VERSION_1 = "frame of version 1"
    OTHER_VERSION = "frame of an unknown version"
    UNKNOWN_CIPHER = "unknown cipher"
    ENCRYPTED = "encrypted on the public channel"
    PLAIN = "plain on a private channel"
    SIZE = "wrong size"
    UNDECRYPTABLE = "does not decrypt"
    UNKNOWN_TYPE = "unknown message"
    WRONG_CHANNEL = "message of the other channel"
    MALFORMED = "malformed message"
    NOT_UTF8 = "text is not UTF-8"
    INCOMPLETE = "incomplete message"


class BadDatagram(Exception):
    """The datagram is invalid. `reason` is for counting, `detail` for people; it never shows the content."""

    def __init__(self, reason: FrameFault, detail: str) -> None:
        super().__init__(f"{reason.value}: {detail}")
        self.reason = reason
        self.detail = detail


class _Kind(NamedTuple):
    """A message that can be the content of a datagram."""

    type: Type[Message]
    ids: bytes
    public: bool
    texts: Texts


def ids_of(message_type: Any) -> bytes:
    """Return the ids with which the payload of a type of message begins."""
    return _IDS.pack(message_type.COMP_ID, message_type.MSG_TYPE)


def _kind(message_type: Any, public: bool) -> _Kind:
    return _Kind(message_type, ids_of(message_type), public, texts_of(message_type.DESCRIPTOR))


_KINDS = [
    _kind(pb.RoahRsbbBeacon, public=True),
    _kind(pb.RobotBeacon, public=True),
    _kind(pb.TabletBeacon, public=True),
    _kind(pb.BenchmarkState, public=False),
    _kind(pb.RobotState, public=False),
]
_BY_IDS: Dict[bytes, _Kind] = {kind.ids: kind for kind in _KINDS}
_BY_TYPE: Dict[Type[Message], _Kind] = {kind.type: kind for kind in _KINDS}
_CIPHERS: Dict[int, Cipher] = {int(cipher): cipher for cipher in Cipher}
_COMPONENT = _IDS.pack(pb.RobotState.COMP_ID, 0)[:2]

PUBLIC_TYPES = tuple(kind.type for kind in _KINDS if kind.public)
PRIVATE_TYPES = tuple(kind.type for kind in _KINDS if not kind.public)


def encode(message: Message, cipher: Cipher = Cipher.NONE, key: Optional[Key] = None,
           iv: Optional[bytes] = None) -> bytes:
    """Encode a message as a frame. `iv`: initialisation vector, given by tests only; otherwise it is random.

    Raises ValueError (a type that is not sent on its own, a cipher without key, a wrong length of `iv`) or protobuf's
    EncodeError (a required field is missing).
    """
    kind = _BY_TYPE.get(type(message))
    if kind is None:
        raise ValueError(f"{type(message).__name__} is not sent as a datagram")
    payload = kind.ids + message.SerializeToString()
    if cipher is not Cipher.NONE:
        if key is None:
            raise ValueError(f"{cipher.label} needs a key")
        payload = key.encrypt(cipher, payload, iv)
    return _HEADER.pack(VERSION, cipher, len(payload)) + payload


def encoded_size(message: Message, cipher: Cipher = Cipher.NONE) -> int:
    """The size of the datagram that `encode` would return (bytes)."""
    plain = _IDS.size + message.ByteSize()
    if cipher is Cipher.NONE:
        return HEADER_SIZE + plain
    return HEADER_SIZE + cipher.iv_size + (plain // BLOCK_SIZE + 1) * BLOCK_SIZE


def decode_public(datagram: bytes) -> Any:
    """Decode a RoahRsbbBeacon, RobotBeacon or TabletBeacon in a plain frame; raises only BadDatagram."""
    cipher, size = _open(datagram)
    if cipher is not Cipher.NONE:
        raise BadDatagram(FrameFault.ENCRYPTED, f"with {cipher.label}")
    payload = datagram[HEADER_SIZE:]
    if size != len(payload):
        raise BadDatagram(FrameFault.SIZE, f"the header says {size} bytes, but {len(payload)} arrived")
    return _message(payload, public=True)


class PrivateFrame(NamedTuple):
    """An encrypted frame of a private channel."""

    cipher: Cipher
    iv: bytes
    ciphertext: bytes


def open_private(datagram: bytes) -> PrivateFrame:
    """Read the frame in a datagram of a private channel without a key.

    Raises only BadDatagram. All four ciphers are accepted, but no plain frame.
    """
    cipher, size = _open(datagram)
    if cipher is Cipher.NONE:
        raise BadDatagram(FrameFault.PLAIN, "not encrypted")
    start = HEADER_SIZE + cipher.iv_size
    ciphertext = datagram[start:]
    if not ciphertext or len(ciphertext) % BLOCK_SIZE:
        raise BadDatagram(FrameFault.SIZE, f"{len(datagram)} bytes do not fit a frame of {cipher.label}")
    # The original counts initialisation vector and padding. Some descriptions omit one or both of them, and the
    # original reads such frames, too, because it uses the length of the datagram.
    came = len(datagram) - HEADER_SIZE
    if not len(ciphertext) - BLOCK_SIZE <= size <= came:
        raise BadDatagram(FrameFault.SIZE, f"the header says {size} bytes, but {came} arrived")
    return PrivateFrame(cipher, datagram[HEADER_SIZE:start], ciphertext)


def decode_private(datagram: bytes, key: Key) -> Any:
    """Decode a BenchmarkState or RobotState in an encrypted frame; raises only BadDatagram."""
    return private_message(decrypt(datagram, key))


def decrypt(datagram: bytes, key: Key) -> bytes:
    """Decrypt the payload of a private channel's frame, for `private_message`; raises only BadDatagram."""
    return decrypt_frame(open_private(datagram), key)


def decrypt_frame(opened: PrivateFrame, key: Key) -> bytes:
    """Like `decrypt`, for a frame that is already open."""
    cipher, iv, ciphertext = opened
    payload = key.decrypt(cipher, iv, ciphertext)
    if payload is None:
        raise BadDatagram(FrameFault.UNDECRYPTABLE, "the padding is wrong")
    # One in 256 wrong keys gives a valid padding. Then the component id is almost certainly wrong.
    if len(payload) >= _IDS.size and not payload.startswith(_COMPONENT):
        raise BadDatagram(FrameFault.UNDECRYPTABLE, "the content is meaningless")
    return payload


def private_message(payload: bytes) -> Any:
    """Decode a BenchmarkState or RobotState from a decrypted payload; raises only BadDatagram."""
    return _message(payload, public=False)


def _open(datagram: bytes) -> Tuple[Cipher, int]:
    """Read cipher and payload size in a header of version 2."""
    if len(datagram) < HEADER_SIZE:
        raise BadDatagram(FrameFault.TOO_SHORT, f"{len(datagram)} bytes, but a frame's header has {HEADER_SIZE}")
    version, cipher_id, size = _HEADER.unpack_from(datagram)
    if version != VERSION:
        # A frame of version 1 has no version number: it begins with the component id.
        if datagram.startswith(_COMPONENT):
            raise BadDatagram(FrameFault.VERSION_1, "only version 2 is supported")
        raise BadDatagram(FrameFault.OTHER_VERSION, f"version {version}, only 2 is supported")
    cipher = _CIPHERS.get(cipher_id)
    if cipher is None:
        raise BadDatagram(FrameFault.UNKNOWN_CIPHER, f"number {cipher_id}")
    return cipher, size


def _message(payload: bytes, public: bool) -> Any:
    if len(payload) < _IDS.size:
        raise BadDatagram(FrameFault.TOO_SHORT, f"{len(payload)} bytes of payload, but its ids have {_IDS.size}")
    kind = _BY_IDS.get(payload[:_IDS.size])
    if kind is None:
        raise BadDatagram(FrameFault.UNKNOWN_TYPE, "component {}, type {}".format(*_IDS.unpack_from(payload)))
    name = kind.type.DESCRIPTOR.name
    if kind.public is not public:
        home = "the public channel" if kind.public else "a private channel"
        raise BadDatagram(FrameFault.WRONG_CHANNEL, f"{name} belongs on {home}")
    protobuf = payload[_IDS.size:]
    try:
        check(protobuf, kind.texts, _MAX_PUBLIC_FIELDS if public else _MAX_PRIVATE_FIELDS)
    except Malformed as error:
        raise BadDatagram(FrameFault.MALFORMED, f"{name}: {error}") from None
    except NotUtf8 as error:
        raise BadDatagram(FrameFault.NOT_UTF8, f"{error} of {name}") from None
    return _parse(kind.type, protobuf)


def _parse(message_type: Any, protobuf: bytes) -> Any:
    name = message_type.DESCRIPTOR.name
    try:
        message = message_type.FromString(protobuf)
    except Exception as error:  # the type depends on the implementation of protobuf
        raise BadDatagram(FrameFault.MALFORMED, f"{name}: {type(error).__name__}") from None
    if not message.IsInitialized():
        missing = message.FindInitializationErrors()
        shown = ", ".join(missing[:_SHOWN_FIELDS]) + (" ..." if len(missing) > _SHOWN_FIELDS else "")
        raise BadDatagram(FrameFault.INCOMPLETE, f"{name} without {shown} (not sent, or a value unknown here)")
    return message
