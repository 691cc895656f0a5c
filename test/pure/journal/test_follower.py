"""The copy survives missing sticks, other journals, restarts and full disks, and catches up."""

import errno
import os
import queue
import shutil
import threading

import pytest

from helpers.competition import run_record
from helpers.copied import contents, numbers
from helpers.journals import Writer
from roah_rsbb.journal import copy_folder as copies
from roah_rsbb.journal import copy_folder as folders
from roah_rsbb.journal import copy_follower, log
from roah_rsbb.journal import copy_follower as module
from roah_rsbb.journal.copy_folder import NEXT, CannotWriteCopy, CopyFolder, Stick, drop_drafts
from roah_rsbb.journal.copy_follower import Follower
from roah_rsbb.journal.log_dir import JOURNAL, Resume
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.store import Journal

PART_BYTES = 300


def asides(folder):
    return sorted(path.name for path in folder.iterdir() if "_aside_" in path.name)


def segments_in(folder, which=""):
    """The paths of the segments in a folder, oldest first; `which`: of the new copy."""
    path = folder / (JOURNAL + which)
    return [path / str(name) for name in log.names_in(str(path))]


def newest(folder):
    return segments_in(folder)[-1]


def inode(path):
    return os.stat(path).st_ino


@pytest.fixture
def small_parts(monkeypatch):
    monkeypatch.setattr(copy_follower, "PART_BYTES", PART_BYTES)


@pytest.fixture
def parts(copied):
    """The parts that are written."""
    found = []
    copied.on_part = lambda write, part: (write(part), found.append(part))
    return found


def stop_after(copied, count):
    """The follower ends after so many parts, as if it were killed."""
    written = []

    def write_some(write, part):
        write(part)
        written.append(part)
        if len(written) == count:
            copied.follower._ended.set()

    copied.on_part, on_part = write_some, copied.on_part
    copied.follower.step()
    copied.on_part = on_part
    copied.follower.close()
    copied.follower = copied.new_follower()


def test_the_copy_is_a_journal_with_all_data(copied):
    copied.writer.run(run_record())
    copied.writer.entry("/notification", "at the bed")
    (copied.log_dir / "used_private_ports").write_text("6667\n")
    (copied.log_dir / "configuration.json").write_text("{}")
    assert copied.step()
    reader = JournalReader(str(copied.stick / JOURNAL))
    assert reader.runs()[0].outcome
    assert not reader.damage
    assert (copied.stick / "used_private_ports").read_text() == "6667\n"
    assert (copied.stick / "configuration.json").read_text() == "{}"


def test_files_beside_the_journal_are_copied_before_the_records_that_need_them(copied):
    (copied.log_dir / "configuration.json").write_text("version 1")
    assert copied.step()
    (copied.log_dir / "configuration.json").write_text("version 2 for a run")
    copied.writer.entry("/notification", "of the run")
    found = []
    copied.on_part = lambda write, part: (
        found.append((copied.stick / "configuration.json").read_text()), write(part))
    assert copied.step()
    assert found == ["version 2 for a run"]


def test_a_journal_with_several_segments_is_copied_in_parts(copied, small_parts):
    for _ in range(3):
        for number in range(20):
            copied.writer.entry("/notification", number)
        copied.restart_box()
    assert copied.step()
    assert len(segments_in(copied.stick)) == 4


@pytest.mark.parametrize("count", range(1, 12))
def test_an_interrupted_copy_is_an_earlier_state(copied, small_parts, count):
    """A segment is complete before the next one begins, and none has a name before it has its summary."""
    copied.writer.entry("/notification", "first")
    assert copied.step()
    before = numbers(copied.stick)
    for number in range(4):
        copied.writer.entry("/notification", number)
    copied.restart_box()
    copied.writer.entry("/notification", "last")
    stop_after(copied, count)
    found = numbers(copied.stick)
    assert before <= found == list(range(1, len(found) + 1))
    for path in segments_in(copied.stick):
        content = log.read(str(path))
        assert any(frame.is_summary for frame in log.frames(content, log.read_head(content).salt))
    assert copied.step()
    assert not asides(copied.stick)


def test_each_part_is_on_the_disk_before_the_next_one(copied, monkeypatch, small_parts):
    happened, fsync, write = [], os.fsync, log.Files.write
    monkeypatch.setattr(log.Files, "write", staticmethod(lambda fd, content, at: (
        happened.append("write"), write(fd, content, at))))
    monkeypatch.setattr(folders.os, "fsync", lambda fd: (happened.append("fsync"), fsync(fd)))
    copied.writer.entry("/notification", "x" * 3 * PART_BYTES)
    copied.writer.journal.close()
    copied.follower.step()
    writes = [at for at, what in enumerate(happened) if what == "write"]
    assert len(writes) > 2 and all(happened[at + 1] == "fsync" for at in writes)


def test_the_journal_is_known_before_it_has_a_copy(copied):
    """Otherwise the core would take it for the one of another core."""
    copied.stick.rmdir()
    assert not copied.step()
    assert copied.follower.progress.journal == copied.writer.journal.identity
    assert copied.follower.progress.complete_mono is None


def test_what_is_being_written_is_not_copied(copied):
    """On a full disk, the box may have written a part of a record, and writes the record again in another way."""
    copied.writer.entry("/notification", 1)
    path = newest(copied.log_dir)
    whole = path.read_bytes()
    path.write_bytes(whole + whole[-80:-20])
    copied.follower.step()
    assert not copied.trouble
    assert newest(copied.stick).read_bytes() == whole


def test_damage_in_a_segment_is_copied_with_what_follows(copied):
    """The record's checksum shows the damage. Nothing else must be missing in the copy."""
    for number in range(5):
        copied.writer.entry("/notification", number)
    copied.writer.journal.close()
    path = newest(copied.log_dir)
    content = bytearray(path.read_bytes())
    frames = list(log.frames(bytes(content), log.read_head(content).salt))
    content[frames[-3].at + 40] ^= 1
    path.write_bytes(content)
    copied.follower.step()
    assert not copied.trouble
    assert newest(copied.stick).read_bytes() == content
    copied.writer = copied.new_writer()
    assert copied.step()
    assert not asides(copied.stick)


def test_a_stick_that_is_pulled_out_is_reported_and_catches_up(copied):
    assert copied.step()
    copied.mono = 110.0
    before = newest(copied.log_dir).stat().st_size
    away = copied.stick.with_name("away")
    copied.stick.rename(away)
    for _ in range(2):
        copied.writer.entry("/notification", "now")
        copied.follower.step()
    progress = copied.follower.progress
    assert "Plug the stick in again" in progress.trouble
    assert progress.complete_mono == 100.0
    assert progress.missing_bytes == newest(copied.log_dir).stat().st_size - before > 0
    assert not copied.stick.exists()  # it is not written where the stick was
    away.rename(copied.stick)
    assert copied.step()
    assert copied.follower.progress[:3] == ("", 110.0, 0)


def test_the_files_are_removed_from_the_stick(copied):
    assert copied.step()
    shutil.rmtree(copied.stick / JOURNAL)
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


def test_another_stick_in_the_same_place(copied):
    """It has an earlier copy. Nothing is written to it before that is known."""
    (copied.log_dir / "used_private_ports").write_text("6667\n")
    assert copied.step()
    other = copied.stick.with_name("other")
    shutil.copytree(copied.stick, other)
    (other / "used_private_ports").unlink()
    before = newest(other).read_bytes()
    copied.writer.entry("/notification", "only on the first one")
    assert copied.step()
    copied.stick.rename(copied.stick.with_name("first"))
    other.rename(copied.stick)
    copied.writer.entry("/notification", "now")
    copied.follower.step()
    assert "it was removed. Plug the stick in again" in copied.trouble
    assert newest(copied.stick).read_bytes() == before
    assert copied.step()
    assert (copied.stick / "used_private_ports").read_text() == "6667\n"


def test_a_restarted_process_adds_only_what_is_missing(copied, parts):
    copied.writer.run(run_record())
    copied.writer.entry("/notification", "before")
    assert copied.step()
    copied.follower.close()
    before = newest(copied.stick).stat().st_size
    copied.writer.entry("/notification", "meanwhile")
    parts.clear()
    copied.follower = copied.new_follower()
    assert copied.step()
    assert [part.at for part in parts] == [before]
    assert not asides(copied.stick)


# -- other journals -------------------------------------------------------------------------------------

def test_a_copy_of_another_journal_is_kept_aside(copied, tmp_path):
    other = Writer(tmp_path / "other")
    other.entry("/notification", "of another competition")
    other.close()
    shutil.copytree(tmp_path / "other" / JOURNAL, copied.stick / JOURNAL)
    copied.writer.entry("/notification", "now")
    before = contents(copied.stick)
    assert copied.step()
    (aside,) = asides(copied.stick)
    assert copied.follower.progress.aside == str(copied.stick / aside)
    (copied.stick / aside).rename(tmp_path / JOURNAL)
    assert contents(tmp_path) == before


def test_records_that_only_the_copy_has_are_kept_aside(copied, tmp_path):
    """A power cut may take the newest records from the box's disk, or a core wrote into the copy."""
    copied.writer.entry("/notification", "saved")
    copied.writer.journal.close()
    shutil.copytree(copied.log_dir, tmp_path / "before")
    copied.writer = copied.new_writer()
    copied.writer.entry("/notification", "lost with the power")
    assert copied.step()
    copied.writer.journal.close()
    copied.follower.close()
    shutil.rmtree(copied.log_dir)
    shutil.copytree(tmp_path / "before", copied.log_dir)
    copied.writer = copied.new_writer()
    copied.writer.entry("/notification", "after the power cut")
    assert copied.step()
    assert len(asides(copied.stick)) == 1


@pytest.mark.parametrize("lost", ["shorter", "other content"])
def test_records_at_the_end_of_a_segment_that_only_the_copy_has(copied, lost):
    _continued_without_its_end(copied, lost == "other content")
    assert copied.step()
    assert len(asides(copied.stick)) == 1


def _continued_without_its_end(copied, is_overwritten=False):
    """A power failure takes the end of the box's newest segment, and the box continues in the next one."""
    copied.writer.entry("/notification", "saved")
    size = newest(copied.log_dir).stat().st_size
    copied.writer.entry("/notification", "lost with the power")
    assert copied.step()
    copied.writer.journal.close()
    path = newest(copied.log_dir)
    path.write_bytes(path.read_bytes()[:size].ljust(path.stat().st_size if is_overwritten else size, b"\0"))
    copied.writer = copied.new_writer()
    copied.follower.close()
    copied.follower = copied.new_follower()


def test_a_new_copy_takes_the_place_of_the_one_before_when_it_is_complete(copied, monkeypatch):
    """A takeover needs what was confirmed."""
    _continued_without_its_end(copied)
    before = contents(copied.stick)
    write = CopyFolder.write
    with monkeypatch.context() as interrupted:
        def write_one(self, part):
            if part.segment == newest(copied.log_dir).name:
                raise CannotWriteCopy("the stick was pulled out")
            write(self, part)
        interrupted.setattr(CopyFolder, "write", write_one)
        assert not copied.step()
    assert len(segments_in(copied.stick)) == 1 and len(segments_in(copied.stick, NEXT)) == 1
    assert contents(copied.stick) == before
    assert copied.step()
    assert contents(copied.stick) == contents(copied.log_dir)
    (aside,) = asides(copied.stick)
    assert copied.follower.progress.aside == str(copied.stick / aside)
    assert not list(copied.stick.glob(f"*{NEXT}*"))


def test_a_copy_whose_exchange_was_interrupted_is_used(copied, monkeypatch):
    def rename(old, new):
        if NEXT in old:
            raise OSError(errno.EIO, "pulled out")
        os.replace(old, new)

    _continued_without_its_end(copied)
    with monkeypatch.context() as killed:
        killed.setattr("os.rename", rename)
        assert not copied.step()
    assert not (copied.stick / JOURNAL).exists()
    assert not drop_drafts(str(copied.stick))
    assert contents(copied.stick) == contents(copied.log_dir)


def test_the_core_begins_another_journal(copied):
    copied.writer.entry("/notification", "before")
    assert copied.step()
    copied.writer.journal.close()
    copied.writer.journal = Journal(
        str(copied.log_dir), copied.writer.journal._session._replace(utc=1.0), "[]", Resume.NEVER, lambda text: None)
    copied.writer.entry("/notification", "of the new one")
    assert copied.step()
    assert len(asides(copied.stick)) == 1


def test_an_earlier_state_of_the_journal_is_put_back(copied):
    """While the copy is kept."""
    copied.writer.entry("/notification", "first")
    earlier = newest(copied.log_dir).read_bytes()
    copied.writer.entry("/notification", "second")
    assert copied.step()
    newest(copied.log_dir).write_bytes(earlier)
    assert copied.step()
    assert len(asides(copied.stick)) == 1


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("at", [10, -10])
def test_a_damaged_copy(copied, which, at):
    """One bit. The end of the newest segment may be torn, and is written again. Otherwise, the copy is kept aside: the
    damage may be that of the box's journal."""
    copied.writer.entry("/notification", "first")
    copied.restart_box()
    copied.writer.entry("/notification", "now")
    assert copied.step()
    copied.follower.close()
    path = segments_in(copied.stick)[which]
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    copied.follower = copied.new_follower()
    assert copied.step()
    assert len(asides(copied.stick)) == (which == 0)


def test_two_followers_do_not_share_a_stick(copied):
    assert copied.step()
    second = copied.new_follower()
    second.step()
    assert "another box or copy" in second.progress.trouble
    copied.follower.close()
    second.step()
    assert not second.progress.trouble
    second.close()


def test_there_is_no_journal_yet(copied, tmp_path):
    follower = Follower(str(tmp_path / "nothing"), lambda: CopyFolder(str(copied.stick)))
    follower.step()
    assert "no journal" in follower.progress.trouble
    assert not list(copied.stick.iterdir())


def test_nothing_is_written_while_nothing_changes(copied, monkeypatch):
    copied.writer.entry("/notification", "now")
    assert copied.step()
    copied.on_part = None
    monkeypatch.setattr(CopyFolder, "write_files", None)
    assert copied.step()


def test_the_thread_copies(copied):
    done = threading.Event()
    copied.on_part = lambda write, part: (write(part), done.set())
    copied.follower.start()
    assert done.wait(60.0)
    done.clear()
    copied.writer.entry("/notification", "now")
    assert done.wait(60.0)
    copied.follower.end(60.0)
    assert contents(copied.stick) == contents(copied.log_dir)


# -- full disks and power failures ----------------------------------------------------------------------

def test_a_full_stick_is_reported_and_catches_up(copied, monkeypatch):
    assert copied.step()
    write = log.Files.write

    def write_some(fd, content, at):
        write(fd, content[:7], at)
        raise OSError(errno.ENOSPC, "No space left on device")

    before = newest(copied.log_dir).stat().st_size
    copied.writer.entry("/notification", "x" * 300)
    with monkeypatch.context() as patch:
        patch.setattr(folders.log.Files, "write", staticmethod(write_some))
        for _ in range(2):
            copied.follower.step()
            assert copied.trouble == f"the disk is full. Free space for {copied.stick}"
            assert copied.follower.progress.missing_bytes == newest(copied.log_dir).stat().st_size - before
    assert copied.step()
    assert not asides(copied.stick)


@pytest.mark.parametrize("end", [b"", bytes(50), b"\xa5" * 4000])
def test_the_torn_end_of_a_copy_is_written_again(copied, end):
    """After a power failure. The copy is continued, and has no torn end any more."""
    copied.writer.entry("/notification", "on the disk")
    assert copied.step()
    before = newest(copied.stick).read_bytes()
    copied.writer.entry("/notification", "lost")
    assert copied.step()
    copied.follower.close()
    newest(copied.stick).write_bytes(before + end)
    copied.follower = copied.new_follower()
    assert copied.step()
    assert newest(copied.stick).read_bytes() == newest(copied.log_dir).read_bytes()
    assert not asides(copied.stick)


def test_a_gap_in_what_may_be_torn_is_no_damage(copied, monkeypatch):
    """Of a copy that was not saved yet, the disk may have the second record and not the first, which was proven on the
    disk of the box."""
    copied.writer.entry("/notification", "copied before")
    assert copied.step()
    saved = newest(copied.stick).stat().st_size
    before = numbers(copied.stick)
    for number in range(2):
        copied.writer.entry("/notification", number)
        copied.save()
    assert copied.step()
    path = newest(copied.stick)
    content = bytearray(path.read_bytes())
    content[saved:saved + 32] = bytes(32)
    path.write_bytes(content)
    assert numbers(copied.stick) == before
    monkeypatch.setattr(folders, "CERTAIN_BYTES", 0)  # from here on, each part is noted to be on the disk
    copied.follower.close()
    copied.follower = copied.new_follower()
    assert copied.step()
    content[saved:saved + 32] = bytes(32)
    path.write_bytes(content)
    assert len(numbers(copied.stick)) == len(before) + 1, "what was on the disk is damaged"


def test_what_may_be_torn_in_a_copy_that_does_not_say_so_yet(copied):
    """It was begun by hand, for example."""
    assert copied.step()
    copied.follower.close()
    (copied.stick / f"{JOURNAL}{log.CERTAIN}").unlink()
    saved, before = newest(copied.stick).stat().st_size, numbers(copied.stick)
    copied.follower = copied.new_follower()
    for number in range(2):
        copied.writer.entry("/notification", number)
        copied.save()
    assert copied.step()
    content = bytearray(newest(copied.stick).read_bytes())
    content[saved:saved + 32] = bytes(32)
    newest(copied.stick).write_bytes(content)
    assert numbers(copied.stick) == before


# -- a failed fsync -------------------------------------------------------------------------------------

def failing_sync(monkeypatch, name, error=errno.EIO):
    """Let the next fsync of a file or folder with this name fail. What was written is in memory."""
    fsync, failed = os.fsync, []

    def fail(fd):
        if not failed and os.path.basename(os.readlink(f"/proc/self/fd/{fd}")) == name:
            failed.append(fd)
            raise OSError(error, os.strerror(error))
        fsync(fd)

    monkeypatch.setattr(os, "fsync", fail)
    return failed


def fail_sync(copied, monkeypatch, name=""):
    """Let an fsync of the next copy fail."""
    copied.writer.entry("/notification", "not saved")
    copied.save()
    with monkeypatch.context() as patch:
        failed = failing_sync(patch, name or newest(copied.stick).name)
        copied.follower.step()
    assert failed
    assert "its disk failed to save what was written" in copied.trouble


def is_again(folder):
    """Whether the newest segment is to be written again."""
    return newest(folder).with_name(newest(folder).name + log.DRAFT).exists()


@pytest.fixture
def failed(copied, monkeypatch):
    """A copy with two segments and some records, in which an fsync has failed."""
    copied.restart_box()
    for number in range(30):
        copied.writer.entry("/notification", number)
    assert copied.step()
    fail_sync(copied, monkeypatch)
    return copied


def test_a_segment_is_not_continued_after_a_failed_fsync(failed, small_parts):
    """All of it is written again. The old one stays until the new one is complete, so that a takeover has a copy."""
    before, old = [inode(path) for path in segments_in(failed.stick)], newest(failed.stick).read_bytes()
    written, on_part = [], failed.on_part

    def note(write, part):
        assert newest(failed.stick).read_bytes() == old, "the new one is not complete yet"
        written.append(part.at)
        write(part)

    failed.on_part = note
    assert failed.step()
    assert written == list(range(0, newest(failed.log_dir).stat().st_size, PART_BYTES))
    after = [inode(path) for path in segments_in(failed.stick)]
    assert after[:-1] == before[:-1] and after[-1] != before[-1]
    assert not is_again(failed.stick)
    failed.follower.close()
    failed.on_part = None
    assert failed.step(), "it is trusted, also when it is opened"
    failed.on_part = on_part
    failed.writer.entry("/notification", "later")
    assert failed.step()


def test_a_disk_that_says_only_in_an_fsync_that_it_is_full(copied, monkeypatch):
    assert copied.step()
    before = inode(newest(copied.stick))
    copied.writer.entry("/notification", "not saved")
    with monkeypatch.context() as patch:
        failing_sync(patch, newest(copied.stick).name, errno.ENOSPC)
        copied.follower.step()
    assert "the disk is full" in copied.trouble
    assert copied.step()
    assert inode(newest(copied.stick)) != before


def test_a_restarted_process_does_not_continue_it_either(failed, monkeypatch):
    monkeypatch.setattr(folders, "_untrusted", set())
    before = inode(newest(failed.stick))
    failed.follower.close()
    failed.follower = failed.new_follower()
    assert failed.step()
    assert inode(newest(failed.stick)) != before


def test_a_process_that_ends_while_it_writes_a_segment_again(failed, small_parts, monkeypatch):
    before = inode(newest(failed.stick))
    stop_after(failed, 2)
    monkeypatch.setattr(folders, "_untrusted", set())
    assert is_again(failed.stick) and inode(newest(failed.stick)) == before
    assert failed.step()
    assert not is_again(failed.stick) and inode(newest(failed.stick)) != before


def test_a_copy_that_is_being_written_reports_no_earlier_trouble(failed, small_parts):
    """It takes a while, and needs nobody."""
    reported = []
    failed.on_part = lambda write, part: (reported.append(failed.follower.progress[:3:2]), write(part))
    assert failed.step()
    assert reported[0][0] and not any(trouble for trouble, _ in reported[1:])
    assert reported[-1][1] > 0


@pytest.mark.parametrize("which", ["draft", "folder"])
def test_an_fsync_that_fails_again(failed, monkeypatch, which):
    """Nothing is reported as complete, and the next attempt succeeds."""
    before = newest(failed.stick).read_bytes()
    fail_sync(failed, monkeypatch, newest(failed.stick).name + log.DRAFT if which == "draft" else JOURNAL)
    assert newest(failed.stick).read_bytes().startswith(before)
    assert is_again(failed.stick)
    assert failed.step()
    assert not is_again(failed.stick)


@pytest.mark.parametrize("which", ["segment", "folder"])
def test_an_fsync_that_fails_when_the_copy_is_opened(copied, monkeypatch, which):
    """What a killed process wrote may be only in memory."""
    assert copied.step()
    copied.follower.close()
    copied.follower = copied.new_follower()
    before = inode(newest(copied.stick))
    fail_sync(copied, monkeypatch, JOURNAL if which == "folder" else "")
    assert copied.step()
    assert inode(newest(copied.stick)) != before


def test_a_segment_beside_which_nothing_can_be_created_is_not_continued(copied, monkeypatch):
    """A file system makes itself read-only after an error."""
    assert copied.step()
    before, real = inode(newest(copied.stick)), os.open

    def refuse(path, flags, *mode):
        if path.endswith(log.DRAFT):
            raise OSError(errno.EROFS, "Read-only file system")
        return real(path, flags, *mode)

    with monkeypatch.context() as patch:
        patch.setattr(folders.os, "open", refuse)
        fail_sync(copied, patch)
    assert not is_again(copied.stick)
    assert copied.step()
    assert inode(newest(copied.stick)) != before


def test_drafts_of_a_copy_that_is_used(failed):
    """Nothing may replace a segment of a box."""
    assert folders.drop_drafts(str(failed.stick))
    assert not is_again(failed.stick)
    assert not folders.drop_drafts(str(failed.stick))
    (failed.stick / JOURNAL / f"journal-000009-00000001.log{log.DRAFT}").write_bytes(b"a part")
    assert not folders.drop_drafts(str(failed.stick)), "nothing of it was in the copy"


# -- questions ------------------------------------------------------------------------------------------

def test_a_question_is_answered_when_the_copy_has_everything_up_to_it(copied):
    answered = []
    copied.follower = copied.new_follower(
        on_answer=lambda question: answered.append((question, len(numbers(copied.stick)) - before)))
    assert copied.step()
    before = len(numbers(copied.stick))
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

    def write_late(write, part):
        """The core writes, and asks, while the copy is written."""
        copied.writer.entry("/notification", 3)
        copied.follower.ask("third")
        write(part)

    copied.writer.entry("/notification", 2)
    copied.follower.ask("second")
    copied.on_part, on_part = write_late, copied.on_part
    copied.follower.step()
    copied.on_part = on_part
    assert answered[1:] == [("second", 2)]
    copied.follower.step()
    assert answered[2:] == [("third", 3)]


def test_a_journal_that_is_written_all_the_time_is_complete_in_each_step(copied):
    assert copied.step()
    before = len(numbers(copied.stick))

    def write_late(write, part):
        copied.writer.entry("/notification", "late")
        write(part)

    copied.on_part = write_late
    for number in range(1, 4):
        copied.mono += 1.0
        copied.writer.entry("/notification", "now")
        copied.follower.step()
        assert copied.follower.progress[:3] == ("", copied.mono, 0)
        assert len(numbers(copied.stick)) - before == 2 * number - 1


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


# -- speed ----------------------------------------------------------------------------------------------

def test_what_was_verified_is_not_read_again(copied):
    """A copy whose disk is full is opened once a second."""
    for _ in range(3):
        copied.writer.entry("/notification", "now")
        copied.restart_box()
    assert copied.step()
    for _ in range(2):
        copied.follower.close()
        before = copies._crc_of.cache_info().misses
        assert copied.step()
    assert copies._crc_of.cache_info().misses == before
