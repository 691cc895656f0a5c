"""What every copy of the journal can do, and the files that go with it."""

import os
from typing import Dict, Mapping, Tuple

from roah_rsbb.copies.rows import CannotReadJournal, Known, Rows
from roah_rsbb.journal import in_force, ports

# What a restart needs besides the journal. The last file has the hashes of the keys of paired browsers.
SESSIONS = "web_sessions.json"
FILES = (ports.FILE_NAME, in_force.FILE_NAME, SESSIONS)

FileContent = Dict[str, bytes]


class CannotWriteCopy(Exception):
    """The copy cannot be written now. The text says why, and what to do."""


class Copy:
    """A copy that is open for writing. All methods raise `CannotWriteCopy`, except `close`."""

    def __init__(self) -> None:
        self.known = Known()
        self.box_uuid = ""  # of the core that wrote the newest session
        self.aside = ""  # where the previous contents were moved

    def check(self) -> None:
        """Check that the copy is still there."""
        raise NotImplementedError

    def write(self, rows: Rows, beside: FileContent) -> None:
        """Write rows and files. They are on the disk of the copy when this returns."""
        raise NotImplementedError

    def set_aside(self) -> None:
        """Keep the contents under another name, and begin a new copy."""
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
