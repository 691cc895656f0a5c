"""What every copy of the journal can do, and the files that go with it."""

import functools
import os
import zlib
from typing import Dict, Mapping, NamedTuple, Tuple

from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs

# What a restart needs besides the journal. The last file has the hashes of the keys of paired browsers.
SESSIONS = "web_sessions.json"
FILES = (log_dirs.PORTS, log_dirs.CONFIGURATION, SESSIONS)
# Bytes of a segment that are copied at once.
PART_BYTES = 1 << 20

FileContent = Dict[str, bytes]


class CannotReadJournal(Exception):
    """The journal cannot be read now."""


class CannotWriteCopy(Exception):
    """The copy cannot be written now. The text says why, and what to do."""


class Part(NamedTuple):
    """A part of a segment."""

    segment: str
    at: int  # bytes from the beginning of the segment
    content: bytes
    is_last: bool  # the copy has all of the segment with it


class Held(NamedTuple):
    """What a copy has of a segment: its beginning."""

    size: int  # bytes
    crc: int


class Copy:
    """A copy that is open for writing. All methods raise `CannotWriteCopy`, except `close`."""

    def __init__(self) -> None:
        self.held: Dict[str, Held] = {}  # when it was opened, by the segments' names
        self.sizes: Dict[str, int] = {}  # now: bytes on the disk of the copy, of each segment of which it has any
        self.aside = ""  # where the previous contents were moved

    def open(self, held: Dict[str, Held]) -> None:
        """Begin with these segments."""
        self.held = held
        self.sizes = {name: found.size for name, found in held.items() if found.size}

    def note(self, part: Part) -> None:
        """Note that a part is on the disk of the copy."""
        if part.segment in self.sizes or part.is_last:
            self.sizes[part.segment] = part.at + len(part.content)

    def check(self) -> None:
        """Check that the copy is still there."""
        raise NotImplementedError

    def write_files(self, files: FileContent) -> None:
        """Replace files beside the journal. They are on the disk of the copy when this returns."""
        raise NotImplementedError

    def write(self, part: Part) -> None:
        """Write a part of a segment, which continues the one before or the size in `sizes`.

        It is on the disk of the copy when this returns. A segment that is not in `sizes` is there after its last part.
        """
        raise NotImplementedError

    def set_aside(self, journal: str) -> None:
        """Begin a new copy, of the journal with this identity, and keep the contents under another name."""
        raise NotImplementedError

    def complete(self) -> None:
        """Everything that the journal had at some moment was written. A new copy takes the place of the one before."""
        raise NotImplementedError

    def close(self) -> None:
        """Close the copy."""
        raise NotImplementedError


class ChangedFiles:
    """Files beside a journal. Reads those that changed."""

    def __init__(self, paths: Mapping[str, str]) -> None:
        """`paths`: by the name that the file has in the copy."""
        self._paths = paths
        self._read: Dict[str, Tuple[int, int, int]] = {}

    def changed(self) -> FileContent:
        """Return the files that changed since the last call, without missing ones. Raises `CannotReadJournal`."""
        found: FileContent = {}
        for name, path in self._paths.items():
            try:
                stat = os.stat(path)
                state = stat.st_ino, stat.st_size, stat.st_mtime_ns
                if state != self._read.get(name):
                    with open(path, "rb") as file:
                        found[name] = file.read()
                    self._read[name] = state
            except FileNotFoundError:
                continue
            except OSError as error:
                raise CannotReadJournal(f"{path}: {error.strerror}") from None
        return found


def crc_of(path: str, size: int) -> int:
    """Return the CRC of the beginning of a file. Raises OSError."""
    stat = os.stat(path)
    return _crc_of(path, size, (stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns))


def intact_size(path: str) -> int:
    """Return where the first damaged or torn record of a segment begins. Raises OSError."""
    stat = os.stat(path)
    return _intact_size(path, (stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns))


# A copy is opened again after each interruption, and most segments never change any more.
@functools.lru_cache(maxsize=1000)
def _crc_of(path: str, size: int, _state: Tuple[int, ...]) -> int:
    crc = 0
    with open(path, "rb") as file:
        while size > 0:
            content = file.read(min(size, PART_BYTES))
            if not content:
                break
            crc = zlib.crc32(content, crc)
            size -= len(content)
    return crc


@functools.lru_cache(maxsize=10)
def _intact_size(path: str, _state: Tuple[int, ...]) -> int:
    content = log.read(path)
    try:
        head, end = log.read_head(content), log.HEAD_BYTES
    except (log.NotASegment, log.NewerFormat):
        return 0
    for frame in log.frames(content, head.salt):
        if frame.at != end:
            break
        end = frame.end
    return end
