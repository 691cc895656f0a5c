"""The rehearsal of a takeover on one computer: a box with a run, its loss, and the takeover, with the times.

Box, standby and robot have addresses of their own on the loopback device, so it needs no rights and no network. The box
is lost by killing all its processes. All files are in a temporary folder.
"""

import contextlib
import os
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time
from typing import Iterator, List, NamedTuple, Tuple

from roah_rsbb.client.places import OWN_VARIABLE
from roah_rsbb.core.authority import SUPERSEDED
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import is_without_ros, typed, without_ros

BOX, STANDBY, ROBOT, BROADCAST = "127.0.0.21", "127.0.0.22", "127.0.0.23", "127.255.255.255"
TEAM, PASSWORD, ZONE = "TestingTeam", "PASSWORD", "Testing TestingTeam"
# Longest time for each step, on a slow computer.
LIMIT_S = 90.0
END_S = 20.0
_WITHOUT = ("gui:=none", "modules:=false", "tablet:=false", "web:=false", "devices:=false")


class Failed(Exception):
    """The rehearsal cannot continue. The text says why, with the last output of the program."""


class Ports(NamedTuple):
    """Free ports of this computer."""

    box_master: int
    standby_master: int
    standby: int
    public: int


class _Program:
    """A running program, and the times of its lines."""

    def __init__(self, folder: str, command: Tuple[str, ...], master: int) -> None:
        """`folder`: of its logs. `command`: of `roah-rsbb`, or rosrun and roslaunch. `master`: port of its ROS master,
        or of whatever distinguishes two boxes without ROS; 0: it has none."""
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", "ROS_HOME": folder}
        environment.pop("ROS_LOG_DIR", None)
        if master:
            environment["ROS_MASTER_URI"] = f"http://127.0.0.1:{master}"
        self._name = command[0]
        if is_without_ros():
            environment.update({"ROS_MASTER_URI": "", OWN_VARIABLE: os.path.join(folder, f"door{master}.json")})
            command = tuple(without_ros(*command))
        self._lines: List[Tuple[float, str]] = []
        self._is_new = threading.Condition()
        self._process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                         stderr=subprocess.STDOUT, text=True, errors="replace")
        threading.Thread(target=self._read, daemon=True).start()

    def wait(self, pattern: str) -> Tuple[float, str]:
        """Wait for a line with this pattern; returns its time and the first group. Raises `Failed`."""
        deadline = time.monotonic() + LIMIT_S
        with self._is_new:
            while True:
                for mono, line in self._lines:
                    found = re.search(pattern, line)
                    if found:
                        return mono, found.group(found.lastindex or 0)
                if self._process.poll() is not None or time.monotonic() > deadline:
                    last = "\n".join(line for _, line in self._lines[-10:])
                    raise Failed(f"{self._name} did not print '{pattern}'. Its last lines:\n{last}")
                self._is_new.wait(1.0)

    def is_done(self) -> bool:
        """Wait until it ends; returns whether it succeeded. Raises `Failed`."""
        try:
            return self._process.wait(LIMIT_S) == 0
        except subprocess.TimeoutExpired:
            raise Failed(f"{self._name} does not end") from None

    def lose(self) -> None:
        """Kill it and its nodes, as if the computer had burned."""
        for pid in (self._process.pid, *_children(self._process.pid)):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    def end(self) -> None:
        """End it, and wait for it."""
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self.lose()

    def _read(self) -> None:
        for line in self._process.stdout:
            with self._is_new:
                self._lines.append((time.monotonic(), line.rstrip("\n")))
                self._is_new.notify_all()
        self._process.wait()
        with self._is_new:
            self._is_new.notify_all()


def rehearse() -> Iterator[str]:
    """Rehearse a takeover; yields a line for each step. Raises `Failed`."""
    with tempfile.TemporaryDirectory(prefix="roah_rsbb_rehearsal_") as folder, contextlib.ExitStack() as cleanup:
        yield from _rehearse(folder, cleanup, Ports(*_free_ports(3), _free_ports(1, socket.SOCK_DGRAM)[0]))


def _rehearse(folder: str, cleanup: contextlib.ExitStack, ports: Ports) -> Iterator[str]:
    log_dir, copy = os.path.join(folder, "log"), os.path.join(folder, "copy")

    def start(*command: str, master: int = 0) -> _Program:
        program = _Program(folder, command, master)
        cleanup.callback(program.end)
        return program

    def box() -> _Program:
        return start(*_launch(ports.box_master), *_WITHOUT,
                     f"rsbb_host:={BROADCAST}", f"rsbb_port:={ports.public}", f"bind_host:={BOX}",
                     f"log_dir:={log_dir}", f"standby_port:={ports.standby}", master=ports.box_master)

    yield "The box starts, with a standby and a robot"
    first = box()
    for ready in ("For a code, enter", "Listening on UDP"):
        first.wait(ready)
    _, code = start(*_run("standby"), "code", "--log-dir", log_dir).wait("The code is ([A-Z0-9-]+)")
    follower = start(*_run("standby"), "follow", BOX, "--port", str(ports.standby), "--code", code, "--log-dir", copy,
                     f"bind_host:={STANDBY}", *_WITHOUT, master=ports.standby_master)
    follower.wait("The copy is kept")
    follower.wait("waiting for a takeover")
    robot = start(*_run("dummy_robot"), "--team", TEAM, "--password", PASSWORD, "--host", BROADCAST,
                  "--port", str(ports.public), "--bind", ROBOT, "--never-end")
    first.wait(f"Robot .* is active at {ROBOT}")
    for command in ("connect", "start"):
        # The box may still listen for another one.
        deadline = time.monotonic() + LIMIT_S
        while not start(*_run("referee"), command, ZONE, master=ports.box_master).is_done():
            if time.monotonic() > deadline:
                raise Failed(f"the referee could not {command} the robot in time")
    robot.wait("executing")
    time.sleep(1.0)  # the copy is usually 0.2 s behind

    lost = time.monotonic()
    first.lose()
    yield f"{0:5.1f} s  The box is lost, in the middle of a run: all its processes are killed"
    yield f"{time.monotonic() - lost:5.1f} s  {typed('standby')} takeover"
    # There is no need to hear that the box is silent.
    taken = start(*_run("standby"), "takeover", "--anyway", "--log-dir", copy,
                  master=ports.standby_master)
    yield f"{0:5.1f} s  {taken.wait('The newest entry of the copy .*')[1]}"
    yield f"{follower.wait('Listening on UDP')[0] - lost:5.1f} s  The second computer is the box, and sends to robots"
    yield f"{robot.wait(f'the box at {STANDBY} is received')[0] - lost:5.1f} s  The robot is connected to it"

    began = time.monotonic()
    yield "The first box starts again"
    mono, reason = box().wait(f"({SUPERSEDED.template.partition(':')[0]}.*)")
    yield f"{mono - began:5.1f} s  {reason}"


def _launch(master: int) -> Tuple[str, ...]:
    """Return the command that starts a box."""
    return ("run", "--no-browser") if is_without_ros() else (
        "roslaunch", "-p", str(master), "roah_rsbb", "roah_rsbb.launch")


def _run(program: str) -> Tuple[str, ...]:
    """Return the command of a program, by its name in ROS."""
    return (program.replace("_", "-"),) if is_without_ros() else ("rosrun", "roah_rsbb", program)


def _free_ports(count: int, kind: int = socket.SOCK_STREAM) -> List[int]:
    with contextlib.ExitStack() as cleanup:
        sockets = [cleanup.enter_context(socket.socket(socket.AF_INET, kind)) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def _children(pid: int) -> List[int]:
    """Return the processes that a process started."""
    return [int(name) for name in os.listdir("/proc")
            if name.isdigit() and linux.status_of(int(name))[1:2] == [str(pid)]]
