"""Writes and describes bags: the file format of rosbag, version 2.0 (wiki.ros.org/Bags/Format/2.0), not compressed.

A bag is a sequence of records. Each has a header of named fields, and data, with their lengths in front. The data of a
chunk are records themselves: messages, and before the first one of a topic its connection, which says what its messages
are. After each chunk comes an index of it, and at the end of the file one of all connections and chunks.

What this writes has the same bytes as what rosbag writes (tested). Everything is written at once, so what a killed
process has written can be read (`salvage.py`).
"""

import bisect
import struct
from typing import IO, Dict, List, Mapping, NamedTuple, Optional, Tuple, Union

MAGIC = b"#ROSBAG V2.0\n"
MSG_DATA, FILE_HEADER, INDEX_DATA, CHUNK, CHUNK_INFO, CONNECTION = 0x02, 0x03, 0x04, 0x05, 0x06, 0x07
LENGTH = struct.Struct("<L")
STAMP = struct.Struct("<LL")
# A chunk ends when it is longer (bytes).
CHUNK_SIZE = 768 * 1024
# The header of the file is filled up to this size, so that it can be written again in its place (bytes).
_HEADER_SIZE = 4096
_LONG = struct.Struct("<Q")
_ENTRY = struct.Struct("<LLL")
_COUNT = struct.Struct("<LL")
_VERSION = LENGTH.pack(1)  # of index and chunk info

Stamp = Tuple[int, int]  # UTC: seconds, nanoseconds


class _Entry(NamedTuple):
    """A message in the index of a chunk."""

    stamp: Stamp
    offset: int  # in the chunk


class _Chunk:
    """A chunk, and what the index says of it."""

    def __init__(self, at: int, stamp: Stamp) -> None:
        self.at = at  # place in the file
        self.begin = self.end = stamp
        self.entries: Dict[int, List[_Entry]] = {}  # by number of the connection

    def add(self, conn: int, stamp: Stamp, offset: int) -> None:
        """Note a message."""
        bisect.insort_right(self.entries.setdefault(conn, []), _Entry(stamp, offset))
        self.begin, self.end = min(self.begin, stamp), max(self.end, stamp)


class BagWriter:
    """Writes a bag into an empty file. All methods raise OSError."""

    def __init__(self, file: IO[bytes]) -> None:
        """`file`: open for writing in binary, and seekable. It stays open."""
        self._file = file
        self._connections: Dict[str, Tuple[int, bytes]] = {}  # by topic: number, and record
        self._chunks: List[_Chunk] = []
        self._chunk: Optional[_Chunk] = None  # the one that is being written
        self._begin = 0  # of its data, in the file
        file.write(MAGIC)
        self._write_header(index_at=0)

    def write(self, topic: str, stamp: Stamp, data: bytes, kind: Mapping[str, Union[str, bytes]]) -> None:
        """Append a message. `data`: as ROS serialises it; `kind`: what the connection of its topic says."""
        chunk = self._chunk or self._begin_chunk(stamp)
        conn, record = self._connections.get(topic, (len(self._connections), b""))
        if not record:
            said = {"topic": topic, **kind}
            record = _record(
                {"op": bytes([CONNECTION]), "topic": topic.encode(), "conn": LENGTH.pack(conn)}, _fields(said))
            self._connections[topic] = conn, record
            self._file.write(record)
        chunk.add(conn, stamp, self._file.tell() - self._begin)
        header = {"op": bytes([MSG_DATA]), "conn": LENGTH.pack(conn), "time": STAMP.pack(*stamp)}
        self._file.write(_record(header, data))
        if self._file.tell() - self._begin > CHUNK_SIZE:
            self.end_chunk()

    def end_chunk(self) -> None:
        """Write the index of what was written since the last call."""
        chunk, self._chunk = self._chunk, None
        if chunk is None:
            return
        end = self._file.tell()
        self._file.seek(chunk.at)
        self._file.write(_chunk_header(end - self._begin))
        self._file.seek(end)
        for conn, entries in chunk.entries.items():
            self._file.write(_record(
                {"op": bytes([INDEX_DATA]), "conn": LENGTH.pack(conn), "ver": _VERSION,
                 "count": LENGTH.pack(len(entries))},
                b"".join(_ENTRY.pack(*entry.stamp, entry.offset) for entry in entries)))

    def close(self) -> None:
        """Write the index of the file. Nothing can be written afterwards."""
        self.end_chunk()
        index_at = self._file.tell()
        for _, record in self._connections.values():
            self._file.write(record)
        for chunk in self._chunks:
            counts = b"".join(_COUNT.pack(conn, len(entries)) for conn, entries in chunk.entries.items())
            self._file.write(_record(
                {"op": bytes([CHUNK_INFO]), "ver": _VERSION, "chunk_pos": _LONG.pack(chunk.at),
                 "start_time": STAMP.pack(*chunk.begin), "end_time": STAMP.pack(*chunk.end),
                 "count": LENGTH.pack(len(chunk.entries))}, counts))
        self._file.seek(len(MAGIC))
        self._write_header(index_at)

    def _begin_chunk(self, stamp: Stamp) -> _Chunk:
        chunk = self._chunk = _Chunk(self._file.tell(), stamp)
        self._chunks.append(chunk)
        self._file.write(_chunk_header(0))
        self._begin = self._file.tell()
        return chunk

    def _write_header(self, index_at: int) -> None:
        header = _fields({
            "op": bytes([FILE_HEADER]), "index_pos": _LONG.pack(index_at),
            "conn_count": LENGTH.pack(len(self._connections)), "chunk_count": LENGTH.pack(len(self._chunks))})
        space = b" " * (_HEADER_SIZE - len(header))
        self._file.write(LENGTH.pack(len(header)) + header + LENGTH.pack(len(space)) + space)


def _chunk_header(size: int) -> bytes:
    header = _fields({"op": bytes([CHUNK]), "compression": b"none", "size": LENGTH.pack(size)})
    return LENGTH.pack(len(header)) + header + LENGTH.pack(size)


def _record(header: Mapping[str, Union[str, bytes]], data: bytes) -> bytes:
    fields = _fields(header)
    return LENGTH.pack(len(fields)) + fields + LENGTH.pack(len(data)) + data


def _fields(values: Mapping[str, Union[str, bytes]]) -> bytes:
    """Return fields as a header has them: each with its length, its name, and its value."""
    fields = (f"{name}=".encode() + (value.encode() if isinstance(value, str) else value)
              for name, value in values.items())
    return b"".join(LENGTH.pack(len(field)) + field for field in fields)
