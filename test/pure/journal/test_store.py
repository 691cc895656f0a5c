"""The journal's writer: written data can be read, other data waits, and other journals are set aside."""

import contextlib
import dataclasses
import errno
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import threading

import pytest

from helpers.small_disk import CannotMount, SmallDisk
from helpers.waiting import wait_until
from roah_rsbb.journal import log
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal import store as stores
from roah_rsbb.journal.log import read_chain, scans
from roah_rsbb.journal.log_dir import (
    JOURNAL,
    NOTHING,
    CoreSession,
    DamagedJournal,
    JournalInUse,
    Resume,
    same_competition,
)
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Batch, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.store import REPAIRED, Journal

COMPETITION = [["Home", "HNF", "Alpha", 1, 1, 0.0], ["Home", "HWV", "Beta", 1, 1, 900.0]]
ENTRY = NewEntry(1e9, 5.0, "Home", "HNF-6667-1", 6667, "/referee", "command", {"command": "start"})
BATCH = Batch(
    entries=[ENTRY], runs=[RunRow("HNF-6667-1", "Home", "HNF", "Alpha", 1, 1, 0.0, 1e9)],
    members=[Member(6667, "HNF-6667-1", "Alpha", "r1")], log_files={6667: "/logs/run.bag"},
    outcomes={"HNF-6667-1": OutcomeRow(None, {"n": 1})}, states={"zone:Home": {"n": 1}},
)


def session(launch="", boot="boot", mono=1.0):
    return CoreSession(1e9, mono, boot, 1, "uuid", launch)


@pytest.fixture
def journals(tmp_path):
    opened = []

    def open_one(competition=COMPETITION, resume=Resume.ALWAYS, file_operations=None, **of_session):
        troubles = []
        journal = Journal(str(tmp_path / "log"), session(**of_session), competition, resume, troubles.append,
                          file_operations=file_operations)
        journal.troubles = troubles
        opened.append(journal)
        return journal

    yield open_one
    for journal in opened:
        journal.close()


def records_of(journal):
    """The records in the folder, with that of each start, as another process reads them."""
    return [frame.payload for _, found in scans(read_chain(journal.path).segments) for frame in found.records]


def entries(journal):
    return [(entry.number, *entry[2:]) for entry in JournalReader(journal.path).entries("HNF-6667-1")]


def test_data_is_written_before_write_returns_and_the_next_start_continues_from_it(journals):
    journal = journals()
    assert journal.previous == NOTHING
    journal.write(BATCH)
    assert entries(journal) == [(1, *ENTRY)]
    reader = JournalReader(journal.path)
    assert [(member.port, member.log_file) for member in reader.all_members()] == [(6667, "/logs/run.bag")]
    journal.close()
    journal = journals(mono=9.0)
    before = journal.previous
    assert (before.states, before.outcomes) == ({"zone:Home": {"n": 1}}, ({"n": 1},)), "its run is still connected"
    assert (before.log_files, before.last_port) == ({6667: "/logs/run.bag"}, 6667)
    assert before.last == session(mono=5.0), "with the times of the last record"
    journal.write(Batch(states={"zone:Home": {"n": 2}}, outcomes={"HNF-6667-1": OutcomeRow(1e9 + 9, {"n": 2})}))
    journal.write(Batch(links=[LinkRow(6667, 1e9 + 20, 25.0, {})]))
    journal.close()
    before = journals(mono=30.0).previous
    assert (before.states, before.outcomes) == ({"zone:Home": {"n": 2}}, ({"n": 2},))
    assert (before.last.utc, before.last.mono) == (1e9 + 20, 25.0), "the last record may be one of a link"


def test_states_survive_many_differences_and_starts(journals, monkeypatch):
    monkeypatch.setattr(log, "FULL_BYTES", 3000)
    chance, state = random.Random(1), {}
    for _ in range(4):
        journal = journals()
        assert journal.previous.states.get("zone:Home", {}) == state
        for _ in range(300):
            state = {**state, f"key {chance.randrange(5)}": [chance.random() for _ in range(chance.randrange(4))]}
            journal.write(Batch(states={"zone:Home": state}))
        if chance.random() < 0.5:
            journal.why_not_saved(journal.committed)
        journal.close()


def test_what_is_not_json_is_refused_and_costs_nothing_else(journals):
    journal = journals()
    with pytest.raises(TypeError):
        journal.write(dataclasses.replace(BATCH, links=[LinkRow(6667, 1.0, 2.0, object())]))
    ticket = journal.write(BATCH)
    assert journal.committed == ticket == 2
    assert entries(journal) == [(1, *ENTRY)]
    assert journal.why_not_saved(ticket) == ""


@pytest.mark.parametrize("name", ["z\tHNF-6667-1\t\ne{", "q\nz{", 'z\tHNF-6667-1\t\ne[[9,0,"Anna","command",{}]]'])
def test_the_name_of_a_run_that_is_not_there_neither_forges_nor_breaks_a_record(journals, name):
    """Callers may name any run; the refusal is recorded with what they wrote."""
    before = journals()
    before.write(BATCH)
    before.write(Batch(entries=[ENTRY._replace(identity=name, port=None)], states={"zone:Home": {"n": 2}}))
    before.close()
    after = journals()
    assert after.previous.states == {"zone:Home": {"n": 2}}
    assert entries(after) == [(1, *ENTRY)]
    assert len(records_of(after)) == 4


def test_saved_data_was_synced(journals, monkeypatch):
    synced = []
    journal = journals()
    real = os.fsync
    monkeypatch.setattr("os.fsync", lambda fd: (synced.append(os.readlink(f"/proc/self/fd/{fd}")), real(fd)))
    ticket = journal.write(BATCH)
    assert journal.why_not_saved(ticket) == ""
    assert journal.saved >= ticket
    assert str(segments(journal)[-1]) in synced


def segments(journal):
    return sorted(pathlib.Path(journal.path).glob("*.log"))


def test_a_disk_that_fails_is_reported_and_a_later_sync_proves_nothing(journals, monkeypatch):
    """Linux forgets pages that it could not write: the next fsync succeeds without them."""
    journal = journals()
    assert journal.why_not_saved(journal.write(Batch(states={"box": {}}))) == ""

    def fail(_fd):
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as broken:
        broken.setattr("os.fsync", fail)
        broken.setattr(stores, "SYNC_TIMEOUT_S", 0.3)
        ticket = journal.write(BATCH)
        assert "Input/output error" in journal.why_not_saved(ticket)
        assert journal.saved < ticket
        assert "Input/output error" in journal.troubles[-1]
    assert journal.why_not_saved(ticket) == ""
    assert len(segments(journal)) == 2
    assert ENTRY.value["command"].encode() in segments(journal)[-1].read_bytes(), "it is written again"
    wait_until(lambda: journal.troubles[-1] == REPAIRED)


def test_a_slow_disk_is_reported(journals, monkeypatch):
    journal, disk_is_back = journals(), threading.Event()
    real = os.fsync
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


class FailingFiles(log.Files):
    """A disk that cannot be written for a while."""

    is_full = False

    def write(self, fd, content, at):
        if self.is_full:
            os.pwrite(fd, content[:len(content) // 2], at)
            raise OSError(28, "No space left on device")
        super().write(fd, content, at)


def test_unwritten_entries_wait_in_their_order(journals, monkeypatch):
    files = FailingFiles()
    journal = journals(file_operations=files)
    journal.write(BATCH)
    files.is_full = True
    for number in range(3):
        ticket = journal.write(Batch(entries=[ENTRY._replace(value=number)], states={"zone:Home": number}))
    assert "the disk is full" in journal.troubles[-1]
    monkeypatch.setattr(stores, "SYNC_TIMEOUT_S", 1e6)
    assert "the disk is full" in journal.why_not_saved(ticket), "at once"
    assert len(entries(journal)) == 1
    files.is_full = False
    journal.look()
    assert journal.troubles[-1] == REPAIRED
    assert [entry[-1] for entry in entries(journal)] == [ENTRY.value, 0, 1, 2]
    assert journal.why_not_saved(ticket) == ""


def test_a_run_has_no_entries_of_a_torn_tail(journals, tmp_path, monkeypatch):
    """After a power failure in which the middle of three writes was lost, their numbers are given again."""
    def fail(_fd):
        raise OSError(5, "Input/output error")

    before = journals()
    assert before.why_not_saved(before.write(BATCH)) == ""
    with monkeypatch.context() as broken:
        broken.setattr("os.fsync", fail)
        for number in range(3):
            before.write(Batch(entries=[ENTRY._replace(value=f"value {number}")]))
        shutil.copytree(str(tmp_path / "log"), str(tmp_path / "after" / "log"))
    left = pathlib.Path(tmp_path / "after" / "log" / JOURNAL)
    _changed(left, lambda content: content.replace(b"value 1", b"value x"))
    after = Journal(str(tmp_path / "after" / "log"), session(), COMPETITION, Resume.ALWAYS, [].append)
    try:
        assert after.why_not_saved(after.write(Batch(states={"box": {}}))) == ""
        assert b"value 2" in min(left.glob("*.log")).read_bytes()
        assert [entry[-1] for entry in entries(after)] == [ENTRY.value, "value 0"]
    finally:
        after.close()


def test_a_disk_that_is_full_at_the_start(journals):
    before = journals()
    before.write(BATCH)
    before.close()
    files = FailingFiles()
    files.is_full = True
    again = journals(file_operations=files)
    again.write(Batch(entries=[ENTRY]))
    assert again.previous.states == {"zone:Home": {"n": 1}}
    assert (again.committed, again.saved) == (0, 0) and "the disk is full" in again.troubles[-1]
    files.is_full = False
    again.look()
    assert again.committed == 1
    assert len(entries(again)) == 2
    assert again.troubles[-1] == REPAIRED


@pytest.mark.parametrize("lose", [
    lambda log_dir: shutil.rmtree(log_dir / JOURNAL), shutil.rmtree, lambda log_dir: log_dir.rename(f"{log_dir} moved"),
])
def test_all_segments_of_a_folder_that_is_gone_are_written_again(journals, tmp_path, lose):
    for number in range(3):
        journal = journals()
        journal.write(dataclasses.replace(BATCH, entries=[ENTRY._replace(value=number)]))
        if number < 2:
            journal.close()
    lose(tmp_path / "log")
    journal.look()
    assert JournalReader(journal.path).damage == []
    assert [entry[-1] for entry in entries(journal)] == [0, 1, 2]
    assert (tmp_path / "log" / f"{JOURNAL}.lock").exists()
    assert journal.why_not_saved(journal.write(Batch(entries=[ENTRY]))) == ""
    assert len(entries(journal)) == 4


def test_another_journal_in_its_place_is_set_aside(journals, tmp_path):
    _closed(journals, tmp_path)
    (tmp_path / "log" / JOURNAL).rename(tmp_path / "other")
    (tmp_path / "log" / (JOURNAL + log.NEWEST)).unlink()
    before = contents(tmp_path / "other")
    journal = journals()
    journal.write(BATCH)
    shutil.rmtree(tmp_path / "log" / JOURNAL)
    (tmp_path / "other").rename(tmp_path / "log" / JOURNAL)
    journal.write(Batch(entries=[ENTRY]))
    assert len(entries(journal)) == 2
    kept, = (one for one in (tmp_path / "log").glob("*_aside_*") if one.is_dir())
    assert contents(kept) == before


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
    (tmp_path / "log").unlink()
    journal.look()
    assert journal.troubles[-1] == REPAIRED
    assert len(entries(journal)) == 4


def test_a_directory_that_cannot_be_made_until_later(tmp_path):
    (tmp_path / "log").write_text("a file where the directory should be")
    troubles = []
    journal = Journal(str(tmp_path / "log"), session(), COMPETITION, Resume.ALWAYS, troubles.append)
    journal.write(BATCH)
    assert "log_dir" in troubles[-1]
    (tmp_path / "log").unlink()
    journal.look()
    assert len(entries(journal)) == 1
    assert troubles[-1] == REPAIRED
    journal.close()


def test_a_journal_belongs_to_one_core(journals):
    first = journals()
    with pytest.raises(JournalInUse, match=f"in use by process {os.getpid()}, since 20.*kill -9 {os.getpid()}"):
        log_dirs.lock(os.path.dirname(first.path))
    second = journals()
    assert "in use by process" in second.troubles[-1]
    first.write(BATCH)
    second.write(BATCH)
    assert len(entries(first)) == 1
    assert not list(pathlib.Path(first.path).parent.glob("*_2*")), "no other journal is begun"


def _changed(path, change):
    """Change the newest segment of a closed journal; returns the contents of its files."""
    segment = max(path.glob("*.log"))
    segment.write_bytes(change(segment.read_bytes()))
    return contents(path)


def contents(path):
    return {file.name: file.read_bytes() for file in path.iterdir()}


def _closed(journals, tmp_path, **how):
    journal = journals(**how)
    for _ in range(50):
        journal.write(BATCH)
    journal.close()
    return tmp_path / "log" / JOURNAL


@pytest.mark.parametrize("spoil, what", [
    (lambda path: (path / "journal-000009-12345678.log").mkdir(), "cannot be read: .*000009.*Is a directory.*chown"),
    (lambda path: (shutil.rmtree(path), path.write_text("a file")), "cannot be read: .*Not a directory"),
    (shutil.rmtree, "all segments are missing, and the newest one was journal-000001.*resume:=never"),
    (lambda path: [each.unlink() for each in path.iterdir()], "all segments are missing.*resume:=never"),
])
def test_no_core_begins_without_the_runs_that_it_cannot_read(journals, tmp_path, spoil, what):
    spoil(_closed(journals, tmp_path))
    with pytest.raises(DamagedJournal, match=what):
        journals()


@pytest.mark.parametrize("spoil, what", [
    (lambda log_dir: (log_dir / (JOURNAL + log.NEWEST)).write_bytes(b"\xff garbage"), ""),
    (lambda log_dir: (shutil.rmtree(log_dir / JOURNAL), (log_dir / (JOURNAL + log.NEWEST)).write_text("garbage")),
     "all segments are missing, and roah_rsbb_journal.newest does not name the newest one.*resume:=never"),
])
def test_a_spoiled_name_of_the_newest_segment_loses_nothing(journals, tmp_path, spoil, what):
    _closed(journals, tmp_path)
    spoil(tmp_path / "log")
    if what:
        with pytest.raises(DamagedJournal, match=what):
            journals()
    else:
        assert journals().previous.states == {"zone:Home": {"n": 1}}


def cannot_be_opened(monkeypatch, error):
    """Nobody may open the lock file any more. Rights mean nothing to root."""
    def refuse(path):
        raise OSError(error, os.strerror(error), path)
    monkeypatch.setattr(log_dirs, "_lock_file", refuse)


def test_no_core_begins_without_the_runs_of_a_journal_that_it_cannot_lock(journals, tmp_path, monkeypatch):
    _closed(journals, tmp_path)
    cannot_be_opened(monkeypatch, errno.EACCES)
    with pytest.raises(DamagedJournal, match="lock: Permission denied. The core does not begin an empty one.*chown"):
        journals()


def test_a_folder_that_cannot_be_searched_may_have_a_journal(journals, tmp_path, monkeypatch):
    cannot_be_opened(monkeypatch, errno.EACCES)
    stat = os.stat

    def refuse(path, **how):
        if str(path).startswith(str(tmp_path / "log" / "roah")):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        return stat(path, **how)

    monkeypatch.setattr(os, "stat", refuse)
    with pytest.raises(DamagedJournal, match="does not begin an empty one"):
        journals()


def test_a_journal_that_appears_after_the_start_is_set_aside(journals, tmp_path):
    path = _closed(journals, tmp_path)
    before = contents(path)
    (tmp_path / "log").rename(tmp_path / "stick")
    (tmp_path / "log").write_text("where the stick will be")
    journal = journals(mono=2.0)
    journal.write(BATCH)
    (tmp_path / "log").unlink()
    (tmp_path / "stick").rename(tmp_path / "log")
    journal.look()
    warning, = journal.take_warnings()
    kept, = (tmp_path / "log").glob("*_aside_*[0-9]")
    assert f"is kept as {kept}" in warning and "put it back in its place, and start again" in warning
    assert journal.take_warnings() == ()
    assert contents(kept) == before
    assert len(entries(journal)) == 1 and journal.troubles[-1] == REPAIRED


def test_without_its_segments_a_journal_begins_only_on_purpose(journals, tmp_path):
    shutil.rmtree(_closed(journals, tmp_path))
    assert "all segments are missing" in " ".join(journals(resume=Resume.NEVER).warnings)


def test_parts_of_two_copies_in_one_folder_are_named(journals, tmp_path):
    path = _closed(journals, tmp_path)
    shutil.copytree(path, tmp_path / "earlier")
    _closed(journals, tmp_path, mono=2.0)
    later = next(each for each in path.iterdir() if each.name.startswith("journal-000002"))
    other = later.read_bytes()
    shutil.rmtree(path)
    shutil.copytree(tmp_path / "earlier", path)
    (tmp_path / "log" / (JOURNAL + log.NEWEST)).unlink()
    for _ in range(2):
        _closed(journals, tmp_path)
    assert read_chain(str(path)).problems == []
    (path / later.name).write_bytes(other)
    warning, = journals().warnings
    assert f"{later.name} does not belong to the newest segments, and 1 of its records does not count" in warning
    assert any("Parts of two copies are in one folder" in damage for damage in JournalReader(str(path)).damage)


def test_a_journal_of_another_competition_is_set_aside(journals, tmp_path):
    path = _closed(journals, tmp_path, competition=[["Hall", "HNF", "Alpha", 1, 1, 0.0]])
    before = contents(path)
    again = journals()
    assert again.previous == NOTHING
    kept, = (one for one in path.parent.glob("*_aside_*") if one.is_dir())
    assert contents(kept) == before
    assert "another competition" in again.warnings[0] and str(kept) in again.warnings[0]
    assert (path.parent / f"{kept.name}{log.NEWEST}").exists()
    again.write(BATCH)
    assert len(records_of(again)) == 2


def test_the_journal_of_a_newer_version_is_set_aside(journals, tmp_path, monkeypatch):
    with monkeypatch.context() as newer:
        newer.setattr(log, "VERSION", log.VERSION + 1)
        path = _closed(journals, tmp_path)
    again = journals()
    assert again.previous == NOTHING and "newer version" in again.warnings[0]
    assert [one.name for one in path.parent.glob("*_aside_*")] != []


def test_a_changed_schedule_is_that_of_the_next_start(journals):
    other = [["Hall", "HNF", "Alpha", 1, 1, 0.0]]
    journal = journals()
    journal.write(BATCH)
    journal.set_competition(other)
    journal.close()
    again = journals(competition=other)
    assert (again.warnings, again.previous.states) == ((), {"zone:Home": {"n": 1}})


def test_damage_is_reported_and_everything_else_continues(journals, tmp_path):
    path = _closed(journals, tmp_path)
    before = _changed(path, lambda content: content.replace(b'"/referee"', b'"/refer??"', 1))
    again = journals()
    assert again.previous.states == {"zone:Home": {"n": 1}}
    assert "is damaged: record 2 damaged or missing, between" in again.warnings[0]
    assert "A copy may have what is missing: compare with 'results --journal COPY verify'" in again.warnings[0]
    again.write(BATCH)
    again.close()
    assert before.items() <= contents(path).items(), "what was there is untouched"
    later = journals()
    assert later.warnings == (), "this start does not read it"
    warning, = later.earlier_damage()
    assert "is damaged: record 2 damaged or missing, between" in warning
    assert "compare with 'results --journal COPY verify'" in warning
    assert list(later.earlier_damage()) == [], "it is looked for once"


def test_an_early_segment_that_cannot_be_read_is_reported(journals, tmp_path):
    path = _closed(journals, tmp_path)
    journals(mono=2.0).close()
    journal = journals(mono=3.0)
    for segment in path.glob("journal-000001-*"):
        segment.unlink()
    warning, = journal.earlier_damage()
    assert "journal-000001-" in warning and "cannot be read: No such file or directory" in warning


def test_a_state_that_depends_on_a_damaged_record_is_not_used(journals, tmp_path):
    state = {"a": "x" * 10, "b": ["y"], "n": 0}
    journal = journals()
    for number in range(5):
        journal.why_not_saved(journal.write(Batch(states={"zone:Home": {**state, "n": number}, "box": {"n": 5}})))
    journal.close()
    segment = max((tmp_path / "log" / JOURNAL).glob("*.log"))
    content = segment.read_bytes()
    content = content.replace(b'"change":{"n":[2]}', b'"change":{"n":[9]}')
    segment.write_bytes(content[:content.rindex(b"RsbS")])  # without the summary at the end
    again = journals()
    assert again.previous.states == {"box": {"n": 5}}
    assert "the state of zone:Home is damaged" in "".join(again.warnings)


@pytest.mark.parametrize("change", [lambda content: b"no journal" * 1000, lambda content: content[:40]])
def test_no_empty_journal_is_begun_beside_a_damaged_one(journals, tmp_path, change):
    path = _closed(journals, tmp_path)
    spoiled = _changed(path, change)
    for _ in range(2):
        with pytest.raises(DamagedJournal, match="Put the newest copy .* resume:=never"):
            journals()
        assert contents(path) == spoiled
    begun = journals(resume=Resume.NEVER)  # the organiser's word
    assert begun.previous == NOTHING
    kept, = (one for one in path.parent.glob("*_aside_*") if one.is_dir())
    assert contents(kept) == spoiled and str(kept) in begun.warnings[0]


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
        with pytest.raises(JournalInUse, match=f"process {hung.pid}, which is stopped.*kill -9 {hung.pid}"):
            log_dirs.lock(os.path.dirname(journal.path))
    finally:
        hung.kill()
        hung.communicate()


def test_a_competition_is_known_by_its_events_not_by_their_times():
    moved = [["Home", "HNF", "Alpha", 1, 1, 77.0], ["Room", "STB", "Beta", 1, 1, 0.0]]
    assert same_competition(COMPETITION, moved)
    assert not same_competition(COMPETITION, [["Home", "HNF", "Alpha", 1, 2, 0.0]])
    assert same_competition(None, moved) and same_competition([1], moved), "unknown"


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
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal import store
from roah_rsbb.journal.store import Journal
store.WRITE_S = 60.0
troubles = []
session = CoreSession(1e9, 1.0, "boot", 1, "uuid", "")
journal = Journal(sys.argv[1], session, json.loads(sys.argv[3]), Resume.ALWAYS, troubles.append)
for line in sys.stdin:
    exec(line)
    number = journal._is_begun and len(journal._writer.contents.sessions)
    print(json.dumps([journal.previous.states, (troubles or [""])[-1], number]), flush=True)
"""


class OnADisk:
    """A journal in a process that sees the disk."""

    def __init__(self, disk):
        self._process = subprocess.Popen(
            [*disk.inside, sys.executable, "-c", ON_A_DISK, f"{disk.mount_point}/log", json.dumps(sys.path),
             json.dumps(COMPETITION)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
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


WRITES = 'from roah_rsbb.journal.records import Batch; journal.write(Batch(states={"zone:Home": {"n": 1}}))'


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
        assert before == {"zone:Home": {"n": 1}}
        assert (bool(trouble), number) == (True, False)
        if how == "full":
            disk.free()
        else:
            disk.make_writable()
        journal.do("journal._retry_at = 0.0")
        journal.do("journal.look()")
        assert journal.do("journal.look()") == [before, "", 2]
        journal.end()
