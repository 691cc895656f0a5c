"""Writes and describes bags: the file format of rosbag, version 2.0 (wiki.ros.org/Bags/Format/2.0), not compressed.

A bag is a sequence of records. Each has a header of named fields, and data, with their lengths in front. The data of a
chunk are records themselves: messages, and before the first one of a topic its connection, which says what its messages
are. After each chunk comes an index of it, and at the end of the file one of all connections and chunks.

What this writes has the same bytes as what rosbag writes (tested).
"""

import bisect
import struct
from typing import Dict, List, Mapping, NamedTuple, Tuple, Union

MAGIC = b"#ROSBAG V2.0\n"
MSG_DATA, FILE_HEADER, INDEX_DATA, CHUNK, CHUNK_INFO, CONNECTION = 0x02, 0x03, 0x04, 0x05, 0x06, 0x07
LENGTH = struct.Struct("<L")
STAMP = struct.Struct("<LL")
# A chunk ends when it is longer (bytes).
CHUNK_SIZE = 768 * 1024
# The header of the file is filled up to this size (bytes).
_HEADER_SIZE = 4096
# Where the first chunk begins.
_BEGIN = len(MAGIC) + 2 * LENGTH.size + _HEADER_SIZE
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


class Bag:
    """A bag in memory: one of an hour has a few megabytes."""

    def __init__(self) -> None:
        self._connections: Dict[str, Tuple[int, bytes]] = {}  # by topic: number, and record
        self._chunks: List[_Chunk] = []
        self._content = bytearray()  # all that follows the header
        self._data = bytearray()  # of the chunk that is being written

    def write(self, topic: str, stamp: Stamp, data: bytes, kind: Mapping[str, Union[str, bytes]]) -> None:
        """Append a message. `data`: as ROS serialises it; `kind`: what the connection of its topic says."""
        if not self._data:
            self._chunks.append(_Chunk(_BEGIN + len(self._content), stamp))
        conn, record = self._connections.get(topic, (len(self._connections), b""))
        if not record:
            said = {"topic": topic, **kind}
            record = _record(
                {"op": bytes([CONNECTION]), "topic": topic.encode(), "conn": LENGTH.pack(conn)}, _fields(said))
            self._connections[topic] = conn, record
            self._data += record
        self._chunks[-1].add(conn, stamp, len(self._data))
        header = {"op": bytes([MSG_DATA]), "conn": LENGTH.pack(conn), "time": STAMP.pack(*stamp)}
        self._data += _record(header, data)
        if len(self._data) > CHUNK_SIZE:
            self._end_chunk()

    def content(self) -> bytes:
        """Return the file. Nothing can be written afterwards."""
        self._end_chunk()
        index_at = _BEGIN + len(self._content)
        for _, record in self._connections.values():
            self._content += record
        for chunk in self._chunks:
            counts = b"".join(_COUNT.pack(conn, len(entries)) for conn, entries in chunk.entries.items())
            self._content += _record(
                {"op": bytes([CHUNK_INFO]), "ver": _VERSION, "chunk_pos": _LONG.pack(chunk.at),
                 "start_time": STAMP.pack(*chunk.begin), "end_time": STAMP.pack(*chunk.end),
                 "count": LENGTH.pack(len(chunk.entries))}, counts)
        header = {
            "op": bytes([FILE_HEADER]), "index_pos": _LONG.pack(index_at),
            "conn_count": LENGTH.pack(len(self._connections)), "chunk_count": LENGTH.pack(len(self._chunks))}
        space = b" " * (_HEADER_SIZE - len(_fields(header)))
        return MAGIC + _record(header, space) + self._content

    def _end_chunk(self) -> None:
        """Write the chunk and its index."""
        if not self._data:
            return
        header = {"op": bytes([CHUNK]), "compression": b"none", "size": LENGTH.pack(len(self._data))}
        self._content += _record(header, self._data)
        self._data = bytearray()
        for conn, entries in self._chunks[-1].entries.items():
            self._content += _record(
                {"op": bytes([INDEX_DATA]), "conn": LENGTH.pack(conn), "ver": _VERSION,
                 "count": LENGTH.pack(len(entries))},
                b"".join(_ENTRY.pack(*entry.stamp, entry.offset) for entry in entries))


def _record(header: Mapping[str, Union[str, bytes]], data: Union[bytes, bytearray]) -> bytes:
    fields = _fields(header)
    return LENGTH.pack(len(fields)) + fields + LENGTH.pack(len(data)) + data


def _fields(values: Mapping[str, Union[str, bytes]]) -> bytes:
    """Return fields as a header has them: each with its length, its name, and its value."""
    fields = (f"{name}=".encode() + (value.encode() if isinstance(value, str) else value)
              for name, value in values.items())
    return b"".join(LENGTH.pack(len(field)) + field for field in fields)
