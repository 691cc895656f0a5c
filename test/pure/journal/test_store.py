"""The journal's writer: written data can be read, other data waits, and foreign files are set aside."""

import contextlib
import dataclasses
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import threading
import time

import pytest

from helpers.journals import make_old
from helpers.small_disk import CannotMount, SmallDisk
from roah_rsbb.journal import disk as disks
from roah_rsbb.journal import file as files
from roah_rsbb.journal import schema
from roah_rsbb.journal import store as stores
from roah_rsbb.journal.batch import Batch, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.damage import find_damage
from roah_rsbb.journal.file import FILE_NAME, CoreSession, Resume, same_competition
from roah_rsbb.journal.previous_session import NOTHING
from roah_rsbb.journal.store import REPAIRED, Journal

COMPETITION = json.dumps([["Home", "HNF", "Alpha", 1, 1, 0.0], ["Home", "HWV", "Beta", 1, 1, 900.0]])
ENTRY = NewEntry(1e9, 5.0, "Home", "HNF-6667-1", 6667, "/referee", "command", '{"command":"start"}')
BATCH = Batch(
    entries=[ENTRY], runs=[RunRow("HNF-6667-1", "Home", "HNF", "Alpha", 1, 1, 0.0, 1e9)],
    members=[Member(6667, "HNF-6667-1", "Alpha", "r1")], log_files={6667: "/logs/run.bag"},
    outcomes={"HNF-6667-1": OutcomeRow(None, '{"n":1}')}, states={"zone:Home": '{"n":1}'},
)


def session(launch="", boot="boot", mono=1.0):
    return CoreSession(1e9, mono, boot, 1, "uuid", launch)


@pytest.fixture
def journals(tmp_path):
    opened = []

    def open_one(competition=COMPETITION, resume=Resume.ALWAYS, **of_session):
        troubles = []
        journal = Journal(str(tmp_path / "log"), session(**of_session), competition, resume, troubles.append)
        journal.troubles = troubles
        opened.append(journal)
        return journal

    yield open_one
    for journal in opened:
        journal.close()


def rows(journal, what="*", table="entries"):
    with sqlite3.connect(f"file:{journal.path}?mode=ro", uri=True) as connection:
        return connection.execute(f"SELECT {what} FROM {table}").fetchall()


def test_data_is_written_before_write_returns(journals):
    journal = journals()
    assert journal.previous == NOTHING
    journal.write(BATCH)
    assert rows(journal, "utc, mono, zone, identity, port, who, kind, value") == [tuple(ENTRY)]
    assert rows(journal, "port, log_file", "members") == [(6667, "/logs/run.bag")]


def test_the_state_from_which_the_next_start_continues(journals):
    journal = journals()
    journal.write(BATCH)
    journal.write(Batch(states={"zone:Home": '{"n":2}'}, outcomes={"HNF-6667-1": OutcomeRow(1e9 + 9, '{"n":2}')}))
    journal.close()
    before = journals(mono=9.0).previous
    assert before.states == {"zone:Home": '{"n":2}'}
    assert before.outcomes == ('{"n":2}',)
    assert (before.log_files, before.last_port) == ({6667: "/logs/run.bag"}, 6667)
    assert before.last == session(mono=5.0), "with the times of the last record"


def test_the_last_record_may_be_one_of_a_link(journals):
    journal = journals()
    journal.write(BATCH)
    journal.write(Batch(links=[LinkRow(6667, 1e9 + 7, 12.0, "{}")]))
    journal.close()
    last = journals().previous.last
    assert (last.utc, last.mono) == (1e9 + 7, 12.0)


def test_the_record_of_a_run_that_is_still_connected_is_there_too(journals):
    journal = journals()
    journal.write(BATCH)
    journal.close()
    assert journals().previous.outcomes == ('{"n":1}',)


def test_all_of_a_batch_or_nothing(journals):
    journal = journals()
    bad = dataclasses.replace(BATCH, links=[("not", "a", "row")])
    journal.write(bad)
    assert rows(journal) == []
    assert "cannot be written" in journal.troubles[-1]


def test_saved_data_was_synced(journals, monkeypatch):
    synced = []
    journal = journals()
    real = stores.os.fsync
    monkeypatch.setattr("os.fsync", lambda fd: (synced.append(os.readlink(f"/proc/self/fd/{fd}")), real(fd)))
    ticket = journal.write(BATCH)
    assert journal.why_not_saved(ticket) == ""
    assert journal.saved >= ticket
    assert f"{journal.path}-wal" in synced


def test_a_disk_that_fails_is_reported_and_a_later_sync_proves_nothing(journals, monkeypatch):
    """Linux forgets pages that it could not write: the next fsync succeeds without them."""
    journal = journals()
    assert journal.why_not_saved(journal.write(Batch(states={"box": "{}"}))) == ""
    database = pathlib.Path(journal.path)

    def fail(_fd):
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as broken:
        broken.setattr("os.fsync", fail)
        broken.setattr(stores, "SYNC_TIMEOUT_S", 0.3)
        ticket = journal.write(BATCH)
        assert "Input/output error" in journal.why_not_saved(ticket)
        assert journal.saved < ticket
        assert "Input/output error" in journal.troubles[-1]
        assert ENTRY.value.encode() not in database.read_bytes()
    assert journal.why_not_saved(ticket) == ""
    assert ENTRY.value.encode() in database.read_bytes(), "it was written again, to the database"
    assert journal.troubles[-1] == REPAIRED


def test_a_slow_disk_is_reported(journals, monkeypatch):
    journal, disk_is_back = journals(), threading.Event()
    real = stores.os.fsync
    monkeypatch.setattr("os.fsync", lambda fd: (disk_is_back.wait(30.0), real(fd)))
    monkeypatch.setattr(stores, "SYNC_TIMEOUT_S", 0.1)
    monkeypatch.setattr(stores, "SLOW_S", 0.1)
    ticket = journal.write(BATCH)
    assert "takes longer than" in journal.why_not_saved(ticket)
    journal.look()
    assert "is slow" in journal.troubles[-1]
    disk_is_back.set()
    monkeypatch.setattr(stores, "SYNC_TIMEOUT_S", 30.0)
    assert journal.why_not_saved(ticket) == ""
    monkeypatch.setattr(stores, "SLOW_S", 30.0)
    journal.look()
    assert journal.troubles[-1] == REPAIRED


def test_a_sign_off_is_moved_into_the_database(journals):
    journal = journals()
    journal.why_not_saved(journal.write(BATCH, checkpoint=True))
    database = pathlib.Path(journal.path)
    wait_until(lambda: ENTRY.value.encode() in database.read_bytes())


def test_the_write_ahead_log_shrinks_while_the_box_runs(journals, monkeypatch):
    monkeypatch.setattr(disks, "CHECKPOINT_PAUSE_S", 0.0)
    monkeypatch.setattr(disks, "CHECKPOINT_BYTES", 1_000_000_000)  # on a busy machine, a sync comes between the writes
    journal = journals()
    log = pathlib.Path(f"{journal.path}-wal")
    for _ in range(100):
        ticket = journal.write(Batch(states={"box": "x" * 5000}))
    assert log.stat().st_size > 200_000
    monkeypatch.setattr(disks, "CHECKPOINT_BYTES", 200_000)

    def is_small():
        journal.why_not_saved(journal.write(Batch(states={"box": "y"})))
        return log.stat().st_size < 100_000

    assert journal.why_not_saved(ticket) == ""
    wait_until(is_small)


def wait_until(condition):
    """Wait for what another thread does soon."""
    limit = time.monotonic() + 30.0
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.01)


def test_unwritten_entries_wait_in_their_order(journals, monkeypatch):
    journal = journals()
    blocked = sqlite3.connect(journal.path, isolation_level=None)
    blocked.execute("BEGIN IMMEDIATE")
    journal._connection.execute("PRAGMA busy_timeout = 10")
    for number in range(3):
        ticket = journal.write(
            Batch(entries=[ENTRY._replace(value=str(number))], states={"zone:Home": str(number)}))
    assert "cannot be written" in journal.troubles[-1]
    assert [entry.value for entry in journal.entries_of(6667)] == ["0", "1", "2"]
    assert "locked" in journal.why_not_saved(ticket)
    blocked.execute("ROLLBACK")
    blocked.close()
    journal.look()
    assert journal.troubles[-1] == REPAIRED
    assert rows(journal, "value") == [("0",), ("1",), ("2",)]
    assert rows(journal, "name, state", "states") == [("zone:Home", "2")]


def test_entries_are_not_given_in_part(journals, monkeypatch):
    before = journals()
    before.write(BATCH)
    before.close()
    real, failures = files.prepare, ["attempt to write a readonly database"]

    def prepare(connection, competition):
        if failures:
            raise sqlite3.OperationalError(failures.pop())
        real(connection, competition)

    monkeypatch.setattr(files, "prepare", prepare)
    again = journals()
    again.write(Batch(entries=[ENTRY]))
    assert again.previous is not NOTHING
    assert again.entries_of(6667) is None  # the disk can be written again, but the file is not open yet
    again.look()
    assert len(again.entries_of(6667)) == 2


def test_a_removed_folder_is_written_again(journals, tmp_path):
    journal = journals()
    journal.write(BATCH)
    shutil.rmtree(tmp_path / "log")
    journal.write(Batch(entries=[ENTRY]))
    journal.look()
    assert len(rows(journal)) == 2
    ticket = journal.write(Batch(entries=[ENTRY]))
    assert len(rows(journal)) == 3
    assert journal.why_not_saved(ticket) == ""


def test_a_directory_that_was_removed_and_cannot_be_made_again_is_reported_until_it_can(journals, tmp_path):
    journal = journals()
    journal.write(BATCH)
    shutil.rmtree(tmp_path / "log")
    (tmp_path / "log").write_text("a file where the directory should be")
    for _ in range(3):
        journal.look()
        journal.write(Batch(entries=[ENTRY]))
    assert "cannot be written" in journal.troubles[-1]
    assert REPAIRED not in journal.troubles
    assert len(journal.entries_of(6667)) == 4
    (tmp_path / "log").unlink()
    journal.look()
    assert journal.troubles[-1] == REPAIRED
    assert len(rows(journal)) == 4


def test_a_directory_that_cannot_be_made_until_later(tmp_path):
    (tmp_path / "log").write_text("a file where the directory should be")
    troubles = []
    journal = Journal(str(tmp_path / "log"), session(), COMPETITION, Resume.ALWAYS, troubles.append)
    journal.write(BATCH)
    assert "log_dir" in troubles[-1]
    (tmp_path / "log").unlink()
    journal.look()
    assert len(rows(journal)) == 1
    assert troubles[-1] == REPAIRED
    journal.close()


def test_two_cores_with_one_log_dir_keep_journals_of_their_own(journals):
    first, second = journals(), journals()
    assert first.path != second.path
    assert first.warnings == ()
    warning, = second.warnings
    assert f"process {os.getpid()})" in warning and first.path in warning and "end_other_core" in warning
    first.write(BATCH)
    assert rows(second) == []


@pytest.mark.parametrize("spoil, why", [
    (lambda path: path.write_bytes(b"no database" * 1000), "damaged, or not a journal"),
    (lambda path: _execute(path, "PRAGMA application_id = 7"), "another program"),
    (lambda path: _execute(path, f"PRAGMA user_version = {schema.VERSION + 1}"), "newer version"),
    (lambda path: _damage(path), "damaged"),
])
def test_a_journal_that_cannot_be_continued_is_set_aside(journals, tmp_path, spoil, why):
    journal = journals()
    for _ in range(50):
        journal.write(BATCH)
    journal.close()
    path = tmp_path / "log" / FILE_NAME
    spoil(path)
    spoiled = path.read_bytes()
    again = journals()
    assert again.previous == NOTHING
    assert why in again.warnings[0]
    kept = list(path.parent.glob("*_aside_*.sqlite3"))
    assert [file.read_bytes() for file in kept] == [spoiled]
    assert str(kept[0]) in again.warnings[0]
    again.write(BATCH)
    assert len(rows(again)) == 1


def _execute(path, statement):
    with sqlite3.connect(str(path)) as connection:
        connection.execute(statement)


def _damage(path):
    content = bytearray(path.read_bytes())
    content[4096:12288] = bytes(8192)
    path.write_bytes(content)


def test_an_older_version_is_brought_up_to_date(journals, monkeypatch):
    journal = journals()
    journal.write(BATCH)
    journal.close()
    monkeypatch.setattr(schema, "VERSION", schema.VERSION + 1)
    monkeypatch.setattr(schema, "MIGRATIONS", {schema.VERSION - 1: ("ALTER TABLE runs ADD COLUMN room TEXT",)})
    again = journals()
    assert again.warnings == ()
    assert again.previous.states == {"zone:Home": '{"n":1}'}
    assert rows(again, "room", "runs") == [(None,)]


def test_a_journal_of_version_1_is_brought_up_to_date(journals):
    journal = journals()
    journal.write(BATCH)
    journal.close()
    make_old(journal.path)
    again = journals()
    assert again.warnings == ()
    assert again.previous.states == {"zone:Home": '{"n":1}'}
    again.write(dataclasses.replace(BATCH, runs=[], members=[]))
    assert len(rows(again)) == 2
    assert find_damage(again._connection) == []


def test_a_core_that_hangs_is_named(journals):
    program = (
        "import fcntl, os, signal, sys; fd = os.open(sys.argv[1], os.O_RDWR); fcntl.flock(fd, fcntl.LOCK_EX);"
        "os.ftruncate(fd, 0); os.pwrite(fd, str(os.getpid()).encode(), 0); print(flush=True);"
        "os.kill(os.getpid(), signal.SIGSTOP)")
    journal = journals()
    journal.close()
    hung = subprocess.Popen([sys.executable, "-c", program, f"{journal.path}.lock"], stdout=subprocess.PIPE)
    try:
        hung.stdout.readline()
        os.waitpid(hung.pid, os.WUNTRACED)  # it is stopped
        warning, = journals().warnings
        assert f"process {hung.pid}, which is stopped" in warning
    finally:
        hung.kill()
        hung.communicate()


def test_a_competition_is_known_by_its_events_not_by_their_times():
    moved = json.dumps([["Home", "HNF", "Alpha", 1, 1, 77.0], ["Room", "STB", "Beta", 1, 1, 0.0]])
    other = json.dumps([["Home", "HNF", "Alpha", 1, 2, 0.0]])
    assert same_competition(COMPETITION, moved)
    assert not same_competition(COMPETITION, other)


def test_syncs_are_grouped(journals, monkeypatch):
    journal, all_are_written = journals(), threading.Event()
    synced = []
    monkeypatch.setattr("os.fsync", lambda fd: (all_are_written.wait(30.0), synced.append(fd)))
    tickets = [journal.write(BATCH) for _ in range(100)]
    all_are_written.set()
    assert journal.why_not_saved(tickets[-1]) == ""
    assert 0 < len(synced) < 10


ON_A_DISK = """
import json, sys
sys.path[:0] = json.loads(sys.argv[2])
from roah_rsbb.journal.file import CoreSession, Resume
from roah_rsbb.journal.store import Journal
troubles = []
session = CoreSession(1e9, 1.0, "boot", 1, "uuid", "")
journal = Journal(sys.argv[1], session, sys.argv[3], Resume.ALWAYS, troubles.append)
for line in sys.stdin:
    exec(line)
    print(json.dumps([journal.previous.states, (troubles or [""])[-1], journal._session_id]), flush=True)
"""


class OnADisk:
    """A journal in a process that sees the disk."""

    def __init__(self, disk):
        self._process = subprocess.Popen(
            [*disk.inside, sys.executable, "-c", ON_A_DISK, f"{disk.mount_point}/log", json.dumps(sys.path),
             COMPETITION], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )

    def do(self, line="pass"):
        """Execute a line; returns the states before, the trouble, the session's number (0: none yet)."""
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def end(self, kill=False):
        if kill:
            self._process.kill()
        self._process.communicate()


WRITES = 'from roah_rsbb.journal.batch import Batch; journal.write(Batch(states={"zone:Home": "{}"}))'


@pytest.mark.long
@pytest.mark.parametrize("kill", [False, True])
@pytest.mark.parametrize("how", ["full", "read-only"])
def test_what_was_before_is_read_on_a_disk_that_cannot_be_written(tmp_path, kill, how):
    try:
        disk = SmallDisk(tmp_path / "disk", 512)
    except (CannotMount, OSError) as error:
        pytest.skip(f"no file system can be mounted here: {error}")
    with contextlib.closing(disk):
        journal = OnADisk(disk)
        assert journal.do(WRITES) == [{}, "", 1]
        if not kill:
            journal.do("journal.close()")
        journal.end(kill)
        if how == "full":
            disk.fill()
        else:
            disk.make_read_only()
        journal = OnADisk(disk)
        before, trouble, number = journal.do()
        assert before == {"zone:Home": "{}"}
        # Where SQLite has room of its own left a full disk is noticed later.
        assert (bool(trouble), number) == (True, 0) or how == "full"
        if how == "full":
            disk.free()
        else:
            disk.make_writable()
        journal.do("journal._retry_at = 0.0")
        journal.do("journal.look()")
        assert journal.do("journal.look()") == [before, "", 2]
        journal.end()
