"""Programs that a test starts itself: their lines, as they come, and their end."""

import contextlib
import os
import re
import signal
import subprocess
import tempfile
import threading
import time
from typing import Iterator, List, Optional

from support.forking import start
from support.waiting import LIMIT_S, happened, wait_until

# roslaunch gives its nodes so long before it kills them.
END_S = 20.0
# Nothing is wrong if these come while a machine is busy. rospy warns of each connection that comes after its topic or
# service ended: it opens a separate connection to check that a service exists, and a subscriber may connect late. A
# message that waited looks like a robot whose clock is behind.
_OF_A_BUSY_MACHINE = re.compile(
    r"Could not process inbound connection|Inbound TCP/IP connection failed|(?:for|within) \d+ s: check"
    r"|clock skew -|times are valid again")


def own(name: str) -> str:
    """The path of a program of this package, as rosrun would find it after a search of 0.3 s."""
    for prefix in os.environ["CMAKE_PREFIX_PATH"].split(os.pathsep):
        path = os.path.join(prefix, "lib", "roah_rsbb", name)
        if os.path.isfile(path):
            return path
    raise FileNotFoundError(f"{name} is not built: source build/devel/setup.bash")


@contextlib.contextmanager
def _input(text: str) -> Iterator[int]:
    """A file descriptor to read that text from. Without text it is no terminal and no pipe, whose end ends programs."""
    if text:
        reading, writing = os.pipe()
        os.write(writing, text.encode())
        os.close(writing)
    else:
        reading = os.open(os.devnull, os.O_RDONLY)
    yield reading
    os.close(reading)


def run(*command: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Run a program from its start to its end; returns its exit status and what it printed."""
    with contextlib.ExitStack() as files:
        outputs = [files.enter_context(tempfile.TemporaryFile("w+", encoding="utf-8")) for _ in range(2)]
        standard_input = files.enter_context(_input(""))
        process = start(command, (standard_input, *(output.fileno() for output in outputs)), **environment)
        try:
            status = process.wait(LIMIT_S)
        finally:
            process.kill()
        for output in outputs:
            output.seek(0)
        return subprocess.CompletedProcess(command, status, outputs[0].read(), outputs[1].read())


class Program:
    """A running program. Close it at the end of the test: it is interrupted as by Ctrl-C."""

    def __init__(self, *command: str, typed: str = "", **environment: str) -> None:
        """`typed`: its standard input."""
        self.lines: List[str] = []
        self.ended_mono: Optional[float] = None
        reading, writing = os.pipe()
        self._output = os.fdopen(reading, encoding="utf-8", errors="replace")
        with _input(typed) as standard_input:
            self._process = start(
                command, (standard_input, writing, writing), PYTHONUNBUFFERED="1", **environment)
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
            self.signal(signal.SIGINT)
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
        self._reader.join(END_S)
        self._output.close()

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """Kill it. Its child processes continue."""
        self._process.kill()

    @property
    def pid(self) -> int:
        """The number of its process."""
        return self._process.pid

    @property
    def text(self) -> str:
        """All that it printed so far."""
        return "\n".join(self.lines)

    @property
    def warnings(self) -> List[str]:
        """The warnings that it printed so far, without those that a busy machine causes."""
        return [line for line in self.lines if "[WARN]" in line and not _OF_A_BUSY_MACHINE.search(line)]

    def wait_printed(self, text: str, times: int = 1) -> None:
        """Wait until its output contains a text."""
        wait_until(lambda: self.text.count(text) >= times, lambda: f"'{text}' is printed; it printed\n{self.text}")

    def wait_ended(self, limit_s: float = LIMIT_S) -> int:
        """Wait until it ends by itself; returns its exit status."""
        wait_until(lambda: self.ended_mono, lambda: f"the program ends; it printed\n{self.text}", limit_s)
        return self._process.wait()
