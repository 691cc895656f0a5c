"""Programs that a test starts itself: their lines, as they come, and their end."""

import os
import signal
import subprocess
import threading
import time
from typing import List, Optional

from support.forking import start
from support.waiting import LIMIT_S, happened, wait_until

# roslaunch gives its nodes so long before it kills them.
END_S = 20.0
_NO_INPUT = os.open(os.devnull, os.O_RDONLY)


def own(name: str) -> str:
    """The path of a program of this package, as rosrun would find it after a search of 0.3 s."""
    for prefix in os.environ["CMAKE_PREFIX_PATH"].split(os.pathsep):
        path = os.path.join(prefix, "lib", "roah_rsbb", name)
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(f"{name} is not built: source build/devel/setup.bash")


class Program:
    """A running program. Close it at the end of the test: it is interrupted as by Ctrl-C."""

    def __init__(self, *command: str, **environment: str) -> None:
        self.lines: List[str] = []
        self.began_mono = time.monotonic()
        self.ended_mono: Optional[float] = None
        reading, writing = os.pipe()
        self._output = os.fdopen(reading, encoding="utf-8", errors="replace")
        self._process = start(command, (_NO_INPUT, writing, writing), PYTHONUNBUFFERED="1", **environment)
        os.close(writing)
        self._reader = threading.Thread(target=self._read, name=command[0], daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._output:
            self.lines.append(line.rstrip("\n"))
            happened()
        self._process.wait()
        self.ended_mono = time.monotonic()
        happened()

    def close(self) -> None:
        """End the program, by force if need be."""
        if self._process.poll() is None:
            self.interrupt()
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
        self._reader.join(END_S)
        self._output.close()

    def interrupt(self) -> None:
        """Interrupt it as Ctrl-C and roslaunch do."""
        self._process.send_signal(signal.SIGINT)

    def kill(self) -> None:
        """Kill it. Its child processes continue."""
        self._process.kill()

    @property
    def text(self) -> str:
        """All that it printed so far."""
        return "\n".join(self.lines)

    def wait_printed(self, text: str, times: int = 1) -> None:
        """Wait until its output contains a text."""
        wait_until(lambda: self.text.count(text) >= times, lambda: f"'{text}' is printed; it printed\n{self.text}")

    def wait_ended(self, limit_s: float = LIMIT_S) -> int:
        """Wait until it ends by itself; returns its exit status."""
        wait_until(lambda: self.ended_mono, lambda: f"the program ends; it printed\n{self.text}", limit_s)
        return self._process.wait()
