"""Run logs on a real disk that is full, read-only or broken (tiny ones, where this user may mount them)."""

import os
import time

import pytest

from helpers.bags import entries, plain
from helpers.run_log_loop import LIMIT_S, PORT, Loop, complete
from helpers.small_disk import CannotMount, SmallDisk
from roah_rsbb.run_logs import writer
from roah_rsbb.run_logs.bag_file import DRAFT
from roah_rsbb.run_logs.salvage import Salvage


@pytest.fixture(autouse=True)
def _quick(monkeypatch):
    monkeypatch.setattr(writer, "CHECK_S", 0.02)
    monkeypatch.setattr(writer, "RETRY_S", 0.05)


@pytest.fixture
def disk(tmp_path, request):
    try:
        made = SmallDisk(tmp_path / "disk", **getattr(request, "param", {"kilobytes": 512}))
    except (CannotMount, OSError) as error:
        pytest.skip(f"no file system can be mounted here: {error}")
    yield made
    made.close()


@pytest.fixture
def loop(disk):
    made = Loop(disk.path / "logs")
    yield made
    made.writer.stop()


def answer_until_repaired(loop):
    deadline = time.monotonic() + LIMIT_S
    while not loop.repaired:
        assert time.monotonic() < deadline
        loop.answer()
        loop.settle()


def test_a_full_disk(disk, loop):
    path = loop.open()
    loop.log(entries(20))
    loop.settle()
    disk.fill()
    loop.log(entries(300, first=20))
    loop.wait(loop.troubles)
    assert "No space left" in loop.troubles[0] and "free space" in loop.troubles[0]
    loop.log(entries(20, first=320))
    disk.free()
    answer_until_repaired(loop)
    loop.log(entries(20, first=340))
    loop.close()
    assert complete(path) == plain(entries(360))
    assert len(loop.troubles) == 1
    assert list(path.parent.iterdir()) == [path]


def test_a_disk_that_is_full_before_the_run(disk, loop):
    disk.fill()
    path = loop.open()
    loop.log(entries(20))
    loop.wait(loop.troubles)
    loop.close()
    loop.settle()
    disk.free()
    answer_until_repaired(loop)
    assert complete(path) == plain(entries(20))


def test_a_disk_that_has_room_for_a_little_only(disk, loop):
    path = loop.open()
    loop.log(entries(2000))
    loop.settle()
    size = path.stat().st_size
    disk.fill(leave=size // 2)  # for more of the log, but not for rewriting it
    loop.log(entries(2000, first=2000))
    loop.wait(loop.troubles)
    time.sleep(0.3)  # some attempts
    assert (loop.repaired, loop.posted.qsize()) == ([], 0)
    left = []
    loop.writer._jobs.put(lambda: left.append(os.path.exists(str(path) + DRAFT)))  # not during an attempt
    loop.settle()
    assert left == [False]
    disk.free()
    answer_until_repaired(loop)
    loop.close()
    assert complete(path) == plain(entries(4000))


def test_the_core_is_ended_while_the_disk_is_full(disk):
    loop = Loop(disk.path / "logs")
    path = loop.open()
    loop.log(entries(20))
    loop.settle()
    disk.fill()
    loop.log(entries(300, first=20))
    loop.wait(loop.troubles)
    loop.writer.stop()
    assert not loop.writer._thread.is_alive()
    disk.free()
    # The next start.
    again = Loop(disk.path / "logs")
    again.journal = loop.journal
    again.writer.resumed(PORT, str(path))
    again.answer()
    again.close()
    assert complete(path) == plain(entries(320))
    again.writer.stop()


def test_a_read_only_directory(disk):
    disk.make_read_only()
    loop = Loop(disk.path / "logs")
    assert "cannot be created" in loop.writer.check()
    path = loop.open()
    loop.log(entries(20))
    loop.wait(loop.troubles)
    assert "Read-only" in loop.troubles[0] and "make the disk of log_dir writable" in loop.troubles[0]
    disk.make_writable()
    answer_until_repaired(loop)
    loop.log(entries(20, first=20))
    loop.close()
    assert complete(path) == plain(entries(40))
    loop.writer.stop()


def test_old_logs_on_a_full_disk_stay_as_they_are(disk):
    loop = Loop(disk.path / "logs")
    path = loop.open()
    loop.log(entries(20))
    loop.settle()
    open_log = path.read_bytes()
    loop.close()
    assert complete(path)
    loop.writer.stop()
    path.write_bytes(open_log)
    disk.fill()
    again = Loop(disk.path / "logs")
    again.writer.repair({})
    again.wait(again.troubles)
    assert "No space left" in again.troubles[0] and "rosbag reindex" in again.troubles[0]
    assert path.read_bytes() == open_log
    again.writer.stop()
    disk.free()
    once_more = Loop(disk.path / "logs")
    once_more.writer.repair({})
    assert complete(path) == plain(entries(20))
    once_more.writer.stop()


@pytest.mark.parametrize("disk", [{"kilobytes": 2048, "breaks": True}], indirect=True)
def test_a_disk_that_fails(disk, loop):
    path = loop.open()
    loop.log(entries(20))
    loop.settle()
    disk.fail()
    loop.log(entries(2000, first=20))
    loop.wait(loop.troubles)
    assert any(text in loop.troubles[0] for text in ("Read-only", "Input/output"))
    assert str(path) in loop.troubles[0]
    loop.close()
    loop.settle()
    assert loop.repaired == []
    with open(str(path), "rb") as file:
        assert len(list(Salvage(file))) >= 20
