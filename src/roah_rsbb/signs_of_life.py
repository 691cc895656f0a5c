"""Signs of life of the core: its loop sends five a second or more, and nothing else of it does.

They are datagrams as systemd expects them (sd_notify), so that one message serves systemd and the nodes that watch the
core on its computer. The kernel says which process sent one. A process that only exists sends none: one that is
stopped, that waits for a disk, or whose loop does not end. The sockets are in a folder of the user into which nobody
else can write.

With its signs, the core gives the supervisor what the next core must know although this one could not record it
(`Signs.keep`). A core that starts asks the supervisor for that, and how many cores failed in succession.

Only Linux has such datagrams. On other systems nothing is sent, and nobody who watches ever sees a core.
"""

import contextlib
import hashlib
import json
import os
import select
import signal
import socket
import stat
import struct
import tempfile
import time
from typing import Callable, Dict, Iterator, List, Mapping, Optional

from roah_rsbb import platform

# The core has not answered for so long: it hangs. Twice as long after each core that failed.
HUNG_S = 2.0
# How often those who watch look.
LOOK_S = 0.1
# A core that has answered for so long lives.
STEADY_S = 10.0
# Those who watch.
SUPERVISOR, BACKUP = "supervisor", "backup"
# READY counts once, and WATCHDOG always.
SIGN = b"READY=1\nWATCHDOG=1"
# Not for systemd, for which the service does not end. A core that ends by itself says so.
END = b"end"
# Of a box that waits for another one to end, or for a takeover: it is no core yet.
WAITING = b"waiting"
# Of the supervisor: the core is gone, and roslaunch starts the next one.
STARTING = b"starting"
# Of a core that starts, to the supervisor; and how long it waits for the answer, s.
ASK, ANSWER_S = b"ask", 0.5
_CREDENTIALS = struct.Struct("3i")  # process, user and group of the sender
# Of what is kept; and of a datagram.
MOST_KEPT, _MAX_BYTES = 60_000, 65_536
_LONGEST_PATH = 107  # of a socket


def _folders() -> Iterator[str]:
    """The folders in which those who watch listen; the first one that they can use. A disk that is full or hangs is
    only in the way where the system has no folder in memory for the user."""
    user = os.geteuid()
    yield f"/run/user/{user}"
    yield os.path.join(os.path.expanduser("~"), ".roah_rsbb")
    yield os.path.join(tempfile.gettempdir(), f"roah_rsbb-{user}")


def _is_ours(folder: str) -> bool:
    """Whether only this user can write into a folder."""
    try:
        found = os.lstat(folder)
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid() and not found.st_mode & 0o022


def _addresses(log_dir: str, name: str) -> List[str]:
    """Where one of this name may listen who has to do with the core of this log_dir."""
    if not platform.names_senders():
        return []
    core = hashlib.sha256(os.fsencode(os.path.realpath(log_dir))).hexdigest()[:16]
    found = [os.path.join(folder, f"roah_rsbb_{core}_{name}") for folder in _folders()]
    return [path for path in found if len(os.fsencode(path)) <= _LONGEST_PATH]


def _bound(addresses: List[str]) -> Optional[socket.socket]:
    """Return a socket that listens at the first of these addresses that can be used; None: at none."""
    opened = platform.local_socket()
    if opened is None:
        return None
    opened.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
    for address in addresses:
        with contextlib.suppress(OSError):
            os.makedirs(os.path.dirname(address), 0o700, exist_ok=True)
            if _is_ours(os.path.dirname(address)):
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(address)  # of one that is just ending, or was killed
                opened.bind(address)
                os.chmod(address, 0o600)
                return opened
    opened.close()
    return None


class Signs:
    """The core's end."""

    def __init__(self, log_dir: str) -> None:
        self._log_dir = log_dir
        self._socket = platform.local_socket()
        self._supervisor, self._backup = _addresses(log_dir, SUPERVISOR), _addresses(log_dir, BACKUP)
        systemd = os.environ.get("NOTIFY_SOCKET", "")
        self._systemd = f"\0{systemd[1:]}" if systemd.startswith("@") else systemd
        self.kept: Mapping[str, str] = {}
        """What the core before had kept when it ended; see `ask`."""
        self._keeps: Dict[str, str] = {}
        self._sign = SIGN

    def ask(self) -> int:
        """Ask the supervisor what the core before kept. Returns how many cores failed in succession: they hung or
        crashed before they had answered for `STEADY_S`; 0: no supervisor answers. Call it once, before the first
        sign."""
        own, failures = _bound(_addresses(self._log_dir, f"core{os.getpid()}")), 0
        if own is None:
            return 0
        usual, self._socket, own_name = self._socket, own, own.getsockname()
        with own, contextlib.suppress(OSError, ValueError):
            asked = [path for path in self._supervisor if self._send_to(path, ASK)]
            if asked and select.select([own], [], [], ANSWER_S)[0]:
                failures, self.kept = json.loads(own.recv(_MAX_BYTES))
        with contextlib.suppress(OSError):
            os.unlink(own_name)
        self._socket, self._keeps = usual, dict(self.kept)
        self._made()
        return failures

    def keep(self, name: str, value: str) -> bool:
        """Have the supervisor keep a text for the next core. Never waits; returns False if that is too much."""
        if self._keeps.get(name) == value:
            return True
        before = self._keeps.get(name)
        self._keeps[name] = value
        if len(self._made()) > MOST_KEPT:
            del self._keeps[name]
            if before is not None:
                self._keeps[name] = before
            self._made()
            return False
        self.send()
        return True

    def drop(self, name: str) -> None:
        """Have it keep that no longer."""
        if self._keeps.pop(name, None) is not None:
            self._made()

    def keeps(self, beginning: str) -> List[str]:
        """The names of what is kept that begin so."""
        return [name for name in self._keeps if name.startswith(beginning)]

    def _made(self) -> bytes:
        self._sign = SIGN + b"\n" + json.dumps(self._keeps).encode() if self._keeps else SIGN
        return self._sign

    def send(self, sign: bytes = SIGN) -> None:
        """Send a sign. Send that of the core in its loop, and nowhere else. Never raises or waits: nobody may watch."""
        for path in self._supervisor:
            self._send_to(path, self._sign if sign is SIGN else sign)
        for path in self._backup:
            self._send_to(path, sign)
        if self._systemd and sign in (SIGN, WAITING):
            self._send_to(self._systemd, SIGN, is_ours=True)

    def _send_to(self, address: str, content: bytes, is_ours: bool = False) -> bool:
        if self._socket is None or not (is_ours or _is_ours(os.path.dirname(address))):
            return False
        with contextlib.suppress(OSError):
            self._socket.sendto(content, address.encode("utf-8", "surrogateescape"))
            return True
        return False

    def wait(self) -> None:
        """Say that this process waits."""
        self.send(WAITING)

    def end(self) -> None:
        """Say that the core ends by itself."""
        self.send(END)


class CoreSilence:
    """How long the core has not given a sign of life. Only time counts in which its watcher was running, too."""

    def __init__(self) -> None:
        self.pid = 0  # process of the core; 0: none was heard
        self.seconds = 0.0
        self._looked: Optional[float] = None

    def look(self, now: float, pid: Optional[int]) -> float:
        """Note that a sign of this process came since the last look; None: none came, 0: the core ended by itself.

        `now`: monotonic seconds. Returns how many of them count since the last look.
        """
        passed = 0.0 if self._looked is None else min(now - self._looked, 2 * LOOK_S)
        self._looked = now
        self.pid, self.seconds = (self.pid, self.seconds + passed) if pid is None else (pid, 0.0)
        return passed

    def forget(self) -> None:
        """Wait for the next core."""
        self.pid = 0

    @property
    def is_alive(self) -> bool:
        """Whether the core answers."""
        return bool(self.pid) and self.seconds < HUNG_S


class Watch:
    """Watches the core of a log_dir. Call `look` every `LOOK_S`, in one thread."""

    def __init__(self, log_dir: str, watcher: str, now: Callable[[], float]) -> None:
        """`now`: monotonic seconds."""
        self._addresses, self._now = _addresses(log_dir, watcher), now
        self._socket: Optional[socket.socket] = None
        self._began = ""  # when the core's process began
        self._kept = b"{}"  # what the core gave last for the next one
        self._failures = 0  # of cores in succession, since one answered for `STEADY_S`
        self._steady_s = 0.0  # for so long the core has answered
        self._starting_mono = float("-inf")
        self.waiting = 0  # the process that said last that it waits; 0: none
        self.silence = CoreSilence()

    def look(self) -> None:
        """Take the signs that came."""
        pid = self._newest()
        if pid and pid != self.silence.pid:
            self._began, self._steady_s = began(pid), 0.0
        passed = self.silence.look(self._now(), pid)
        self._steady_s = self._steady_s + passed if self.silence.is_alive else 0.0
        if self._steady_s >= STEADY_S or pid == 0:
            self._failures = 0

    def wait(self, seconds: float) -> None:
        """Wait for the next sign, or for so long."""
        if self._socket is None:
            time.sleep(seconds)
        else:
            select.select([self._socket], [], [], seconds)

    @property
    def patience_s(self) -> float:
        """How long the core may be silent: longer each time, so that a slow one is not ended again and again."""
        return HUNG_S * 2 ** min(self._failures, 4)

    def failed(self) -> None:
        """A core did not live: see `Signs.ask`."""
        self._failures += 1

    @property
    def can_hear(self) -> bool:
        """Whether signs of life can be heard on this system."""
        return self._socket is not None

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
        return self.silence.pid > 0 and self.silence.seconds >= self.patience_s and not self.is_gone

    def kill(self) -> None:
        """End the core's process: it does nothing any more from now on, whatever it waits for."""
        if self.is_hung:
            self.failed()
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.silence.pid, signal.SIGKILL)

    def close(self) -> None:
        """Stop watching."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _newest(self) -> Optional[int]:
        """The process that sent the newest sign since the last call; None: none came, 0: the core ended by itself."""
        if self._socket is None and not self._open():
            return None
        found: Optional[int] = None
        while True:
            try:
                data, parts, _, sender = self._socket.recvmsg(_MAX_BYTES, socket.CMSG_SPACE(_CREDENTIALS.size))
            except OSError:
                return found
            for _level, kind, content in parts:
                if kind != socket.SCM_CREDENTIALS:
                    continue
                pid, user, _group = _CREDENTIALS.unpack(content)
                if user != os.geteuid():
                    continue
                if data.startswith(SIGN):
                    found, self._kept = pid, data[len(SIGN) + 1:] or b"{}"
                elif data == END:
                    found = 0
                elif data == STARTING:
                    self._starting_mono = self._now()
                elif data == WAITING:
                    self.waiting = pid
                elif data == ASK and sender:
                    with contextlib.suppress(OSError):
                        self._socket.sendto(b"[%d, %s]" % (self._failures, self._kept), sender)

    def _open(self) -> bool:
        """Open the socket."""
        self._socket = _bound(self._addresses)
        return self._socket is not None


def state_of(pid: int) -> str:
    """Say what a process does that does not answer."""
    return {"T": "it is stopped", "t": "a debugger holds it", "D": "it waits for a disk",
            "R": "its loop does not end"}.get(platform.status_of(pid)[0], "its loop waits")


def began(pid: int) -> str:
    """When a process began, to distinguish it from a later one of the same number; empty: there is none any more."""
    state, *rest = platform.status_of(pid)
    return "" if state in ("", "Z", "X") else rest[18]
