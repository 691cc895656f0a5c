"""The copy on a standby: how far it is behind, what it costs the core, and how long a new one takes."""

import contextlib
import os
import pathlib
import signal
import statistics
import tempfile
import threading
import time
from typing import Dict, Iterator, List, NamedTuple

import reaction
import results_speed
from addresses import BOX_HOST, BROADCAST
from fleet import Fleet
from processes import ROOT, Box, Measured, wait

from roah_rsbb.box.program.supervisor import COPIES
from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.journal import log
from roah_rsbb.journal.contents import open_journal
from roah_rsbb.journal.copy_folder import CannotReadJournal
from roah_rsbb.journal.copy_follower import CopySettings, JournalSegments
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.standby.pairing import make_code

STANDBY_HOST = "127.0.0.3"
PORT = 9983  # below the ports of boxes
ZONES = 20
# In turns of about two seconds: in longer ones, the rest of the machine changes what the core costs.
PROBES_PER_TURN = 15
TURNS = 10
# From one look at both journals to the next.
LOOK_S = 0.002
COPIED_S = 600.0


# Runs that the core writes itself. More are made of these: it would take minutes.
WRITTEN_RUNS = 1000
# Records that are handed to the disk together.
TOGETHER = 10_000


class Standby(NamedTuple):
    """A standby."""

    folder: pathlib.Path  # of the copy
    processes: List[Measured]  # on the box and on the second computer

    def signal(self, number: int) -> None:
        """Send a signal to its processes."""
        for process in self.processes:
            os.kill(process.pid, number)


class Cost(NamedTuple):
    """What was measured beside a standby that works or is stopped, in all turns."""

    core_percent: float
    reaction_ms: List[float]


@contextlib.contextmanager
def standby(log_dir: pathlib.Path, passwords: pathlib.Path) -> Iterator["Standby"]:
    """A standby of the box that has its journal there, in two processes as usual."""
    with tempfile.TemporaryDirectory(prefix="roah_rsbb_bench.") as far, contextlib.ExitStack() as cleanup:
        settings = CopySettings(str(log_dir), "", PORT, BOX_HOST, str(passwords), BROADCAST, 6666, "")
        copying = Measured(*without_ros(COPIES, *settings.words))
        cleanup.callback(copying.close)
        wait(lambda: "For a code, enter" in copying.text, "a standby can be paired")
        code = make_code(str(log_dir))
        follower = Measured(str(ROOT / "scripts" / "standby"), "follow", BOX_HOST, "--port", str(PORT), "--code", code,
                            "--log-dir", far, f"bind_host:={STANDBY_HOST}")
        cleanup.callback(follower.close)
        wait(lambda: "is connected from" in copying.text, "the standby is connected", COPIED_S)
        yield Standby(pathlib.Path(far), [copying, follower])


class Lag:
    """Measures, in a thread, the time from each record in the journal to the same record in the copy."""

    def __init__(self, near: pathlib.Path, far: pathlib.Path) -> None:
        self.taken_ms: List[float] = []
        self._near, self._far = (JournalSegments(str(folder / JOURNAL)) for folder in (near, far))
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()

    def _work(self) -> None:
        known = _bytes(self._near)
        wait(lambda: _bytes(self._far) >= known, "the copy is complete", COPIED_S)
        known, waiting = _bytes(self._near), []
        while not self._ended.wait(LOOK_S):
            now, size = time.monotonic(), _bytes(self._near)
            if size > known:
                known = size
                waiting.append((size, now))
            copied = _bytes(self._far)
            while waiting and waiting[0][0] <= copied:
                self.taken_ms.append((time.monotonic() - waiting.pop(0)[1]) * 1e3)


def beside(box: Box, fleet: Fleet, probes: int) -> Dict[bool, Cost]:
    """Return what the core costs and how fast it reacts beside a standby, while this works (True) and while it is
    stopped, in turns."""
    taken: Dict[bool, List[float]] = {False: [], True: []}
    percents: Dict[bool, List[float]] = {False: [], True: []}
    with standby(box.log_dir, box.passwords) as beside_it:
        for works in [False, True] * max(TURNS, probes // PROBES_PER_TURN):
            beside_it.signal(signal.SIGCONT if works else signal.SIGSTOP)
            began, used = time.monotonic(), box.process.cpu_s()
            taken[works] += reaction.react(fleet, fleet.robots, PROBES_PER_TURN)
            percents[works].append(100.0 * (box.process.cpu_s() - used) / (time.monotonic() - began))
    return {key: Cost(statistics.mean(percents[key]), taken[key]) for key in taken}


def lag_ms(box: Box, fleet: Fleet, seconds: float, period_s: float) -> List[float]:
    """Return how far the copy of each entry was behind while all robots send and two referees press buttons."""
    fleet.keep_sending(period_s)
    with standby(box.log_dir, box.passwords) as beside_it:
        lag = Lag(box.log_dir, beside_it.folder)
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            for zone in (0, 1):
                box.command("stop", zone)
                box.command_when_allowed("start", zone)
        lag.close()
    return lag.taken_ms


def paired_again_s(runs: int) -> float:
    """Return how long a new standby of a box with so many runs takes until its copy is complete."""
    with tempfile.TemporaryDirectory(prefix="roah_rsbb_bench.") as folder:
        log_dir = pathlib.Path(folder)
        journal = pathlib.Path(results_speed.write_journal(folder, min(runs, WRITTEN_RUNS)))
        repeat_runs(journal, runs // WRITTEN_RUNS)
        passwords = log_dir / "passwords.yaml"
        passwords.write_text("Team: password\n")
        near = JournalSegments(str(journal))
        began = time.monotonic()
        with standby(log_dir, passwords) as beside_it:
            far = JournalSegments(str(beside_it.folder / JOURNAL))
            wait(lambda: _bytes(far) == _bytes(near), "the copy is complete", COPIED_S)
            return time.monotonic() - began


def repeat_runs(journal: pathlib.Path, times: int) -> None:
    """Let a journal have all its records so many times. Their bytes are copied, whatever they mean."""
    opened = open_journal(str(journal))
    payloads = [frame.payload for _, found in log.scans(opened.segments) for frame in found.records]
    longer = log.Log(str(journal), opened.contents.summary, lambda *_: None)
    longer.continue_after(opened.segments, opened.newest)
    longer.begin()
    for number, payload in enumerate(payloads * (times - 1)):
        longer.append(payload)
        if number % TOGETHER == 0:
            longer.write()
            longer.sync()
    longer.write()
    longer.sync()
    longer.close()


def _bytes(journal: JournalSegments) -> int:
    """Return the size of a journal; 0 if there is none yet."""
    try:
        return sum(journal.sizes().values())
    except CannotReadJournal:
        return 0
