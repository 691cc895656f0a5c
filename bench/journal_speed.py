"""Speed of the journal: an event until it is on the disk, events a second, a start with many runs."""

import sys
import tempfile
import time
from typing import List, NamedTuple

import results_speed  # noqa: F401  (where the tests' helpers are)

from helpers.many_runs import write_journal
from roah_rsbb.journal.contents import open_journal
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.records import Batch, NewEntry
from roah_rsbb.journal.store import Journal

SESSION = CoreSession(1e9, 1.0, "boot", 1, "uuid", "")
COMPETITION = [["Home", "HNF", "Alpha", 1, 1, 0.0]]


class Appended(NamedTuple):
    """What events took."""

    durable_ms: List[float]  # of each of them, until it was on the disk
    per_second: float  # without waiting for the disk


def append(count: int) -> Appended:
    """Measure so many events one after the other, and ten times as many without waiting for the disk."""
    with tempfile.TemporaryDirectory() as folder:
        journal = Journal(folder, SESSION, COMPETITION, Resume.ALWAYS, lambda _: None)
        durable_ms = []
        for number in range(count):
            began = time.perf_counter()
            if journal.why_not_saved(journal.write(_event(number))):
                sys.exit("bench: the disk is too slow for the journal")
            durable_ms.append(1e3 * (time.perf_counter() - began))
        began = time.perf_counter()
        for number in range(10 * count):
            journal.write(_event(number))
        per_second = 10 * count / (time.perf_counter() - began)
        journal.close()
    return Appended(durable_ms, per_second)


def _event(number: int) -> Batch:
    entry = NewEntry(1e9 + number, 1.0 + number, "Home", "run", 6667, "/referee", "command", {"command": "x" * 100})
    return Batch(entries=[entry], states={"zone:Home": {"number": number, "text": "x" * 500}})


def start_s(runs: int) -> float:
    """Return how long a core's journal takes to open with so many runs."""
    with tempfile.TemporaryDirectory() as folder:
        competition = open_journal(write_journal(folder, runs)).contents.competition
        began = time.perf_counter()
        journal = Journal(folder, SESSION, competition, Resume.ALWAYS, lambda _: None)
        taken = time.perf_counter() - began
        found = len(journal.previous.outcomes)
        journal.close()
    if found < runs // 2:
        sys.exit(f"bench: only {found} of {runs} runs were found")
    return taken
