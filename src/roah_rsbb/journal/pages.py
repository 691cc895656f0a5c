"""Reads the pages of an SQLite file and of its write-ahead log without SQLite, including pages that SQLite cannot read.

SQLite reads a write-ahead log up to the first damaged frame and silently drops the rest. The checksum of each frame
begins with the stored checksum of the frame before. Each frame can therefore be verified by itself, and the frames
after the damage can still be used (https://www.sqlite.org/fileformat2.html).
"""

import collections
import contextlib
import os
import struct
from typing import Callable, Container, Dict, Iterator, List, NamedTuple, Optional, Tuple

PAGE_SIZE = 4096
_LOG_MAGIC = {0x377F0682: "<", 0x377F0683: ">"}
_LOG_HEADER, _FRAME_HEADER = 32, 24
_FILE_MAGIC = b"SQLite format 3\0"
_TABLE_LEAF, _INDEX_LEAF, _INDEX_INTERIOR = 0x0D, 0x0A, 0x02
# Bytes of a whole number by its serial type.
_WHOLE = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8}
MAX_RECORD = 64 * 1024 * 1024


class Frame(NamedTuple):
    """One page in the write-ahead log."""

    page: int  # number, from 1
    pages: int  # of the file after this transaction; 0: the transaction continues
    content: bytes
    is_good: bool


class PageRecord(NamedTuple):
    """One row somewhere in the file."""

    rowid: Optional[int]  # None: of an index, or of a table without rowids
    values: Tuple[object, ...]


# -- write-ahead log --------------------------------------------------------------------------------


def read_frames(path: str) -> List[Frame]:
    """The frames of a write-ahead log. Raises OSError."""
    try:
        with open(path, "rb") as file:
            content = file.read()
    except FileNotFoundError:
        return []
    size = _page_size(content)
    places = range(_LOG_HEADER, len(content) - _FRAME_HEADER - size + 1, _FRAME_HEADER + size)
    salts = collections.Counter(content[at + 8:at + 16] for at in places)
    if not places:
        return []
    order, before = _order_and_sum(content)
    salt = content[16:24] if before is not None else salts.most_common(1)[0][0]
    frames = []
    for at in places:
        if content[at + 8:at + 16] != salt and content[16:24] == salt and not _belongs(content, at, salt, places):
            break  # the rest is from an earlier use of the file
        body = content[at + _FRAME_HEADER:at + _FRAME_HEADER + size]
        stored = struct.unpack_from(">II", content, at + 16)
        is_good = content[at + 8:at + 16] == salt and _checksum(order, before, content[at:at + 8] + body) == stored
        page, pages = struct.unpack_from(">II", content, at)
        frames.append(Frame(page, pages, body, is_good))
        before = stored
    return frames


def is_damaged(frames: List[Frame]) -> bool:
    """Whether a frame before the last good one cannot be read."""
    good = [i for i, frame in enumerate(frames) if frame.is_good]
    return bool(good) and len(good) <= good[-1]


def is_torn(frames: List[Frame]) -> bool:
    """Whether the last frame cannot be read: it is damaged, or a power failure interrupted its writing."""
    return bool(frames) and not frames[-1].is_good


def _belongs(content: bytes, at: int, salt: bytes, places: range) -> bool:
    """Whether later frames of the same use of the file follow. If so, this frame is damaged, not old."""
    return any(content[later + 8:later + 16] == salt for later in places if later > at)


def _page_size(content: bytes) -> int:
    size = struct.unpack_from(">I", content, 8)[0] if len(content) >= _LOG_HEADER else 0
    return size if 512 <= size <= 65536 and size & (size - 1) == 0 else PAGE_SIZE


def _order_and_sum(content: bytes) -> Tuple[str, Optional[Tuple[int, int]]]:
    """Return the byte order of the checksums, and the header's own checksum; None: the header is damaged."""
    order = _LOG_MAGIC.get(struct.unpack_from(">I", content)[0], "<")
    stored = struct.unpack_from(">II", content, 24)
    return order, stored if _checksum(order, (0, 0), content[:24]) == stored else None


def _checksum(order: str, before: Optional[Tuple[int, int]], content: bytes) -> Optional[Tuple[int, int]]:
    if before is None:
        return None
    first, second = before
    words = struct.unpack(f"{order}{len(content) // 4}I", content)
    for one, other in zip(words[::2], words[1::2]):
        first = (first + one + second) & 0xFFFFFFFF
        second = (second + other + first) & 0xFFFFFFFF
    return first, second


# -- image ------------------------------------------------------------------------------------------


def read_image(path: str) -> bytes:
    """Return the whole file, with the readable part of its write-ahead log merged into it. Raises OSError."""
    with open(path, "rb") as file:
        content = bytearray(file.read())
    size = _size_of_file(content)
    waiting: Dict[int, bytes] = {}
    with contextlib.suppress(struct.error):
        for frame in read_frames(f"{path}-wal"):
            if not frame.is_good:
                continue
            waiting[frame.page] = frame.content
            if frame.pages:
                for page, body in waiting.items():
                    if 0 < page <= frame.pages and len(body) == size:
                        end = page * size
                        content.extend(bytes(max(0, end - len(content))))
                        content[end - size:end] = body
                waiting.clear()
    if len(content) >= 100:
        content.extend(bytes(-len(content) % size))
        content[18:20] = b"\1\1"  # without a write-ahead log
        content[28:32] = struct.pack(">I", len(content) // size)  # SQLite refuses a file shorter than this number
        content[92:96] = content[24:28]
    return bytes(content)


def is_closed(path: str) -> bool:
    """Whether SQLite reads all of a file without changes: it has no write-ahead log, and a right header. Raises
    OSError."""
    with open(path, "rb") as file:
        header = file.read(100)
    pages = os.path.getsize(path) / _size_of_file(header)
    return (len(header) == 100 and header[:16] == _FILE_MAGIC and header[18:20] in (b"\1\1", b"\2\2")
            and struct.pack(">I", round(pages)) == header[28:32] and pages == round(pages)
            and header[24:28] == header[92:96] and not read_frames(f"{path}-wal"))


def _size_of_file(content: bytes) -> int:
    size = struct.unpack_from(">H", content, 16)[0] if len(content) >= 100 else 0
    size = 65536 if size == 1 else size
    return size if size >= 512 and size & (size - 1) == 0 and content[:16] == _FILE_MAGIC else PAGE_SIZE


# -- rows -------------------------------------------------------------------------------------------


# What is known of a page, given one of its records: the numbers of rows that are known, or None if it has no rows.
KnownOnPage = Callable[[PageRecord], Optional[Container[object]]]


def page_records(image: bytes, known_on_page: KnownOnPage) -> Iterator[PageRecord]:
    """Return every readable record of all pages, including unused pages, except known rows."""
    size = _size_of_file(bytearray(image[:100]))
    for at in range(0, len(image) - size + 1, size):
        yield from _records_of_page(image, at, size, known_on_page)


def _records_of_page(image: bytes, at: int, size: int, known_on_page: KnownOnPage) -> Iterator[PageRecord]:
    head = at + (100 if at == 0 else 0)
    kind = image[head]
    if kind not in (_TABLE_LEAF, _INDEX_LEAF, _INDEX_INTERIOR):
        return
    count = struct.unpack_from(">H", image, head + 3)[0]
    pointers = head + (12 if kind == _INDEX_INTERIOR else 8)
    if pointers + 2 * count > at + size:
        return
    known: Optional[Container[object]] = ()
    for place in struct.unpack_from(f">{count}H", image, pointers):
        with contextlib.suppress(IndexError, struct.error, ValueError):
            if kind == _TABLE_LEAF and known and _rowid(image, at + place) in known:
                continue
            record = _record(image, at + place, size, kind)
            known = known or known_on_page(record)
            if known is None:
                return
            if record.rowid is None or record.rowid not in known:
                yield record


def _rowid(image: bytes, at: int) -> int:
    """Return the number of a row without reading the row."""
    _, at = _varint(image, at)
    return _varint(image, at)[0]


def _record(image: bytes, at: int, size: int, kind: int) -> PageRecord:
    if kind == _INDEX_INTERIOR:
        at += 4
    length, at = _varint(image, at)
    rowid = None
    if kind == _TABLE_LEAF:
        rowid, at = _varint(image, at)
    return PageRecord(rowid, _values(_payload(image, at, size, length, kind)))


def _payload(image: bytes, at: int, size: int, length: int, kind: int) -> bytes:
    if length > MAX_RECORD:
        raise ValueError("too long for a record")
    most = size - 35 if kind == _TABLE_LEAF else (size - 12) * 64 // 255 - 23
    if length <= most:
        return image[at:at + length]
    least = (size - 12) * 32 // 255 - 23
    local = least + (length - least) % (size - 4)
    local = local if local <= most else least
    parts = [image[at:at + local]]
    left, page = length - local, struct.unpack_from(">I", image, at + local)[0]
    while left > 0:
        begin = (page - 1) * size
        if page < 1 or begin + size > len(image):
            raise ValueError("the rest is missing")
        page = struct.unpack_from(">I", image, begin)[0]
        parts.append(image[begin + 4:begin + 4 + min(left, size - 4)])
        left -= size - 4
    return b"".join(parts)


def _values(payload: bytes) -> Tuple[object, ...]:
    end, at = _varint(payload, 0)
    kinds = []
    while at < end:
        kind, at = _varint(payload, at)
        kinds.append(kind)
    values = []
    for kind in kinds:
        value, at = _value(payload, at, kind)
        values.append(value)
    if at != len(payload):
        raise ValueError("not a record")
    return tuple(values)


def _value(payload: bytes, at: int, kind: int) -> Tuple[object, int]:
    if kind in (0, 8, 9):
        return {0: None, 8: 0, 9: 1}[kind], at
    if kind in _WHOLE:
        return int.from_bytes(payload[at:at + _WHOLE[kind]], "big", signed=True), at + _WHOLE[kind]
    if kind == 7:
        return struct.unpack_from(">d", payload, at)[0], at + 8
    if kind < 12:
        raise ValueError("unknown type")
    length = (kind - 12) // 2
    content = payload[at:at + length]
    return content if kind % 2 == 0 else content.decode("utf-8"), at + length


def _varint(content: bytes, at: int) -> Tuple[int, int]:
    value = 0
    for i in range(9):
        byte = content[at + i]
        if i == 8:
            value = value << 8 | byte
            return value - (1 << 64) if value >= 1 << 63 else value, at + 9
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, at + i + 1
    raise ValueError("not a number")


def has_damaged_log(path: str) -> bool:
    """Whether the write-ahead log of a file is damaged before its last good frame. Raises OSError."""
    return os.path.exists(f"{path}-wal") and is_damaged(read_frames(f"{path}-wal"))


def has_torn_log(path: str) -> bool:
    """Whether the last frame in the write-ahead log of a file cannot be read. Raises OSError."""
    return os.path.exists(f"{path}-wal") and is_torn(read_frames(f"{path}-wal"))
