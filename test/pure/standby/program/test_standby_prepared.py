"""The box that is started in advance on the standby, and the request that lets it begin."""

import os
import pathlib
import queue
import socket
import subprocess
import sys
import threading
import time

import pytest

from helpers.waiting import LIMIT_S, wait_until
from roah_rsbb.standby.pair import Side
from roah_rsbb.standby.pairing import PairedBox, PairedStandby, is_standby, partners_of, write_box, write_standby
from roah_rsbb.standby.program import prepared as module
from roah_rsbb.standby.program.keeping import Reply, Requests, request
from roah_rsbb.standby.program.prepared import Prepared

# The programs without ROS, as the tests have the package.
TEAM = f"""
import roah_rsbb
roah_rsbb.__path__ = {list(sys.modules["roah_rsbb"].__path__)!r}
from roah_rsbb.tools.team import main
main()
"""


class NotYet(Exception):
    """There is no copy yet."""


@pytest.fixture
def preparing(tmp_path, monkeypatch):
    """A program instead of roslaunch, which notes its part in a file, and runs until it is interrupted."""
    monkeypatch.setattr(module, "_core_runs", lambda: False)
    monkeypatch.setattr(module, "LOOK_S", 0.01)
    program = ("import sys, time\nopen(sys.argv[1] + '/' + sys.argv[-1], 'w').close()\n"
               "time.sleep(600)\n")
    return [sys.executable, "-c", program, str(tmp_path)], tmp_path


def test_the_core_is_started_when_there_is_a_copy(preparing):
    command, folder = preparing
    tries = []

    def command_of():
        tries.append(1)
        if len(tries) < 3:
            raise NotYet
        return command

    prepared = Prepared(str(folder), command_of, NotYet, lambda text: None)
    prepared.start()
    wait_until((folder / "part:=core").exists)
    wait_until(lambda: prepared.is_for(command), "it is prepared")  # the program may be faster than its start returns
    assert len(tries) == 3 and not prepared.is_for([*command, "gui:=none"])
    prepared.end()
    assert not prepared.is_for(command)


def test_a_box_that_waits_has_no_sockets_of_the_network(tmp_path):
    """Ports of robots, pages and tablet are those of the box before, perhaps on this computer, and devices its own."""
    write_box(str(tmp_path), PairedBox("10.1.0.2", 8083, "", ""))
    words = ("run", "--unsupervised", "--no-browser", f"log_dir:={tmp_path}", "devices:=true", "tablet:=true")
    box = subprocess.Popen([sys.executable, "-c", TEAM, *words], stderr=subprocess.PIPE, text=True)
    try:
        assert "waiting for a takeover" in box.stderr.readline()
        time.sleep(0.5)
        folder = f"/proc/{box.pid}/fd"
        own = {os.readlink(os.path.join(folder, name)) for name in os.listdir(folder)}
        lines = [line.split() for kind in ("tcp", "udp") for line in
                 pathlib.Path(f"/proc/net/{kind}").read_text("ascii").splitlines()]
        assert [line[1] for line in lines if f"socket:[{line[9]}]" in own] == []
    finally:
        box.kill()
        box.wait()
        box.stderr.close()


def test_nothing_is_started_beside_another_core(preparing, monkeypatch):
    command, folder = preparing
    monkeypatch.setattr(module, "_core_runs", lambda: True)
    said = queue.Queue()
    prepared = Prepared(str(folder), lambda: command, NotYet, said.put)
    prepared.start()
    assert "A core runs" in said.get(timeout=LIMIT_S)
    prepared.end()
    assert not prepared.is_for(command) and not list(folder.iterdir())


def test_the_request_of_the_organiser(tmp_path):
    folder = tmp_path / ("long" * 40)  # longer than the path of a socket may be
    folder.mkdir()
    asked, went = [], threading.Event()

    def on_ask(anyway, arguments):
        asked.append((anyway, arguments))
        return Reply([] if anyway else ["The box is heard."], True)

    def on_go():
        went.set()
        requests.report(["Epoch 2"])

    requests = Requests(str(folder), on_ask, on_go)
    with request(str(folder), False, ["gui:=none"]) as found:
        assert found.answer == Reply(["The box is heard."], True)
    with request(str(folder), True, []) as found:
        assert found.answer.reasons == [] and not went.is_set()
        assert found.go() == ["Epoch 2"] and went.is_set()
    assert asked == [(False, ["gui:=none"]), (True, [])]
    requests.close()
    with request(str(folder), True, []) as found:
        assert found is None


def test_a_program_that_does_not_take_over(tmp_path):
    def on_go():
        raise OSError("no space left")

    requests = Requests(str(tmp_path), lambda anyway, arguments: Reply([], True), on_go)
    with request(str(tmp_path), True, []) as found, pytest.raises(OSError, match="did not take over"):
        found.go()
    requests.close()


def test_a_foreign_program_at_the_socket_harms_nobody(tmp_path):
    requests = Requests(str(tmp_path), lambda anyway, arguments: Reply([], True), lambda: None)
    for nonsense in (b"\n", b"[]\n", b'{"anyway": 1}\n', b"\xff\n"):
        with socket.socket(socket.AF_UNIX) as stranger:
            stranger.connect(str(tmp_path / "standby.sock"))
            stranger.sendall(nonsense)
            assert stranger.recv(1) == b""
    with request(str(tmp_path), True, []) as found:
        assert found is not None
    requests.close()


def test_a_folder_of_a_standby(tmp_path):
    assert not is_standby(str(tmp_path)), "of a box without a pair"
    write_box(str(tmp_path), PairedBox("10.0.0.1", 8083, "ff", "key"))
    assert is_standby(str(tmp_path))
    write_standby(str(tmp_path), PairedStandby("the box before", "hash", "10.0.0.1", 8083))
    assert not is_standby(str(tmp_path)), "it took over"
    assert [partner.own_side for partner in partners_of(str(tmp_path)).values()] == [Side.BOX, Side.STANDBY]


# -- the guard of what the standby prepared -------------------------------------------------------------

KEEPER = """
import subprocess, sys, time
from roah_rsbb.standby.program.guard import guarded
subprocess.Popen(guarded(sys.argv[1], [sys.executable, "-c", sys.argv[2], sys.argv[1]]))
time.sleep(1000)
"""
BOX = """
import os, signal, sys, time
open(sys.argv[1] + "/pid", "w").write(str(os.getpid()))
os.rename(sys.argv[1] + "/pid", sys.argv[1] + "/started")
try:
    while True:
        time.sleep(0.01)
        if os.path.exists(sys.argv[1] + "/look"):
            open(sys.argv[1] + "/lives", "w").close()
except KeyboardInterrupt:
    open(sys.argv[1] + "/ended", "w").close()
"""


@pytest.fixture
def keeper(tmp_path):
    write_box(str(tmp_path), PairedBox("10.0.0.1", 8083, "ff", "key"))
    process = subprocess.Popen([sys.executable, "-c", KEEPER, str(tmp_path), BOX])
    wait_until((tmp_path / "started").exists)
    yield process
    process.kill()
    process.wait()
    if not (tmp_path / "ended").exists():
        os.kill(int((tmp_path / "started").read_text()), 2)
        wait_until((tmp_path / "ended").exists)


def test_a_box_that_waits_ends_with_the_program_that_keeps_the_copy(keeper, tmp_path):
    keeper.kill()
    wait_until((tmp_path / "ended").exists)


def test_after_the_takeover_it_continues(keeper, tmp_path):
    write_standby(str(tmp_path), PairedStandby("the box before", "hash", "10.0.0.1", 8083))
    keeper.kill()
    keeper.wait()
    time.sleep(1.5)  # three looks of the guard
    assert not (tmp_path / "ended").exists()
    (tmp_path / "look").touch()
    wait_until((tmp_path / "lives").exists)
