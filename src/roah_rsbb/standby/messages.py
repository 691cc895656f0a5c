"""The messages between box and standby: JSON objects, each with its length before it. Bytes in them follow the JSON.

A message of the box is a request. The standby answers all of them in their order. Requests can be repeated: what is
missing is computed from what the standby says it has.
"""

import json
import struct
from typing import Any, Dict, List

from roah_rsbb.copies.copy import FILES, FileContent, Held, Part
from roah_rsbb.journal import log

LENGTH = struct.Struct(">I")
# A part of the journal, or a file beside it. Before a standby is known, messages are small.
MAX_BYTES = 50_000_000
MAX_BYTES_OF_STRANGERS = 4096

# Files of the box's computer that a standby needs, by their names in the copy.
PASSWORDS, NETWORK, MODULES = "passwords.yaml", "network.json", "modules.zip"
# No other names are written: a message must not reach outside the folder.
NAMES = frozenset((*FILES, PASSWORDS, NETWORK, MODULES))

Message = Dict[str, Any]
# In the JSON, the key of an object that stands for so many bytes.
_BYTES = "bytes"


class BadMessage(Exception):
    """What arrived is not a message of this protocol."""


def encode(message: Message) -> bytes:
    """Return a message, whose values may be bytes, without its length."""
    found: List[bytes] = []

    def follows(value: object) -> Dict[str, int]:
        if not isinstance(value, bytes):
            raise TypeError(value)
        found.append(value)
        return {_BYTES: len(value)}

    text = json.dumps(message, separators=(",", ":"), default=follows).encode("ascii")
    return b"".join((text, b"\n", *found)) if found else text


def decode(data: bytes) -> Message:
    """Read a message. Raises `BadMessage`."""
    text, _, rest = data.partition(b"\n")
    at = 0

    def read(value: Message) -> object:
        nonlocal at
        if value.keys() != {_BYTES}:
            return value
        begin, at = at, at + value[_BYTES]
        return rest[begin:at]

    try:
        message = json.loads(text.decode("ascii"), object_hook=read)
    except (ValueError, TypeError, RecursionError):
        raise BadMessage("it is not JSON, or not all of it arrived") from None
    if not isinstance(message, dict) or at != len(rest):
        raise BadMessage("it is not an object")
    return message


def held_of(message: Message) -> Dict[str, Held]:
    """Return what a copy has, by the names of the segments. Raises `BadMessage`."""
    try:
        return {str(name): Held(int(size), int(crc)) for name, (size, crc) in message["held"].items()}
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise BadMessage(f"held: {error!r}") from None


def part_of(message: Message) -> Part:
    """Return the part of a segment in a message. Raises `BadMessage`."""
    try:
        part = Part(*(message[name] for name in Part._fields))
    except KeyError as error:
        raise BadMessage(f"part: {error!r}") from None
    types = tuple(map(type, part))
    if types != (str, int, bytes, bool) or part.at < 0 or log.name_of(part.segment) is None:
        raise BadMessage("part of something else")
    return part


def files_of(message: object) -> FileContent:
    """Return the files in a message, by their names. Raises `BadMessage`."""
    if not isinstance(message, dict) or not NAMES.issuperset(message):
        raise BadMessage("files with other names")
    if not all(isinstance(content, bytes) for content in message.values()):
        raise BadMessage("files without contents")
    return message
