"""The record of used private ports, so that none is used twice in a competition, even across restarts.

It is a text file in the log directory with one port a line. A thread appends a port when it is used (docs/protocol.md,
"Channels"), because a slow disk must not delay the box. The journal has it, too, before it is used: it is written, and
synced within 0.05 s and the time of the disk. A power failure meanwhile may take the record of a connect, and so its
port. A line that a power failure truncated contains a smaller number, or is empty. Both are harmless, because only the
largest number counts.
"""

import os
import threading
from typing import Callable, List, Optional, Tuple

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
        """Record a port. `on_problem` is called from another thread if it does not reach the disk."""
        self._begin(lambda: _append(self.path, port, on_problem))


def _append(path: str, port: int, on_problem: Callable[[OSError], None]) -> None:
    """Append a port to the file, and sync that to the disk."""
    try:
        fd = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        try:
            # Begin with a line break, in case the previous line is truncated.
            os.write(fd, f"\n{port}\n".encode("ascii"))
            os.fsync(fd)
        finally:
            os.close(fd)
    except OSError as error:
        on_problem(error)
