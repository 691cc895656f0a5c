"""The benchmarking modules of a box without ROS, in a process of their own.

Rules of a competition are Python code of others. They may loop, hold Python's lock, or end their process: none of this
reaches the box, whose STOP must not wait. A process that has ended, or says nothing any more, is replaced by the next
one, which gets all steps of the runs again (`model/modules.py`). The core pauses a run whose module is missing.

Both ends send JSON, an object in a line. To the process: {"runs": [`RunForModule`, …]}. From it: {"state":
`ModulesState`} and {"log": [level, text]}.
"""

import argparse
import asyncio
import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time
from typing import IO, Any, Callable, Dict, List, Optional, Sequence, Tuple

from roah_rsbb import platform
from roah_rsbb.arguments import without_ros
from roah_rsbb.bmbox.host.dummy_frames import DummyFrames
from roah_rsbb.bmbox.host.ground_truth_of_frames import NoFrames, ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost
from roah_rsbb.bmbox.host.limits import checked_state
from roah_rsbb.model.modules import ModulesState, RunForModule
from roah_rsbb.model.saved import BadState, freeze, thaw

COMMAND = "modules"  # of `roah-rsbb`; not for users
# Seconds without a message, of which two come in a second; and until the first one, on a busy computer.
HUNG_S, START_S = 5.0, 30.0
LOOK_S = 0.5
# Seconds between the end of a process and the next one.
PAUSE_S = 1.0
# For the process to end by itself, seconds.
END_S = 1.0

_log = logging.getLogger(__name__)


class ModulesProcess:
    """The process, seen from the box. Call everything in the thread of the box's loop: `start`, `take`, `close`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, command: Sequence[str],
                 on_state: Callable[[ModulesState], object]) -> None:
        """`command` starts the process: see `modules_command`. `on_state` is called in the loop's thread."""
        self._loop, self._command, self._on_state = loop, command, on_state
        self._process: Optional[subprocess.Popen[str]] = None
        self._silent_mono = 0.0  # from when on a silence is too long
        self._said = "", ModulesState("", (), ())  # the last state, as it was read and as it was taken
        self._news = threading.Condition()
        self._runs: Sequence[RunForModule] = ()
        self._is_sent = True  # the process has the runs
        self._is_closed = False
        self._timer: Optional[asyncio.TimerHandle] = None

    def start(self) -> None:
        """Start the process."""
        for work in (self._serve, self._write):
            threading.Thread(target=work, name="benchmarking modules", daemon=True).start()
        self._look()

    def take(self, runs: Sequence[RunForModule]) -> None:
        """Hand the present runs over. While the process is busy, only the newest ones wait."""
        with self._news:
            self._runs, self._is_sent = runs, False
            self._news.notify_all()

    def close(self) -> None:
        """End the process."""
        with self._news:
            self._is_closed = True
            self._news.notify_all()
        if self._timer is not None:
            self._timer.cancel()
        if self._process is not None:
            try:
                self._process.wait(END_S)  # its input has ended
            except subprocess.TimeoutExpired:
                self._process.kill()

    def _look(self) -> None:
        """End a process that says nothing."""
        self._timer = self._loop.call_later(LOOK_S, self._look)
        process = self._process
        if process is not None and time.monotonic() > self._silent_mono and process.poll() is None:
            _log.error("The rules of a benchmark do not answer: their process is ended, and the next one continues")
            process.kill()

    def _serve(self) -> None:
        """In a thread: keep a process."""
        while not self._is_closed:
            try:
                status = self._run_one()
            except OSError as error:  # the computer has no room for a process just now
                _log.error("The benchmarking modules cannot be started: %s", error)
            else:
                if not self._is_closed:
                    _log.error("The process of the benchmarking modules has ended (%s): the next one continues", status)
            if not self._is_closed:
                time.sleep(PAUSE_S)

    def _run_one(self) -> int:
        """Start a process, and read what it sends; returns its exit status. Raises OSError."""
        self._silent_mono = time.monotonic() + START_S
        process = self._process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8")
        with self._news:
            self._is_sent = False
            self._news.notify_all()
        assert process.stdout is not None, "it is a pipe"
        for line in process.stdout:
            self._silent_mono = time.monotonic() + HUNG_S
            self._take_line(line)
        return process.wait()

    def _take_line(self, line: str) -> None:
        try:
            if line != self._said[0]:  # most lines repeat the one before
                found = json.loads(line)
                if "log" in found:
                    level, text = found["log"]
                    _log.log(int(level), "%s", text)
                    return
                self._said = line, checked_state(thaw(ModulesState, found["state"]))
            self._loop.call_soon_threadsafe(self._on_state, self._said[1])
        except (BadState, ValueError, TypeError, KeyError) as error:
            _log.error("The process of the benchmarking modules sent what cannot be read: %s", error)
        except RuntimeError:  # the loop has ended
            pass

    def _write(self) -> None:
        """In a thread: send the newest runs, and end the input at last."""
        while True:
            with self._news:
                self._news.wait_for(lambda: self._is_closed or (not self._is_sent and self._process is not None))
                process, runs, self._is_sent = self._process, self._runs, True
            try:
                if self._is_closed:
                    if process is not None and process.stdin is not None:
                        process.stdin.close()
                    return
                assert process is not None and process.stdin is not None, "it is waited for"
                process.stdin.write(json.dumps({"runs": [freeze(run) for run in runs]}) + "\n")
                process.stdin.flush()
            except OSError:  # it has just ended
                if self._is_closed:
                    return


def modules_command(folder: str, benchmarks: Optional[Sequence[str]], is_dummy: bool) -> List[str]:
    """Return the command that starts the process. `benchmarks`: None: all. `is_dummy`: a simulated motion-capture
    system sees what the rules ask for."""
    return without_ros(COMMAND, folder, *(["--dummy"] if is_dummy else []),
                       *([] if benchmarks is None else [f"--codes={','.join(benchmarks)}"]))


# -- in the process ---------------------------------------------------------------------------------


class _Output(logging.Handler):
    """What is sent to the box; also the lines of the log."""

    def __init__(self, file: IO[str]) -> None:
        super().__init__()
        self._file = file

    def send(self, message: Dict[str, Any]) -> None:
        with self.lock:  # type: ignore[union-attr]
            self._file.write(json.dumps(message) + "\n")
            self._file.flush()

    def emit(self, record: logging.LogRecord) -> None:
        self.send({"log": [record.levelno, self.format(record)]})


def _private_streams() -> Tuple[IO[str], IO[str]]:
    """Take the standard input and output, so that rules that print or read disturb nothing."""
    reading, writing = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return os.fdopen(reading, "r", encoding="utf-8"), os.fdopen(writing, "w", encoding="utf-8")


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the modules until the input ends."""
    parser = argparse.ArgumentParser(prog=COMMAND, description="Runs the rules of benchmarks for a box.")
    parser.add_argument("folder")
    parser.add_argument("--codes", type=lambda text: text.split(","))
    parser.add_argument("--dummy", action="store_true")
    options = parser.parse_args(arguments)
    platform.end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the box ends this process
    reading, writing = _private_streams()
    output = _Output(writing)
    logging.basicConfig(level=logging.INFO, handlers=[output], format="%(message)s")
    loop = platform.new_loop()
    asyncio.set_event_loop(loop)
    host = ModulesHost(
        loop, options.folder, options.codes,
        ZonesGroundTruth(options.folder, DummyFrames if options.dummy else NoFrames),
        lambda state: output.send({"state": freeze(state)}))

    def follow() -> None:
        for line in reading:
            runs = tuple(thaw(RunForModule, run) for run in json.loads(line)["runs"])
            loop.call_soon_threadsafe(host.take, runs)
        os._exit(0)  # whatever the rules do

    host.start()
    threading.Thread(target=follow, name="runs", daemon=True).start()
    loop.run_forever()
    sys.exit(1)
