"""Speed of the results program with a journal of many runs, which the real core writes in simulated time."""

import contextlib
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
SAMPLE_S = 0.2  # from one look at the memory to the next


class Taken(NamedTuple):
    """What a command took."""

    seconds: float
    memory_mb: float  # of all its processes at the same time


def measure(runs: int, commands: Dict[str, List[str]]) -> Dict[str, Taken]:
    """Measure commands with a journal of so many runs; each is repeated, and the quickest counts."""
    with tempfile.TemporaryDirectory() as folder:
        path = write_journal(folder, runs)
        return {
            name: _command(["--journal", path, *words], folder, 1 if name == "report" else REPEATS)
            for name, words in commands.items()
        }


def _command(words: List[str], folder: str, repeats: int) -> Taken:
    taken = [_once([sys.executable, str(PROGRAM), *words], folder) for _ in range(repeats)]
    return Taken(min(each.seconds for each in taken), max(each.memory_mb for each in taken))


def _once(command: List[str], folder: str) -> Taken:
    began = time.monotonic()
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL)
    most_kb = 0.0
    while process.poll() is None:
        most_kb = max(most_kb, _memory_kb(process.pid))
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(SAMPLE_S)
    if process.returncode:
        raise SystemExit(f"bench: failed: {' '.join(command)}")
    return Taken(time.monotonic() - began, most_kb / 1024.0)


def _memory_kb(pid: int) -> float:
    """Return the memory of a process and its children; what they share counts once."""
    found = 0.0
    with contextlib.suppress(OSError):  # it has ended
        lines = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        found = sum(float(line.split()[1]) for line in lines if line.startswith("Pss:"))
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        found += sum(_memory_kb(int(child)) for child in children)
    return found
