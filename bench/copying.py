"""The copy on a standby: how far it is behind, what it costs the core, and how long a new one takes."""

import contextlib
import pathlib
import re
import sqlite3
import tempfile
import threading
import time
from typing import Dict, Iterator, List, NamedTuple

import reaction
import results_speed
from addresses import BOX_HOST, BROADCAST
from fleet import Fleet
from processes import ROOT, Box, Measured, wait

from roah_rsbb.journal.file import FILE_NAME

STANDBY_HOST = "127.0.0.3"
PORT = 9983  # below the ports of boxes
ZONES = 20
TURNS = 3
# From one look at both journals to the next.
LOOK_S = 0.002
COPIED_S = 600.0


class Cost(NamedTuple):
    """What was measured with or without a standby, in all turns."""

    core_percent: float
    reaction_ms: List[float]


@contextlib.contextmanager
def standby(log_dir: pathlib.Path, passwords: pathlib.Path) -> Iterator[pathlib.Path]:
    """A standby of the box that has its journal there, in two processes as usual; yields the folder of the copy."""
    with tempfile.TemporaryDirectory(prefix="roah_rsbb_bench.") as far, contextlib.ExitStack() as cleanup:
        settings: Dict[str, object] = {"log_dir": log_dir, "standby_port": PORT, "bind_host": BOX_HOST,
                                       "rsbb_host": BROADCAST, "passwords_file": passwords}
        node = Measured(str(ROOT / "scripts" / "roah_rsbb_backup"), *(f"_{k}:={v}" for k, v in settings.items()))
        cleanup.callback(node.close)
        wait(lambda: "with the code" in node.text, "the box shows a code")
        code = re.search("with the code ([A-Z0-9-]+)", node.text).group(1)
        follower = Measured(str(ROOT / "scripts" / "standby"), "follow", BOX_HOST, "--port", str(PORT), "--code", code,
                            "--log-dir", far, f"bind_host:={STANDBY_HOST}")
        cleanup.callback(follower.close)
        wait(lambda: "The copy is kept" in follower.text, "the standby is connected", COPIED_S)
        yield pathlib.Path(far)


class Lag:
    """Measures, in a thread, the time from each entry in the journal to the same entry in the copy."""

    def __init__(self, near: pathlib.Path, far: pathlib.Path) -> None:
        self.taken_ms: List[float] = []
        self._paths = near / FILE_NAME, far / FILE_NAME
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()

    def _work(self) -> None:
        with contextlib.ExitStack() as cleanup:
            near, far = (cleanup.enter_context(contextlib.closing(_opened(path))) for path in self._paths)
            wait(lambda: _newest(far) >= _newest(near) - 1, "the copy is complete", COPIED_S)
            waiting: Dict[int, float] = {}
            known = _newest(near)
            while not self._ended.wait(LOOK_S):
                now, newest = time.monotonic(), _newest(near)
                waiting.update((number, now) for number in range(known + 1, newest + 1))
                known, copied = newest, _newest(far)
                for number in [number for number in waiting if number <= copied]:
                    self.taken_ms.append((time.monotonic() - waiting.pop(number)) * 1e3)


def beside(box: Box, fleet: Fleet, probes: int) -> Dict[bool, Cost]:
    """Return what the core costs and how fast it reacts, with a standby (True) and without, in turns, and what is
    behind."""
    taken: Dict[bool, List[float]] = {False: [], True: []}
    cpu_s, seconds = dict.fromkeys(taken, 0.0), dict.fromkeys(taken, 0.0)
    for has_standby in [False, True] * TURNS:
        with standby(box.log_dir, box.passwords) if has_standby else contextlib.nullcontext():
            began, used = time.monotonic(), box.process.cpu_s()
            taken[has_standby] += reaction.react(fleet, fleet.robots, probes // TURNS)
            cpu_s[has_standby] += box.process.cpu_s() - used
            seconds[has_standby] += time.monotonic() - began
    return {key: Cost(100.0 * cpu_s[key] / seconds[key], taken[key]) for key in taken}


def lag_ms(box: Box, fleet: Fleet, seconds: float, period_s: float) -> List[float]:
    """Return how far the copy of each entry was behind while all robots send and two referees press buttons."""
    fleet.keep_sending(period_s)
    with standby(box.log_dir, box.passwords) as far:
        lag = Lag(box.log_dir, far)
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
        journal = pathlib.Path(results_speed.write_journal(folder, runs))
        passwords = log_dir / "passwords.yaml"
        passwords.write_text("Team: password\n")
        began = time.monotonic()
        with contextlib.closing(_opened(journal)) as near, standby(log_dir, passwords) as far:
            wait((far / FILE_NAME).exists, "the copy begins")
            with contextlib.closing(_opened(far / FILE_NAME)) as copy:
                wait(lambda: _runs(copy) == _runs(near), "the copy is complete", COPIED_S)
            return time.monotonic() - began


def _opened(path: pathlib.Path) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True, isolation_level=None, timeout=5.0,
                           check_same_thread=False)


def _newest(connection: sqlite3.Connection) -> int:
    return connection.execute("SELECT ifnull(max(id), 0) FROM entries").fetchone()[0]


def _runs(connection: sqlite3.Connection) -> int:
    """Return the number of runs, which are copied last."""
    return connection.execute("SELECT count(*) FROM members").fetchone()[0]
