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
import glob
import os
import shutil
from typing import Iterator, Optional, Set

from roah_rsbb.copies.copy import CannotWriteCopy, Copy, FileContent, Held, Part, crc_of, intact_size
from roah_rsbb.copies.segments import identity_in
from roah_rsbb.ground import durable
from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.model.reason import say

_NOT_SYNCED = say("its disk failed to save what was written. It is written again, and what was there before stays "
                  "until that is complete. If this happens again, replace the disk")
_IN_USE = say("another core or copy uses the folder. Use another folder, or end that one")
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
