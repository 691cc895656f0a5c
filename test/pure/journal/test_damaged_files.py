"""Changed bits and lost sectors anywhere in a journal: it opens, nothing in it is wrong, and what is lost is named.

`make test` tries some hundred damaged journals, `make test-all` 20,000; a failure names the seed of its journal.
"""

import collections
import pathlib
import random
import re
import shutil

import pytest

from helpers.crash_states import in_memory
from helpers.damaged_files import damaged
from helpers.examples import ALL
from helpers.journals import UTC0, Writer
from roah_rsbb.journal.log import NEWEST, read_chain, scans
from roah_rsbb.journal.log_dir import JOURNAL, CoreSession, DamagedJournal, Resume
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.records import Batch
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import RunRecord

COUNT = 20_000 if ALL else 200
COMPETITION = [["Home", "HNF", "Alpha", 1, 1, 0.0]]
LIVES, RUNS = 3, 2


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A log_dir after its box ended; and the same when its box was killed."""
    whole, killed = (tmp_path_factory.mktemp(name) / "log" for name in ("whole", "killed"))
    for life in range(LIVES):
        writer = Writer(whole, COMPETITION)
        for run in range(life * RUNS, (life + 1) * RUNS):
            record = RunRecord(f"HNF-{6667 + run}-1.000", "Home", "HNF", "Alpha", 1, run, UTC0, UTC0 + run)
            writer.run(record, ((6667 + run, "r1"),))
            for i in range(8):
                writer.entry("notice", {"text": f"{i} " * (5 if i % 4 else 900)}, record.identity, "Home", 6667 + run)
                writer.link(LinkSample(0.1 * i), port=6667 + run)
                writer.journal.write(Batch(states={"zone:Home": {"run": run, "i": i, "text": "x" * 50}}))
                if i % 3 == 0:
                    assert writer.journal.why_not_saved(writer.journal.committed) == ""
            writer.outcome(record._replace(closed_utc=UTC0 + 900.0))
        if life == LIVES - 1:
            shutil.copytree(whole, killed)
        writer.close()
    return whole, killed


@pytest.fixture(scope="module")
def everything(folders):
    """All records of the journal by number, and all records of each run."""
    payloads = {frame.number: frame.payload for _, found in scans(read_chain(str(folders[0] / JOURNAL)).segments)
                for frame in found.records}
    reader = JournalReader(str(folders[0] / JOURNAL))
    assert reader.damage == []
    runs = {run.identity: run for run in reader.runs()}
    assert len(runs) == LIVES * RUNS and list(payloads) == list(range(1, len(payloads) + 1))
    return payloads, runs


def spoil(folder, chance, log_dir):
    """Copy a log_dir, and damage one of its files."""
    shutil.copytree(folder, log_dir)
    path = chance.choice([*sorted((log_dir / JOURNAL).iterdir()), log_dir / (JOURNAL + NEWEST)])
    path.write_bytes(damaged(path.read_bytes(), chance))
    if chance.random() < 0.05:
        path.unlink()


def check(path, everything):
    """Nothing in the journal is wrong, and what is missing is named unless it is at the end. Returns its damage."""
    payloads, runs = everything
    chain = read_chain(path)
    found = {frame.number: frame.payload for _, part in scans(chain.segments) for frame in part.records}
    assert found.items() <= payloads.items()
    reader = JournalReader(path)
    damage = reader.damage
    for run in reader.runs():
        assert run[:8] == runs[run.identity][:8] or not run.zone
        assert run.outcome in ({}, runs[run.identity].outcome) or run.closed_utc is None or damage
        assert reader.entries(run.identity) is not None
    named = {number for text in damage for match in re.finditer(r"records? (\d+)(?: to (\d+))? damaged", text)
             for number in range(int(match[1]), int(match[2] or match[1]) + 1)}
    missing = {number for number in payloads if number not in found and number < max(found, default=0)}
    assert missing <= named, (missing - named, damage)
    assert not named & set(found)
    return damage


def start(log_dir):
    """Start a core with it."""
    troubles = []
    session = CoreSession(UTC0 + 5000.0, 1.0, "boot", 1, "uuid", "")
    journal = Journal(str(log_dir), session, COMPETITION, Resume.ALWAYS, troubles.append)
    journal.close()
    assert not any(troubles), troubles
    return journal


def trial(folders, everything, chance, folder):
    """Read a damaged journal, then start a core with it; returns what happened."""
    log_dir = folder / "log"
    spoil(chance.choice(folders), chance, log_dir)
    path = str(log_dir / JOURNAL)
    try:
        damage = check(path, everything)
        yield "whole" if not damage else "damaged"
    except JournalError as error:
        assert "no journal that can be read" in str(error)
        damage = ["all"]
        yield "unreadable"
    before = {file.name: file.read_bytes() for file in pathlib.Path(path).iterdir()}
    try:
        journal = start(log_dir)
    except DamagedJournal:
        yield "not started"
    else:
        assert journal.previous.outcomes, f"an empty competition: {journal.warnings}"
        yield "started with a warning" if journal.warnings else "started"
    after = {file.name: file.read_bytes() for file in pathlib.Path(path).iterdir()}
    assert before.items() <= after.items(), "what was there is untouched"


@pytest.mark.long
def test_changed_bits_and_lost_sectors(folders, everything):
    """A core that is started with the journal continues with what there is, or refuses to begin an empty one."""
    outcomes = collections.Counter()
    for seed in range(COUNT):
        with in_memory() as folder:
            try:
                outcomes.update(trial(folders, everything, random.Random(seed), folder))
            except Exception:
                print(f"seed {seed}")
                raise
    print(outcomes)
    assert outcomes["damaged"] > 0.7 * COUNT
    assert outcomes["not started"] < 0.01 * COUNT
