"""Reads run logs that were not closed: all messages in the file, with or without an index.

Theory of operation. The data of a chunk record are records themselves (`bag.py`). The reader skips only the chunk's own
header, so it finds all messages, including those of an unfinished chunk. A killed process leaves an incomplete last
record; a power failure may leave zeros. Everything else that cannot be read is damage.
"""

import os
import struct
from typing import IO, Dict, Iterator, Optional, Tuple

from roah_rsbb.run_logs.bag import (
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    FILE_HEADER,
    INDEX_DATA,
    LENGTH,
    MAGIC,
    MSG_DATA,
    STAMP,
)
from roah_rsbb.run_logs.messages import Message

# Longest record of a run log (bytes). A larger length is damage.
MAX_RECORD = 1 << 24


class NotABag(ValueError):
    """The file is not a bag."""


class Salvage:
    """Iterates over the messages of a bag in the order in which they were written.

    Afterwards `damage` says where the file became unreadable; empty if it was read to its end or to an incomplete
    last record.
    """

    def __init__(self, file: IO[bytes]) -> None:
        """`file`: open for reading, at its beginning. Raises `NotABag`."""
        self.damage = ""
        self._file = file
        self._size = os.fstat(file.fileno()).st_size
        magic = file.read(len(MAGIC))
        if not MAGIC.startswith(magic):
            raise NotABag("it does not begin like a bag")

    def __iter__(self) -> Iterator[Message]:
        connections: Dict[bytes, Tuple[str, Dict[str, bytes]]] = {}
        try:
            while True:
                at = self._file.tell()
                header = self._fields(self._sized())
                op = header[b"op"][0]
                if op == CHUNK:
                    if header[b"compression"] != b"none":
                        raise ValueError("it is compressed")
                    self._length()
                    continue
                data = self._sized()
                if op == CONNECTION:
                    connections[header[b"conn"]] = header[b"topic"].decode(), _named(self._fields(data))
                elif op == MSG_DATA:
                    topic, kind_of_topic = connections[header[b"conn"]]
                    yield Message(topic, STAMP.unpack(header[b"time"]), data, kind_of_topic)
                elif op not in (FILE_HEADER, INDEX_DATA, CHUNK_INFO):
                    raise ValueError(f"unknown record {op}")
        except EOFError:
            pass
        except (ValueError, KeyError, IndexError, struct.error):
            if not self._only_zeros(at):
                self.damage = f"at byte {at} of {self._size}"

    def _length(self) -> int:
        data = self._file.read(LENGTH.size)
        if len(data) < LENGTH.size:
            raise EOFError
        return LENGTH.unpack(data)[0]

    def _sized(self) -> bytes:
        length = self._length()
        if length > MAX_RECORD:
            raise ValueError("no length")
        data = self._file.read(length)
        if len(data) < length:
            raise EOFError
        return data

    @staticmethod
    def _fields(data: bytes) -> Dict[bytes, bytes]:
        fields, at = {}, 0
        while at < len(data):
            end = at + LENGTH.size + LENGTH.unpack_from(data, at)[0]
            name, equals, value = data[at + LENGTH.size:end].partition(b"=")
            if not equals or end > len(data):
                raise ValueError("no field")
            fields[name] = value
            at = end
        return fields

    def _only_zeros(self, at: int) -> bool:
        self._file.seek(at)
        while True:
            data = self._file.read(1 << 16)
            if not data:
                return True
            if data.strip(b"\0"):
                return False


def _named(fields: Dict[bytes, bytes]) -> Dict[str, bytes]:
    return {name.decode(): value for name, value in fields.items()}


def is_closed(file: IO[bytes]) -> bool:
    """Whether a bag was closed, that is, has its index. `file`: open for reading, at its beginning."""
    if file.read(len(MAGIC)) != MAGIC:
        return False
    length = file.read(LENGTH.size)
    if len(length) < LENGTH.size:
        return False
    index = _index_position(file.read(min(LENGTH.unpack(length)[0], MAX_RECORD)))
    return index is not None and 0 < index < os.fstat(file.fileno()).st_size


def _index_position(header: bytes) -> Optional[int]:
    name = b"index_pos="
    at = header.find(name)
    data = header[at + len(name):at + len(name) + 8]
    return struct.unpack("<Q", data)[0] if at >= 0 and len(data) == 8 else None
