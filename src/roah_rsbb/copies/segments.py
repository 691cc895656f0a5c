"""Reads from a journal in use the bytes that a copy does not have yet.

Theory of operation. A segment is only appended to, and none is written after the next one has its name. So a copy is an
earlier state of the journal if each of its segments is the beginning of the segment with the same name, which contains
a random number. The bytes of older segments are copied as they are, with their damage; those of the newest one up to
the end of its last intact record: what follows is being written, or is written again when the disk has space.
"""

import os
from typing import Dict, Iterator, Mapping

from roah_rsbb.copies.copy import PART_BYTES, CannotReadJournal, Held, Part, crc_of
from roah_rsbb.journal import log


class JournalSegments:
    """The journal in a folder, which another process may write."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._newest = ""  # a segment,
        self._end = 0  # and where its last intact record ends
        self.identity = ""  # of the journal; empty: unknown

    def sizes(self) -> Dict[str, int]:
        """Return how many bytes of each segment can be copied, the oldest first. Raises `CannotReadJournal`."""
        try:
            names = log.names_in(self._folder)
            sizes = {str(name): os.stat(self._path(str(name))).st_size for name in names}
            if names:
                sizes[str(names[-1])] = self._end_of_newest(names[-1], sizes[str(names[-1])])
        except OSError as error:
            raise self._cannot_read(error) from None
        if not sizes:
            raise CannotReadJournal(f"there is no journal {self._folder} yet")
        return sizes

    def has(self, held: Mapping[str, Held], sizes: Mapping[str, int]) -> bool:
        """Whether a copy with these segments is an earlier state of the journal. Raises `CannotReadJournal`."""
        try:
            return all(size <= sizes.get(name, -1) and crc_of(self._path(name), size) == crc
                       for name, (size, crc) in held.items())
        except OSError as error:
            raise self._cannot_read(error) from None

    def parts(self, segment: str, begin: int, end: int) -> Iterator[Part]:
        """Return the parts of a segment between these bytes. Raises `CannotReadJournal`."""
        try:
            with open(self._path(segment), "rb") as file:
                file.seek(begin)
                while begin < end:
                    content = file.read(min(PART_BYTES, end - begin))
                    if not content:
                        raise CannotReadJournal(f"{self._path(segment)} is shorter than before")
                    yield Part(segment, begin, content, begin + len(content) == end)
                    begin += len(content)
        except OSError as error:
            raise self._cannot_read(error) from None

    # -- steps --------------------------------------------------------------------------------------

    def _path(self, segment: str) -> str:
        return os.path.join(self._folder, segment)

    def _cannot_read(self, error: OSError) -> CannotReadJournal:
        return CannotReadJournal(f"{self._folder}: {error.strerror}")

    def _end_of_newest(self, name: log.Name, size: int) -> int:
        if str(name) != self._newest or size < self._end:
            self._newest, self._end = str(name), log.HEAD_BYTES
            with open(self._path(str(name)), "rb") as file:
                self.identity = identity_in(file.read(log.HEAD_BYTES))
        if size > self._end:
            with open(self._path(str(name)), "rb") as file:
                file.seek(self._end)
                content = file.read(size - self._end)
            self._end += max((frame.end for frame in log.frames(content, name.salt, 0)), default=0)
        return self._end


def identity_in(head: bytes) -> str:
    """Return the identity of the journal to which the head of a segment belongs; empty: it is damaged."""
    try:
        return log.read_head(head).uuid.hex()
    except (log.NotASegment, log.NewerFormat):
        return ""
