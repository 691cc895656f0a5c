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
from typing import Dict, Optional, Sequence, Union

from support.waiting import happened

Files = Sequence[int]  # standard input, output and error output
# The parent of the programs. It imports what a program imports, and then forks; the fork becomes the program.
_PARENT = r"""
import array, ast, ctypes, gc, importlib, io, os, pickle, random, runpy, signal, socket, sys, time

requests = socket.socket(fileno=int(sys.argv[1]))
imported = set()


def import_for(path):
    with open(path, encoding="utf-8") as file:
        for node in ast.parse(file.read()).body:
            if isinstance(node, ast.Assign) and node.targets[0].id == "python_script":
                import_for(node.value.value)  # catkin's relay to the program in the source folder
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names + ([node.module] if isinstance(node, ast.ImportFrom) else []):
                importlib.import_module(name)


def report_ended(*_):
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return
        if not pid:
            return
        code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
        requests.send(pickle.dumps(("ended", pid, code)))


def become(files, arguments, environment):
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGCHLD])
    ctypes.CDLL(None).prctl(1, signal.SIGINT)  # PR_SET_PDEATHSIG: a test that is killed leaves no program behind
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    requests.close()
    sys.stdin = open(0, encoding=sys.stdin.encoding, closefd=False)
    for number, name in ((1, "stdout"), (2, "stderr")):
        old = getattr(sys, name)
        made = io.TextIOWrapper(open(number, "wb", 0, closefd=False), old.encoding, old.errors, write_through=True)
        setattr(sys, name, made)
    os.environ.clear()
    os.environ.update(environment)
    time.tzset()
    random.seed()
    sys.argv[:] = arguments  # the same list, to which default arguments of functions refer
    if "rospy" in sys.modules:
        sys.modules["rospy"].names.reload_mappings(arguments)  # it reads them when it is imported


def next_program():
    while True:
        request, ancillary, _, _ = requests.recvmsg(1 << 20, socket.CMSG_SPACE(3 * 4))
        if not request:
            sys.exit()
        files = array.array("i")
        files.frombytes(ancillary[0][2])
        path, arguments, environment = pickle.loads(request)
        if path not in imported:
            import_for(path)
            imported.add(path)
            gc.freeze()  # a program that ends would look through all that was imported: 0.2 s of CPU
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGCHLD])  # its beginning is reported before its end
        pid = os.fork()
        if not pid:
            become(files, arguments, environment)
            return path
        requests.send(pickle.dumps(("began", pid, 0)))
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGCHLD])
        for file in files:
            os.close(file)


signal.signal(signal.SIGCHLD, report_ended)
runpy.run_path(next_program(), run_name="__main__")
"""


class Forked:
    """A program that runs; like a `subprocess.Popen`."""

    def __init__(self, parent: "_Parent", pid: int) -> None:
        self.pid = pid
        self.returncode: Optional[int] = None
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
        self.returncode = self._parent.ended.get(self.pid)
        return self.returncode


class _Parent:
    """The process that forks."""

    def __init__(self) -> None:
        self.ended: Dict[int, int] = {}  # process to its exit status
        self.news = threading.Condition()
        self._began: Optional[int] = None
        self._starting = threading.Lock()
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        for end in (self._socket, theirs):
            end.settimeout(None)  # parts of ROS change the default
        self._process = subprocess.Popen(
            [sys.executable, "-u", "-c", _PARENT, str(theirs.fileno())], pass_fds=(theirs.fileno(),),
            stdin=subprocess.DEVNULL,
        )
        theirs.close()
        threading.Thread(target=self._read, name="forking", daemon=True).start()
        atexit.register(self._close)

    def start(self, path: str, arguments: Sequence[str], files: Files, environment: Dict[str, str]) -> Forked:
        """Start a Python program. Its arguments begin with its name."""
        request = pickle.dumps((path, list(arguments), environment))
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
            message = self._socket.recv(4096)
            kind, pid, status = pickle.loads(message) if message else ("began", 0, 0)
            with self.news:
                if kind == "began":
                    self._began = pid
                    self.ended.pop(pid, None)
                else:
                    self.ended[pid] = status
                self.news.notify_all()
            happened()
            if not message:
                return

    def _close(self) -> None:
        self._socket.shutdown(socket.SHUT_RDWR)
        self._process.wait()


_parent: Optional[_Parent] = None


def start(command: Sequence[str], files: Files, **environment: str) -> Union[Forked, "subprocess.Popen[bytes]"]:
    """Start a program: forked if it is a Python program that can be found, else executed."""
    global _parent
    path = shutil.which(command[0])
    assert path, f"{command[0]} cannot be found: source build/devel/setup.bash"
    made = {**os.environ, **environment}
    with pathlib.Path(path).open("rb") as file:
        is_python = file.readline().rstrip() in (b"#!/usr/bin/python3", b"#!/usr/bin/env python3")
    if is_python:
        _parent = _parent or _Parent()
        return _parent.start(path, [path, *command[1:]], files, made)
    return subprocess.Popen(command, stdin=files[0], stdout=files[1], stderr=files[2], env=made,
                            preexec_fn=_end_with_parent)


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(1, signal.SIGINT)
