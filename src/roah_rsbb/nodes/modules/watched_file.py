"""A configuration file that may be mended while it is in use: read anew when it changed. No ROS."""

import os
from typing import Callable, Generic, List, Optional, Tuple, TypeVar

from roah_rsbb.rulebook.errors import ConfigErrors

T = TypeVar("T")


class WatchedFile(Generic[T]):
    """A file and what `read` (which raises ConfigErrors) made of it when it was looked at last."""

    def __init__(self, path: str, read: Callable[[], T]) -> None:
        self.path = path
        self._read = read
        self._seen: Optional[Tuple[int, ...]] = None
        self._content: Optional[T] = None
        self._errors: Optional[ConfigErrors] = None
        self.look()

    def look(self) -> bool:
        """Read it if it is not as it was; whether it was read."""
        seen = _signature(self.path)
        if seen == self._seen:
            return False
        self._seen = seen
        try:
            self._content, self._errors = self._read(), None
        except ConfigErrors as errors:
            self._content, self._errors = None, errors
        return True

    def content(self) -> T:
        """What is in it now; raises ConfigErrors."""
        self.look()
        if self._errors is not None:
            raise self._errors
        return self._content

    @property
    def problems(self) -> List[str]:
        """What is wrong in it, a line each."""
        return [] if self._errors is None else str(self._errors).splitlines()


def _signature(path: str) -> Tuple[int, ...]:
    """Changes whenever the file's content may have changed; empty: it cannot be seen."""
    try:
        found = os.stat(path)
    except OSError:
        return ()
    return found.st_ino, found.st_size, found.st_mtime_ns
