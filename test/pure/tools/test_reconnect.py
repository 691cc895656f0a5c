"""Windows that are restarted with the master of the box that took over."""

import os
import subprocess
import sys
import time

import pytest

from roah_rsbb.tools import reconnect
from roah_rsbb.tools.reconnect import NotReconnected, Process, clients, descendants, is_client

URI = "http://10.0.0.3:11311"
LIMIT_S = 60.0


@pytest.mark.parametrize("words, expected", [
    ("/usr/bin/python3 /opt/ros/noetic/bin/roslaunch roah_rsbb roah_rsbb_client.launch zone:=A", True),
    ("/usr/bin/python3 /opt/ros/noetic/bin/roslaunch roah_rsbb roah_rsbb_public.launch", True),
    ("/usr/bin/python3 /opt/ros/noetic/bin/roslaunch roah_rsbb roah_rsbb.launch", False),
    ("/usr/bin/python3 /usr/bin/rqt --perspective-file x", True),
    ("/usr/bin/python3 /home/x/panel window", True),
    ("vim roah_rsbb_client.launch", False),
    ("/usr/bin/python3 /home/x/roah_rsbb_core", False),
    ("", False)])
def test_programs_that_follow_a_box(words, expected):
    assert is_client(words.split()) == expected


def test_a_window_of_a_launch_is_restarted_with_its_launch():
    client, box = ("python3 roslaunch roah_rsbb roah_rsbb_client.launch".split(),
                   "python3 roslaunch roah_rsbb roah_rsbb.launch".split())
    processes = [
        Process(10, 1, ["bash"]), Process(11, 10, client), Process(12, 11, ["python3", "roah_rsbb_gui"]),
        Process(13, 12, ["rqt"]), Process(20, 10, ["python3", "/usr/bin/rqt"]), Process(30, 10, box),
        Process(31, 30, ["python3", "roah_rsbb_gui"]), Process(32, 31, ["rqt"])]
    assert [process.pid for process in clients(processes)] == [11, 20]
    assert descendants(11, processes) == [11, 12, 13]


def test_a_window_gets_the_new_master(tmp_path, monkeypatch, capfd):
    program = tmp_path / "rqt"
    program.write_text("import os, sys, time\nfile = sys.argv[1]\n"
                       "open(file, 'a').write(os.environ['ROS_MASTER_URI'] + ' ' + os.getcwd() + '\\n')\n"
                       "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
                       "time.sleep(600)\n")
    file = tmp_path / "started"
    file.touch()
    monkeypatch.setattr(reconnect, "check_box", lambda uri: None)
    monkeypatch.setattr(reconnect, "END_S", 0.2)  # it hangs, as it does without its master
    with subprocess.Popen([sys.executable, str(program), str(file)], cwd=tmp_path,
                          env={**os.environ, "ROS_MASTER_URI": "http://10.0.0.2:11311"}) as process:
        wait_lines(file, 1)
        monkeypatch.setattr(reconnect, "clients", lambda all_: [each for each in all_ if each.pid == process.pid])
        (started,) = reconnect.reconnect(URI)
        with started:
            assert process.wait(LIMIT_S) < 0
            wait_lines(file, 2)
            assert file.read_text().splitlines() == [f"http://10.0.0.2:11311 {tmp_path}", f"{URI} {tmp_path}"]
            started.kill()
    assert f"ROS_MASTER_URI={URI}" in capfd.readouterr().out


def wait_lines(file, count):
    deadline = time.monotonic() + LIMIT_S
    while len(file.read_text().splitlines()) < count:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_nothing_is_ended_without_a_box(monkeypatch):
    monkeypatch.setattr(reconnect, "clients", lambda all_: pytest.fail("they are not asked for"))
    with pytest.raises(NotReconnected, match="no ROS master answers"):
        reconnect.reconnect("http://127.0.0.1:1")


def test_nothing_to_restart(monkeypatch):
    monkeypatch.setattr(reconnect, "check_box", lambda uri: None)
    monkeypatch.setattr(reconnect, "clients", lambda all_: [])
    with pytest.raises(NotReconnected, match="ROS_MASTER_URI=http://10.0.0.3:11311 roslaunch"):
        reconnect.reconnect(reconnect.uri_of("10.0.0.3"))
