"""The benchmarking modules of a box, in a process of their own.

Rules of a competition are Python code of others. They may loop, hold Python's lock, or end their process: none of this
reaches the box, whose STOP must not wait. A process that has ended, or says nothing any more, is replaced by the next
one, which gets all steps of the runs again (`model/modules.py`). The core pauses a run whose module is missing. A run
whose rules hang or end their process twice in succession is ended, because all others wait for it.

Both ends send JSON, an object in a line. To the process: {"runs": [`RunForModule`, …]}. From it: {"state":
`ModulesState`} and {"log": [level, text]}. The process leaves in two files which run it was in, and where (`Traces`).
"""

import argparse
import asyncio
import contextlib
import faulthandler
import json
import logging
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import IO, Any, Callable, Dict, List, Optional, Sequence, Set, Tuple, Type

from roah_rsbb.bmbox import framework
from roah_rsbb.bmbox import host as host_folder
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.rule_files import load_rules, refuse_ending, signature
from roah_rsbb.bmbox.host.dummy_world import DummyFrames
from roah_rsbb.bmbox.host.ground_truth_of_frames import Frames, NoFrames, ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost
from roah_rsbb.bmbox.host.limits import checked_state
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.model.as_json import BadData, from_json, to_json
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, RunForModule
from roah_rsbb.model.reason import Template, say

COMMAND = "modules"  # of `roah-rsbb`; not for users
# Seconds without a message, of which two come in a second; and until the first one, on a busy computer.
HUNG_S, START_S = 5.0, 30.0
LOOK_S = 0.5
# After which a process that hangs leaves its trace.
TRACE_S = 0.6 * HUNG_S
# Seconds between the end of a process and the next one.
PAUSE_S = 1.0
# Whose message ends a run in the place of a process that cannot.
OWN_NODE = "the box"
HUNG, CRASHED = say("its rules do not answer ({place})"), say("its rules end their process ({place})")
# What ends a process from outside: a person, or a computer whose memory is full.
_FROM_OUTSIDE = (-signal.SIGTERM, -signal.SIGKILL)
# For the process to end by itself, seconds.
END_S = 1.0

_log = logging.getLogger(__name__)


class ModulesProcess:
    """The process, seen from the box. Call everything in the thread of the box's loop: `start`, `take`, `close`."""

    def __init__(self, loop: asyncio.AbstractEventLoop, command: Sequence[str],
                 on_state: Callable[[ModulesState], object]) -> None:
        """`command` starts the process: see `modules_command`. `on_state` is called in the loop's thread."""
        self._loop, self._on_state = loop, on_state
        self._command, self._traces = list(command), Traces("")
        self._hung: Optional[subprocess.Popen[str]] = None  # the process that was ended last, because it hung
        self._without: Set[str] = set()  # rules that ended a process while it loaded them: see `_RulesFiles`
        self._blamed = ""  # the run in which that one was; empty: it is not known
        self._process: Optional[subprocess.Popen[str]] = None
        self._silent_s, self._most_s = 0.0, START_S  # how long it said nothing, while this process ran, and the most
        self._looked_mono = 0.0
        self._swept: Optional[subprocess.Popen[str]] = None  # the process that ended last, with what it started
        self._said = "", ModulesState("", (), ())  # the last state, as it was read and as it was taken
        self._news = threading.Condition()
        self._runs: Sequence[RunForModule] = ()
        self._is_sent = True  # the process has the runs
        self._is_closed = False
        self._timer: Optional[asyncio.TimerHandle] = None

    def start(self) -> None:
        """Start the process."""
        with contextlib.suppress(OSError):  # on a full disk, the process leaves no traces
            self._traces = Traces(tempfile.mkdtemp(prefix="roah_rsbb_modules_"))
        self._command.append(f"--traces={self._traces.folder}")
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
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(END_S)  # its input has ended
            linux.end_with_children(self._process)
            self._process.wait()
        self._traces.remove()

    def _look(self) -> None:
        """End a process that says nothing, and what is left of one that has ended."""
        self._timer = self._loop.call_later(LOOK_S, self._look)
        process, now_mono = self._process, time.monotonic()
        self._silent_s += min(now_mono - self._looked_mono, 2 * LOOK_S)
        self._looked_mono = now_mono
        if process is None:
            return
        is_hung = process.poll() is None and self._silent_s > self._most_s
        if is_hung:
            self._hung = process
        if is_hung or (process.poll() is not None and process is not self._swept):
            self._swept = process
            linux.end_with_children(process)

    def _serve(self) -> None:
        """In a thread: keep a process."""
        while not self._is_closed:
            try:
                status = self._run_one()
            except OSError as error:  # the computer has no room for a process just now
                _log.error("The benchmarking modules cannot be started: %s", error)
            else:
                if not self._is_closed:
                    self._say_gone(self._said[1].node)
                    if self._process is self._hung:
                        self._blame(HUNG, "do not answer")
                    elif status not in _FROM_OUTSIDE and self._traces.entered():
                        self._blame(CRASHED, f"end their process with status {status}")
                    else:
                        _log.error("The process of the benchmarking modules has ended (%s): the next one continues",
                                   status)
            if not self._is_closed:
                time.sleep(PAUSE_S)

    def _run_one(self) -> int:
        """Start a process, and read what it sends; returns its exit status. Raises OSError."""
        self._silent_s, self._most_s = 0.0, START_S
        # In a session of its own: what rules start ends with them, and no key of a terminal stops them.
        process = self._process = subprocess.Popen(
            [*self._command, *(f"--without={word}" for word in self._without)], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, text=True, encoding="utf-8", start_new_session=True)
        with self._news:
            self._is_sent = False
            self._news.notify_all()
        assert process.stdout is not None, "it is a pipe"
        for line in process.stdout:
            self._silent_s, self._most_s = 0.0, HUNG_S
            self._take_line(line)
        return process.wait()

    def _blame(self, why: Template, said: str) -> None:
        """Say whose rules hung or ended their process, and end their run if they did so before."""
        entered = self._traces.entered()
        if entered.startswith(_LOADING):
            file = entered[len(_LOADING):]
            self._without.add(_file_word(file))
            _log.error("The rules in %s %s while they are loaded: they are left out until the file is changed", file,
                       said)
            return
        run = next((run for run in self._runs if run.run == entered), None)
        whose, place = "a benchmark" if run is None else f"{run.benchmark} in zone {run.zone}", self._traces.place()
        _log.error("The rules of %s %s (%s): the next process continues", whose, said, place)
        before, self._blamed = self._blamed, "" if run is None else run.run
        if run is not None and run.running and run.run == before:
            self._take(ModulesState(OWN_NODE, (ModuleInfo(run.benchmark, zone=run.zone),), (
                Progress(run.run, run.attempt, failed=why(place=place)),)))
            self._say_gone(OWN_NODE)

    def _say_gone(self, node: str) -> None:
        """The box need not wait until it misses this process."""
        self._take(ModulesState(node, (), ()))

    def _take(self, state: ModulesState) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._on_state, state)

    def _take_line(self, line: str) -> None:
        try:
            if line != self._said[0]:  # most lines repeat the one before
                found = json.loads(line)
                if "log" in found:
                    level, text = found["log"]
                    _log.log(int(level), "%s", text)
                    return
                self._said = line, checked_state(from_json(ModulesState, found["state"]))
            self._take(self._said[1])
        except (BadData, ValueError, TypeError, KeyError) as error:
            _log.error("The process of the benchmarking modules sent what cannot be read: %s", error)

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
                process.stdin.write(json.dumps({"runs": [to_json(run) for run in runs]}) + "\n")
                process.stdin.flush()
            except OSError:  # it has just ended
                if self._is_closed:
                    return


class Traces:
    """What a process leaves that hangs or crashes: written by itself, and read by the box when it has ended. On a full
    disk it leaves nothing."""

    _BYTES = 4096  # of the identity of a run, or of a path
    _FRAME = re.compile(r'^  File "(.+)", line (\d+) in (.+)$', re.MULTILINE)
    # What rules call comes before them in a trace, and what calls them after.
    _OTHERS = ("<", *(os.path.dirname(str(file)) for file in (
        os.__file__, __file__, host_folder.__file__, framework.__file__)))

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self._run_file, self._place_file = pathlib.Path(folder, "run"), pathlib.Path(folder, "place")
        self._run, self._entered = -1, ""
        self._place: Optional[IO[str]] = None

    def open(self) -> None:
        """In the process: begin."""
        if not self.folder:
            return
        with contextlib.suppress(OSError):
            self._place = self._place_file.open("w", encoding="utf-8")
            self._run = os.open(str(self._run_file), os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o600)
            faulthandler.enable(self._place)
        self.live()

    def enter(self, run: str) -> str:
        """In the process: the rules of this run are called now. Returns what was entered before."""
        before, self._entered = self._entered, run
        with contextlib.suppress(OSError):
            os.pwrite(self._run, run.encode()[:self._BYTES].ljust(self._BYTES), 0)
        return before

    def live(self) -> None:
        """In the process: it does not hang. If this is not called again in time, it writes where it is, also while
        rules hold Python's lock."""
        if self._place is not None:
            faulthandler.dump_traceback_later(TRACE_S, file=self._place)

    def entered(self) -> str:
        """The run whose rules were called last; empty: none were."""
        with contextlib.suppress(OSError):
            return self._run_file.read_text("utf-8", "replace").rstrip()
        return ""

    def place(self) -> str:
        """Where the process was, in words: the line of the rules, if they were called."""
        frames = []
        with contextlib.suppress(OSError):
            found = self._place_file.read_text("utf-8", "replace")
            frames = self._FRAME.findall(found[max(map(found.rfind, ("Timeout (", "Fatal Python error"))):])
        of_rules = [frame for frame in frames if not frame[0].startswith(self._OTHERS)]
        for file, line, function in (*of_rules, *frames):
            return f"{os.path.basename(file)}, line {line}, {function}"
        return "it is not known where"

    def remove(self) -> None:
        """In the box: they are no longer needed."""
        shutil.rmtree(self.folder, ignore_errors=True)


def modules_command(folder: str, benchmarks: Optional[Sequence[str]], is_dummy: bool,
                    program: Sequence[str] = ()) -> List[str]:
    """Return the command that starts the process. `benchmarks`: None: all. `is_dummy`: a simulated motion-capture
    system sees what the rules ask for. `program`: one that calls `main` with other frames."""
    return [*(program or without_ros(COMMAND)), folder, *(["--dummy"] if is_dummy else []),
            *([] if benchmarks is None else [f"--codes={','.join(benchmarks)}"])]


# In place of a run: the file of rules that is being loaded.
_LOADING = "loading "


def _file_word(path: str) -> str:
    """A word for a file as it is now."""
    return f"{'-'.join(map(str, signature(path)))}:{path}"


# -- in the process ---------------------------------------------------------------------------------


class _RulesFiles:
    """Loads files of rules. One that ended a process before, and has not changed since, is an error."""

    def __init__(self, traces: Traces, without: Sequence[str]) -> None:
        self._traces, self._without = traces, frozenset(without)

    def load(self, path: str) -> Type[Module]:
        """Load a file; raises ConfigErrors."""
        if _file_word(path) in self._without:
            refuse_ending(path)
        before = self._traces.enter(f"{_LOADING}{path}")
        try:
            return load_rules(path)
        finally:
            self._traces.enter(before)


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


def main(arguments: Optional[List[str]] = None, make_frames: Callable[[], Frames] = NoFrames) -> None:
    """Run the modules until the input ends. `make_frames` makes the frames of a motion-capture system."""
    parser = argparse.ArgumentParser(prog=COMMAND, description="Runs the rules of benchmarks for a box.")
    parser.add_argument("folder")
    parser.add_argument("--codes", type=lambda text: text.split(","))
    parser.add_argument("--dummy", action="store_true")
    parser.add_argument("--traces", required=True)
    parser.add_argument("--without", action="append", default=[])
    options = parser.parse_args(arguments)
    linux.end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the box ends this process
    reading, writing = _private_streams()
    output = _Output(writing)
    logging.basicConfig(level=logging.INFO, handlers=[output], format="%(message)s")
    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    traces = Traces(options.traces)
    traces.open()

    def send(state: ModulesState) -> None:
        traces.live()
        output.send({"state": to_json(state)})

    host = ModulesHost(
        loop, options.folder, options.codes,
        ZonesGroundTruth(options.folder, DummyFrames if options.dummy else make_frames), send, on_enter=traces.enter,
        load=_RulesFiles(traces, options.without).load)

    def follow() -> None:
        for line in reading:
            runs = tuple(from_json(RunForModule, run) for run in json.loads(line)["runs"])
            loop.call_soon_threadsafe(host.take, runs)
        os._exit(0)  # whatever the rules do

    host.start()
    threading.Thread(target=follow, name="runs", daemon=True).start()
    loop.run_forever()
    sys.exit(1)
