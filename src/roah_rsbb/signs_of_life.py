"""Signs of life of the core: its loop sends five a second or more, and nothing else of it does.

They are datagrams as systemd expects them (sd_notify), so that one message serves systemd and the nodes that watch the
core on its computer. The kernel says which process sent one. A process that only exists sends none: one that is
stopped, that waits for a disk, or whose loop does not end.

Only Linux has such datagrams. On other systems nothing is sent, and nobody who watches ever sees a core.
"""

import contextlib
import hashlib
import os
import signal
import socket
import struct
from typing import Callable, Optional

from roah_rsbb import platform

# The core has not answered for so long: it hangs.
HUNG_S = 2.0
# How often those who watch look.
LOOK_S = 0.1
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
_CREDENTIALS = struct.Struct("3i")  # process, user and group of the sender
_MAX_BYTES = 256


def _address(log_dir: str, watcher: str) -> bytes:
    """The address of one who watches the core of this log_dir. It is in no folder, so no disk takes part in it."""
    return b"\0roah_rsbb/" + f"{hashlib.sha256(os.fsencode(os.path.realpath(log_dir))).hexdigest()}/{watcher}".encode()


class Signs:
    """The core's end."""

    def __init__(self, log_dir: str) -> None:
        self._socket = platform.local_socket()
        self._addresses = [_address(log_dir, watcher) for watcher in (SUPERVISOR, BACKUP)]
        systemd = os.environ.get("NOTIFY_SOCKET", "")
        self._systemd = (f"\0{systemd[1:]}" if systemd.startswith("@") else systemd).encode()

    def send(self, sign: bytes = SIGN) -> None:
        """Send a sign. Send that of the core in its loop, and nowhere else. Never raises or waits: nobody may watch."""
        if self._socket is None:
            return
        for address in (*self._addresses, *([self._systemd] if self._systemd and sign in (SIGN, WAITING) else [])):
            with contextlib.suppress(OSError):
                self._socket.sendto(SIGN if address == self._systemd else sign, address)

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


class Watch:
    """Watches the core of a log_dir. Call `look` every `LOOK_S`, in one thread."""

    def __init__(self, log_dir: str, watcher: str, now: Callable[[], float]) -> None:
        """`now`: monotonic seconds."""
        self._address, self._now = _address(log_dir, watcher), now
        self._socket: Optional[socket.socket] = None
        self._began = ""  # when the core's process began
        self._starting_mono = float("-inf")
        self.waiting = 0  # the process that said last that it waits; 0: none
        self.silence = CoreSilence()

    def look(self) -> None:
        """Take the signs that came."""
        pid = self._newest()
        if pid and pid != self.silence.pid:
            self._began = began(pid)
        self.silence.look(self._now(), pid)

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
                data, parts, _, _ = self._socket.recvmsg(_MAX_BYTES, socket.CMSG_SPACE(_CREDENTIALS.size))
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
                elif user == os.geteuid() and data == WAITING:
                    self.waiting = pid

    def _open(self) -> bool:
        """Open the socket. Another process may have it for a moment, such as a node that is just ending."""
        opened = platform.local_socket()
        if opened is None:
            return False
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        try:
            opened.bind(self._address)
        except OSError:
            opened.close()
            return False
        self._socket = opened
        return True


def state_of(pid: int) -> str:
    """Say what a process does that does not answer."""
    return {"T": "it is stopped", "t": "a debugger holds it", "D": "it waits for a disk",
            "R": "its loop does not end"}.get(platform.status_of(pid)[0], "its loop waits")


def began(pid: int) -> str:
    """When a process began, to distinguish it from a later one of the same number; empty: there is none any more."""
    state, *rest = platform.status_of(pid)
    return "" if state in ("", "Z", "X") else rest[18]
