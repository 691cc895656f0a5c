"""The terminal's referee as a program of its own, for tests.

A command of the referee takes half a second to import what it needs. So `referee` asks a process that has imported
everything to fork: the fork becomes the referee's program, with its own arguments, output and ROS node.
"""

import array
import contextlib
import json
import os
import pickle
import socket
import subprocess
import sys
import tempfile
from typing import Callable, Optional

from support.programs import Program
from support.waiting import LIMIT_S, wait_until

COMMAND = (sys.executable, "-c", "from roah_rsbb.referee.program import main; main()")

_FORKING = """
import array, os, pickle, socket, sys
from roah_rsbb.referee.program import main

requests = socket.socket(fileno=int(sys.argv[1]))
while True:
    request, ancillary, _, _ = requests.recvmsg(65536, socket.CMSG_SPACE(8))
    if not request:
        break
    outputs = array.array("i")
    outputs.frombytes(ancillary[0][2])
    pid = os.fork()
    if pid == 0:
        requests.close()
        for number, output in enumerate(outputs, 1):
            os.dup2(output, number)
        sys.argv = ["referee", *pickle.loads(request)]
        main()
    for output in outputs:
        os.close(output)
    _, status = os.waitpid(pid, 0)
    requests.send(pickle.dumps(os.WEXITSTATUS(status) if os.WIFEXITED(status) else -os.WTERMSIG(status)))
"""
_forking: Optional[socket.socket] = None


def _start_forking() -> socket.socket:
    """The process that forks. It ends when the test's process closes its socket, at the latest at its end."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    subprocess.Popen(
        [sys.executable, "-c", _FORKING, str(theirs.fileno())], pass_fds=(theirs.fileno(),), stdin=subprocess.DEVNULL,
    )
    theirs.close()
    ours.settimeout(LIMIT_S)
    return ours


def referee(*words: str, **environment: str) -> subprocess.CompletedProcess:
    """A referee, from its start to its end. With a given environment, it is executed instead of forked."""
    global _forking
    if environment:
        return subprocess.run([*COMMAND, *words], capture_output=True, text=True, timeout=LIMIT_S,
                              env={**os.environ, **environment})
    _forking = _forking or _start_forking()
    with contextlib.ExitStack() as files:
        outputs = [files.enter_context(tempfile.TemporaryFile("w+", encoding="utf-8")) for _ in range(2)]
        handles = array.array("i", [output.fileno() for output in outputs])
        _forking.sendmsg([pickle.dumps(words)], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, handles)])
        status = pickle.loads(_forking.recv(65536))
        for output in outputs:
            output.seek(0)
        return subprocess.CompletedProcess(words, status, outputs[0].read(), outputs[1].read())


class Referee(Program):
    """A referee that runs. Its lines are asked for in their order."""

    def __init__(self, *words: str) -> None:
        self._next = 0
        super().__init__(*COMMAND, *words)

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def line(self, fits: Callable[[str], bool], what: str) -> str:
        """Wait for the next line that fits."""
        def found() -> str:
            while self._next < len(self.lines):
                self._next += 1
                if fits(self.lines[self._next - 1]):
                    return self.lines[self._next - 1]
            return ""
        return wait_until(found, lambda: f"{what} is printed; it printed\n{self.text}")

    def event(self, kind: str, **facts: object) -> dict:
        """Wait for the next JSON line of a kind with these facts."""
        def fits(line: str) -> bool:
            made = json.loads(line)
            return made["kind"] == kind and all(made.get(name) == value for name, value in facts.items())
        return json.loads(self.line(fits, f"{kind} {facts}"))
