"""Makes the bags of runs: the file format of rosbag, version 2.0 (wiki.ros.org/Bags/Format/2.0), not compressed.

A bag is a sequence of records. Each has a header of named fields, and data, with their lengths in front. The data of a
chunk are records themselves: messages, and before the first one of a topic its connection, which says what its messages
are. After each chunk comes an index of it, and at the end of the file one of all connections and chunks.

What this writes has the same bytes as what rosbag writes (tested). It is made from the journal, which has every entry
of a run.
"""

import bisect
import contextlib
import errno
import os
import struct
from typing import Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Tuple, Union

from roah_rsbb.ground import linux
from roah_rsbb.ground.durable import USUAL, has_space, write_file
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.run_log import KINDS, LogKind

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


# -- messages ---------------------------------------------------------------------------------------


# topic (of `roah_rsbb.model.run_log`), value, UTC (s)
LogEntry = Tuple[str, object, float]

_UINT8, _INT32, _LENGTH = struct.Struct("<B"), struct.Struct("<i"), struct.Struct("<I")
_SCORE = """\
# The value of a scoring item (or one that the referee wants it to have).
string group
string desc
int32 value
"""


class BadEntry(Exception):
    """The entry does not fit into a message."""


class Message(NamedTuple):
    """A message as stored in a bag."""

    topic: str
    stamp: Stamp
    data: bytes
    kind: Dict[str, bytes]  # header of its connection: type, md5sum, message_definition


def _kind(name: str, md5sum: str, definition: str) -> Dict[str, bytes]:
    return {"type": name.encode(), "md5sum": md5sum.encode(), "message_definition": definition.encode()}


# The sums are made of the definitions (tested).
HEADERS: Dict[LogKind, Dict[str, bytes]] = {
    LogKind.UINT8: _kind("std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n"),
    LogKind.STRING: _kind("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n"),
    LogKind.SCORE: _kind("roah_rsbb/Score", "dae5eaddb8494f806eb4f392cd53e4e9", _SCORE),
    LogKind.EMPTY: _kind("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e", ""),
}


def message_of(entry: LogEntry) -> Message:
    """Build the message of an entry; raises `BadEntry`."""
    topic, value, utc = entry
    try:
        kind = KINDS[topic]
        seconds = int(utc)
        stamp = seconds, int((utc - seconds) * 1_000_000_000)
        struct.pack("<II", *stamp)
        return Message(topic, stamp, _PACKED[kind](value), HEADERS[kind])
    except (struct.error, TypeError, ValueError, KeyError, AttributeError) as error:
        raise BadEntry(f"{topic} cannot hold {value!r}: {error}") from None


def _string(value: str) -> bytes:
    data = value.encode()
    return _LENGTH.pack(len(data)) + data


def _score(value: Tuple[str, str, int]) -> bytes:
    group, desc, number = value
    return _string(group) + _string(desc) + _INT32.pack(number)


_PACKED: Dict[LogKind, Callable[..., bytes]] = {
    LogKind.UINT8: _UINT8.pack, LogKind.STRING: _string, LogKind.SCORE: _score, LogKind.EMPTY: lambda value: b"",
}


# -- making bags ------------------------------------------------------------------------------------


class _RunLog:
    """The bag of a robot in a run."""

    def __init__(self) -> None:
        self._bag = Bag()
        self._stamp = (0, 0)
        self._same = 0

    def add(self, entry: LogEntry) -> None:
        """Append an entry, unless it does not fit into its message.

        Simultaneous messages get different stamps, because readers sort by them.
        """
        with contextlib.suppress(BadEntry):
            message = message_of(entry)
            self._same = self._same + 1 if message.stamp == self._stamp else 0
            self._stamp = message.stamp
            seconds, nanoseconds = divmod(message.stamp[1] + self._same, 1_000_000_000)
            self._bag.write(message.topic, (message.stamp[0] + seconds, nanoseconds), message.data, message.kind)

    def write(self, path: str) -> None:
        """Write the file, whole or not at all. The last of the disk belongs to the journal. Raises OSError."""
        content = self._bag.content()
        if not has_space(os.path.dirname(path), len(content)):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), path)
        write_file(path, content, USUAL)


def write_bag(path: str, entries: Iterable[LogEntry]) -> None:
    """Write the log of a robot in a run, whole or not at all. Raises OSError."""
    bag = _RunLog()
    for entry in entries:
        bag.add(entry)
    bag.write(path)


def write_bags(reader: JournalReader, paths: Mapping[Tuple[str, int], str]) -> None:
    """Write the logs of robots to these paths, by the identities of their runs and their ports. This reads the journal
    once. Raises OSError and `JournalError`."""
    bags: Dict[Tuple[str, int], _RunLog] = {which: _RunLog() for which in paths}
    for entry in reader.entries_of({identity for identity, _ in paths}):
        bag = bags.get((entry.identity, entry.port or 0))
        if bag is not None and entry.kind in KINDS:
            bag.add((entry.kind, entry.value, entry.utc))
    for which, path in paths.items():
        bags.pop(which).write(path)


# A file beside the journal.
LOCK = "roah_rsbb_bags.lock"


def missing_bags(reader: JournalReader) -> Dict[Tuple[str, int], str]:
    """Return where the bags of runs that are over are missing: beside the journal. By identity and port."""
    folder, found = os.path.dirname(reader.path), {}
    for member in reader.all_members():
        path = os.path.join(folder, os.path.basename(member.log_file))
        if member.log_file and reader.is_over(member.identity) and not os.path.exists(path):
            found[member.identity, member.port] = path
    return found


@contextlib.contextmanager
def making_bags(reader: JournalReader) -> Iterator[bool]:
    """Let no other process make bags beside this journal; returns whether this one may. Raises OSError."""
    fd = os.open(os.path.join(os.path.dirname(reader.path), LOCK), os.O_RDWR | os.O_CREAT, 0o644)
    may_make = True
    try:
        with contextlib.suppress(OSError):  # some network file systems have no locks
            try:
                linux.lock(fd)
            except BlockingIOError:
                may_make = False
        yield may_make
    finally:
        os.close(fd)
