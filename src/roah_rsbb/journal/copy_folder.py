"""A copy of the journal in another folder, from which a core can resume.

The folder is often a USB stick: it can vanish at any moment, and be another one when it is back.

Theory of operation. A segment is on the disk before the next one is begun, so whatever is lost, the copy is an earlier
state of the journal. A segment that the copy does not have is written as a draft, which gets its name when it is on the
disk. So is a segment in which an fsync failed: Linux does not try again to write these pages, so what is read back may
be only in memory. All of it is written again, and the old one stays in its place, for a takeover, until the new one
replaces it.

Where the box continued an earlier state of the journal, such as after a power failure that took the newest records, the
copy is begun again. The one before stays in its place until the new one is complete: a takeover needs what was
confirmed.

The records of a segment say what was proven on the disk of the box, which says nothing of this disk. So a file beside
the journal says how much of the newest segment was on this one. A gap after that is a torn tail, not damage.
"""

import contextlib
import functools
import glob
import os
import shutil
import zlib
from typing import Dict, Iterator, Mapping, NamedTuple, Optional, Set, Tuple

from roah_rsbb.ground import durable
from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.model.reason import say

# -- what every copy can do ---------------------------------------------------------------------------

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


def identity_in(head: bytes) -> str:
    """Return the identity of the journal to which the head of a segment belongs; empty: it is damaged."""
    try:
        return log.read_head(head).uuid.hex()
    except (log.NotASegment, log.NewerFormat):
        return ""


# -- a folder -----------------------------------------------------------------------------------------

_NOT_SYNCED = say("its disk failed to save what was written. It is written again, and what was there before stays "
                  "until that is complete. If this happens again, replace the disk")
_IN_USE = say("another box or copy uses the folder. Use another folder, or end that one")
_FULL = say("the disk is full. Free space for {folder}")
_FAILED = say("{error}. Check the disk or stick of the copy")
_NOT_MOUNTED = say("the stick is not mounted. Plug it in again")
_MISSING = say("the folder is missing. Plug the stick in again")
_REMOVED, _REPLACED = say("it was removed. Plug the stick in again"), say("it was replaced. Plug the stick in again")
# A copy that takes the place of the one before when it is complete.
NEXT = ".next"
# The file that says so may lack this much.
CERTAIN_BYTES = 1 << 20
# Segments in which an fsync failed, and that were not written again yet. Their drafts say so to later processes.
_untrusted: Set[str] = set()


class Stick:
    """The folder of a copy, which is often where a stick is mounted."""

    def __init__(self, folder: str, log_dir: str) -> None:
        self._folder = folder
        self._log_dir = log_dir
        self._has_other_device = False

    def open(self) -> "CopyFolder":
        """Open the copy. Raises `CannotWriteCopy`."""
        self._check_device()
        return CopyFolder(self._folder)

    def _check_device(self) -> None:
        """Refuse to write into the empty folder where the stick was mounted."""
        try:
            has_other = os.stat(self._folder).st_dev != os.stat(self._log_dir).st_dev
        except OSError:
            return  # the folder is missing, which is reported when it is opened
        if self._has_other_device and not has_other:
            raise CannotWriteCopy(_NOT_MOUNTED)
        self._has_other_device = has_other


class CopyFolder(Copy):
    """A copy that is open for writing. Call all methods in one thread."""

    def __init__(self, folder: str) -> None:
        """Raises `CannotWriteCopy`."""
        super().__init__()
        self._place = folder
        self.path = self._final = os.path.join(folder, log_dirs.JOURNAL)
        self._certain = 0  # bytes of the newest segment that are noted to be on the disk
        self._lock: Optional[log_dirs.Lock] = None
        with self._writing():
            if not os.path.isdir(folder):
                raise CannotWriteCopy(_MISSING)
            self._lock = log_dirs.lock(folder)
            self._file = log.identity(f"{self.path}.lock")
            try:
                _finish_exchange(self._final)
                self._open()
            except BaseException:
                self.close()
                raise

    def close(self) -> None:
        """Release the folder. Never raises: the stick may be gone."""
        if self._lock is not None:
            with contextlib.suppress(OSError):
                os.close(self._lock.fd)
            self._lock = None

    def check(self) -> None:
        """Raise `CannotWriteCopy` if the path no longer leads to this copy."""
        if not os.path.isdir(self.path) or log.identity(f"{self._final}.lock") != self._file:
            raise CannotWriteCopy(_REMOVED)

    def write_files(self, beside: FileContent) -> None:
        """Replace files beside the journal. They are on the disk when this returns. Raises `CannotWriteCopy`."""
        with self._writing():
            for name, content in beside.items():
                # Only the owner may read it: it can be the teams' passwords.
                durable.write_file(os.path.join(self._place, name), content)

    def write(self, part: Part) -> None:
        """Write a part of a segment. It is on the disk when this returns. Raises `CannotWriteCopy`."""
        path = os.path.join(self.path, part.segment)
        is_new = part.segment not in self.sizes
        with self._writing():
            with open(path + log.DRAFT if is_new else path, "r+b" if part.at else "wb", buffering=0) as file:
                _put(file.fileno(), part)
                with _syncing(path):
                    os.fsync(file.fileno())
            self.note(part)
            if is_new and part.is_last:
                with _syncing(path):
                    os.replace(path + log.DRAFT, path)
                    durable.sync(self.path)
                _untrusted.discard(path)
                self._note_certain(part.segment)
            elif not is_new and self.sizes[part.segment] >= self._certain + CERTAIN_BYTES:
                self._note_certain(part.segment)

    def set_aside(self, journal: str) -> None:
        """Begin a new copy of this journal. An earlier one of the same journal keeps its place until `complete`.
        Raises `CannotWriteCopy`."""
        with self._writing():
            if _identity_of(self._final) == journal:
                self.path = self._final + NEXT
                _remove(self.path)
            else:
                self.aside = log_dirs.set_aside(self._final)
            self._open()

    def complete(self) -> None:
        """See `Copy`. Raises `CannotWriteCopy`."""
        if self.path == self._final:
            return
        with self._writing():
            self.aside = log_dirs.set_aside(self._final)
            _finish_exchange(self._final)
            self.path = self._final
            self._note_certain(str(log.names_in(self.path)[-1]))

    # -- steps --------------------------------------------------------------------------------------

    def _open(self) -> None:
        os.makedirs(self.path, exist_ok=True)
        found, held = [str(name) for name in log.names_in(self.path)], {}
        for name in found:
            path = os.path.join(self.path, name)
            is_again = path in _untrusted or os.path.exists(path + log.DRAFT)
            # The end of the newest one may be torn.
            size = 0 if is_again else intact_size(path) if name == found[-1] else os.path.getsize(path)
            held[name] = Held(size, crc_of(path, size))
        # The newest one, or a name, may be only in the memory of a process that was killed.
        newest = [os.path.join(self.path, found[-1])] if found else []
        with _syncing(*newest):
            for path in (*newest, self.path, self._place):
                durable.sync(path)
        self.open(held)
        if found and found[-1] in self.sizes:
            self._note_certain(found[-1])

    def _note_certain(self, segment: str) -> None:
        """Note that everything that the copy has of this segment is on the disk."""
        self._certain = self.sizes[segment]
        log.note_certain(self.path, segment, self._certain)

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            yield
        except log_dirs.JournalInUse:
            raise CannotWriteCopy(_IN_USE) from None
        except (log_dirs.CannotWriteJournal, OSError) as error:
            if durable.is_full(error):
                raise CannotWriteCopy(_FULL(folder=self._place)) from None
            raise CannotWriteCopy(_FAILED(error=getattr(error, "strerror", None) or str(error))) from None


def drop_drafts(folder: str) -> bool:
    """Remove the drafts of a copy that is used from now on: nothing may replace it or its segments any more. Returns
    whether one of these was not to be trusted. Raises OSError."""
    path = os.path.join(folder, log_dirs.JOURNAL)
    _finish_exchange(path)
    _remove(path + NEXT)
    drafts = glob.glob(os.path.join(glob.escape(folder), log_dirs.JOURNAL, f"*{log.DRAFT}"))
    for draft in drafts:
        os.unlink(draft)
    return any(os.path.exists(draft[:-len(log.DRAFT)]) for draft in drafts)


def _identity_of(path: str) -> str:
    """Return the identity of the journal in a folder; empty: there is none. Raises OSError."""
    names = log.names_in(path)
    if not names:
        return ""
    with open(os.path.join(path, str(names[-1])), "rb") as file:
        return identity_in(file.read(log.HEAD_BYTES))


def _remove(path: str) -> None:
    """Remove a journal that is not needed. Raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(path)
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path + log.CERTAIN)


def _finish_exchange(path: str) -> None:
    """Give a new copy its place, if the one before was set aside. Raises OSError."""
    if not os.path.isdir(path) and os.path.isdir(path + NEXT):
        os.rename(path + NEXT, path)
        durable.sync(os.path.dirname(path))
        _remove(path + NEXT)


def _put(fd: int, part: Part) -> None:
    """Write a part into a file, which ends with it. Raises OSError or `CannotWriteCopy`."""
    size, end = os.fstat(fd).st_size, part.at + len(part.content)
    if size < part.at:
        raise CannotWriteCopy(_REPLACED)
    log.Files.write(fd, part.content, part.at)
    if size > end:
        os.ftruncate(fd, end)  # a torn end


@contextlib.contextmanager
def _syncing(*segments: str) -> Iterator[None]:
    """If an fsync fails here, these segments are written again, also after a restart of this process. Raises
    `CannotWriteCopy` then."""
    try:
        yield
    except OSError as error:
        _untrusted.update(segments)
        for path in segments:
            with contextlib.suppress(OSError):
                os.close(os.open(path + log.DRAFT, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, durable.USUAL))
        if durable.is_full(error):
            raise
        raise CannotWriteCopy(_NOT_SYNCED) from None
