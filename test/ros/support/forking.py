"""Starts Python programs as forks of a process that has imported what they need.

To import rospy and its own modules takes a program half a second of CPU; to fork takes 10 ms. A program that is started
here is a process with its own arguments, environment, output, signals and ROS node, as if it had been executed.
"""

import array
import atexit
import contextlib
import ctypes
import os
import pathlib
import pickle
import shutil
import signal
import socket
import subprocess
import sys
import threading
from typing import Callable, Dict, Optional, Sequence, Tuple, Union

from support.waiting import happened

Files = Sequence[int]  # standard input, output and error output
_PARENT = str(pathlib.Path(__file__).resolve().parent / "forking_parent.py")
_INTERPRETERS = (b"#!/usr/bin/python3", b"#!/usr/bin/env python3")


class Forked:
    """A program that runs; like a `subprocess.Popen`."""

    def __init__(self, parent: "Parent", pid: int) -> None:
        self.pid = pid
        self.returncode: Optional[int] = None
        self.cpu_s = 0.0  # when it has ended: of itself and of the processes that it waited for
        self._parent = parent

    def poll(self) -> Optional[int]:
        """The exit status; None: it runs."""
        with self._parent.news:
            return self._look()

    def wait(self, timeout: Optional[float] = None) -> int:
        """Wait for its end; returns the exit status, or raises subprocess.TimeoutExpired."""
        with self._parent.news:
            if not self._parent.news.wait_for(lambda: self._look() is not None, timeout):
                raise subprocess.TimeoutExpired(str(self.pid), timeout)
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send it a signal."""
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        """End it by force."""
        self.send_signal(signal.SIGKILL)

    def _look(self) -> Optional[int]:
        if self.returncode is None and self.pid in self._parent.ended:
            self.returncode, self.cpu_s = self._parent.ended[self.pid]
        elif self.returncode is None and self._parent.has_ended:
            self.returncode = -signal.SIGKILL  # the kernel sends it when the parent ends
        return self.returncode


class Parent:
    """The process that forks."""

    def __init__(self, requests: socket.socket) -> None:
        self.ended: Dict[int, Tuple[int, float]] = {}  # process to its exit status and its CPU seconds
        self.news = threading.Condition()
        self.has_ended = False
        self._began: Optional[int] = None
        self._starting = threading.Lock()
        self._socket = requests
        threading.Thread(target=self._read, name="forking", daemon=True).start()

    def start(
            self, path: str, arguments: Sequence[str], files: Files, environment: Dict[str, str],
            **options: Union[str, bool]) -> Forked:
        """Start a Python program. Its arguments begin with its name; for the options, see `become` of the parent."""
        request = pickle.dumps((path, list(arguments), environment, options))
        handles = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", files))]
        with self._starting:
            self._began = None
            self._socket.sendmsg([request], handles)
            with self.news:
                self.news.wait_for(lambda: self._began is not None)
                assert self._began, f"the process that forks has ended; it could not import what {path} imports"
                return Forked(self, self._began)

    def _read(self) -> None:
        while True:
            try:
                message = self._socket.recv(4096)
            except ConnectionResetError:
                message = b""  # it ended before it read all requests
            kind, pid, status, cpu_s = pickle.loads(message) if message else ("began", 0, 0, 0.0)
            with self.news:
                self.has_ended = not message
                if kind == "began":
                    self._began = pid
                    self.ended.pop(pid, None)
                else:
                    self.ended[pid] = status, cpu_s
                self.news.notify_all()
            happened()
            if not message:
                return

    def close(self) -> None:
        """End the process that forks. Programs that still run are ended, too."""
        with contextlib.suppress(OSError):  # it has ended
            self._socket.shutdown(socket.SHUT_RDWR)


def executed(*programs: str, **environment: str) -> Parent:
    """Start a process that forks. It imports what these programs import at once, and the others' imports on demand."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    for end in (ours, theirs):
        end.settimeout(None)  # parts of ROS change the default
    # A session of its own: an interruption of a test does not end it before the test's programs.
    process = subprocess.Popen(
        [sys.executable, "-u", _PARENT, str(theirs.fileno()), *programs], pass_fds=(theirs.fileno(),),
        stdin=subprocess.DEVNULL, env={**os.environ, **environment}, start_new_session=True,
    )
    theirs.close()
    parent = Parent(ours)
    atexit.register(_end, parent, process.wait)
    return parent


def _end(parent: Parent, wait: Callable[[], object]) -> None:
    parent.close()
    wait()


def is_python(path: str) -> bool:
    """Whether a program can be forked."""
    with open(path, "rb") as file:
        return file.readline().rstrip() in _INTERPRETERS


_parent: Optional[Parent] = None


def use(parent: Parent, wait: Callable[[], object]) -> None:
    """Start all programs as forks of this process. `wait` waits for its end."""
    global _parent
    _parent = parent
    atexit.register(_end, parent, wait)


def start(command: Sequence[str], files: Files, **environment: str) -> Union[Forked, "subprocess.Popen[bytes]"]:
    """Start a program: forked if it is a Python program that can be found, else executed."""
    global _parent
    path = shutil.which(command[0])
    assert path, f"{command[0]} cannot be found: source build/devel/setup.bash"
    made = {**os.environ, **environment}
    if is_python(path):
        _parent = _parent or executed()
        return _parent.start(path, [path, *command[1:]], files, made, death_signal="SIGINT")
    return subprocess.Popen(command, stdin=files[0], stdout=files[1], stderr=files[2], env=made,
                            preexec_fn=_end_with_parent)


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(1, signal.SIGINT)
