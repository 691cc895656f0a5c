"""The copy survives missing sticks, other journals, restarts and full disks, and catches up."""

import contextlib
import os
import queue
import shutil
import sqlite3
import threading

import pytest

from helpers.competition import run_record
from helpers.copied import contents
from helpers.journals import Writer
from roah_rsbb.copies import folder as folders
from roah_rsbb.copies import follower as module
from roah_rsbb.copies import rows
from roah_rsbb.copies.folder import Stick
from roah_rsbb.copies.follower import Follower
from roah_rsbb.copies.rows import COLUMNS
from roah_rsbb.journal.file import FILE_NAME, Resume
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.store import Journal


def asides(folder):
    return sorted(path.name for path in folder.iterdir() if "_aside_" in path.name and path.suffix == ".sqlite3")


def test_the_copy_is_a_journal_with_all_data(copied):
    copied.writer.run(run_record())
    copied.writer.entry("/notification", "at the bed")
    (copied.log_dir / "used_private_ports").write_text("6667\n")
    (copied.log_dir / "configuration.json").write_text("{}")
    assert copied.step()
    with JournalReader(str(copied.stick / FILE_NAME)) as reader:
        assert reader.runs()[0].outcome
        assert not reader.damage
    assert (copied.stick / "used_private_ports").read_text() == "6667\n"
    assert (copied.stick / "configuration.json").read_text() == "{}"


def test_files_beside_the_journal_are_copied_before_the_rows_that_need_them(copied):
    (copied.log_dir / "configuration.json").write_text("version 1")
    assert copied.step()
    (copied.log_dir / "configuration.json").write_text("version 2 for a run")
    copied.writer.entry("/notification", "of the run")
    assert copied.step()
    assert (copied.stick / "configuration.json").read_text() == "version 2 for a run"


def test_a_large_journal_is_copied_in_parts(copied, monkeypatch):
    monkeypatch.setattr(rows, "PART", 10)
    copied.writer.run(run_record())
    for number in range(35):
        copied.writer.entry("/notification", number)
    assert copied.step()
    copied.writer.outcome(run_record(elapsed_s=5.0))
    for number in range(35):
        copied.writer.entry("/notification", number, identity=run_record().identity)
    assert copied.step()


@pytest.mark.parametrize("count", [folders.TOGETHER - 1, folders.TOGETHER, 2 * folders.TOGETHER + 3])
def test_many_rows_are_copied_at_once(copied, count):
    for number in range(count):
        copied.writer.entry("/notification", number)
    assert copied.step()
    assert contents(copied.stick) == contents(copied.log_dir)


def test_only_the_last_part_waits_for_the_disk(copied, monkeypatch):
    """Also if it has no rows."""
    monkeypatch.setattr(rows, "PART", 5)
    assert copied.step()
    happened, write = [], folders.CopyFolder.write

    def written(copy, part, beside):
        write(copy, part, beside)
        (level,) = copy._connection.execute("PRAGMA synchronous").fetchone()
        happened.append((part.is_last, part.is_empty(), level))

    monkeypatch.setattr(folders.CopyFolder, "write", written)
    for number in range(10):
        copied.writer.entry("/notification", number)
    assert copied.step()
    normal, full = 1, 2
    assert happened == [(False, False, normal), (False, False, normal), (True, True, full)]


def test_an_unfinished_copy_has_no_newer_state_than_entries(copied, monkeypatch):
    """Killed between two parts, the copy still is a whole earlier state."""
    monkeypatch.setattr(rows, "PART", 10)
    assert copied.step()
    copied.writer.run(run_record())
    for number in range(15):
        copied.writer.entry("/notification", number)
    written = []
    write = folders.CopyFolder.write

    def write_once(folder, *arguments):
        if not written:
            written.append(write(folder, *arguments))
        copied.follower._ended.set()

    monkeypatch.setattr(folders.CopyFolder, "write", write_once)
    copied.follower.step()
    found = contents(copied.stick)
    assert len(found["entries"]) == 10
    assert not found["runs"] and not found["members"]


def test_a_stick_that_is_pulled_out_is_reported_and_catches_up(copied):
    assert copied.step()
    copied.mono = 110.0
    copied.writer.run(run_record())
    away = copied.stick.with_name("away")
    copied.stick.rename(away)
    for _ in range(2):
        copied.writer.entry("/notification", "now")
        copied.follower.step()
    progress = copied.follower.progress
    assert "Plug the stick in again" in progress.trouble
    assert (progress.complete_mono, progress.missing_entries) == (100.0, 2)
    assert not copied.stick.exists()  # it is not written where the stick was
    away.rename(copied.stick)
    assert copied.step()
    assert copied.follower.progress == ("", 110.0, 0, "uuid", "")


def test_the_files_are_removed_from_the_stick(copied):
    assert copied.step()
    for path in copied.stick.iterdir():
        path.unlink()
    copied.writer.entry("/notification", "now")
    copied.follower.step()
    assert "removed" in copied.trouble
    assert copied.step()


def test_a_mount_point_without_its_stick_is_not_written_to(copied, monkeypatch):
    real, devices = os.stat, {str(copied.stick): 77}

    class Other:
        def __init__(self, stat, device):
            self.stat, self.st_dev = stat, device

        def __getattr__(self, name):
            return getattr(self.stat, name)

    monkeypatch.setattr(folders.os, "stat", lambda path, **of: (
        Other(real(path, **of), devices[path]) if path in devices else real(path, **of)))
    assert copied.step()
    away = copied.stick.with_name("away")
    copied.stick.rename(away)
    copied.stick.mkdir()
    del devices[str(copied.stick)]
    copied.follower.step()
    copied.follower.step()
    assert "not mounted" in copied.trouble
    assert not list(copied.stick.iterdir())


def test_a_restarted_process_adds_only_what_is_missing(copied, monkeypatch):
    copied.writer.run(run_record())
    copied.writer.entry("/notification", "before")
    assert copied.step()
    copied.follower.close()
    copied.writer.entry("/notification", "meanwhile")
    written = []
    write = folders.CopyFolder.write
    monkeypatch.setattr(folders.CopyFolder, "write", lambda folder, found, beside: (
        written.append(found), write(folder, found, beside)))
    copied.follower = copied.new_follower()
    assert copied.step()
    assert sum(len(found.tables["entries"]) for found in written) == 1
    assert not any(found.tables["runs"] for found in written)
    assert not asides(copied.stick)


def test_a_copy_of_another_journal_is_kept_aside(copied, tmp_path):
    other = Writer(tmp_path / "other")
    other.utc += 5.0
    other.entry("/notification", "of another competition")
    other.close()
    shutil.copy(other.path, copied.stick)
    copied.writer.entry("/notification", "now")
    before = contents(copied.stick)
    assert copied.step()
    (aside,) = asides(copied.stick)
    assert copied.follower.progress.aside == str(copied.stick / aside)
    kept = tmp_path / "kept"
    kept.mkdir()
    shutil.copy(copied.stick / aside, kept / FILE_NAME)
    assert contents(kept) == before


def test_entries_that_only_the_copy_has_are_kept_aside(copied, tmp_path):
    """A power cut may take the newest entries from the box's disk, or a core wrote into the copy."""
    copied.writer.entry("/notification", "saved")
    copied.writer.journal.close()
    shutil.copytree(copied.log_dir, tmp_path / "before")
    copied.writer = Writer(copied.log_dir)
    copied.writer.entry("/notification", "lost with the power")
    assert copied.step()
    copied.writer.journal.close()
    copied.follower.close()
    shutil.rmtree(copied.log_dir)
    shutil.copytree(tmp_path / "before", copied.log_dir)
    copied.writer = Writer(copied.log_dir)
    copied.writer.entry("/notification", "after the power cut")
    assert copied.step()
    assert len(asides(copied.stick)) == 1


def test_the_core_begins_another_journal(copied):
    copied.writer.entry("/notification", "before")
    assert copied.step()
    copied.writer.journal.close()
    copied.writer.journal = Journal(
        str(copied.log_dir), copied.writer.journal._session._replace(utc=1.0), "[]", Resume.NEVER, lambda text: None)
    copied.writer.entry("/notification", "of the new one")
    assert copied.step()
    assert len(asides(copied.stick)) == 1


def test_a_damaged_copy_is_kept_aside(copied):
    (copied.stick / FILE_NAME).write_bytes(b"no database" * 1000)
    assert copied.step()
    assert len(asides(copied.stick)) == 1


def test_two_followers_do_not_share_a_stick(copied):
    assert copied.step()
    second = copied.new_follower()
    second.step()
    assert "another core or copy" in second.progress.trouble
    copied.follower.close()
    second.step()
    assert not second.progress.trouble
    second.close()


def test_there_is_no_journal_yet(copied, tmp_path):
    follower = Follower(str(tmp_path / "nothing"), lambda: folders.CopyFolder(str(copied.stick)))
    follower.step()
    assert "no journal" in follower.progress.trouble
    assert not list(copied.stick.iterdir())


def test_the_journal_needs_no_lock_of_the_follower(copied):
    """The core can write, checkpoint and end in any state of the copy."""
    copied.writer.entry("/notification", "first")
    assert copied.step()
    with contextlib.closing(sqlite3.connect(copied.writer.path, timeout=0.0, isolation_level=None)) as connection:
        assert connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0] == 0
    copied.writer.entry("/notification", "second")
    assert copied.step()


def test_nothing_is_written_while_nothing_changes(copied, monkeypatch):
    copied.writer.entry("/notification", "now")
    assert copied.step()
    monkeypatch.setattr(folders.CopyFolder, "write", None)
    assert copied.step()


def test_the_thread_copies(copied, monkeypatch):
    done = threading.Event()
    write = folders.CopyFolder.write
    monkeypatch.setattr(folders.CopyFolder, "write", lambda *arguments: (write(*arguments), done.set()))
    copied.follower.start()
    assert done.wait(60.0)
    done.clear()
    copied.writer.entry("/notification", "now")
    assert done.wait(60.0)
    copied.follower.end(60.0)
    assert contents(copied.stick) == contents(copied.log_dir)


def test_a_full_stick_is_reported_and_catches_up(copied):
    assert copied.step()
    connection = copied.follower._copy._connection
    connection.execute(f"PRAGMA max_page_count = {connection.execute('PRAGMA page_count').fetchone()[0]}")
    for _ in range(100):
        copied.writer.entry("/notification", "x" * 300)
    copied.follower.step()
    assert "full" in copied.trouble
    assert copied.follower.progress.missing_entries == 100
    assert copied.step()  # another file handle has no limit: there is space again


def test_damaged_text_is_copied_too(copied):
    """Its checksum shows the damage. Everything after it must not be missing in the copy."""
    copied.writer.run(run_record())
    for number in range(3):
        copied.writer.entry("/notification", number)
    with contextlib.closing(sqlite3.connect(copied.writer.path, isolation_level=None)) as connection:
        connection.execute("UPDATE entries SET value = CAST(x'22ff22' AS TEXT) WHERE id = 2")
        connection.execute("UPDATE sessions SET launch = CAST(x'ff' AS TEXT)")
    copied.follower.step()
    assert not copied.trouble
    found = contents(copied.stick)
    assert [row[COLUMNS["entries"].index("value")] for row in found["entries"]] == ["0", '"\ufffd"', "2"]
    assert found["sessions"][0][COLUMNS["sessions"].index("launch")] == "\ufffd"


# -- questions ------------------------------------------------------------------------------------------


def test_a_question_is_answered_when_the_copy_has_everything_up_to_it(copied, monkeypatch):
    answered = []
    copied.follower = Follower(
        str(copied.log_dir), Stick(str(copied.stick), str(copied.log_dir)).open,
        on_answer=lambda question: answered.append((question, len(contents(copied.stick)["entries"]))))
    assert copied.step()
    copied.writer.entry("/notification", 1)
    copied.follower.ask("first")
    away = copied.stick.with_name("away")
    copied.stick.rename(away)
    copied.follower.step()
    assert not answered
    away.rename(copied.stick)
    copied.follower.step()
    copied.follower.step()
    assert answered == [("first", 1)]  # once
    write = folders.CopyFolder.write

    def write_late(folder, *arguments):
        """The core writes, and asks, while the copy is written."""
        copied.writer.entry("/notification", 3)
        copied.follower.ask("third")
        write(folder, *arguments)

    copied.writer.entry("/notification", 2)
    copied.follower.ask("second")
    with monkeypatch.context() as patch:
        patch.setattr(folders.CopyFolder, "write", write_late)
        copied.follower.step()
    assert answered[1:] == [("second", 2)]
    copied.follower.step()
    assert answered[2:] == [("third", 3)]


def test_a_journal_that_is_written_all_the_time_is_complete_in_each_step(copied, monkeypatch):
    write = folders.CopyFolder.write

    def write_late(folder, *arguments):
        copied.writer.entry("/notification", "late")
        write(folder, *arguments)

    monkeypatch.setattr(folders.CopyFolder, "write", write_late)
    for number in range(1, 4):
        copied.mono += 1.0
        copied.writer.entry("/notification", "now")
        copied.follower.step()
        assert copied.follower.progress == ("", copied.mono, 0, "uuid", "")
        assert len(contents(copied.stick)["entries"]) == 2 * number - 1


def test_a_question_wakes_the_thread(copied, monkeypatch):
    """Otherwise a referee would wait for the next look at the journal."""
    monkeypatch.setattr(module, "PERIOD_S", 1000.0)
    answered = queue.Queue()
    follower = Follower(str(copied.log_dir), Stick(str(copied.stick), str(copied.log_dir)).open, on_answer=answered.put)
    follower.start()
    for number in (1, 2):
        copied.writer.entry("/notification", number)
        follower.ask(number)
        assert answered.get(timeout=60.0) == number
    follower.end(60.0)
