"""The copy on a standby: how far it is behind, what it costs the core, and how long a new one takes."""

import contextlib
import os
import pathlib
import re
import signal
import sqlite3
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

from roah_rsbb.journal import schema
from roah_rsbb.journal.file import FILE_NAME

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
# What the repetition `n` of a run adds to its columns. Each takes place after the others, on other ports.
_REPEATED = {
    "identity": "CASE identity WHEN '' THEN '' ELSE identity || ' ' || :n END", "port": "port + :n * :ports",
    **{column: f"{column} + :n * :seconds" for column in ("utc", "mono", "scheduled", "opened_utc", "closed_utc")},
}


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
        yield Standby(pathlib.Path(far), [node, follower])


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
        began = time.monotonic()
        with contextlib.closing(_opened(journal)) as near, standby(log_dir, passwords) as beside_it:
            far = beside_it.folder
            wait((far / FILE_NAME).exists, "the copy begins")
            with contextlib.closing(_opened(far / FILE_NAME)) as copy:
                wait(lambda: _runs(copy) == _runs(near), "the copy is complete", COPIED_S)
            return time.monotonic() - began


def repeat_runs(journal: pathlib.Path, times: int) -> None:
    """Let a journal have all its runs so many times, with all their entries."""
    with contextlib.closing(sqlite3.connect(journal, isolation_level=None)) as connection:
        connection.create_function("row_crc", -1, schema.row_crc, deterministic=True)
        connection.execute("PRAGMA synchronous = OFF")
        ports, seconds = connection.execute(
            "SELECT (SELECT max(port) FROM members), max(utc) - min(utc) + 60 FROM entries").fetchone()
        connection.execute("BEGIN")
        for table in ("entries", "links", "runs", "members"):
            connection.execute(f"CREATE TEMP TABLE first_{table} AS SELECT * FROM {table}")
            columns = schema.CHECKED[table]
            names = ", ".join(columns)
            changed = ", ".join(f"{_REPEATED.get(column, column)} AS {column}" for column in columns)
            for n in range(1, times):
                connection.execute(
                    f"INSERT INTO {table} ({names}, crc) SELECT {names}, row_crc({names})"
                    f" FROM (SELECT {changed} FROM temp.first_{table} ORDER BY rowid)",
                    {"n": n, "ports": ports, "seconds": seconds})
        connection.execute("COMMIT")


def _opened(path: pathlib.Path) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True, isolation_level=None, timeout=5.0,
                           check_same_thread=False)


def _newest(connection: sqlite3.Connection) -> int:
    return connection.execute("SELECT ifnull(max(id), 0) FROM entries").fetchone()[0]


def _runs(connection: sqlite3.Connection) -> int:
    """Return the number of runs, which are copied last."""
    return connection.execute("SELECT count(*) FROM members").fetchone()[0]
