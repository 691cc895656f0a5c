"""Cores that are killed at random moments, one after the other: what one of them has written is there for the next.

`make test` kills 10 of them, `make test-all` 500.
"""

import json
import os
import random
import select
import signal
import subprocess
import sys

import pytest

from helpers.examples import ALL
from roah_rsbb.journal.reader import JournalReader

KILLS = 500 if ALL else 10
SEED = os.environ.get("ROAH_TEST_SEED", "1")
# Writes events and announces the number of each when `write` has returned.
PROGRAM = """
import itertools, json, sys
sys.path[:] = json.loads(sys.argv[2])
import roah_rsbb
roah_rsbb.__path__ = json.loads(sys.argv[3])
from roah_rsbb.journal import log, store
from roah_rsbb.journal.records import Batch, Member, NewEntry
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.store import Journal
log.FULL_BYTES, store.WRITE_S = 100_000, 60.0
troubles = []
session = CoreSession(1e9, 1.0, "boot", 1, "uuid", "")
journal = Journal(sys.argv[1], session, [["Home", "HNF", "Alpha", 1, 1, 0.0]], Resume.ALWAYS, troubles.append)
state = journal.previous.states.get("zone:Home", {"n": 0})
print(json.dumps([state["n"], journal.warnings, troubles]), flush=True)
for number in itertools.count(state["n"] + 1):
    state = {"n": number, "last": [*state.get("last", ())[-5:], number]}
    entry = NewEntry(1e9 + number, 1.0, "Home", "run", 6667, "", "notice", number)
    ticket = journal.write(Batch([entry], members=[Member(6667, "run", "Alpha", "r1")], states={"zone:Home": state}))
    print(number, flush=True)
    if number % 7 == 0:
        assert not journal.why_not_saved(ticket)
"""


@pytest.mark.long
@pytest.mark.random
def test_what_was_written_is_there(tmp_path):
    import roah_rsbb

    chance, written = random.Random(SEED), 0
    command = [sys.executable, "-c", PROGRAM, str(tmp_path), json.dumps(sys.path), json.dumps(list(roah_rsbb.__path__))]
    for kill in range(KILLS):
        process = subprocess.Popen(command, stdout=subprocess.PIPE)
        found, warnings, troubles = json.loads(process.stdout.readline())
        assert (warnings, troubles) == ([], []), f"after {kill} kills"
        assert found >= written, f"after {kill} kills, {found} events of {written} are left"
        select.select([], [], [], chance.uniform(0.0, 0.2))
        process.send_signal(signal.SIGKILL)
        announced = process.communicate()[0].decode().split("\n")[:-1]
        written = int(announced[-1]) if announced else found
    reader = JournalReader(str(tmp_path / "roah_rsbb_journal"))
    assert reader.damage == []
    numbers = [entry.value for entry in reader.entries("run")]
    assert numbers == list(range(1, len(numbers) + 1)) and len(numbers) >= written
    print(f"{len(numbers)} events, {KILLS} kills")
