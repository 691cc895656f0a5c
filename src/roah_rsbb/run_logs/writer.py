"""Has the bags of runs made, one for each robot in a run, when the run is over (docs/ros_interface.md, "Run log").

Theory of operation. The journal has every entry of a run, and survives whatever happens. A bag is made of it at the
run's end by a process of low priority, `results bags --make`, so that neither the disk nor Python's lock delays the
box. It makes all bags that are missing: after a restart, a takeover or a full disk also earlier ones.
"""

import logging
import os
import queue
import subprocess
import threading
import time
from typing import Callable, Dict, Iterable, List, Optional, Set

from roah_rsbb.core import effects
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.run_logs.names import log_name, unused

# A bag that could not be made is tried again after this time, which doubles each time (s).
RETRY_S, MOST_RETRY_S = 2.0, 64.0
# Time limit for making the last bags when the box ends.
STOP_S = 5.0

_log = logging.getLogger(__name__)


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
