"""The barest core: what is left when the core cannot start any more stops all robots, and does nothing else."""

import asyncio
import json
import os
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request

import pytest

import roah_rsbb
from helpers.waiting import LIMIT_S, wait_until
from roah_rsbb.box.program.barest import open_robots
from roah_rsbb.client.places import OWN_VARIABLE, OnlyStops, read_place
from roah_rsbb.comm.channels import Network, PrivateChannel
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState

ROBOT, BOX = "127.0.0.31", "127.0.0.30"


def free_port(host, kind):
    with socket.socket(socket.AF_INET, kind) as trial:
        trial.bind((host, 0))
        return trial.getsockname()[1]


def kept(port, password="secret"):
    return json.dumps([
        "R1 of Alpha", password, ROBOT, "HGTKMH", LOOPBACK_BROADCAST, BOX, int(Cipher.AES_128_CBC), False, 1024])


# The programs of a box, as the tests have the package.
TEAM = f"""
import roah_rsbb
roah_rsbb.__path__ = {list(roah_rsbb.__path__)!r}
from roah_rsbb.tools.team import main
main()
"""
# A supervisor whose cores only keep the channels of `kept.json`, and then hang or crash; and its barest core.
SUPERVISOR = """
import os, subprocess, sys
from roah_rsbb.box.program import supervisor
from roah_rsbb.journal.copy_follower import CopySettings
kill = subprocess.Popen.kill
subprocess.Popen.kill = lambda self: os.path.exists("undead") or kill(self)  # as beside a disk that hangs
supervisor.PAUSE_S, supervisor.STEADY_S = 0.0, 1e6
# Nobody waits long for a box that failed before, but the barest core for as long as a busy computer takes.
supervisor._Course.patience_s = property(lambda self: 60.0 if self.is_barest else 0.2)
start_s = float(sys.argv[2])
supervisor._Course.start_s = property(lambda self: 60.0 if self.is_barest or not self.failures else start_s)
supervisor.without_ros = lambda *words: [
    sys.executable, "-c", sys.argv[1] if words[0] != "copies" else open("copies.py").read(), *words]
command = [sys.executable, "-c", open("box.py").read()]
settings = CopySettings(".", "stick", 0, "0.0.0.0", "none", "127.255.255.255", 6666, "")
sys.exit(supervisor.supervise(command, command, lambda memory: settings if os.path.exists("copies.py") else None))
"""
BOX_PROGRAM = """
import json, os, signal, sys, time
from roah_rsbb.ground.signs_of_life import Lifeline
open("starts", "a").write("x")
starts = len(open("starts").read())
lifeline = Lifeline(os.getcwd())
for name, value in json.load(open("kept.json")).items():
    lifeline.keep(name, value)
if starts == 1 or os.path.exists("answers"):
    lifeline.send()
"""


class Robot:
    """A robot that executes until it is sent STOP. It notes which states it is sent."""

    def __init__(self, loop, port):
        self.loop, self.states, self.acknowledged = loop, [], []
        self.state = RobotState.EXECUTING
        self.stopped = loop.create_future()
        network = Network(LOOPBACK_BROADCAST, bind_host=ROBOT)
        self.channel = PrivateChannel(loop, network, port, Key("secret"), self.hear, print)
        self.channel.remote = BOX
        self.channel.open()

    def say(self, second):
        self.channel.send(pb.RobotState(
            time=pb.Time(sec=second, nsec=0), messages_saved=1, robot_state=int(self.state)))

    def hear(self, message, address):
        self.states.append(message.benchmark_state)
        if message.acknowledgement.sec == 7 and not self.stopped.done():
            self.stopped.set_result(None)
        self.state = RobotState.STOP
        self.say(7)


@pytest.fixture
def box(tmp_path):
    """Start the supervisor of a box that fails in this way, with an open channel; returns it and the port."""
    started = []

    def start(fault, **more):
        port = free_port(ROBOT, socket.SOCK_DGRAM)
        (tmp_path / "kept.json").write_text(json.dumps({
            "channel/1": kept(1, ""), f"channel/{port}": kept(port), **more}), "utf-8")
        (tmp_path / "box.py").write_text(BOX_PROGRAM + fault, "utf-8")
        # Only one that hangs must be ended: each other one ends by itself, however slow the computer is.
        start_s = "0.2" if "sleep(1000)" in fault else "60"
        process = subprocess.Popen([sys.executable, "-c", SUPERVISOR, TEAM, start_s], cwd=str(tmp_path),
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        started.append(process)
        return process, port

    yield start
    for process in started:
        process.terminate()
        process.communicate(timeout=LIMIT_S)


@pytest.mark.parametrize("answers", [False, True])
@pytest.mark.parametrize("fault", [
    "time.sleep(1000)", "os.abort()", "sys.exit(1)",
])
def test_a_box_that_fails_again_and_again_stops_its_robots(box, tmp_path, fault, answers):
    """It is not restarted without end, while the robots execute and nobody can stop them."""
    if answers:
        (tmp_path / "answers").touch()
    process, port = box(fault)

    async def play():
        robot = Robot(asyncio.get_event_loop(), port)
        await asyncio.wait_for(robot.stopped, LIMIT_S)
        robot.channel.close()
        return robot.states
    assert set(asyncio.run(play())) == {BoxState.STOP}
    process.terminate()
    out, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert out.count("The box has ended unexpectedly") == 4, "the first one, and three in vain"
    assert "it failed too often, and only sends STOP from now on" in out and "This box only sends STOP" in out
    assert "The robot on port 1 cannot be stopped" in out


def test_a_robot_whose_port_another_process_has_is_not_heard():
    loop, channel = asyncio.new_event_loop(), f"channel/{free_port(ROBOT, socket.SOCK_DGRAM)}"
    robots = [open_robots(loop, {channel: kept(channel.partition("/")[2])})[0] for _ in range(2)]
    assert [str(robot) for robot in robots] == [
        "R1 of Alpha (does not say that it stopped)",
        "R1 of Alpha (not heard, because the box that was killed still has its port: see whether it stopped)"]
    for robot in robots:
        robot.close()
    loop.close()


def test_faces_say_why(box, tmp_path):
    """The program `referee`, and a browser on the pages' port."""
    door, web_port = str(tmp_path / "door.json"), free_port("127.0.0.1", socket.SOCK_STREAM)
    process, _ = box("sys.exit(1)", doors=json.dumps([door]), web_port=str(web_port))

    def page():
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{web_port}/", timeout=LIMIT_S)
        except urllib.error.HTTPError as error:
            return error.read().decode()
        except OSError:
            return ""
    wait_until(page)
    assert "It only sends STOP now" in page()
    wait_until(lambda: os.path.exists(door))
    with pytest.raises(OnlyStops, match="It only sends STOP now"):
        read_place(door)
    for what in (["status"], ["stop", "all"]):
        with subprocess.Popen([sys.executable, "-m", "roah_rsbb.tools.team", "referee", *what], text=True,
                              env={**os.environ, OWN_VARIABLE: door}, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT) as referee:
            assert any("It only sends STOP now" in line for line in referee.stdout)
            referee.kill()  # STOP is tried again
    process.terminate()
    process.communicate(timeout=LIMIT_S)
    assert not os.path.exists(door)


def test_the_barest_core_follows_one_that_is_ended(box):
    """By somebody who does not end the program: its robots are still to be stopped. With the program, it ends, too."""
    process, _ = box("sys.exit(1)")
    for number in (signal.SIGTERM, signal.SIGKILL):
        wait_for(process, "This box only sends STOP")
        os.kill(child_of(process.pid), number)
    wait_for(process, "This box only sends STOP")
    child = child_of(process.pid)
    process.kill()
    wait_until(lambda: not os.path.exists(f"/proc/{child}"))


# A process that was killed and is not gone: only a thread of it is left, or it waits for the disk itself.
ZOMBIE = """
if starts == 1:
    kept = sockets.listen("{box}", int(max(lifeline.kept or json.load(open("kept.json")), key=len)[8:]), shared=False)
    threading.Thread(target=stay).start()
    ctypes.CDLL(None).pthread_exit(None)  # all that is left is the thread
"""
WAITS = """
if starts == 1:
    os.close(os.open("undead", os.O_CREAT))
    while not os.path.exists("thawed"):
        time.sleep(0.05)
"""


@pytest.mark.parametrize("how, is_ended_before", [(ZOMBIE, False), (WAITS, False), (WAITS, True)])
def test_a_box_that_was_killed_and_cannot_end_leaves_no_robot_executing(box, tmp_path, how, is_ended_before):
    """A disk that hangs keeps its process, and with that the port of the channel, until it takes data again."""
    process, port = box(f"""
import ctypes, threading
from roah_rsbb.comm import sockets
def stay():
    while not os.path.exists("thawed"):
        lifeline.send()  # or it would be killed, which a disk that hangs would not let happen
        time.sleep(0.05)
    os.kill(os.getpid(), signal.SIGKILL)
{how.format(box=BOX)}
sys.exit(0)
""")

    async def play():
        robot = Robot(asyncio.get_event_loop(), port)
        while robot.state is not RobotState.STOP:
            await asyncio.sleep(0.05)
        robot.channel.close()
        return robot.states
    try:
        assert set(asyncio.run(asyncio.wait_for(play(), LIMIT_S))) == {BoxState.STOP}
        if is_ended_before:
            process.terminate()
            process.wait(LIMIT_S)
    finally:
        (tmp_path / "thawed").touch()
    out, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert "the next one cannot start. Until the disk takes data again, all robots in runs are sent STOP" in out
    if how is ZOMBIE:
        assert (tmp_path / "starts").read_text("utf-8") == "xx"


def child_of(pid):
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
        return int(file.read())


def wait_for(process, text):
    assert any(text in line for line in process.stdout)


# The program that copies says once, or all the time, what it knows of the standby.
COPIES = """
import time
from roah_rsbb.ground.signs_of_life import Lifeline
lifeline = Lifeline()
lifeline.keep("standby", "{says}")
lifeline.send()
open("said", "w").close()
while True:
    time.sleep(0.02)
    {then}
"""
WITH_COPIES = """
while starts == 1 and os.path.exists("copies.py") and not os.path.exists("said"):
    lifeline.send()
    time.sleep(0.02)
"""
KILLED = "os.kill(os.getpid(), signal.SIGKILL)"  # from outside: all that anybody sees is the signal


@pytest.mark.parametrize("fault, says, then", [
    (KILLED, "", ""), ("os.abort()", "connected", "lifeline.send()"), ("os.abort()", "taken", "pass")])
def test_there_is_no_barest_core_for_a_box_that_is_only_killed_or_has_a_standby(box, tmp_path, fault, says, then):
    (tmp_path / "answers").touch()
    if says:
        (tmp_path / "copies.py").write_text(COPIES.format(says=says, then=then), "utf-8")
    process, _ = box(f"""{WITH_COPIES}
if starts > 8:
    sys.exit(0)
{fault}
""")
    out, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0 and "STOP" not in out
    assert len((tmp_path / "starts").read_text("utf-8")) == 9


@pytest.mark.parametrize("then", ["pass", "lifeline.drop('standby'); lifeline.send()", "break"])
def test_a_standby_that_is_lost_or_refuses_is_none(box, tmp_path, then):
    """Also while no core lives: the program that copies is silent, says so, or has ended."""
    (tmp_path / "answers").touch()
    (tmp_path / "copies.py").write_text(COPIES.format(says="connected", then=then), "utf-8")
    process, _ = box(f"""{WITH_COPIES}
os.abort()
""")
    wait_for(process, "This box only sends STOP")
