"""What the programs ask of the operating system, which is Linux."""

import contextlib
import fcntl
import os
import shutil
import signal
import socket
import stat
import struct
import subprocess
import threading
import time
from typing import IO, TYPE_CHECKING, Any, Callable, List, Optional, Tuple

if TYPE_CHECKING:
    import asyncio

# -- time -------------------------------------------------------------------------------------------


def time_zone() -> str:
    """Return what this computer calls its time zone, such as Asia/Tokyo; empty: not known. Where TZ describes one, such
    as JST-9, it is no name."""
    name = os.environ.get("TZ", "").lstrip(":")
    if not name:
        try:
            name = os.readlink("/etc/localtime")
        except FileNotFoundError:
            name = "UTC"
        except OSError:  # a copy, which has no name
            name = ""
    return name.rpartition("zoneinfo/")[2]


# -- files ------------------------------------------------------------------------------------------


def lock(fd: int) -> None:
    """Lock an open file until it is closed, without waiting.

    Raises BlockingIOError if it is locked already, and another OSError if the file system has no locks.
    """
    fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_locked(path: str) -> bool:
    """Whether a program has locked a file. False also if there is no such file, or if nobody can say."""
    try:
        # NFS locks only what may be written.
        with open(path, "r+b" if os.access(path, os.W_OK) else "rb") as file:
            lock(file.fileno())
    except BlockingIOError:
        return True
    except OSError:
        pass
    return False


def open_to_others(path: str) -> int:
    """The permissions of a file that others than its owner may read; 0: they may not. Raises OSError or ValueError."""
    mode = stat.S_IMODE(os.stat(path).st_mode)
    return mode if mode & (stat.S_IRGRP | stat.S_IROTH) else 0


# -- the computer and its processes -----------------------------------------------------------------

_PR_SET_PDEATHSIG = 1


def boot_id() -> str:
    """The id of the computer's start; empty if unknown."""
    try:
        with open("/proc/sys/kernel/random/boot_id", encoding="ascii") as file:
            return file.read().strip()
    except OSError:
        return ""


def running_s() -> float:
    """Seconds of a clock that also runs while the computer sleeps."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def status_of(pid: int) -> List[str]:
    """The fields of a process's status from its state on; an empty one: there is no process."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split() or [""]
    except OSError:
        return [""]


def end_with_parent() -> None:
    """End this process when its parent ends."""
    import ctypes

    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def allow_many_files() -> None:
    """Let this process open as many files as the system allows: the journal keeps its files open."""
    import resource  # only the box needs it

    with contextlib.suppress(ValueError, OSError):
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def with_low_priority(command: List[str]) -> List[str]:
    """Return a command that gives way to all other programs, where the system has a program for that."""
    nice = shutil.which("nice")
    return command if nice is None else [nice, "-n", "19", *command]


def end_with_children(process: "subprocess.Popen[Any]") -> None:
    """End a process at once, with the processes that it started. It was started with `start_new_session`."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def has_display() -> bool:
    """Whether there is a screen for windows."""
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


LEADS_S = 60.0  # so long a browser may take to start
_leads: List[str] = []  # folders that lead browsers to pages


def open_in_browser(url: str) -> bool:
    """Open a page in the user's browser; returns whether there is one. A browser in the terminal does not count.

    All users of a computer see the arguments of programs, and the address may contain a code. So the browser is given a
    file that only this user may read. It leads to the page, and is removed after `LEADS_S`.
    """
    if not has_display():
        return False
    import atexit  # only the start of a box needs these
    import html
    import pathlib
    import tempfile
    import webbrowser

    try:
        # Browsers of snap packages read neither hidden folders nor /tmp.
        folder = pathlib.Path(tempfile.mkdtemp(prefix="roah_rsbb_", dir=os.path.expanduser("~")))
        with open(os.open(folder / "page.html", os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            file.write('<!DOCTYPE html><meta name="referrer" content="no-referrer">'
                       f'<meta http-equiv="refresh" content="0;url={html.escape(url)}">')
    except OSError:
        return False
    _leads.append(str(folder))
    atexit.register(remove_leads)
    timer = threading.Timer(LEADS_S, shutil.rmtree, (folder, True))
    timer.daemon = True
    timer.start()
    return webbrowser.open((folder / "page.html").as_uri())


def remove_leads() -> None:
    """Remove what leads browsers to pages. Call it before a process ends without running destructors."""
    while _leads:
        shutil.rmtree(_leads.pop(), True)


# -- the loop ---------------------------------------------------------------------------------------

END_S = 1.0  # for what is cancelled at the end
_READ_BYTES = 4096


def end_loop(loop: "asyncio.AbstractEventLoop") -> None:
    """Cancel what is left in a loop that does not run any more, and close it."""
    import asyncio

    tasks = asyncio.all_tasks(loop)
    for task in tasks:
        task.cancel()
    if tasks:
        loop.run_until_complete(asyncio.wait(tasks, timeout=END_S))
    loop.close()


def ending_signals() -> List[int]:
    """The signals with which a process is asked to end. Under nohup, a terminal that is closed ends nothing."""
    asked = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
    return [number for number in asked if signal.getsignal(number) is not signal.SIG_IGN]


def ignore_stops() -> None:
    """Let no terminal stop this process and those that it starts: neither Ctrl-Z, nor in the background."""
    for number in (signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU):
        signal.signal(number, signal.SIG_IGN)


def on_end(loop: "asyncio.AbstractEventLoop", callback: Callable[[], object]) -> None:
    """Call this in the loop when the process is to end: see `ending_signals`. In the main thread."""
    for number in ending_signals():
        loop.add_signal_handler(number, callback)


def on_input(loop: "asyncio.AbstractEventLoop", file: Optional[IO[Any]], callback: Callable[[bytes], None]) -> None:
    """Call this in the loop with what comes from a file, such as the standard input, and with no bytes at its end.

    Raises OSError if the system cannot wait for this file, and ValueError if there is none.
    """
    if file is None:
        raise ValueError("there is no input")
    fd = file.fileno()

    def read() -> None:
        data = os.read(fd, _READ_BYTES)
        if not data:
            loop.remove_reader(fd)
        callback(data)

    loop.add_reader(fd, read)


# -- sockets ----------------------------------------------------------------------------------------

_LARGEST_DATAGRAM = 65535
# Option of Linux for which Python has no name, and the type of the message with the time.
_SO_TIMESTAMPNS = 35
_TIMESPEC = struct.Struct("@ll")  # seconds and nanoseconds
_TIME_SPACE = socket.CMSG_SPACE(_TIMESPEC.size)


def set_up(endpoint: socket.socket, shared: bool) -> None:
    """Before a UDP socket is bound: whether other programs may bind the same address and port, if they also allow it.
    Asks the system for the times of datagrams. Raises OSError."""
    if shared:
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    endpoint.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)


def receive(endpoint: socket.socket) -> Tuple[bytes, Tuple[str, int], Optional[float]]:
    """Read a datagram: its bytes, its sender, and when the system received it (UTC seconds; None: not said).

    A busy process reads later than the system receives. Raises OSError, also if no datagram is there.
    """
    datagram, notes, _, sender = endpoint.recvmsg(_LARGEST_DATAGRAM, _TIME_SPACE)
    if not notes:
        return datagram, sender, None
    seconds, nanoseconds = _TIMESPEC.unpack(notes[0][2])  # the only option that is set
    return datagram, sender, seconds + nanoseconds / 1e9


def local_socket() -> socket.socket:
    """A socket for datagrams between processes of this computer, whose senders the system names."""
    opened = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    opened.setblocking(False)
    return opened


# Requests for the address and the broadcast address of an interface.
_ASK_INTERFACE = (0x8915, 0x8919)


def interfaces() -> List[Tuple[str, str, str]]:
    """Name, IPv4 address and broadcast address of the interfaces of this computer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        return [(name, *(_address(asking, name, what) for what in _ASK_INTERFACE))  # type: ignore[misc]
                for _, name in socket.if_nameindex()]


def _address(asking: socket.socket, name: str, what: int) -> str:
    """An address of an interface; empty: it has none."""
    try:
        answer = fcntl.ioctl(asking.fileno(), what, struct.pack("256s", name.encode()[:15]))
    except OSError:
        return ""
    return socket.inet_ntoa(answer[20:24])


def end_launch(launch: "subprocess.Popen[Any]", limit_s: float) -> None:
    """Ask a roslaunch, which has a session of its own, to end its nodes, as Ctrl-C does, and wait. After `limit_s`
    seconds, kill it and its nodes."""
    with contextlib.suppress(ProcessLookupError):
        launch.send_signal(signal.SIGINT)
    try:
        launch.wait(limit_s)
    except subprocess.TimeoutExpired:
        os.killpg(launch.pid, signal.SIGKILL)
        launch.wait()
