"""Signs of life of the core: its loop sends five a second or more, and nothing else of it does.

They go to systemd (sd_notify), to the supervisor that started the core, and to the program that copies the journal. The
supervisor's way is a pair of sockets that the core inherits, the other one a socket in a folder of this user: nobody
else can write to either. A process that only exists sends no sign: one that is stopped, that waits for a disk, or whose
loop does not end.

Over the same pair the supervisor keeps a few texts for the next core, such as which channels are open: its *memory*.
The program that copies has such a pair, too, over which it says whether there is a standby.
"""

import contextlib
import errno
import hashlib
import json
import os
import signal
import socket
import stat
import struct
import subprocess
import threading
import time
from typing import Callable, Dict, Iterator, Mapping, Optional, Sequence

from roah_rsbb.ground import linux

# The core has not answered for so long: it hangs.
HUNG_S = 2.0
# How often those who watch look.
LOOK_S = 0.1
# How often the program that copies is looked for, as long as none listens.
FIND_S = 1.0
# READY counts once, and WATCHDOG always.
SIGN = b"READY=1\nWATCHDOG=1"
# Not for systemd, for which the service does not end. A core that ends by itself says so.
END = b"end"
# Of a box that waits for another one to end, or for a takeover: it is no core yet.
WAITING = b"waiting"
# Of the supervisor: the core is gone, or slow, and the next one is started.
STARTING = b"starting"
# Names in the memory: before the port of a channel; the folder of the journal; the files that say where the door is;
# the TCP port of the pages; what the first core asked the ROS master for.
CHANNEL, LOG_DIR, DOORS, WEB_PORT, ROS_START = "channel/", "log_dir", "doors", "web_port", "ros_start"
# In the memory of the program that copies: the standby. It takes over when that is due, or has taken over.
STANDBY, CONNECTED, TAKEN = "standby", "connected", "taken"
# In the environment of the core: its end of the pair.
LIFELINE = "ROAH_RSBB_LIFELINE"
# Before a text for the memory.
_KEEP = b"keep "
# Of the memory, with its names.
MOST_BYTES = 60_000
_CREDENTIALS = struct.Struct("3i")  # process, user and group of the sender
_READ_BYTES = 2 * MOST_BYTES


def _folder() -> str:
    """A folder to which only this user may write. It is not in /run/user, which goes when the user logs out."""
    return os.path.join(os.path.expanduser("~"), ".roah_rsbb", "watch")


def _checked_folder() -> str:
    """Return the folder. Raises OSError if it is not there, or if others may write to it."""
    path = _folder()
    found = os.stat(path)
    if found.st_uid != os.geteuid() or stat.S_IMODE(found.st_mode) != 0o700:
        raise PermissionError(errno.EPERM, "others may write there", path)
    return path


@contextlib.contextmanager
def _address(log_dir: str) -> Iterator[str]:
    """The address of the program that copies the journal of this log_dir. A short one, however long the folder's is.
    Nothing is written: the disk may be frozen. Raises OSError."""
    name = hashlib.sha256(os.fsencode(os.path.realpath(log_dir))).hexdigest()[:32]
    folder = os.open(_checked_folder(), os.O_RDONLY)
    try:
        yield f"/proc/self/fd/{folder}/{name}"
    finally:
        os.close(folder)


class Lifeline:
    """The core's end. Without a supervisor, it has no memory. Nothing here raises or waits: nobody may watch."""

    def __init__(self, log_dir: str = "") -> None:
        """`log_dir`: default: that of the core before."""
        self.kept: Dict[str, str] = {}
        """What the core before had kept when it ended."""
        self._copier: Optional[socket.socket] = None
        self._finding, self._find_mono = threading.Thread(), float("-inf")
        systemd = os.environ.get("NOTIFY_SOCKET", "")
        self._systemd = (f"\0{systemd[1:]}" if systemd.startswith("@") else systemd).encode()
        self._unsent: Dict[str, Optional[str]] = {}  # by name; None: it is to be forgotten
        self._supervisor: Optional[socket.socket] = None
        fd = os.environ.pop(LIFELINE, "")
        if fd:
            with contextlib.suppress(OSError, ValueError):
                self._supervisor = socket.socket(fileno=int(fd))
                self._supervisor.set_inheritable(False)
                self._supervisor.setblocking(False)
                self.kept = json.loads(self._supervisor.recv(_READ_BYTES))
        self._sizes = {name: _size(name, value) for name, value in self.kept.items()}
        self.use(log_dir or self.kept.get(LOG_DIR, ""))

    @property
    def has_supervisor(self) -> bool:
        """Whether something starts the core again."""
        return self._supervisor is not None

    def use(self, log_dir: str) -> None:
        """Be the core of this log_dir; empty: it is not known yet."""
        self._log_dir = log_dir
        if log_dir:
            self.keep(LOG_DIR, log_dir)
            self._find_copier()

    def send(self, sign: bytes = SIGN) -> None:
        """Send a sign. Send that of the core in its loop, and nowhere else."""
        if self._supervisor is not None:
            self._send_unsent()
            with contextlib.suppress(OSError):
                self._supervisor.send(sign)
        if not self._log_dir:
            return
        try:
            if self._copier is not None:
                self._copier.send(sign)
        except OSError as error:
            if error.errno not in (errno.EAGAIN, errno.ENOBUFS):
                self._copier = None
        if self._copier is None and time.monotonic() >= self._find_mono and not self._finding.is_alive():
            self._find_mono = time.monotonic() + FIND_S
            self._finding = threading.Thread(target=self._find_copier, args=(sign,), daemon=True)
            with contextlib.suppress(RuntimeError):
                self._finding.start()  # whoever sends does not wait for a disk
        if self._systemd and sign in (SIGN, WAITING):
            with contextlib.suppress(OSError), contextlib.closing(linux.local_socket()) as opened:
                opened.sendto(SIGN, self._systemd)

    def wait(self) -> None:
        """Say that this process waits."""
        self.send(WAITING)

    def end(self) -> None:
        """Say that the core ends by itself."""
        self.send(END)

    def keep(self, name: str, value: str) -> bool:
        """Keep a text under this name for the next core. Returns whether the supervisor has it: otherwise it gets it
        before the next sign, unless there is none, or the memory is full."""
        if self._supervisor is None or sum(
                size for other, size in self._sizes.items() if other != name) + _size(name, value) > MOST_BYTES:
            return False
        self._sizes[name] = _size(name, value)
        self._unsent[name] = value
        return self._send_unsent()

    def drop(self, name: str) -> bool:
        """Keep it no longer. Returns as `keep`."""
        if self._supervisor is None or self._sizes.pop(name, None) is None:
            return False
        self._unsent[name] = None
        return self._send_unsent()

    def _send_unsent(self) -> bool:
        with contextlib.suppress(OSError):
            while self._unsent:
                name = next(iter(self._unsent))
                self._supervisor.send(_KEEP + json.dumps([name, self._unsent[name]]).encode())
                del self._unsent[name]
        return not self._unsent

    def _find_copier(self, *signs: bytes) -> None:
        opened = linux.local_socket()
        try:
            with _address(self._log_dir) as address:
                opened.connect(address)
            for sign in signs:
                opened.send(sign)
            self._copier = opened
        except OSError:
            opened.close()


def _size(name: str, value: str) -> int:
    return len(json.dumps([name, value]))


class CoreSilence:
    """How long the core has not given a sign of life. Only time counts in which its watcher was running, too."""

    def __init__(self) -> None:
        self.pid = 0  # process of the core; 0: none was heard
        self.seconds = 0.0
        self._looked: Optional[float] = None

    def look(self, now: float, pid: Optional[int]) -> None:
        """Note that a sign of this process came since the last look; None: none came, 0: the core ended by itself.

        `now`: monotonic seconds.
        """
        passed = 0.0 if self._looked is None else min(now - self._looked, 2 * LOOK_S)
        self._looked = now
        self.pid, self.seconds = (self.pid, self.seconds + passed) if pid is None else (pid, 0.0)

    def forget(self) -> None:
        """Wait for the next core."""
        self.pid = 0

    @property
    def is_alive(self) -> bool:
        """Whether the core answers."""
        return bool(self.pid) and self.seconds < HUNG_S


class Supervision:
    """The supervisor's end of its cores' lifelines. Call `look` every `LOOK_S`, in one thread."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now`: monotonic seconds."""
        self.memory: Dict[str, str] = {}
        self.silence = CoreSilence()  # of the present core
        self.is_waiting = False  # it said so since the last look
        self._now = now
        self._socket: Optional[socket.socket] = None

    def start(self, command: Sequence[str], environment: Mapping[str, str]) -> "subprocess.Popen[bytes]":
        """Start the next core. It has the memory before it does anything."""
        self.close()
        self.silence = CoreSilence()
        self._socket, inherited = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.setblocking(False)
        self._socket.send(json.dumps(self.memory).encode())
        with inherited:
            return subprocess.Popen(command, env={**environment, LIFELINE: str(inherited.fileno())},
                                    pass_fds=[inherited.fileno()])

    def look(self, pid: int) -> None:
        """Take what the core said; `pid`: its process."""
        found: Optional[int] = None
        self.is_waiting = False
        while self._socket is not None:
            try:
                data = self._socket.recv(_READ_BYTES)
            except OSError:
                break
            if not data:
                break  # it is gone
            if data.startswith(_KEEP):
                self._remember(*json.loads(data[len(_KEEP):]))
            elif data in (SIGN, END):
                found = 0 if data == END else pid
            elif data == WAITING:
                self.is_waiting = True
        self.silence.look(self._now(), found)

    def close(self) -> None:
        """Take no more."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _remember(self, name: str, value: Optional[str]) -> None:
        self.memory.pop(name, None)
        if value is not None:
            self.memory[name] = value


class Watch:
    """Watches the core of a log_dir for the program that copies. Call `look` every `LOOK_S`, in one thread."""

    def __init__(self, log_dir: str, now: Callable[[], float]) -> None:
        """`now`: monotonic seconds."""
        self._log_dir, self._now = log_dir, now
        self._socket: Optional[socket.socket] = None
        self._began = ""  # when the core's process began
        self._starting_mono = float("-inf")
        self.silence = CoreSilence()

    def look(self) -> None:
        """Take the signs that came."""
        pid = self._newest()
        if pid and pid != self.silence.pid:
            self._began = began(pid)
        self.silence.look(self._now(), pid)

    @property
    def is_gone(self) -> bool:
        """Whether the process of a core that did not end by itself does not exist any more."""
        return self.silence.pid > 0 and (began(self.silence.pid) or "none") != self._began

    @property
    def is_starting(self) -> bool:
        """Whether the supervisor said lately that the next core is being started."""
        return self._now() - self._starting_mono < HUNG_S

    @property
    def is_hung(self) -> bool:
        """Whether the core's process exists, but does not answer."""
        return self.silence.pid > 0 and self.silence.seconds >= HUNG_S and not self.is_gone

    def kill(self) -> None:
        """End the core's process: it does nothing any more from now on, whatever it waits for."""
        if self.is_hung:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.silence.pid, signal.SIGKILL)

    def close(self) -> None:
        """Stop watching."""
        if self._socket is not None:
            self._socket.close()

    def _newest(self) -> Optional[int]:
        """The process that sent the newest sign since the last call; None: none came, 0: the core ended by itself."""
        if self._socket is None and not self._open():
            return None
        found: Optional[int] = None
        while True:
            try:
                data, parts, _, _ = self._socket.recvmsg(_READ_BYTES, socket.CMSG_SPACE(_CREDENTIALS.size))
            except OSError:
                return found
            for _level, kind, content in parts:
                if kind != socket.SCM_CREDENTIALS:
                    continue
                pid, user, _group = _CREDENTIALS.unpack(content)
                if user == os.geteuid() and data in (SIGN, END):
                    found = pid if data == SIGN else 0
                elif user == os.geteuid() and data == STARTING:
                    self._starting_mono = self._now()

    def _open(self) -> bool:
        """Open the socket. Another process may have it for a moment, such as a node that is just ending."""
        opened = linux.local_socket()
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        try:
            os.makedirs(_folder(), mode=0o700, exist_ok=True)
            with _address(self._log_dir) as address:
                if _is_left(address):
                    os.unlink(address)
                opened.bind(address)
        except OSError:
            opened.close()
            return False
        self._socket = opened
        return True


def _is_left(address: str) -> bool:
    """Whether there is a socket that nobody reads any more."""
    with contextlib.closing(linux.local_socket()) as trial:
        try:
            trial.connect(address)
        except ConnectionRefusedError:
            return True
        except OSError:
            pass
    return False


def state_of(pid: int) -> str:
    """Say what a process does that does not answer."""
    return {"T": "it is stopped", "t": "a debugger holds it", "D": "it waits for a disk",
            "R": "its loop does not end"}.get(linux.status_of(pid)[0], "its loop waits")


def began(pid: int) -> str:
    """When a process began, to distinguish it from a later one of the same number; empty: there is none any more."""
    state, *rest = linux.status_of(pid)
    return "" if state in ("", "Z", "X") else rest[18]
