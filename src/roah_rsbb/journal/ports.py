"""The record of used private ports, so that none is used twice in a competition, even across restarts.

It is a text file in the log directory with one port a line. A port is appended before it is used (docs/protocol.md,
"Channels"), so the record survives the process. A thread syncs it to the disk, because a slow disk must not delay the
box. A line that a power failure truncated contains a smaller number, or is empty. Both are harmless, because only the
largest number counts.
"""

import os
import threading
from typing import Callable, List, Optional, Tuple

from roah_rsbb import platform

FILE_NAME = "used_private_ports"
LARGEST_PORT = 65535
_DIGITS = 5


def begin_thread(work: Callable[[], None]) -> None:
    """Run a function in a thread of its own."""
    threading.Thread(target=work, name="ports", daemon=True).start()


class PortRecord:
    """The ports that a competition used; `log_dir` holds the file."""

    def __init__(self, log_dir: str, begin: Callable[[Callable[[], None]], None] = begin_thread) -> None:
        """`begin` runs a function that may wait for the disk."""
        self.path = os.path.join(log_dir, FILE_NAME)
        self._begin = begin

    def read(self) -> Tuple[Optional[int], List[str]]:
        """Return the largest used port (None if no port was used), and warnings about invalid lines.

        Raises OSError if the file exists but cannot be read.
        """
        try:
            with open(self.path, encoding="ascii", errors="replace") as file:
                lines = file.read().split()
        except FileNotFoundError:
            return None, []
        ports = [int(line) for line in lines if len(line) <= _DIGITS and line.isdigit() and int(line) <= LARGEST_PORT]
        warnings = []
        if len(ports) < len(lines):
            warnings.append(f"{self.path}: {len(lines) - len(ports)} lines are not UDP ports and were skipped")
        return max(ports, default=None), warnings

    def add(self, port: int, on_problem: Callable[[OSError], None]) -> None:
        """Record a port. Raises OSError if it cannot be written.

        `on_problem` is called from another thread if it does not reach the disk.
        """
        fd = platform.open_file(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        try:
            # Begin with a line break, in case the previous line is truncated.
            os.write(fd, f"\n{port}\n".encode("ascii"))
        except OSError:
            os.close(fd)
            raise
        self._begin(lambda: _force(fd, on_problem))


def _force(fd: int, on_problem: Callable[[OSError], None]) -> None:
    """Sync a file to the disk and close it."""
    try:
        platform.sync(fd)
    except OSError as error:
        on_problem(error)
    finally:
        os.close(fd)
