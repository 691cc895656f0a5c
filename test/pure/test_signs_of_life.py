"""Signs of life of the core, and who misses them."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading

import pytest

from roah_rsbb import signs_of_life
from roah_rsbb.client.client import OLD_S
from roah_rsbb.signs_of_life import HUNG_S, LOOK_S, STARTING, SUPERVISOR, CoreSilence, Signs, Watch
from roah_rsbb.web import server

CORE = """
import sys
from roah_rsbb.signs_of_life import Signs
signs = Signs(sys.argv[1])
for line in sys.stdin:
    {"end": signs.end, "wait": signs.wait, "sign": signs.send}[line.strip()]()
    print(flush=True)
"""


class Core:
    """A process that sends signs when the test says so."""

    def __init__(self, log_dir):
        self.process = subprocess.Popen(
            [sys.executable, "-c", CORE, str(log_dir)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.pid = self.process.pid

    def send(self, what="sign"):
        print(what, file=self.process.stdin, flush=True)
        self.process.stdout.readline()

    def close(self):
        self.process.kill()
        self.process.communicate()


class Watched:
    """A core, one who watches it, and their time."""

    def __init__(self, folder):
        self.now, self.folder = 0.0, str(folder)
        self.watch = Watch(str(folder), SUPERVISOR, lambda: self.now)
        self.watch.look()
        self.core = Core(folder)

    def pass_time(self, seconds):
        for _ in range(round(seconds / LOOK_S)):
            self.now += LOOK_S
            self.watch.look()

    def close(self):
        self.core.close()
        self.watch.close()


@pytest.fixture
def watched(tmp_path):
    made = Watched(tmp_path)
    yield made
    made.close()


def silence_after(*looks):
    """The silence after looks: the seconds since the one before, and the process that was heard."""
    silence, now = CoreSilence(), 0.0
    for seconds, pid in looks:
        now += seconds
        silence.look(now, pid)
    return silence


def test_the_time_since_the_last_sign():
    assert not silence_after((0.0, None)).is_alive, "none was heard"
    assert silence_after((0.0, 7)).is_alive
    silent = [(LOOK_S, None)] * round(HUNG_S / LOOK_S)
    assert silence_after((0.0, 7), *silent[:-1]).is_alive
    assert not silence_after((0.0, 7), *silent, (LOOK_S / 2, None)).is_alive
    assert silence_after((0.0, 7), *silent, (LOOK_S, 7)).is_alive
    assert silence_after((0.0, 7), *silent, (LOOK_S, 8)).pid == 8


def test_whoever_was_stopped_itself_knows_nothing_of_that_time():
    """The whole computer may have been stopped: the core is not to blame."""
    assert silence_after((0.0, 7), (3600.0, None)).is_alive
    assert silence_after((0.0, 7), (3600.0, None)).seconds == pytest.approx(2 * LOOK_S)


def test_a_core_that_ended_by_itself_does_not_hang():
    silence = silence_after((0.0, 7), (LOOK_S, 0), *[(LOOK_S, None)] * 100)
    assert silence.pid == 0 and not silence.is_alive


def test_a_core_that_is_stopped_hangs_and_is_killed(watched):
    watched.core.send()
    watched.pass_time(HUNG_S - LOOK_S)
    assert watched.watch.silence.pid == watched.core.pid and not watched.watch.is_hung
    watched.core.process.send_signal(signal.SIGSTOP)
    os.waitpid(watched.core.pid, os.WUNTRACED)
    watched.pass_time(3 * LOOK_S)
    assert watched.watch.is_hung and signs_of_life.state_of(watched.core.pid) == "it is stopped"
    watched.watch.kill()
    assert watched.core.process.wait(60.0) == -signal.SIGKILL
    assert not watched.watch.is_hung, "there is no such process any more"


def test_a_core_that_answers_is_not_killed(watched):
    for _ in range(10):
        watched.core.send()
        watched.pass_time(1.0)
        watched.watch.kill()
    watched.core.send()


def test_a_core_that_ends_by_itself_is_not_waited_for(watched):
    watched.core.send()
    watched.pass_time(LOOK_S)
    watched.core.send("end")
    watched.pass_time(60.0)
    assert not watched.watch.is_hung


def test_another_process_of_the_same_number_is_not_killed(watched, monkeypatch):
    watched.core.send()
    watched.pass_time(HUNG_S + 2 * LOOK_S)
    assert watched.watch.is_hung
    monkeypatch.setattr(signs_of_life, "began", lambda pid: "later")
    watched.watch.kill()
    watched.core.send()


def test_a_core_that_is_gone(watched):
    watched.core.send()
    watched.pass_time(1.0)
    assert not watched.watch.is_gone and not watched.watch.is_starting
    Signs(watched.folder).send(STARTING)
    watched.core.close()
    watched.pass_time(LOOK_S)
    assert watched.watch.is_gone and not watched.watch.is_hung and watched.watch.is_starting
    watched.pass_time(HUNG_S + LOOK_S)
    assert not watched.watch.is_starting and watched.watch.silence.pid == watched.core.pid


def test_the_next_core_has_what_the_one_before_kept(watched):
    def next_core():
        asked = []
        signs = Signs(watched.folder)
        thread = threading.Thread(target=lambda: asked.append(signs.ask()))
        thread.start()
        while thread.is_alive():
            watched.watch.look()
        return signs, asked[0]

    first, failures = next_core()
    assert (failures, first.kept) == (0, {})
    assert first.keep("stop/1", "by Ann") and first.keep("channel/7", "x")
    first.drop("channel/7")
    first.send()
    watched.watch.failed()
    second, failures = next_core()
    assert (failures, second.kept) == (1, {"stop/1": "by Ann"})
    second.send()  # it still keeps what it was given: it may be killed now
    watched.watch.failed()
    third, failures = next_core()
    assert (failures, third.kept) == (2, {"stop/1": "by Ann"})
    third.drop("stop/1")
    for _ in range(round(signs_of_life.STEADY_S) + 2):
        third.send()
        watched.pass_time(1.0)
    assert next_core()[1] == 0, "it lived for long enough"


def test_what_is_kept_has_a_limit(tmp_path):
    signs = Signs(str(tmp_path))
    assert signs.keep("a", "x" * 1000)
    assert not signs.keep("b", "x" * signs_of_life.MOST_KEPT)
    assert signs.keeps("") == ["a"]


def test_nobody_waits_for_a_supervisor_that_is_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr(signs_of_life, "ANSWER_S", 1e6)
    signs = Signs(str(tmp_path))
    assert (signs.ask(), signs.kept) == (0, {})


def test_the_supervisor_waits_longer_each_time(watched):
    found = []
    for _ in range(8):
        found.append(watched.watch.patience_s)
        watched.watch.failed()
    assert found[:3] == [HUNG_S, 2 * HUNG_S, 4 * HUNG_S] and found[-1] == found[-2] == 16 * HUNG_S


def test_nobody_else_can_write_where_signs_are_heard(tmp_path, monkeypatch):
    """Another user could get the core killed, or take the place of who watches."""
    folder = pathlib.Path(tempfile.mkdtemp())  # addresses of sockets are short
    open_to_all, own = folder / "all", folder / "own"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    monkeypatch.setattr(signs_of_life, "_folders", lambda: iter([str(open_to_all), str(own)]))
    watch = Watch(str(tmp_path), SUPERVISOR, lambda: 0.0)
    watch.look()
    assert list(open_to_all.iterdir()) == []
    (address,) = own.iterdir()
    assert (own.stat().st_mode & 0o777, address.stat().st_mode & 0o777) == (0o700, 0o600)
    Signs(str(tmp_path)).send()
    watch.look()
    assert watch.silence.pid == os.getpid()
    watch.close()
    shutil.rmtree(str(folder))


def test_signs_of_another_user_do_not_count(watched, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    watched.core.send()
    watched.pass_time(LOOK_S)
    assert watched.watch.silence.pid == 0


def test_signs_of_another_box_do_not_count(watched, tmp_path):
    other = Core(tmp_path / "other")
    other.send()
    watched.pass_time(LOOK_S)
    other.close()
    assert watched.watch.silence.pid == 0


def test_a_watcher_takes_the_place_of_one_that_ends(watched, tmp_path):
    second = Watch(str(tmp_path), SUPERVISOR, lambda: watched.now)
    second.look()
    watched.watch.close()
    second.look()
    watched.core.send()
    second.look()
    second.close()
    assert second.silence.pid == watched.core.pid


@pytest.mark.parametrize("is_abstract", [False, True])
def test_systemd_gets_each_sign(tmp_path, monkeypatch, is_abstract):
    name = f"@roah_rsbb_test_{os.getpid()}" if is_abstract else str(tmp_path / "notify")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(f"\0{name[1:]}" if is_abstract else name)
        systemd.settimeout(60.0)
        monkeypatch.setenv("NOTIFY_SOCKET", name)
        signs = Signs(str(tmp_path))
        signs.send()
        assert systemd.recv(256).splitlines() == [b"READY=1", b"WATCHDOG=1"]
        signs.end()
        signs.send(STARTING)
        signs.send()
        assert systemd.recv(256) == signs_of_life.SIGN, "nothing else: for systemd, the service does not end"


def test_nobody_watches(tmp_path, monkeypatch):
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "missing"))
    signs = Signs(str(tmp_path))
    for _ in range(1000):
        signs.send()


def test_a_watcher_that_does_not_read_stops_nobody(tmp_path):
    """It may hang itself."""
    watch = Watch(str(tmp_path), SUPERVISOR, lambda: 0.0)
    watch.look()
    signs = Signs(str(tmp_path))
    for _ in range(10_000):
        signs.send()
    watch.close()


def test_each_face_knows_before_the_core_is_ended():
    """The next core may be heard soon: a face that looks later would show nothing of it. Panels know after 0.7 s
    (test/ros/panels/test_benchmark_control.py)."""
    limits = {
        "terminal": OLD_S, "pages": OLD_S + server.LOOK_S,
    }
    assert {face: limit for face, limit in limits.items() if limit > HUNG_S} == {}


def test_a_process_that_waits_is_not_taken_for_the_core(watched):
    """A second box of the same log_dir waits: it must not hide that the first one hangs."""
    watched.core.send()
    watched.pass_time(LOOK_S)
    other = Core(watched.folder)
    try:
        for _ in range(round(HUNG_S / LOOK_S) + 1):
            other.send("wait")
            watched.pass_time(LOOK_S)
        assert watched.watch.is_hung and watched.watch.silence.pid == watched.core.pid
        assert watched.watch.waiting == other.pid
    finally:
        other.close()
