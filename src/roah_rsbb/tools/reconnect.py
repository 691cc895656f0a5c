"""Restarts the windows of this computer with the ROS master of the box that took over (docs/standby.md).

    rosrun roah_rsbb reconnect 192.168.1.3

A ROS node cannot change its master. So this program ends the clients, public displays and rqt windows that you started
on this computer, and starts each again with the same command, in the same folder, but with the new master. What panels
show comes from the new box, so nothing is lost except the selected zone and an entry that was not sent yet.
"""

import argparse
import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from typing import Dict, List, NamedTuple, Sequence

import rosgraph

from roah_rsbb.ground.arguments import Parser

PROGRAM = "reconnect"
MASTER_PORT = 11311
LAUNCHES = ("roah_rsbb_client.launch", "roah_rsbb_public.launch")
# Names of programs and of our own windows, which scripts start.
WINDOWS = ("rqt", "rqt_gui", "panel", "roah_rsbb_public")
# A service that only a box has. A core that waits on a standby does not have it.
SERVICE = "/core/start"
# Seconds until programs that do not end are killed: with a master that is off, they may wait for it for minutes.
END_S = 3.0
_MASTER = "ROS_MASTER_URI"


class Process(NamedTuple):
    """A running program."""

    pid: int
    parent: int
    words: List[str]


class NotReconnected(Exception):
    """Nothing was changed. The text says why."""


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, (__doc__ or "").strip())
    parser.add_argument("box", metavar="ADDRESS", help="address of the box that took over, or its ROS_MASTER_URI")
    return parser


def uri_of(box: str) -> str:
    """Return the URI of the box's ROS master."""
    return box if "://" in box else f"http://{box}:{MASTER_PORT}"


def is_client(words: Sequence[str]) -> bool:
    """Whether a command line belongs to a program that follows a box: a client, a public display, rqt."""
    names = [os.path.basename(word) for word in words]
    # A script stands behind its interpreter.
    begin = names[1:2] if names and names[0].startswith("python") else names[:1]
    if "roslaunch" in begin:
        return any(name in LAUNCHES for name in names)
    return any(name in WINDOWS for name in begin)


def clients(processes: Sequence[Process]) -> List[Process]:
    """Return the clients, without programs that another client started."""
    by_pid = {process.pid: process for process in processes}

    def has_client_above(process: Process) -> bool:
        above = by_pid.get(process.parent)
        return above is not None and (is_started_by_launch(above.words) or has_client_above(above))

    return [process for process in processes if is_client(process.words) and not has_client_above(process)]


def is_started_by_launch(words: Sequence[str]) -> bool:
    """Whether this is a client, or a roslaunch, with which the windows that it started end."""
    return is_client(words) or any(os.path.basename(word) == "roslaunch" for word in words[:2])


def own_processes() -> List[Process]:
    """Return the programs of this user."""
    found = []
    for name in os.listdir("/proc"):
        with contextlib.suppress(OSError, ValueError, IndexError):
            if not name.isdigit() or os.stat(f"/proc/{name}").st_uid != os.getuid():
                continue
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                parent = int(file.read().rpartition(")")[2].split()[1])
            found.append(Process(int(name), parent, _strings(name, "cmdline")))
    return found


def _strings(pid: object, what: str) -> List[str]:
    with open(f"/proc/{pid}/{what}", "rb") as file:
        return [os.fsdecode(part) for part in file.read().split(b"\0")[:-1]]


def descendants(pid: int, processes: Sequence[Process]) -> List[int]:
    """Return a process and all that it started."""
    found = [pid]
    for each in found:  # the list grows during the loop
        found += [process.pid for process in processes if process.parent == each]
    return found


class RestartedProgram(NamedTuple):
    """A program to start again."""

    words: List[str]
    folder: str
    environment: Dict[str, str]


def restart_of(pid: int, uri: str) -> RestartedProgram:
    """Return how a program was started, with another master. Raises OSError."""
    environment = dict(entry.partition("=")[::2] for entry in _strings(pid, "environ"))
    return RestartedProgram(_strings(pid, "cmdline"), os.readlink(f"/proc/{pid}/cwd"), {**environment, _MASTER: uri})


def end(pid: int) -> None:
    """End a program and all that it started: panels hold nothing that could be lost."""
    all_of_it = descendants(pid, own_processes())
    _signal(pid, signal.SIGINT)
    deadline = time.monotonic() + END_S
    while time.monotonic() < deadline and any(map(_runs, all_of_it)):
        time.sleep(0.05)
    for each in all_of_it:
        _signal(each, signal.SIGKILL)


def _signal(pid: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)


def _runs(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def check_box(uri: str) -> None:
    """Raise `NotReconnected` if no box runs there."""
    try:
        rosgraph.Master("/roah_rsbb_reconnect", uri).lookupService(SERVICE)
    except rosgraph.MasterException:
        raise NotReconnected(f"the ROS master at {uri} has no box yet: take over first") from None
    except (OSError, ValueError) as error:
        raise NotReconnected(f"no ROS master answers at {uri} ({error}): check the address") from None


def reconnect(uri: str) -> List[subprocess.Popen]:
    """Restart all clients; returns them. Raises `NotReconnected`."""
    check_box(uri)
    found = clients(own_processes())
    if not found:
        raise NotReconnected("no client, public display or rqt of yours runs here. Start it with: "
                             f"{_MASTER}={uri} roslaunch roah_rsbb roah_rsbb_client.launch")
    restarts = [restart_of(process.pid, uri) for process in found]
    threads = [threading.Thread(target=end, args=(process.pid,)) for process in found]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    started = []
    for restart in restarts:
        print(f"{_MASTER}={uri} {' '.join(restart.words)}", flush=True)
        started.append(subprocess.Popen(restart.words, cwd=restart.folder, env=restart.environment))
    return started


def main() -> None:
    """Run the program until all restarted programs have ended."""
    options = _parser().parse_args()
    try:
        started = reconnect(uri_of(options.box))
    except (NotReconnected, OSError) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        sys.exit(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C also reaches the started programs, for which this one waits
    sys.exit(max(abs(process.wait()) for process in started))
