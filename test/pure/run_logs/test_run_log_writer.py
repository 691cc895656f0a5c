"""The thread that writes run logs: failures are reported, and the data is written later."""

import errno
import os
import pathlib
import shutil
import struct
import threading
import time

import pytest

from helpers.bags import END, NAME, TEXT, UTC, entries, plain, read, rosbag
from helpers.run_log_loop import LIMIT_S, OTHER, PORT, Loop, complete
from roah_rsbb.run_logs import writer
from roah_rsbb.run_logs.bag_file import DRAFT, GrowingBag, write_whole
from roah_rsbb.run_logs.messages import message_of

pytestmark = pytest.mark.usefixtures("quick_writer")


def broken_disk(monkeypatch, number=errno.ENOSPC):
    """Prevent writing to any file until the returned function is called."""
    state = {"broken": True}
    for name in ("write", "flush"):
        real = getattr(GrowingBag, name)

        def fail(self, *arguments, real=real):
            if state["broken"]:
                raise OSError(number, os.strerror(number))
            return real(self, *arguments)

        monkeypatch.setattr(GrowingBag, name, fail)
    real_allocate = os.posix_fallocate

    def allocate(*arguments):
        if state["broken"]:
            raise OSError(number, os.strerror(number))
        real_allocate(*arguments)

    monkeypatch.setattr(os, "posix_fallocate", allocate)
    return lambda: state.update(broken=False)


def test_runs_side_by_side(loop):
    paths = [loop.open(PORT), loop.open(OTHER)]
    assert paths[0] != paths[1]
    loop.log(entries(5), PORT)
    loop.log(entries(3), OTHER)
    loop.close(PORT)
    loop.close(OTHER)
    assert complete(paths[0]) == plain(entries(5))
    assert complete(paths[1]) == plain(entries(3))
    assert loop.writer.files == {}
    assert loop.troubles == []


def test_entries_are_in_the_file_at_once(loop, tmp_path):
    path = loop.open()
    loop.log(entries(3))
    loop.settle()
    copy = tmp_path / NAME
    shutil.copy(str(path), str(copy))
    write_whole(str(copy), ())
    assert read(copy) == plain(entries(3))


def test_rosbag_reindex_finds_what_is_a_second_old(loop, tmp_path):
    path = loop.open()
    loop.log(entries(3))
    loop.settle()
    copy = tmp_path / NAME

    def found():
        shutil.copy(str(path), str(copy))
        try:
            with rosbag.Bag(str(copy), "a", allow_unindexed=True) as bag:
                list(bag.reindex())
            return read(copy)
        except (rosbag.ROSBagException, struct.error):
            return []  # its first chunk is not ended yet

    deadline = time.monotonic() + LIMIT_S
    while found() != plain(entries(3)):
        assert time.monotonic() < deadline


def test_stop_closes_what_is_open(log_dir):
    loop = Loop(log_dir)
    path = loop.open()
    loop.log(entries(500))
    loop.writer.stop()
    assert read(path) == plain(entries(500))


# -- continuing after a kill ----------------------------------------------------------------------------


def test_a_run_continues_in_its_file(loop, log_dir):
    log_dir.mkdir()
    path = log_dir / NAME
    bag = GrowingBag(str(path))
    for entry in entries(4):
        bag.write(message_of(entry))
    bag.abandon()
    loop.journal[PORT] = entries(6)
    loop.writer.resumed(PORT, str(path))
    assert loop.writer.files[PORT] == str(path)
    loop.log(entries(2, first=6))  # before the writer has asked, or while it waits
    loop.settle()
    loop.log(entries(2, first=8))
    loop.answer()
    loop.log(entries(2, first=10))
    loop.close()
    assert complete(path) == plain(entries(12))
    assert loop.troubles == loop.repaired == []


def test_a_run_that_is_over_before_its_log_can_continue(loop, log_dir):
    loop.journal[PORT] = entries(6)
    loop.writer.resumed(PORT, str(log_dir / NAME))
    loop.log([(END, None, UTC + 6)])
    loop.close()
    loop.answer()
    assert complete(log_dir / NAME) == plain([*entries(6), (END, None, 0.0)])


def test_the_log_is_in_log_dir_wherever_it_was(loop, log_dir, tmp_path):
    loop.journal[PORT] = entries(1)
    loop.journal[OTHER] = entries(2)
    loop.writer.resumed(PORT, str(tmp_path / "another" / NAME))
    loop.writer.resumed(OTHER, "")
    loop.answer()
    loop.answer()
    assert loop.writer.files[PORT] == str(log_dir / NAME)
    other = pathlib.Path(loop.writer.files[OTHER])
    assert str(OTHER) in other.name and other.parent == log_dir
    loop.close(PORT)
    loop.close(OTHER)
    assert complete(log_dir / NAME) == plain(entries(1))
    assert complete(other) == plain(entries(2))


def test_a_run_that_continues_when_the_core_is_ended_at_once(log_dir):
    loop = Loop(log_dir)
    loop.journal[PORT] = entries(6)
    loop.writer.resumed(PORT, str(log_dir / NAME))
    loop.writer.stop()
    assert read(log_dir / NAME) == plain(entries(6))


# -- trouble ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number, remedy", [
    (errno.ENOSPC, "free space on the disk"), (errno.EROFS, "make the disk of log_dir writable"),
    (errno.EACCES, "make log_dir writable for this user"), (errno.EIO, "check the disk"),
])
def test_what_cannot_be_written_is_reported_and_written_later(loop, monkeypatch, number, remedy):
    path = loop.open()
    loop.log(entries(3))
    loop.settle()
    repair = broken_disk(monkeypatch, number)
    loop.log(entries(2, first=3))
    loop.wait(loop.troubles)
    assert os.strerror(number) in loop.troubles[0] and remedy in loop.troubles[0] and str(path) in loop.troubles[0]
    loop.log(entries(2, first=5))
    loop.settle()
    time.sleep(0.2)  # some more attempts
    assert (len(loop.troubles), loop.repaired, loop.posted.qsize()) == (1, [], 0)
    repair()
    loop.answer()
    loop.log(entries(2, first=7))
    loop.wait(loop.repaired)
    assert loop.repaired == [(loop.troubles[0], f"The run log {path} is complete again")]
    loop.close()
    assert complete(path) == plain(entries(9))
    assert len(loop.troubles) == 1


def test_a_trouble_that_comes_again_is_reported_again(loop, log_dir):
    path = loop.open()
    loop.log(entries(2))
    for times in (1, 2):
        loop.settle()
        shutil.rmtree(str(log_dir))
        loop.wait(loop.troubles, times)
        loop.answer()
        loop.wait(loop.repaired, times)
    assert len(loop.repaired) == 2
    loop.close()
    assert complete(path) == plain(entries(2))


def test_an_answer_that_comes_twice_counts_once(loop, log_dir):
    loop.journal[PORT] = entries(3)
    loop.writer.resumed(PORT, NAME)
    answer = loop.posted.get(timeout=LIMIT_S)
    answer()
    loop.log(entries(2, first=3))
    loop.settle()
    before = (log_dir / NAME).stat().st_ino
    answer()
    loop.settle()
    assert (log_dir / NAME).stat().st_ino == before
    loop.close()
    assert complete(log_dir / NAME) == plain(entries(5))


def test_a_run_that_is_over_before_the_disk_is_repaired(loop, monkeypatch):
    repair = broken_disk(monkeypatch)
    path = loop.open()
    loop.log(entries(3))
    loop.wait(loop.troubles)
    loop.close()
    loop.settle()
    repair()
    loop.answer()
    assert complete(path) == plain(entries(3))


def test_the_disk_is_repaired_when_the_core_is_ended(log_dir, monkeypatch):
    loop = Loop(log_dir)
    repair = broken_disk(monkeypatch)
    path = loop.open()
    loop.log(entries(3))
    loop.wait(loop.troubles)
    repair()
    loop.writer.stop()
    assert read(path) == plain(entries(3))


def test_a_core_that_is_ended_with_a_broken_disk_ends(log_dir, monkeypatch):
    loop = Loop(log_dir)
    broken_disk(monkeypatch)
    loop.open()
    loop.log(entries(3))
    loop.wait(loop.troubles)
    loop.writer.stop()
    assert not loop.writer._thread.is_alive()


def test_a_log_that_fails_while_it_is_rewritten(loop, monkeypatch):
    repair = broken_disk(monkeypatch)
    path = loop.open()
    loop.log(entries(3))
    loop.wait(loop.troubles)
    monkeypatch.setattr(writer, "try_out", lambda path, room: None)
    for _ in range(3):
        loop.answer()
        loop.settle()
    assert path.exists() and not pathlib.Path(str(path) + DRAFT).exists()
    repair()
    while not loop.repaired:
        loop.answer()
        loop.settle()
    loop.close()
    assert complete(path) == plain(entries(3))
    assert len(loop.troubles) == 1


@pytest.mark.parametrize("how", ["remove", "rename", "file"])
def test_a_removed_log_is_written_again(loop, log_dir, tmp_path, how):
    path = loop.open()
    loop.log(entries(3))
    loop.settle()
    if how == "remove":
        shutil.rmtree(str(log_dir))
    elif how == "rename":
        log_dir.rename(tmp_path / "elsewhere")
    else:
        path.unlink()
    loop.wait(loop.troubles)
    assert f"{path} was removed" in loop.troubles[0]
    loop.log(entries(2, first=3))
    loop.answer()
    loop.log(entries(2, first=5))
    loop.wait(loop.repaired)
    loop.close()
    assert complete(path) == plain(entries(7))
    if how == "rename":
        assert read(tmp_path / "elsewhere" / path.name)[:3] == plain(entries(3))


def test_a_directory_that_cannot_be_made(loop, log_dir):
    log_dir.write_text("in the way")
    assert "cannot be created" in loop.writer.check()
    path = loop.open()
    loop.log(entries(3))
    loop.wait(loop.troubles)
    log_dir.unlink()
    assert loop.writer.check() == ""
    loop.answer()
    loop.close()
    assert complete(path) == plain(entries(3))


def test_a_disk_that_is_too_slow_gets_the_rest_later(loop, monkeypatch):
    monkeypatch.setattr(writer, "MAX_WAITING", 50)
    hang, hangs = threading.Event(), threading.Event()
    real = GrowingBag.write

    def slow(self, message):
        hangs.set()
        assert hang.wait(LIMIT_S)
        real(self, message)

    monkeypatch.setattr(GrowingBag, "write", slow)
    path, other = loop.open(PORT), loop.open(OTHER)
    loop.log(entries(1))
    assert hangs.wait(LIMIT_S)
    loop.log(entries(1000, first=1))
    loop.log(entries(10), OTHER)
    assert loop.writer._jobs.qsize() < 60
    hang.set()
    loop.wait(loop.troubles, 2)
    assert "too slow" in loop.troubles[0]
    loop.log(entries(5, first=1001))
    loop.answer()
    loop.answer()
    loop.log(entries(5, first=1006))
    loop.wait(loop.repaired, 2)
    loop.close(PORT)
    loop.close(OTHER)
    assert complete(path) == plain(entries(1011))
    assert complete(other) == plain(entries(10))


def test_a_journal_that_cannot_answer_is_asked_again(loop, log_dir, monkeypatch):
    loop.journal[PORT] = entries(3)

    def fail(port):
        raise RuntimeError("test")

    loop.writer.resumed(PORT, NAME)
    for answer in (fail, lambda port: None):
        with monkeypatch.context() as context:
            context.setattr(loop.writer, "_entries_of", answer)
            loop.answer()
    loop.answer()
    loop.close()
    assert complete(log_dir / NAME) == plain(entries(3))


def test_an_entry_that_no_message_can_hold_ends_no_log(loop):
    path = loop.open()
    loop.log([(TEXT, 5, UTC), *entries(2)])
    loop.close()
    assert complete(path) == plain(entries(2))
