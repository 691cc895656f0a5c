"""A configuration file that is reloaded when it changes."""

import os
from typing import Callable, Generic, List, Optional, Tuple, TypeVar

from roah_rsbb.rulebook.errors import ConfigErrors

T = TypeVar("T")


class WatchedFile(Generic[T]):
    """A file with its content, as returned by `read` (which raises ConfigErrors)."""

    def __init__(self, path: str, read: Callable[[], T]) -> None:
        self.path = path
        self._read = read
        self._seen: Optional[Tuple[int, ...]] = None
        self._content: Optional[T] = None
        self._errors: Optional[ConfigErrors] = None
        self.reload()

    def forget(self) -> None:
        """Read the file at the next opportunity, whether it changed or not."""
        self._seen = None

    def reload(self) -> bool:
        """Read the file if it changed; returns whether it was read."""
        seen = signature(self.path)
        if seen == self._seen:
            return False
        self._seen = seen
        try:
            self._content, self._errors = self._read(), None
        except ConfigErrors as errors:
            self._content, self._errors = None, errors
        return True

    def content(self) -> T:
        """The present content; raises ConfigErrors."""
        self.reload()
        if self._errors is not None:
            raise self._errors
        return self._content

    @property
    def problems(self) -> List[str]:
        """The errors in the file, one per line."""
        return [] if self._errors is None else str(self._errors).splitlines()


def signature(path: str) -> Tuple[int, ...]:
    """A value that changes with the file's content; empty if the file is not accessible."""
    try:
        found = os.stat(path)
    except OSError:
        return ()
    return found.st_ino, found.st_size, found.st_mtime_ns
