"""What was acknowledged is there after a power failure at any moment, whichever of the latest writes the disk has.

Real processes write, are killed and continue, and their operations on files are recorded (`helpers/crash_states.py`).
`make test` looks at some hundred of the states that a power failure can leave, `make test-all` at more than 90,000.
`make test` kills 10 cores, `make test-all` 500.
"""

import collections
import json
import os
import random
import select
import signal
import subprocess
import sys

import pytest

from helpers.crash_states import NOT_KEPT, CannotRecord, Disk, Recorder, crash_states, in_memory, put
from helpers.crash_subjects import SUBJECTS, limits, lives_of, problem_of, quiet_folder
from helpers.examples import ALL
from roah_rsbb.journal.reader import JournalReader

SEED = os.environ.get("ROAH_TEST_SEED", "1")
# States in `make test`, as a share of those in `make test-all`.
SHARE = 1.0 if ALL else 0.015


@pytest.fixture
def folder():
    with in_memory() as path:
        yield path


def recorded(name, folder, *fail):
    """The operations of a subject's processes on the files of a folder, `files`."""
    try:
        recorder = Recorder(folder)
    except CannotRecord as error:
        pytest.skip(f"no compiler: {error}")
    (folder / "files").mkdir()
    operations = recorder.run(folder / "files", lives_of(name, folder / "files"), *fail)
    disk = Disk()
    for number, operation in enumerate(operations):
        disk.do(number, operation)
    real = {str(path): path.read_bytes() for path in (folder / "files").rglob("*")
            if path.is_file() and not path.name.endswith(NOT_KEPT)}
    assert disk.after_kill() == real, "not all operations are recorded"
    return operations


def problems(name, folder, count, *fail):
    """What is wrong after each of so many power failures; empty: nothing."""
    for state in crash_states(recorded(name, folder, *fail), count, SEED):
        with quiet_folder(folder) as place:
            put(state.files, folder / "files", place)
            newest = max(limits(state.marks)[0], default=0)
            problem = problem_of(SUBJECTS[name].found(place, newest), state.marks)
        yield problem.replace(place, "")


CASES = [
    ("Journal", 40_000), ("Copy", 10_000), ("KeptFile", 2000),
    *(("Journal", 4000, ".log", number) for number in (1, 2, 3, 5, 8, 12)),  # also after a kill
    *(("Journal", 4000, ".log.new", number) for number in (1, 2, 3, 4)), ("Journal", 4000, "/roah_rsbb_journal", 2),
    *(("Copy", 2000, ".log", number) for number in (1, 2, 5, 12)),
    *(("Copy", 2000, ".log.new", number) for number in (1, 2, 5)), ("Copy", 2000, "/roah_rsbb_journal", 3),
    ("KeptFile", 500, ".new", 5),
]


@pytest.mark.long
@pytest.mark.parametrize("name, count, fail", [(name, count, fail) for name, count, *fail in CASES])
def test_what_was_acknowledged_is_there(folder, name, count, fail):
    """`fail`: which fsync of which file fails, in each process."""
    found = collections.Counter(problems(name, folder, round(count * SHARE), *fail))
    assert set(found) == {""}, found
    assert found[""] > count * SHARE * 0.5


@pytest.mark.long
@pytest.mark.parametrize("name, fail", [
    ("SealsPageCache", ()), ("NamesTooEarly", ()), ("TrustsFailedSync", (".log", 3)), ("CopyOfUnsyncedDrafts", ()),
    ("CopyThatTrustsFailedSync", (".log", 5)), ("CopyThatTakesTheDiskOfTheBoxForItsOwn", ())])
def test_the_enumeration_finds_what_it_is_made_for(folder, name, fail):
    assert any(problems(name, folder, 600, *fail))


# -- kills ------------------------------------------------------------------------------------------

# Cores that are killed at random moments, one after the other: what one of them has written is there for the next.
KILLS = 500 if ALL else 10
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
