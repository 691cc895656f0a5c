"""What the programs ask of the operating system."""

import asyncio
import errno
import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest

from roah_rsbb.ground import durable, linux

TIMEOUT_S = 60.0


# -- files --------------------------------------------------------------------------------------------


def test_a_locked_file_is_not_locked_again(tmp_path):
    path = str(tmp_path / "file")
    with open(path, "w+b", buffering=0) as one, open(path, "rb") as other:
        linux.lock(one.fileno())
        with pytest.raises(BlockingIOError):
            linux.lock(other.fileno())
    with open(path, "rb") as other:
        linux.lock(other.fileno())


def test_whether_a_file_is_locked_is_known_without_a_lock(tmp_path, monkeypatch):
    path = str(tmp_path / "file")
    assert not linux.is_locked(path)
    assert not os.path.exists(path)
    with open(path, "w+b") as file:
        linux.lock(file.fileno())
        assert linux.is_locked(path)
        os.chmod(path, 0o444)
        assert linux.is_locked(path)
    assert not linux.is_locked(path)

    def no_locks(*_arguments):
        raise OSError(errno.EOPNOTSUPP, "this file system has no locks")

    monkeypatch.setattr("fcntl.flock", no_locks)
    assert not linux.is_locked(path)


def test_files_and_folders_are_synced(tmp_path, monkeypatch):
    real, synced = os.fsync, []
    monkeypatch.setattr(os, "fsync", lambda fd: (synced.append(os.readlink(f"/proc/self/fd/{fd}")), real(fd)))
    (tmp_path / "file").touch()
    durable.sync(str(tmp_path / "file"))
    durable.sync(str(tmp_path))
    assert synced == [str(tmp_path / "file"), str(tmp_path)]
    durable.write_file(str(tmp_path / "file"), b"content")
    assert (tmp_path / "file").read_bytes() == b"content"
    assert synced[2:] == [str(tmp_path / "file.new"), str(tmp_path)]


def test_files_that_others_may_read(tmp_path):
    path = tmp_path / "file"
    path.touch()
    path.chmod(0o600)
    assert linux.open_to_others(str(path)) == 0
    path.chmod(0o640)
    assert linux.open_to_others(str(path)) == 0o640


# -- the computer and its processes -------------------------------------------------------------------


def test_the_start_of_the_computer():
    assert linux.boot_id() == pathlib.Path("/proc/sys/kernel/random/boot_id").read_text().strip()


def test_the_clock_that_runs_in_sleep():
    before = time.clock_gettime(time.CLOCK_BOOTTIME)
    assert before <= linux.running_s() <= time.clock_gettime(time.CLOCK_BOOTTIME)


def test_the_status_of_a_process():
    assert linux.status_of(os.getpid())[0] in ("R", "S")
    assert linux.status_of(1 << 30) == [""]


def test_a_process_ends_with_those_that_it_started():
    """The output ends when both of them have ended."""
    process = subprocess.Popen(["bash", "-c", "sleep 1000 & echo ready; wait"], stdout=subprocess.PIPE,
                               start_new_session=True)
    with process:
        assert process.stdout.readline() == b"ready\n"
        linux.end_with_children(process)
        assert process.stdout.read() == b""
    linux.end_with_children(process)  # it has ended already


# -- the loop -----------------------------------------------------------------------------------------


@pytest.fixture
def loop():
    loop = asyncio.new_event_loop()
    yield loop
    loop.close()


@pytest.fixture
def kept_signals():
    kept = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_end_comes_into_the_loop(loop, kept_signals, number):
    ended = loop.create_future()
    linux.on_end(loop, lambda: ended.set_result("ended"))
    loop.call_soon(os.kill, os.getpid(), number)
    assert loop.run_until_complete(asyncio.wait_for(ended, TIMEOUT_S)) == "ended"
    loop.remove_signal_handler(signal.SIGINT)
    loop.remove_signal_handler(signal.SIGTERM)


def test_input_comes_into_the_loop_until_its_end(loop):
    reading, writing = os.pipe()
    came, ended = [], loop.create_future()

    def take(data):
        assert asyncio.get_event_loop() is loop
        came.append(data)
        if not data:
            ended.set_result(None)
        elif b"".join(came) == b"one":
            os.write(writing, b"two")
            os.close(writing)

    with open(reading, "rb") as file:
        linux.on_input(loop, file, take)
        os.write(writing, b"one")
        loop.run_until_complete(asyncio.wait_for(ended, TIMEOUT_S))
    assert b"".join(came) == b"onetwo" and came.count(b"") == 1


def test_there_may_be_no_input(loop):
    with pytest.raises(ValueError, match="no input"):
        linux.on_input(loop, None, print)


# -- sockets ------------------------------------------------------------------------------------------


def test_interfaces():
    assert ("lo", "127.0.0.1") in [(name, address) for name, address, _ in linux.interfaces()]


# -- the browser --------------------------------------------------------------------------------------


def test_other_users_do_not_see_the_address_that_a_browser_is_given(tmp_path):
    """All users see the arguments of programs, and the address of the organiser's page has a code."""
    browser, seen = tmp_path / "browser", tmp_path / "seen"
    browser.write_text(f'#!/bin/sh\necho "$1" > {seen}\ncd "$(dirname "${{1#file://}}")" && stat -c %a . page.html >> '
                       f'{seen} && cat page.html >> {seen}\n')
    browser.chmod(0o700)
    subprocess.run(
        [sys.executable, "-c", "from roah_rsbb.ground.linux import open_in_browser\n"
         "assert open_in_browser('http://127.0.0.1:1/?a=b&token=SECRET')"], check=True,
        env={**os.environ, "HOME": str(tmp_path), "DISPLAY": ":0", "BROWSER": f"{browser} %s"})
    given, folder, file, page = seen.read_text().splitlines()
    assert "SECRET" not in given and given.startswith(f"file://{tmp_path}/roah_rsbb_")
    assert (folder, file) == ("700", "600")
    assert "0;url=http://127.0.0.1:1/?a=b&amp;token=SECRET" in page
    assert not list(tmp_path.glob("roah_rsbb_*")), "it is removed"
