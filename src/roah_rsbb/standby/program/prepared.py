"""The box on the standby, started in advance: its core has everything imported and waits, and its ROS master runs.

At a takeover, the core only has to read the journal. With ROS, the referee's window starts beside it.
"""

import contextlib
import os
import signal
import subprocess
import threading
import xmlrpc.client
from http.client import HTTPException
from typing import Any, Callable, List, Optional, Sequence
from xml.parsers.expat import ExpatError

from roah_rsbb.client.places import MASTER_URI
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.standby.program.guard import guarded

LOOK_S = 1.0
# What starts the core alone, and then the rest.
CORE_PART, REST_PART = "part:=core", "part:=rest"
# roslaunch ends its nodes within this time.
END_S = 30.0


class Prepared:
    """The core that waits."""

    def __init__(self, folder: str, command_of: Callable[[], List[str]], not_yet: type,
                 on_state: Callable[[str], None]) -> None:
        """`folder`: of the standby. `command_of` returns the command that starts the whole box, or raises `not_yet`."""
        self._folder, self._command_of, self._not_yet, self._on_state = folder, command_of, not_yet, on_state
        self._command: Optional[Sequence[str]] = None
        self._process: Optional[subprocess.Popen] = None
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, name="prepared", daemon=True)

    def start(self) -> None:
        """Start the core as soon as the copy has its configuration."""
        self._thread.start()

    def is_for(self, command: Sequence[str]) -> bool:
        """Whether the box that this command starts is prepared."""
        return self._command == command and self._process is not None and self._process.poll() is None

    def end(self) -> None:
        """End it."""
        self._ended.set()
        if self._process is not None:
            linux.end_launch(self._process, END_S)
        self._thread.join()

    def run(self) -> int:
        """Start the rest of the box, and wait until either part or this program is ended; returns the exit status."""
        over = threading.Event()
        self._ended.set()  # nothing is prepared any more
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: over.set())
        rest = [] if is_without_ros() else [_start(self._folder, [*self._command, REST_PART])]
        parts = [*rest, self._process]
        for process in parts:
            threading.Thread(target=lambda process=process: (process.wait(), over.set()), daemon=True).start()
        over.wait()
        for process in parts:
            linux.end_launch(process, END_S)
        return self._process.returncode

    def _work(self) -> None:
        while not self._ended.is_set():
            with contextlib.suppress(self._not_yet, OSError):
                command = self._command_of()
                if not is_without_ros() and _core_runs():
                    self._on_state("A core runs at ROS_MASTER_URI, so no box is prepared here: a takeover takes longer")
                    return
                self._command, self._process = command, _start(
                    self._folder, command if is_without_ros() else [*command, CORE_PART])
                if self._ended.is_set():
                    linux.end_launch(self._process, END_S)
                # It gets a signal when the thread that started it ends.
                self._process.wait()
                if not self._ended.is_set():
                    self._on_state("The prepared box ended: a takeover takes longer")
                return
            self._ended.wait(LOOK_S)


def _core_runs() -> bool:
    try:
        master: Any = xmlrpc.client.ServerProxy(os.environ.get("ROS_MASTER_URI") or MASTER_URI)
        return bool(master.lookupNode("/roah_rsbb_standby", "/roah_rsbb_core")[0] == 1)
    except (OSError, HTTPException, xmlrpc.client.Error, ExpatError, LookupError, TypeError):
        return False


def _start(folder: str, command: Sequence[str]) -> subprocess.Popen:
    """Start a part of the box. Ctrl-C does not reach it directly."""
    return subprocess.Popen(guarded(folder, command), stdin=subprocess.DEVNULL, start_new_session=True)
