"""Speed of the results program with a journal of many runs, which the real core writes in simulated time."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import Dict, List, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "test" / "pure"))

from helpers.many_runs import write_journal  # noqa: E402

PROGRAM = ROOT / "scripts" / "results"
REPEATS = 3


class Taken(NamedTuple):
    """What a command took."""

    seconds: float
    memory_mb: float


def measure(runs: int, commands: Dict[str, List[str]], recovers: bool) -> Dict[str, Taken]:
    """Measure commands with a journal of so many runs; each is repeated, and the quickest counts. `recovers`: measure
    `recover`, too."""
    with tempfile.TemporaryDirectory() as folder:
        path = write_journal(folder, runs)
        megabytes = os.path.getsize(path) / 1e6
        found = {
            name: _command(["--journal", path, *words], folder, 1 if name == "report" else REPEATS)
            for name, words in commands.items()
        }
        if not recovers:
            return found
        new = os.path.join(folder, "recovered")
        taken = _command(["recover", path, new], folder, 1)
        found["recover, of 100 MB"] = taken._replace(seconds=taken.seconds * 100.0 / megabytes)
    return found


def _command(words: List[str], folder: str, repeats: int) -> Taken:
    taken = [_once([sys.executable, str(PROGRAM), *words], folder) for _ in range(repeats)]
    return Taken(min(each.seconds for each in taken), max(each.memory_mb for each in taken))


def _once(command: List[str], folder: str) -> Taken:
    began = time.monotonic()
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = status
    if status:
        raise SystemExit(f"bench: failed: {' '.join(command)}")
    return Taken(time.monotonic() - began, used.ru_maxrss / 1024.0)
