"""The journal's format: a folder of segments, which are only ever appended to.

```text
journal-NNNNNN-SALT.log      a segment; NNNNNN rises, SALT is random (8 hexadecimal digits)
 head, 64 bytes:  magic, version, salt, uuid of the journal, number of the first record,
                  salt and bytes of the segment before, epoch, CRC
 frame, 32 bytes: magic, length of the payload, number, durable, CRC of the payload, CRC of these with the salt as seed
 payload:         a record (`journal/records.py`), or a summary: everything that a start needs, as of its number
```

Theory of operation. Records are numbered without gaps across segments. Nothing is overwritten or cut off, so what is
on the disk stays there. A record is *proven* when an fsync that began after its write has succeeded. Each frame has the
number of the newest record that was proven when it was written (`durable`), so a reader knows what must be there:

- A record that is missing or fails its CRC is *damage* if it was proven. Its number names it.
- What follows the newest proven record may be incomplete after a power failure, in any order. The first gap ends the
  journal; the rest is a *torn tail*, and was never acknowledged.

A segment ends where the head of the next one says: at the newest record that was proven when that one began. Everything
later is copied into the next segment, from memory, or after a restart from the file. The next segment is written as
`.new`, with these copies and a summary. It gets its name when all of this is on the disk. So a segment that has a name
is complete up to its summary, whose `durable` is its own number.

The summary is everything that a start needs, and has a copy of the head. A box that ends writes another one at the end
of its segment, which proves what is before it.

A new segment begins with each start, when one is full, and after each failed fsync: Linux then counts the pages that it
could not write as written, and a later fsync succeeds without them. Records stay in memory until they are proven, so
they are written again in another place.

The name of the newest segment is also kept beside the folder, so that a lost segment is noticed.
"""

import contextlib
import os
import re
import struct
import threading
import zlib
from collections import deque
from typing import Callable, Deque, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

from roah_rsbb.ground import durable

VERSION = 1
_HEAD = struct.Struct("<8sII16sQQQII")
_FRAME = struct.Struct("<IIQQII")
_CHECKED_HEAD, _CHECKED_FRAME = _HEAD.size - 4, _FRAME.size - 4
HEAD_BYTES, FRAME_BYTES = _HEAD.size, _FRAME.size
_HEAD_MAGIC = b"RSBBlog\n"
_RECORD, _SUMMARY = 0x52627352, 0x53627352  # "RsbR", "RsbS"
_MAGIC = re.compile(b"Rsb[RS]")

# A segment with so many bytes after its summary is full. A start reads the newest one: 0.1 s at most.
FULL_BYTES = 8_000_000
# So many files are kept open, in case they are removed.
MOST_KEPT = 200
# A single frame is read with so many bytes; most are shorter.
_USUAL_BYTES = 8192
# A longer payload is damage.
LONGEST_BYTES = 256_000_000
DRAFT = ".new"
# The file beside the folder, with the name of its newest segment.
NEWEST = ".newest"
# The file beside the folder of a copy, with the name of its newest segment and what of it is on the disk for certain.
CERTAIN = ".certain"
_NAME = re.compile(r"journal-(\d{6,})-([0-9a-f]{8})\.log")


class NotASegment(Exception):
    """The head of a segment is damaged."""


class NewerFormat(Exception):
    """A newer version of roah_rsbb wrote the journal."""


class Head(NamedTuple):
    """The beginning of a segment."""

    salt: int
    uuid: bytes  # of the journal: 16 bytes
    first: int  # number of its first record
    before: int  # salt of the segment before; 0: it is the first one
    before_bytes: int  # where that one ends
    epoch: int


class Name(NamedTuple):
    """The name of a segment."""

    number: int
    salt: int

    def __str__(self) -> str:
        return f"journal-{self.number:06}-{self.salt:08x}.log"


class Segment(NamedTuple):
    """A segment in a folder."""

    name: Name
    path: str
    head: Head
    certain: float = float("inf")  # see `certain_in`


class Frame(NamedTuple):
    """A record or a summary in a segment."""

    number: int
    durable: int  # number of the newest record that was proven when the frame was written
    is_summary: bool
    at: int  # bytes from the beginning of the file
    end: int  # where the next one begins
    payload: bytes


class Hole(NamedTuple):
    """Records that are damaged or missing."""

    first: int
    last: int


class Files:
    """The operations on files of whoever writes a journal. Tests and the simulator replace them.

    All of them raise OSError.
    """

    @staticmethod
    def unique(count: int) -> bytes:
        """Return so many random bytes."""
        return os.urandom(count)

    @staticmethod
    def make_folder(path: str) -> None:
        """Create a folder unless it exists."""
        os.makedirs(path, exist_ok=True)

    @staticmethod
    def create(path: str) -> int:
        """Create a file that does not exist; returns its descriptor."""
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)

    @staticmethod
    def write(fd: int, content: bytes, at: int) -> None:
        """Write all of the content at this place."""
        view = memoryview(content)
        while view:
            count = os.pwrite(fd, view, at)
            view, at = view[count:], at + count

    @staticmethod
    def sync(fd: int) -> None:
        """Sync a file to the disk."""
        os.fsync(fd)

    @staticmethod
    def close(fd: int) -> None:
        """Close a file."""
        os.close(fd)

    @staticmethod
    def rename(old: str, new: str) -> None:
        """Rename a file or a folder."""
        os.replace(old, new)

    @staticmethod
    def remove(path: str) -> None:
        """Remove a file."""
        os.remove(path)

    @staticmethod
    def sync_folder(path: str) -> None:
        """Sync the names in a folder to the disk."""
        durable.sync(path)

    @staticmethod
    def note(path: str, text: str) -> None:
        """Write a small file, whole or not at all. It is on the disk when this returns."""
        durable.write_file(path, text.encode("ascii"), durable.USUAL)


# -- reading ----------------------------------------------------------------------------------------


def name_of(text: str) -> Optional[Name]:
    """Read the name of a segment; None: it is none."""
    match = _NAME.fullmatch(text)
    return None if match is None else Name(int(match.group(1)), int(match.group(2), 16))


def names_in(folder: str) -> List[Name]:
    """Return the names of all segments in a folder, in order; empty if it is missing. Raises OSError."""
    try:
        found = map(name_of, os.listdir(folder))
    except FileNotFoundError:
        return []
    return sorted(name for name in found if name is not None)


def note_certain(folder: str, segment: str, size: int) -> None:
    """Note that in this copy of a journal, so many bytes of its newest segment are on the disk for certain. Raises
    OSError."""
    durable.write_file(folder + CERTAIN, f"{segment} {size}\n".encode("ascii"), durable.USUAL)


def certain_in(folder: str, segment: str) -> float:
    """Return how many bytes of the newest segment are on the disk for certain if the journal is a copy; inf: it is not.
    Later frames prove nothing: the records in them say what was on the disk of the box."""
    with contextlib.suppress(OSError, ValueError), open(folder + CERTAIN, encoding="ascii") as file:
        name, size = file.read(100).split()
        if name == segment:
            return int(size)
    return float("inf")


def newest_name(folder: str) -> str:
    """Return the name of the newest segment as it is kept beside the folder; empty: none."""
    with contextlib.suppress(OSError, UnicodeDecodeError), open(folder + NEWEST, encoding="ascii") as file:
        return file.read(100).strip()
    return ""


def read_head(content: bytes) -> Head:
    """Read the head of a segment. Raises `NotASegment` or `NewerFormat`."""
    if len(content) < HEAD_BYTES or content[:8] != _HEAD_MAGIC:
        raise NotASegment("its beginning is not that of a segment")
    _, version, salt, journal, first, before, before_bytes, epoch, crc = _HEAD.unpack_from(content)
    if zlib.crc32(content[:_CHECKED_HEAD]) != crc:
        raise NotASegment("its head is damaged")
    if version > VERSION:
        raise NewerFormat(f"a newer version of roah_rsbb wrote it (format {version}, known up to {VERSION})")
    return Head(salt, journal, first, before, before_bytes, epoch)


def frames(content: bytes, salt: int, at: int = HEAD_BYTES, end: Optional[int] = None) -> Iterator[Frame]:
    """Return the intact frames of a segment, from `at` to `end` (default: all). Damaged ones are skipped."""
    end = len(content) if end is None else min(end, len(content))
    view = memoryview(content)
    crc32, unpack, magics, size = zlib.crc32, _FRAME.unpack_from, (_RECORD, _SUMMARY), FRAME_BYTES
    while at + size <= end:
        magic, length, number, proven, crc, own = unpack(content, at)
        if magic in magics and length <= LONGEST_BYTES and crc32(view[at:at + _CHECKED_FRAME], salt) == own:
            payload = content[at + size:at + size + length]
            after = at + size + length
            if after <= end and crc32(payload) == crc:
                yield Frame(number, proven, magic == _SUMMARY, at, after, payload)
                at = after
                continue
        match = _MAGIC.search(content, at + 1, end)
        if match is None:
            return
        at = match.start()


def payloads_at(path: str, salt: int, places: Iterable[int]) -> Iterator[Optional[bytes]]:
    """Read single frames of a segment; None: it is damaged, or the file is missing or unreadable."""
    with contextlib.ExitStack() as opened:
        try:
            fd = opened.enter_context(open(path, "rb", buffering=0)).fileno()
        except OSError:
            fd = -1
        for at in places:
            try:
                yield _payload(fd, salt, at)
            except OSError:
                yield None


def _payload(fd: int, salt: int, at: int) -> Optional[bytes]:
    content = os.pread(fd, _USUAL_BYTES, at)
    if len(content) < FRAME_BYTES:
        return None
    _, length, _, _, crc, own = _FRAME.unpack_from(content)
    if zlib.crc32(content[:_CHECKED_FRAME], salt) != own:
        return None
    payload = content[FRAME_BYTES:FRAME_BYTES + length]
    if len(payload) < length:
        payload += os.pread(fd, length - len(payload), at + len(content))
    return payload if zlib.crc32(payload) == crc else None


class Scan(NamedTuple):
    """What a segment contains."""

    summary: Optional[Frame]  # the last one; None: it is damaged
    records: List[Frame]  # in order, up to the first torn one
    holes: List[Hole]
    last: int  # number of the last record that counts, whether it is intact or not
    proven: int  # number of the newest record that was proven
    proven_end: int  # where the last intact frame up to `proven` ends
    torn: int  # bytes after the last frame that counts, which a power failure left incomplete, or damage


def scan(content: bytes, head: Head, after: Optional[Head] = None, certain: float = float("inf")) -> Scan:
    """Read a whole segment. `after`: the head of the next one; one that continues this one says where this one ends.
    `certain`: see `certain_in`."""
    if after is not None and after.before != head.salt:
        after = None
    end = len(content) if after is None else after.before_bytes
    last = head.first - 1
    found = list(frames(content, head.salt, HEAD_BYTES, end))
    proven = after.first - 1 if after is not None else max(
        (frame.durable for frame in found if frame.end <= certain), default=last)
    summary, records, holes, place, proven_end = None, [], [], HEAD_BYTES, HEAD_BYTES
    for frame in found:
        if frame.is_summary:
            summary = frame
        elif frame.number == last + 1 or last < frame.number <= proven + 1:
            if frame.number > last + 1:
                holes.append(Hole(last + 1, frame.number - 1))
            last = frame.number
            records.append(frame)
        else:
            break
        place = frame.end
        if frame.number <= proven:
            proven_end = place
    if last < proven:
        holes.append(Hole(last + 1, proven))
    return Scan(summary, records, holes, max(last, proven), proven, proven_end,
                max(0, min(end, len(content)) - place))


def read(path: str) -> bytes:
    """Read a whole file. Raises OSError."""
    with open(path, "rb") as file:
        return file.read()


class Chain(NamedTuple):
    """The segments of a journal, each of which continues the one before."""

    segments: List[Segment]  # oldest first
    problems: List[str]  # what is missing or damaged, in words


def read_chain(folder: str) -> Chain:
    """Find the segments of the journal in a folder by their heads. Raises OSError, and `NewerFormat`."""
    known: Dict[int, Segment] = {}  # by salt
    problems: List[str] = []
    names = names_in(folder)
    for name in names:
        path = os.path.join(folder, str(name))
        try:
            known[name.salt] = Segment(name, path, _head_of(path, name.salt), certain_in(folder, str(name)))
        except NotASegment as error:
            problems.append(f"{name}: {error}")
    kept = name_of(newest_name(folder))
    if not names and kept is None and os.path.exists(folder + NEWEST):
        name = os.path.basename(folder + NEWEST)
        problems.append(f"all segments are missing, and {name} does not name the newest one")
    if kept is not None and kept > max(names, default=Name(0, 0)):
        problems.append(f"the newest segment {kept} is missing: the newest records are lost" if names else
                        f"all segments are missing, and the newest one was {kept}")
    return _linked(sorted(known.values(), reverse=True), known, problems)


def _head_of(path: str, salt: int) -> Head:
    """Return the head of a segment. If it is damaged, the summary has a copy."""
    with open(path, "rb") as file:
        begin = file.read(HEAD_BYTES)
    try:
        head = read_head(begin)
    except NotASegment:
        copies = [frame.payload for frame in frames(read(path), salt) if frame.is_summary]
        if not copies:
            raise
        head = read_head(copies[0])
    if head.salt != salt:
        raise NotASegment("its name is that of another one")
    return head


def _linked(newest_first: List[Segment], known: Dict[int, Segment], problems: List[str]) -> Chain:
    """Follow the segments from the newest one to the first. A missing one is named, and an older one is next."""
    found: List[Segment] = []
    segment = newest_first[0] if newest_first else None
    while segment is not None:
        found.append(segment)
        before = segment.head.before
        earlier = known.get(before)
        if before and earlier is None:
            earlier = next((one for one in newest_first if one.name < segment.name
                            and one.head.uuid == segment.head.uuid and one.head.first < segment.head.first), None)
            problems.append(f"the segment before {segment.name}, whose salt is {before:08x}, is missing or damaged")
        segment = earlier
    strayed = [other for other in known.values() if other not in found]
    return Chain(found[::-1], problems + [problem for other in strayed for problem in _strayed(other, found)])


def _strayed(segment: Segment, chain: Sequence[Segment]) -> List[str]:
    """Return what a segment has that the journal lacks, in words: copies were mixed. Nothing is lost in one whose name
    was not on the disk in time, because all of its records are in the next one. Raises OSError."""
    counted = {(frame.number, frame.payload) for other in chain if other.name.number >= segment.name.number
               for frame in frames(read(other.path), other.head.salt) if not frame.is_summary}
    own = [frame for frame in scan(read(segment.path), segment.head).records
           if (frame.number, frame.payload) not in counted]
    return [f"{segment.name} does not belong to the newest segments, and {len(own)} of its records "
            f"{'does' if len(own) == 1 else 'do'} not count. Parts of two copies are in one folder: keep each copy in "
            "a folder of its own, and look at both with 'results --journal FOLDER'"] if own else []


def scan_at(segments: Sequence[Segment], place: int) -> Scan:
    """Read one of the segments of a journal. Raises OSError."""
    segment, *following = segments[place:place + 2]
    found = scan(read(segment.path), segment.head, following[0].head if following else None, segment.certain)
    if following and found.last >= following[0].head.first:  # the one between both is missing
        last = following[0].head.first - 1
        found = found._replace(records=[frame for frame in found.records if frame.number <= last], last=last)
    return found


def scans(segments: Sequence[Segment]) -> Iterator[Tuple[Segment, Scan]]:
    """Read all segments of a journal. Where one is missing, its records are a hole of the next one. Raises OSError."""
    last = 0
    for place, segment in enumerate(segments):
        found = scan_at(segments, place)
        if segment.head.first > last + 1:
            found.holes.insert(0, Hole(last + 1, segment.head.first - 1))
        last = found.last
        yield segment, found


# -- writing ----------------------------------------------------------------------------------------


class _Waiting(NamedTuple):
    """A record that is not proven."""

    number: int
    payload: bytes


class Log:
    """Writes the records of a journal into its segments.

    `append` belongs to one thread, which never waits for the disk; `write` and `sync` may be called in others. `lock`
    protects what all of them change, and nobody holds it while the disk works: hold it while you change what `summary`
    returns. All methods raise OSError; nothing is lost then.
    """

    def __init__(self, folder: str, summary: Callable[[], bytes],
                 placed: Callable[[bytes, int, int], None], files: Optional[Files] = None) -> None:
        """`summary` returns a summary as of the last record. `placed` is called with a payload when its
        place is known: number of the segment, and bytes from its beginning."""
        self.folder = folder
        self.lock = threading.RLock()
        self._writing = threading.Lock()  # of whoever writes into the newest segment, or replaces it
        self.last = 0  # number of the newest record
        self.written = 0  # of the newest record in the file
        self.saved = 0  # of the newest record that is on the disk, and will be found there
        self.epoch = 1
        self.segment: Optional[Segment] = None  # the one that is written
        self._summary, self._placed = summary, placed
        self._files = Files() if files is None else files
        self.uuid = self._files.unique(16)
        self._waiting: Deque[_Waiting] = deque()
        self._unwritten: Deque[_Waiting] = deque()
        self._before: Optional[Segment] = None  # the one that the next segment continues,
        self._before_end = 0  # and where that one ends
        self._proven = 0  # number of the last record before that place
        self._kept: List[Tuple[Segment, int]] = []  # earlier segments, and their open files
        self._fd: Optional[int] = None
        self._own = (0, 0)  # the identity of that file
        self._at = 0  # where the next frame is written
        self._full_at = FULL_BYTES
        self._must_begin = True

    def continue_after(self, segments: Sequence[Segment], found: Scan) -> None:
        """Before the first `append`: continue the journal with these segments. `found`: what the newest contains."""
        segment = segments[-1]
        for each in segments[-MOST_KEPT:]:
            with contextlib.suppress(OSError):
                self._kept.append((each, os.open(each.path, os.O_RDONLY)))
        self.uuid, self.epoch = segment.head.uuid, segment.head.epoch
        self._before, self._before_end, self._proven = segment, found.proven_end, found.proven
        self.last = self.written = found.last
        self._waiting.extend(_Waiting(f.number, f.payload) for f in found.records if f.number > found.proven)

    def append(self, payload: bytes) -> int:
        """Add a record, which waits in memory until it is proven; returns its number. Call `write` next."""
        with self.lock:
            self.last += 1
            waiting = _Waiting(self.last, payload)
            self._waiting.append(waiting)
            self._unwritten.append(waiting)
            return self.last

    def write(self) -> None:
        """Hand records to the system, in their order; those that cannot be written wait."""
        with self._writing:
            while True:
                with self.lock:
                    if self._fd is None or self.segment is None or not self._unwritten:
                        return
                    waiting = self._unwritten[0]
                    frame = _frame(_RECORD, waiting, self._proven, self.segment.head.salt)
                self._files.write(self._fd, frame, self._at)
                with self.lock:
                    self._placed(waiting.payload, self.segment.name.number, self._at)
                    self._at += len(frame)
                    self.written = waiting.number
                    self._unwritten.popleft()

    def sync(self) -> None:
        """Bring everything that was written to the disk. Begins a segment if the newest one is full or not to be
        trusted."""
        with self.lock:
            fd, target, end = self._fd, self.written, self._at
        if fd is None or self._must_begin:
            self.begin()
            return
        self._must_begin = True  # until the fsync has succeeded
        self._files.sync(fd)
        self._must_begin = False
        with self.lock:
            self._prove(target, end)
            self.saved = target
        if end >= self._full_at:
            self.begin()

    def begin(self, epoch: Optional[int] = None) -> None:
        """Begin a segment, which has all records that are not proven. It is on the disk when this returns."""
        self._must_begin = True
        self._files.make_folder(self.folder)
        with self.lock:
            epoch = self.epoch if epoch is None else epoch
            segment = self._next(epoch)
            last, salt, number = self.last, segment.head.salt, segment.name.number
            content = [_head(segment.head)]
            at = HEAD_BYTES
            for waiting in self._waiting:
                content.append(_frame(_RECORD, waiting, last, salt))
                self._placed(waiting.payload, number, at)
                at += len(content[-1])
            text = self._summary()
        summary = _frame(_SUMMARY, _Waiting(last, content[0] + text), last, salt)
        end = at + len(summary)
        self._remove_drafts()
        fd = self._files.create(segment.path + DRAFT)
        try:
            self._files.write(fd, b"".join((*content, summary)), 0)
            self._files.sync(fd)
            self._switch(segment, fd, last, end)
        except BaseException:
            self._files.close(fd)
            with contextlib.suppress(OSError):
                self._files.remove(segment.path + DRAFT)
            raise
        self._files.sync_folder(self.folder)
        self._files.sync_folder(os.path.dirname(self.folder) or ".")
        with self.lock:
            self._prove(last, end)
        self._full_at = end + FULL_BYTES
        self.saved, self._must_begin = max(self.saved, last), False
        with contextlib.suppress(OSError):  # an older name stays there, which only says less
            self._files.note(self.folder + NEWEST, f"{segment.name}\n")

    def _remove_drafts(self) -> None:
        """Remove what a process has left that ended while it began a segment."""
        for name in os.listdir(self.folder):
            if name.endswith(DRAFT):
                self._files.remove(os.path.join(self.folder, name))

    def _next(self, epoch: int) -> Segment:
        newest = self.segment or self._before
        name = Name(newest.name.number + 1 if newest else 1, int.from_bytes(self._files.unique(4), "big") or 1)
        before = self._before.head.salt if self._before else 0
        head = Head(name.salt, self.uuid, self._proven + 1, before, self._before_end if before else 0, epoch)
        return Segment(name, os.path.join(self.folder, str(name)), head)

    def _switch(self, segment: Segment, fd: int, last: int, end: int) -> None:
        """Give a complete segment its name, and write there from now on."""
        with self._writing:
            with self.lock:
                later = [waiting for waiting in self._waiting if waiting.number > last]
            places = []
            for waiting in later:
                places.append(end)
                frame = _frame(_RECORD, waiting, self._proven, segment.head.salt)
                self._files.write(fd, frame, end)
                end += len(frame)
            self._files.rename(segment.path + DRAFT, segment.path)
            own = identity(fd)
            with self.lock:
                if self._fd is not None and self.segment is not None:
                    self._kept.append((self.segment, self._fd))
                for waiting, at in zip(later, places):
                    self._placed(waiting.payload, segment.name.number, at)
                self._fd, self.segment, self._at, self._own = fd, segment, end, own
                self.written = later[-1].number if later else last
                self._unwritten = deque(waiting for waiting in self._waiting if waiting.number > self.written)
                self.epoch = segment.head.epoch

    def _prove(self, number: int, end: int) -> None:
        """Records up to this number, which ends there, are proven in the present segment."""
        self._before, self._before_end, self._proven = self.segment, end, number
        while self._waiting and self._waiting[0].number <= number:
            self._waiting.popleft()

    @property
    def is_in_place(self) -> bool:
        """Whether the segment that is written is still in the folder."""
        with self.lock:
            segment, own = self.segment, self._own
        return segment is None or identity(segment.path) == own

    def restore(self) -> None:
        """Write the segments again that were removed from the folder, from their open files. Call `begin` next."""
        self._files.make_folder(self.folder)
        with self.lock:
            found = [*self._kept, (self.segment, self._fd)]
        for segment, fd in found:
            if identity(segment.path) != identity(fd):
                self._remove_drafts()
                new = self._files.create(segment.path + DRAFT)
                try:
                    self._files.write(new, _content(fd), 0)
                    self._files.sync(new)
                finally:
                    self._files.close(new)
                self._files.rename(segment.path + DRAFT, segment.path)

    def finish(self) -> None:
        """Sync everything, and say in the file that it is proven: nothing else follows that would."""
        self.sync()
        with self.lock:
            if self._fd is not None and not self._must_begin and self._proven == self.last:
                frame = _frame(_SUMMARY, _Waiting(self.last, _head(self.segment.head) + self._summary()), self.last,
                               self.segment.head.salt)
                self._files.write(self._fd, frame, self._at)
                self._at += len(frame)
                self._files.sync(self._fd)

    def close(self) -> None:
        """Close the files."""
        with self.lock:
            open_files = [fd for _, fd in self._kept] + ([] if self._fd is None else [self._fd])
            self._kept, self._fd = [], None
        for fd in open_files:
            self._files.close(fd)


def identity(file: Union[str, int]) -> Tuple[int, int]:
    """Identify the file at a path, or an open one: a deleted file stays writable."""
    with contextlib.suppress(OSError):
        found = os.stat(file)
        return found.st_dev, found.st_ino
    return 0, 0


def _content(fd: int) -> bytes:
    parts, at = [], 0
    while True:
        parts.append(os.pread(fd, 1 << 24, at))
        if not parts[-1]:
            return b"".join(parts)
        at += len(parts[-1])


def _head(head: Head) -> bytes:
    content = _HEAD.pack(_HEAD_MAGIC, VERSION, head.salt, head.uuid, head.first, head.before, head.before_bytes,
                         head.epoch, 0)[:_CHECKED_HEAD]
    return content + struct.pack("<I", zlib.crc32(content))


def _frame(magic: int, waiting: _Waiting, proven: int, salt: int) -> bytes:
    begin = struct.pack("<IIQQI", magic, len(waiting.payload), waiting.number, proven, zlib.crc32(waiting.payload))
    return b"".join((begin, struct.pack("<I", zlib.crc32(begin, salt)), waiting.payload))
