"""Has the bags of runs made, one for each robot in a run, when the run is over (docs/ros_interface.md, "Run log").

Theory of operation. The journal has every entry of a run, and survives whatever happens. A bag is made of it at the
run's end by a process of low priority, `results bags --make`, so that neither the disk nor Python's lock delays the
box. It makes all bags that are missing: after a restart, a takeover or a full disk also earlier ones.
"""

import logging
import os
import queue
import re
import subprocess
import threading
import time
from typing import Callable, Container, Dict, Iterable, List, Optional, Set

from roah_rsbb.core import effects
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.wording.times import formatted

# A bag that could not be made is tried again after this time, which doubles each time (s).
RETRY_S, MOST_RETRY_S = 2.0, 64.0
# Time limit for making the last bags when the box ends.
STOP_S = 5.0

SUFFIX = ".bag"
# Longest robot name in a file name (characters).
MAX_ROBOT_NAME = 40

_log = logging.getLogger(__name__)


def log_name(utc: float, team: str, robot: str, round_: int, run: int, box_uuid: str) -> str:
    """The file name of a run's log that begins at `utc` (s); `robot` is empty unless a team has several robots."""
    local = formatted(utc, "%Y-%m-%d_%H-%M-%S", in_utc=False)
    team = re.sub(r"[^\w.-]", "-", team)
    # The name comes from the robot: its characters and length are unchecked.
    robot = re.sub(r"[^A-Za-z0-9_.-]", "-", robot)[:MAX_ROBOT_NAME]
    who = f"{team}_{robot}" if robot else team
    return f"online_log_{local}_{who}_round{round_}_run{run}_{box_uuid}{SUFFIX}"


def unused(path: str, port: int, in_use: Container[str]) -> str:
    """The path, or one with the run's port if the path is in use.

    That happens if two robots have similar names, or if the same event was opened within one second.
    """
    if path not in in_use and not os.path.exists(path):
        return path
    return f"{path[:-len(SUFFIX)]}_port{port}{SUFFIX}"


class RunLogWriter:
    """The bags of all runs. Call all methods in the loop's thread."""

    def __init__(
        self, log_dir: str, box_uuid: str, on_problem: Callable[[str], None], on_repaired: Callable[[str, str], None],
    ) -> None:
        """`on_problem` is called in another thread with a problem and its remedy, `on_repaired` with the text of a
        problem that is solved and with what to report instead."""
        self._log_dir = log_dir
        self._box_uuid = box_uuid
        self._on_problem = on_problem
        self._on_repaired = on_repaired
        self._command = linux.with_low_priority(without_ros("results", "--log-dir", log_dir, "bags", "--make"))
        self._paths: queue.Queue[Optional[str]] = queue.Queue()  # of bags to be made; None: the box ends
        self._used: Set[str] = set()
        self.files: Dict[int, str] = {}  # by the run's port: where its log will be
        self._thread = threading.Thread(target=self._work, name="run logs", daemon=True)
        self._thread.start()

    def check(self) -> str:
        """Why logs cannot be written to the log directory, with the remedy; empty if they can."""
        try:
            os.makedirs(self._log_dir, exist_ok=True)
        except OSError as error:
            return f"log_dir {self._log_dir} cannot be created: {error.strerror}. Choose another log_dir"
        if not os.access(self._log_dir, os.W_OK | os.X_OK):
            return f"log_dir {self._log_dir} is not writable: choose another log_dir, or make it writable"
        return ""

    def opened(self, effect: effects.RunOpened, utc: float) -> None:
        """A run has begun."""
        name = log_name(utc, effect.team, effect.robot, effect.round, effect.run, self._box_uuid)
        path = unused(os.path.join(self._log_dir, name), effect.port, self._used)
        self._used.add(path)
        self.files[effect.port] = path

    def resumed(self, port: int, path: str) -> None:
        """A run continues after a restart; `path` was that of its log, empty if unknown."""
        name = os.path.basename(path) or log_name(time.time(), f"port{port}", "", 0, 0, self._box_uuid)
        self.files[port] = os.path.join(self._log_dir, name)

    def closed(self, effect: effects.RunClosed) -> None:
        """A run is over, and the journal has it."""
        self._paths.put(self.files.pop(effect.port, None) or "")

    def make(self, paths: Iterable[str]) -> None:
        """Make those of the bags of earlier runs that are missing. `paths` are as the journal has them."""
        for path in paths:
            self._paths.put(os.path.join(self._log_dir, os.path.basename(path)))

    def stop(self) -> None:
        """Wait for the last bags for a while. Whatever is missing then is made after the next start."""
        self._paths.put(None)
        self._thread.join(STOP_S)

    # -- in the thread ------------------------------------------------------------------------------

    def _work(self) -> None:
        missing: List[str] = []
        reported: List[str] = []
        retry_s, is_over = RETRY_S, False
        while not is_over:
            found = self._wait(retry_s if missing else None)
            retry_s = RETRY_S if found else min(2.0 * retry_s, MOST_RETRY_S)
            is_over = None in found
            missing = [path for path in [*missing, *filter(None, found)] if not os.path.exists(path)]
            if not missing:
                continue
            problem = self._make()
            missing = [path for path in missing if not os.path.exists(path)]
            if problem and problem not in reported:
                reported.append(problem)
                self._on_problem(problem)
            elif not problem and not missing:
                for text in reported:
                    self._on_repaired(text, "The run logs are complete again")
                reported = []

    def _wait(self, limit_s: Optional[float]) -> List[Optional[str]]:
        """Return the paths that are new; empty: the time is over."""
        found: List[Optional[str]] = []
        try:
            found.append(self._paths.get(timeout=limit_s))
            while True:
                found.append(self._paths.get_nowait())
        except queue.Empty:
            return found

    def _make(self) -> str:
        """Make all missing bags; returns why that is not possible, with the remedy."""
        try:
            # In a session of its own: Ctrl-C, which ends the box, does not end it.
            done = subprocess.run(self._command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE, start_new_session=True, check=False)
        except OSError as error:  # the computer has no room for a process just now
            return f"The run logs cannot be made: {error}. The journal has all of them, and the box tries again"
        said = done.stderr.decode(errors="replace").strip().splitlines()
        if not done.returncode:
            return ""
        why = said[-1] if said else f"the program ended with status {done.returncode}"
        return f"The run logs cannot be made: {why}. The journal has all of them, and the box tries again"
