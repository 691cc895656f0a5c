"""All in which operating systems differ, for the programs that need no ROS.

The box is developed and tested on Linux. What Windows and macOS do differently was written from their documentation and
was not tried there (docs/architecture.md, "Windows and macOS"). What needs ROS runs on Linux only, and calls the system
itself.
"""

import contextlib
import errno
import importlib
import os
import shutil
import signal
import socket
import stat
import struct
import subprocess
import sys
import threading
import time
from typing import IO, TYPE_CHECKING, Any, Awaitable, Callable, List, Optional, Tuple, TypeVar

if TYPE_CHECKING:
    import asyncio

Result = TypeVar("Result")

WINDOWS = os.name == "nt"
MACOS = sys.platform == "darwin"


def _module(name: str) -> Any:
    """A module of the standard library; None: this system does not have it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


fcntl, msvcrt, _winapi = _module("fcntl"), _module("msvcrt"), _module("_winapi")


# -- time -------------------------------------------------------------------------------------------


def time_zone() -> str:
    """Return what this computer calls its time zone, such as Asia/Tokyo; empty: not known. Where TZ describes one, such
    as JST-9, it is no name."""
    name = os.environ.get("TZ", "").lstrip(":")
    if not name:
        try:
            name = os.readlink("/etc/localtime")
        except FileNotFoundError:
            name = "" if WINDOWS else "UTC"
        except OSError:  # a copy, which has no name
            name = ""
    return name.rpartition("zoneinfo/")[2]


# -- files ------------------------------------------------------------------------------------------

# Arguments of CreateFile that Python has no names for.
_READ, _WRITE, _SHARE_ALL = 0x80000000, 0x40000000, 0x1 | 0x2 | 0x4
_CREATE_NEW, _CREATE_ALWAYS, _OPEN_EXISTING, _OPEN_ALWAYS, _TRUNCATE_EXISTING = 1, 2, 3, 4, 5
_NORMAL_FILE = 0x80
# Windows lets nobody else read a locked byte, so it is one that no file has.
_LOCKED_BYTE = 1 << 40
_PIECE_BYTES = 1 << 20
_position = threading.Lock()


def open_file(path: str, flags: int, mode: int = 0o666) -> int:
    """As `os.open`, for bytes. The file can be renamed and removed while it is open, also on Windows. Raises OSError.

    It can be the `opener` of `open`.
    """
    if _winapi is None:
        return os.open(path, flags, mode)
    access = {os.O_RDONLY: _READ, os.O_WRONLY: _WRITE}.get(flags & (os.O_WRONLY | os.O_RDWR), _READ | _WRITE)
    if flags & os.O_CREAT:
        how = _CREATE_NEW if flags & os.O_EXCL else _CREATE_ALWAYS if flags & os.O_TRUNC else _OPEN_ALWAYS
    else:
        how = _TRUNCATE_EXISTING if flags & os.O_TRUNC else _OPEN_EXISTING
    handle = _winapi.CreateFile(path, access, _SHARE_ALL, 0, how, _NORMAL_FILE, 0)
    fd: int = msvcrt.open_osfhandle(handle, flags & os.O_APPEND)
    return fd


def lock(fd: int) -> None:
    """Lock an open file until it is closed, without waiting.

    Raises BlockingIOError if it is locked already, and another OSError if the file system has no locks.
    """
    if fcntl is not None:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return
    at = os.lseek(fd, 0, os.SEEK_CUR)
    os.lseek(fd, _LOCKED_BYTE, os.SEEK_SET)
    try:
        msvcrt.locking(fd, msvcrt.LK_NBLCK, 1)
    except PermissionError:
        raise BlockingIOError(errno.EWOULDBLOCK, os.strerror(errno.EWOULDBLOCK)) from None
    finally:
        os.lseek(fd, at, os.SEEK_SET)


def is_locked(path: str) -> bool:
    """Whether a program has locked a file. False also if there is no such file, or if nobody can say."""
    try:
        # NFS locks only what may be written.
        with open(path, "r+b" if os.access(path, os.W_OK) else "rb", opener=open_file) as file:
            lock(file.fileno())
    except BlockingIOError:
        return True
    except OSError:
        pass
    return False


def read_at(fd: int, count: int, at: int) -> bytes:
    """Read up to so many bytes at this place of a file, whose position nothing else uses. Raises OSError."""
    if hasattr(os, "pread"):
        return os.pread(fd, count, at)
    with _position:
        os.lseek(fd, at, os.SEEK_SET)
        return os.read(fd, count)


def write_at(fd: int, content: "bytes | memoryview", at: int) -> int:
    """Write at this place of a file, as `read_at`; returns how many bytes were written. Raises OSError."""
    if hasattr(os, "pwrite"):
        return os.pwrite(fd, content, at)
    with _position:
        os.lseek(fd, at, os.SEEK_SET)
        return os.write(fd, content)


def sync(fd: int) -> None:
    """Sync an open file to the disk. Raises OSError."""
    # On macOS, fsync leaves the content in the memory of the disk, which a power failure takes.
    if hasattr(fcntl, "F_FULLFSYNC"):
        try:
            fcntl.fcntl(fd, fcntl.F_FULLFSYNC)
            return
        except OSError as error:
            if error.errno not in (errno.ENOTSUP, errno.EINVAL, errno.ENOTTY):  # the file system does not know it
                raise
    os.fsync(fd)


def open_to_sync(path: str) -> Optional[int]:
    """Open a file or folder for `sync`; None: a folder on Windows, whose file system keeps the names itself. Raises
    OSError."""
    if not WINDOWS:
        return os.open(path, os.O_RDONLY)
    return None if os.path.isdir(path) else open_file(path, os.O_RDWR)  # only a writer may sync


def open_to_others(path: str) -> int:
    """The permissions of a file that others than its owner may read; 0: they may not, or the system has no such
    permissions. Raises OSError or ValueError."""
    mode = stat.S_IMODE(os.stat(path).st_mode)
    return mode if mode & (stat.S_IRGRP | stat.S_IROTH) and not WINDOWS else 0


# -- the computer and its processes -----------------------------------------------------------------

_BOOT_STEP_S = 60.0
_PR_SET_PDEATHSIG = 1


def boot_id() -> str:
    """The id of the computer's start; empty if unknown."""
    if WINDOWS:
        # The monotonic clock counts from the start. An id that changes with the system clock only means that times are
        # taken from that, as after a start.
        return f"started {round((time.time() - time.monotonic()) / _BOOT_STEP_S)}"
    if MACOS:
        asked = subprocess.run(["sysctl", "-n", "kern.bootsessionuuid"], stdout=subprocess.PIPE, check=False)
        return asked.stdout.decode("ascii", errors="replace").strip()
    try:
        with open("/proc/sys/kernel/random/boot_id", encoding="ascii") as file:
            return file.read().strip()
    except OSError:
        return ""


def running_s() -> float:
    """Seconds of a clock that also runs while the computer sleeps."""
    for name in ("CLOCK_BOOTTIME", "CLOCK_MONOTONIC_RAW"):  # of Linux, of macOS
        if hasattr(time, name):
            return time.clock_gettime(getattr(time, name))
    return time.monotonic()  # that of Windows does


def status_of(pid: int) -> List[str]:
    """The fields of a process's status from its state on; an empty one: there is no process, or the system is not
    Linux."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split() or [""]
    except OSError:
        return [""]


def end_with_parent() -> None:
    """End this process when its parent ends. Only Linux can do that."""
    if sys.platform.startswith("linux"):
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def allow_many_files() -> None:
    """Let this process open as many files as the system allows: the journal keeps its files open."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def processors() -> int:
    """How many processes of a program work at the same time; 1 on Windows, where a process cannot be forked."""
    if not hasattr(os, "fork"):
        return 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def with_low_priority(command: List[str]) -> List[str]:
    """Return a command that gives way to all other programs, where the system has a program for that."""
    nice = shutil.which("nice")
    return command if nice is None else [nice, "-n", "19", *command]


def is_root() -> bool:
    """Whether this process is the superuser's."""
    return hasattr(os, "geteuid") and os.geteuid() == 0


def end_with_children(process: "subprocess.Popen[Any]") -> None:
    """End a process at once, with the processes that it started. It was started with `start_new_session`."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        return
    with contextlib.suppress(OSError):
        subprocess.run(["taskkill", "/F", "/T", "/PID", str(process.pid)], stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    process.kill()


def signal_named(name: str) -> Optional[signal.Signals]:
    """A signal by its name, such as SIGHUP; None: this system does not have it."""
    return getattr(signal, name, None)


def has_display() -> bool:
    """Whether there is a screen for windows."""
    return WINDOWS or MACOS or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


LEADS_S = 60.0  # so long a browser may take to start


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
    atexit.register(shutil.rmtree, folder, True)
    timer = threading.Timer(LEADS_S, shutil.rmtree, (folder, True))
    timer.daemon = True
    timer.start()
    return webbrowser.open((folder / "page.html").as_uri())


# -- the loop ---------------------------------------------------------------------------------------

END_S = 1.0  # for what is cancelled at the end
_WAKE_S = 0.2  # so late a program notices Ctrl-C on Windows
_READ_BYTES = 4096


def new_loop() -> "asyncio.AbstractEventLoop":
    """A loop that can wait for sockets (`add_reader`), which the usual one of Windows cannot."""
    import asyncio  # it takes long, and most programs with this file need no loop

    return asyncio.SelectorEventLoop()


def end_loop(loop: "asyncio.AbstractEventLoop") -> None:
    """Cancel what is left in a loop that does not run any more, and close it."""
    import asyncio

    tasks = asyncio.all_tasks(loop)
    for task in tasks:
        task.cancel()
    if tasks:
        loop.run_until_complete(asyncio.wait(tasks, timeout=END_S))
    loop.close()


def run(work: "Awaitable[Result]") -> Result:
    """As `asyncio.run`, in a loop as `new_loop` makes it."""
    import asyncio

    if WINDOWS:
        policy: Any = asyncio  # the checker of types knows the policy on Windows only
        asyncio.set_event_loop_policy(policy.WindowsSelectorEventLoopPolicy())
    return asyncio.run(work)  # type: ignore[arg-type]


def ending_signals() -> List[int]:
    """The signals with which a process is asked to end. Under nohup, a terminal that is closed ends nothing."""
    named = [signal.SIGINT, signal.SIGTERM, *filter(None, map(signal_named, ("SIGHUP", "SIGQUIT")))]
    return [number for number in named if signal.getsignal(number) is not signal.SIG_IGN]


def ignore_stops() -> None:
    """Let no terminal stop this process and those that it starts: neither Ctrl-Z, nor in the background."""
    for name in ("SIGTSTP", "SIGTTIN", "SIGTTOU"):
        number = signal_named(name)
        if number is not None:
            signal.signal(number, signal.SIG_IGN)


def on_end(loop: "asyncio.AbstractEventLoop", callback: Callable[[], object]) -> None:
    """Call this in the loop when the process is to end: see `ending_signals`. In the main thread."""
    try:
        for number in ending_signals():
            loop.add_signal_handler(number, callback)
    except NotImplementedError:
        for number in ending_signals():
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(callback))
        _wake(loop)


def _wake(loop: "asyncio.AbstractEventLoop") -> None:
    """Python handles signals between two steps of a program, and a loop that waits on Windows does none."""
    loop.call_later(_WAKE_S, _wake, loop)


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

    def follow() -> None:
        data = b"nothing yet"
        with contextlib.suppress(RuntimeError):  # the loop was closed
            while data:
                data = os.read(fd, _READ_BYTES)
                loop.call_soon_threadsafe(callback, data)

    if WINDOWS:  # a loop waits for sockets only
        threading.Thread(target=follow, name="input", daemon=True).start()
    else:
        loop.add_reader(fd, read)


# -- sockets ----------------------------------------------------------------------------------------

_ANY_HOST = "0.0.0.0"
_LARGEST_DATAGRAM = 65535
# Option of Linux for which Python has no name, and the type of the message with the time.
_SO_TIMESTAMPNS = 35
_TIMESPEC = struct.Struct("@ll")  # seconds and nanoseconds
# Whether the system says when it received a datagram.
HAS_TIMES = sys.platform.startswith("linux") and hasattr(socket, "CMSG_SPACE")
_TIME_SPACE = socket.CMSG_SPACE(_TIMESPEC.size) if HAS_TIMES else 0


def set_up(endpoint: socket.socket, shared: bool) -> None:
    """Before a UDP socket is bound: whether other programs may bind the same address and port, if they also allow it.
    Asks the system for the times of datagrams. Raises OSError."""
    if shared:
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if MACOS:  # on Linux, only one socket would get a broadcast with it
            endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    elif hasattr(socket, "SO_EXCLUSIVEADDRUSE"):  # Windows: otherwise, a program that shares may take the port
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
    if HAS_TIMES:
        endpoint.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)


def is_in_use(error: OSError) -> bool:
    """Whether a socket cannot be bound because another one has the address and port."""
    return error.errno == errno.EADDRINUSE or (WINDOWS and error.errno == errno.EACCES)  # a port for itself only


def reason_of(error: OSError) -> str:
    """What an error of a socket means, in the system's words."""
    return str(error.strerror) if WINDOWS else os.strerror(error.errno or 0)  # Windows has numbers without words


def receive(endpoint: socket.socket) -> Tuple[bytes, Tuple[str, int], Optional[float]]:
    """Read a datagram: its bytes, its sender, and when the system received it (UTC seconds).

    The last is None where the system does not say it. A busy process reads later than the system receives. Raises
    OSError, also if no datagram is there.
    """
    if not HAS_TIMES:
        while True:
            # Windows reports here that an earlier datagram did not arrive. It says nothing about the next one.
            with contextlib.suppress(ConnectionResetError):
                return (*endpoint.recvfrom(_LARGEST_DATAGRAM), None)
    datagram, notes, _, sender = endpoint.recvmsg(_LARGEST_DATAGRAM, _TIME_SPACE)
    if not notes:
        return datagram, sender, None
    seconds, nanoseconds = _TIMESPEC.unpack(notes[0][2])  # the only option that is set
    return datagram, sender, seconds + nanoseconds / 1e9


def host_for_broadcasts(broadcast: str) -> str:
    """The address that a socket must be bound to so that it receives broadcasts: the broadcast address, which Windows
    does not allow."""
    return _ANY_HOST if WINDOWS else broadcast


def names_senders() -> bool:
    """Whether there are sockets for datagrams between processes of this computer, whose senders the system names: only
    Linux has them."""
    return hasattr(socket, "SO_PASSCRED")


def local_socket() -> Optional[socket.socket]:
    """Such a socket; None: the system has none."""
    if not names_senders():
        return None
    opened = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    opened.setblocking(False)
    return opened


# Requests for the address and the broadcast address of an interface.
_ASK_INTERFACE = (0xC0206921, 0xC0206923) if MACOS else (0x8915, 0x8919)


def interfaces() -> List[Tuple[str, str, str]]:
    """Name, IPv4 address and broadcast address of the interfaces of this computer. On Windows, the name is that of the
    computer and the broadcast address is empty."""
    if fcntl is None:
        name = socket.gethostname()
        with contextlib.suppress(OSError):
            return [(name, address, "") for address in ("127.0.0.1", *socket.gethostbyname_ex(name)[2])]
        return [(name, "127.0.0.1", "")]
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
