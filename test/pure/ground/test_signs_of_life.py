"""Signs of life of the core, and who misses them."""

import functools
import os
import signal
import socket
import subprocess
import sys
import threading
from unittest import mock

import pytest

from helpers.waiting import wait_until
from roah_rsbb.client.client import OLD_S
from roah_rsbb.ground import signs_of_life
from roah_rsbb.ground.signs_of_life import HUNG_S, LOOK_S, STARTING, CoreSilence, Lifeline, Supervision, Watch
from roah_rsbb.web import server

CORE = """
import sys
from roah_rsbb.ground.signs_of_life import Lifeline
signs = Lifeline(sys.argv[1])
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
        self.watch = Watch(str(folder), lambda: self.now)
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
    Lifeline(watched.folder).send(STARTING)
    watched.core.close()
    watched.pass_time(LOOK_S)
    assert watched.watch.is_gone and not watched.watch.is_hung and watched.watch.is_starting
    watched.pass_time(HUNG_S + LOOK_S)
    assert not watched.watch.is_starting and watched.watch.silence.pid == watched.core.pid


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
    second = Watch(str(tmp_path), lambda: watched.now)
    second.look()
    watched.watch.close()
    second.look()

    def is_heard():
        watched.core.send()
        second.look()
        return second.silence.pid == watched.core.pid
    wait_until(is_heard)
    second.close()


@pytest.mark.parametrize("is_abstract", [False, True])
def test_systemd_gets_each_sign(tmp_path, monkeypatch, is_abstract):
    name = f"@roah_rsbb_test_{os.getpid()}" if is_abstract else str(tmp_path / "notify")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(f"\0{name[1:]}" if is_abstract else name)
        systemd.settimeout(60.0)
        monkeypatch.setenv("NOTIFY_SOCKET", name)
        signs = Lifeline(str(tmp_path))
        signs.send()
        assert systemd.recv(256).splitlines() == [b"READY=1", b"WATCHDOG=1"]
        signs.end()
        signs.send(STARTING)
        signs.send()
        assert systemd.recv(256) == signs_of_life.SIGN, "nothing else: for systemd, the service does not end"


def test_nobody_watches(tmp_path, monkeypatch):
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "missing"))
    signs = Lifeline(str(tmp_path))
    for _ in range(1000):
        signs.send()


@pytest.mark.parametrize("is_there", [False, True])
def test_who_sends_waits_for_no_disk(tmp_path, monkeypatch, is_there):
    """While a disk is frozen, whoever writes to it waits, also to make a folder that is there. Nobody may copy."""
    monkeypatch.setenv("HOME", str(tmp_path))
    if is_there:
        (tmp_path / ".roah_rsbb" / "watch").mkdir(parents=True, mode=0o700)
    waited, begun = [], []

    def watched(name, usual):
        def call(path, *more, **given):
            is_write = name == "mkdir" or (name == "open" and more[:1] != (os.O_RDONLY,))
            if str(path).startswith(str(tmp_path)) and (is_write or (
                    begun and threading.current_thread() is threading.main_thread())):
                waited.append((name, path))
            return usual(path, *more, **given)
        return call
    for name in ("mkdir", "open", "stat"):
        monkeypatch.setattr(os, name, watched(name, getattr(os, name)))
    signs = Lifeline(str(tmp_path))
    begun.append(True)
    signs.send()
    signs.send()
    assert not waited


def test_a_watcher_that_does_not_read_stops_nobody(tmp_path):
    """It may hang itself."""
    watch = Watch(str(tmp_path), lambda: 0.0)
    watch.look()
    signs = Lifeline(str(tmp_path))
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
    finally:
        other.close()


STRANGER = """
import os, socket, sys
os.setuid(65534)
opened = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
for path in sys.argv[1:]:
    for what in (opened.connect, opened.bind):
        try:
            what(path)
            print("could", what.__name__, path)
        except OSError:
            pass
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="needs a second user")
def test_no_other_user_can_write_where_signs_are_heard(watched):
    """Or take that place: one could get a healthy core killed, or switch off who notices a hung one."""
    with signs_of_life._address(watched.folder) as address:
        place = os.path.realpath(address)
    assert os.path.exists(place), "the watch listens there"
    folder = os.path.dirname(place)
    done = subprocess.run([sys.executable, "-c", STRANGER, place, os.path.join(folder, "other")], text=True,
                          stdout=subprocess.PIPE, check=True)
    assert done.stdout == ""
    with open("/proc/net/unix", encoding="utf-8") as file:
        assert not [line for line in file if "@" in line and os.path.basename(place) in line], "anybody can"


def test_a_folder_that_others_can_write_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / ".roah_rsbb" / "watch").mkdir(parents=True)
    (tmp_path / ".roah_rsbb" / "watch").chmod(0o777)
    watch = Watch(str(tmp_path), lambda: 0.0)
    watch.look()
    Lifeline(str(tmp_path)).send()
    assert watch.silence.pid == 0 and not list((tmp_path / ".roah_rsbb" / "watch").iterdir())


def test_the_socket_of_a_watcher_that_was_killed_is_replaced(tmp_path):
    subprocess.run([sys.executable, "-c", "import sys; from roah_rsbb.ground.signs_of_life import Watch; "
                    "Watch(sys.argv[1], lambda: 0.0).look()", str(tmp_path)], check=True)
    watch = Watch(str(tmp_path), lambda: 0.0)
    watch.look()
    Lifeline(str(tmp_path)).send()
    watch.look()
    watch.close()
    assert watch.silence.pid == os.getpid()


# -- the supervisor's end ------------------------------------------------------------------------------

REMEMBERING = """
import json, sys
from roah_rsbb.ground.signs_of_life import Lifeline
lifeline = Lifeline("folder")
print(json.dumps(lifeline.kept, sort_keys=True), flush=True)
for line in sys.stdin:
    print(eval(line), flush=True)
"""


class Supervised:
    """A supervisor and its core, which evaluates what the test says."""

    def __init__(self):
        self.now = 0.0
        self.core = Supervision(lambda: self.now)
        self.process = None

    def start(self):
        """Start the next core; returns what it finds."""
        self.close()
        with mock.patch.object(subprocess, "Popen", functools.partial(
                subprocess.Popen, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)):
            self.process = self.core.start([sys.executable, "-c", REMEMBERING], os.environ)
        return self.process.stdout.readline().strip()

    def do(self, code):
        print(code, file=self.process.stdin, flush=True)
        return self.process.stdout.readline().strip()

    def look(self):
        self.now += LOOK_S
        self.core.look(self.process.pid)

    def close(self):
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None


@pytest.fixture
def supervised():
    made = Supervised()
    yield made
    made.close()
    made.core.close()


def test_the_next_core_has_what_the_one_before_kept(supervised):
    assert supervised.start() == "{}"
    assert supervised.do("lifeline.keep('stop/1', 'by Ann')") == "True"
    assert supervised.do("lifeline.keep('channel/7', 'x'), lifeline.drop('channel/7')") == "(True, True)"
    supervised.close()  # killed before anybody looked
    supervised.core.look(1)
    for _ in range(2):  # also of one that was killed before it did anything
        assert supervised.start() == '{"log_dir": "folder", "stop/1": "by Ann"}'
        supervised.look()
    assert supervised.do("lifeline.drop('stop/1')") == "True"
    supervised.look()
    assert supervised.start() == '{"log_dir": "folder"}'


def test_signs_over_the_lifeline(supervised):
    supervised.start()
    supervised.look()
    assert not supervised.core.silence.is_alive
    supervised.do("lifeline.wait()")
    supervised.look()
    assert supervised.core.is_waiting and not supervised.core.silence.is_alive
    supervised.do("lifeline.send()")
    supervised.look()
    assert supervised.core.silence.pid == supervised.process.pid and not supervised.core.is_waiting
    supervised.do("lifeline.end()")
    supervised.look()
    assert supervised.core.silence.pid == 0


def test_a_supervisor_that_does_not_read_stops_nobody_and_gets_all_later(supervised):
    supervised.start()
    supervised.do("[lifeline.send() for _ in range(10_000)] and None")
    assert supervised.do("lifeline.keep('a', '1')") == "False"
    assert supervised.do("lifeline.keep('b', '2')") == "False"
    supervised.look()
    supervised.do("lifeline.send()")
    supervised.look()
    assert supervised.core.memory == {"log_dir": "folder", "a": "1", "b": "2"}


def test_the_memory_has_a_limit(supervised):
    supervised.start()
    assert supervised.do(f"lifeline.keep('a', 'x' * {signs_of_life.MOST_BYTES - 100})") == "True"
    assert supervised.do("lifeline.keep('b', 'y' * 100)") == "False"
    assert supervised.do("lifeline.keep('a', 'x')") == "True"
    supervised.look()
    assert supervised.start() == '{"a": "x", "log_dir": "folder"}'
    assert supervised.do(f"lifeline.keep('b', 'y' * {signs_of_life.MOST_BYTES - 100})") == "True"
    supervised.look()
    supervised.start()


def test_what_a_core_starts_does_not_hold_the_lifeline(supervised):
    supervised.start()
    assert supervised.do(
        "__import__('subprocess').check_output(['sh', '-c', 'echo $ROAH_RSBB_LIFELINE; ls /proc/self/fd | wc -l'], "
        "close_fds=False).split()") == "[b'4']"


def test_without_a_supervisor_there_is_no_memory(tmp_path):
    lifeline = Lifeline(str(tmp_path))
    assert (lifeline.kept, lifeline.keep("a", "b"), lifeline.drop("a")) == ({}, False, False)
