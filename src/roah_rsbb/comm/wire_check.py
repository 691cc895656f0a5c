"""Checks a serialised protobuf before the protobuf library parses it.

The implementations of the library (C++, upb, Python) and its versions treat invalid input differently: text that is not
UTF-8 causes an exception, a `bytes` value, or a line on standard error for every datagram; a stray end-group tag
truncates the message with a warning; nested groups exhaust Python's stack. This check rejects all such input in the
same way and at bounded cost.
"""

from typing import Any, Dict, List, Tuple

from google.protobuf.descriptor import Descriptor, FieldDescriptor

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
        tag, position = varint(protobuf, position)
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
