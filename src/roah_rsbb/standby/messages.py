"""The messages between box and standby: JSON objects, each with its length before it.

A message of the box is a request. The standby answers all of them in their order. Requests can be repeated: what is
missing is computed from what the standby says it has.
"""

import base64
import binascii
import json
import struct
from typing import Any, Dict, List

from roah_rsbb.copies.copy import FILES, FileContent
from roah_rsbb.copies.rows import APPENDED, COLUMNS, Known, Last, Rows

LENGTH = struct.Struct(">I")
# A part of the journal has 5000 rows. Before a standby is known, messages are small.
MAX_BYTES = 200_000_000
MAX_BYTES_OF_STRANGERS = 4096

# Files of the box's computer that a standby needs, by their names in the copy.
PASSWORDS, NETWORK = "passwords.yaml", "network.json"
# No other names are written: a message must not reach outside the folder.
NAMES = frozenset((*FILES, PASSWORDS, NETWORK))

Message = Dict[str, Any]


class BadMessage(Exception):
    """What arrived is not a message of this protocol."""


def encode(message: Message) -> bytes:
    """Return a message as bytes, without its length."""
    return json.dumps(message, ensure_ascii=False, separators=(",", ":"), default=_bytes_value).encode(
        "utf-8", "surrogatepass")


def decode(data: bytes) -> Message:
    """Read a message. Raises `BadMessage`."""
    try:
        message = json.loads(data.decode("utf-8", "surrogatepass"), object_hook=_read_object)
    except (ValueError, TypeError, RecursionError):
        raise BadMessage("it is not JSON") from None
    if not isinstance(message, dict):
        raise BadMessage("it is not an object")
    return message


def rows_message(rows: Rows) -> Message:
    """Return rows as a part of a message: column by column, which takes less time to write and to read."""
    return {"tables": {table: list(zip(*found)) for table, found in rows.tables.items()}, "is_last": rows.is_last}


def rows_of(message: Message) -> Rows:
    """The opposite of `rows_message`. Raises `BadMessage`."""
    tables: Dict[str, List[tuple]] = {}
    try:
        for table, columns in message["tables"].items():
            if len(columns) not in (0, len(COLUMNS[table])) or len(set(map(len, columns))) > 1:
                raise BadMessage(f"rows of {table} have other columns")
            tables[table] = list(zip(*columns))
        return Rows(tables, bool(message["is_last"]))
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise BadMessage(f"rows: {error!r}") from None


def known_message(known: Known) -> Message:
    """Return what a copy has as a part of a message."""
    return {"last": known.last, "rest": {table: list(found.items()) for table, found in known.rest.items()}}


def known_of(message: Message) -> Known:
    """The opposite of `known_message`. Raises `BadMessage`."""
    known = Known()
    try:
        for table in APPENDED:
            known.last[table] = Last(*message["last"][table])
        for table, found in known.rest.items():
            found.update((key, crc) for key, crc in message["rest"][table])
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise BadMessage(f"what the copy has: {error!r}") from None
    return known


def files_message(files: FileContent) -> Dict[str, str]:
    """Return files as a part of a message."""
    return {name: base64.b64encode(content).decode("ascii") for name, content in files.items()}


def files_of(message: Any) -> FileContent:
    """The opposite of `files_message`. Raises `BadMessage`."""
    try:
        files = {name: base64.b64decode(content, validate=True) for name, content in message.items()}
    except (TypeError, AttributeError, ValueError, binascii.Error):
        raise BadMessage("files") from None
    if not NAMES.issuperset(files):
        raise BadMessage("files with other names")
    return files


def _bytes_value(value: object) -> Message:
    """A damaged journal can have bytes where text should be."""
    if isinstance(value, bytes):
        return {"hex": value.hex()}
    raise TypeError(value)


def _read_object(value: Message) -> object:
    return bytes.fromhex(value["hex"]) if value.keys() == {"hex"} else value
