"""The program that keeps the copy on the standby, and takes over: when it is asked, by itself, or handed over.

The organiser's request reaches it through a socket in its folder: it has listened to the box all the time.
"""

import contextlib
import json
import os
import queue
import signal
import socket
import threading
import time
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional

from roah_rsbb.ground import durable
from roah_rsbb.standby.pairing import PairedBox, forget_standby
from roah_rsbb.standby.program.ears import Automatic, Ears, NoAddress
from roah_rsbb.standby.program.prepared import Prepared
from roah_rsbb.standby.program.takeover import Denied, StandbyFolder
from roah_rsbb.standby.standby_end import StandbyEnd
from roah_rsbb.wording import times

# Seconds without beacon, word and copy after which the program that keeps the copy allows a takeover. A box is heard
# several times a second.
SILENT_S = 3.0
LOG_DIR = "~/.ros/roah_rsbb_standby"
# In LOG_DIR: names the folder in which this computer keeps the copy, if it is another one.
KEPT_IN = "kept_in.txt"


class CopyKeeper:
    """Keeps the copy, and takes over. Call `run` once."""

    def __init__(self, folder: StandbyFolder, box: PairedBox, automatic: Optional[Automatic],
                 takes_address: bool) -> None:
        """`automatic`: when to take over without being asked; None: never."""
        self._folder, self._box, self._automatic, self._takes_address = folder, box, automatic, takes_address
        self._taking_over = ""  # why

    def run(self) -> int:
        """Keep the copy until the program is ended, or take over. Returns the exit status."""
        folder, box = self._folder, self._box
        folder.check_unused()
        folder.give_back_address()
        forget_standby(folder.path)  # this computer may have been the box
        note_folder(folder.path)
        folder.use_zone()
        self._prepared = Prepared(folder.path, folder.launch_command, Denied, show)
        self._ears = Ears(box, lambda: folder.network() if folder.network_of_box() else {},
                          lambda: folder.standing.epoch, self._automatic, self._on_silence, show)
        self._end = StandbyEnd(folder.path, box, show, self._ears.heard, folder.network()["bind_host"],
                               self._on_hand_over)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: threading.Thread(target=self._end.end).start())
        with contextlib.ExitStack() as cleanup:
            # Until the prepared box has ended, too: the next one must not start beside it.
            lock = cleanup.enter_context(folder.locked())
            requests = Requests(
                folder.path, self._on_ask, lambda: self._take_over("The organiser requested a takeover"))
            cleanup.callback(requests.close)
            cleanup.callback(self._prepared.end)
            self._ears.start()
            self._prepared.start()
            try:
                self._end.run()
            finally:
                self._ears.end()
            if self._end.was_handed_over and not self._taking_over:
                self._taking_over = (f"The core of the box at {box.host} does not answer, and its computer hands over: "
                                     "taking over")
            if not self._taking_over:
                return 0
            print(self._taking_over, flush=True)
            if not self._prepared.is_for(folder.launch_command()):
                self._prepared.end()  # it would begin, too, and with other arguments
            if self._takes_address:
                self._take_address()
            command, lines = folder.become_box(box)
            requests.report(lines)
            if self._prepared.is_for(command):
                lock.close()  # this program is the box, and not to be ended by the next takeover
                return self._prepared.run()
        os.execvp(command[0], command)
        return 0

    def _take_over(self, why: str) -> None:
        self._taking_over = self._taking_over or why
        self._end.end()

    def _on_silence(self) -> None:
        self._take_over(f"Nothing was heard of the box for {self._automatic.silence_s:g} s: taking over")

    def _on_ask(self, anyway: bool, given: List[str]) -> "Reply":
        is_silent = anyway or self._ears.wait_silent(SILENT_S)
        is_prepared = given in ([], self._folder.arguments) and self._prepared.is_for(self._folder.launch_command())
        return Reply([] if is_silent else [f"The box at {self._box.host} is heard."], is_prepared)

    def _on_hand_over(self) -> bool:
        try:
            self._folder.launch_command()
        except (Denied, OSError) as error:
            show(f"the box hands over, but: {error}")
            return False
        return True

    def _take_address(self) -> None:
        """Take the box's address in an automatic takeover. A failure does not end it: most robots need no address."""
        try:
            self._folder.take_address(self._box)
        except NoAddress as error:
            print(f"The box's address cannot be taken over: {error}", flush=True)


def show(state: str) -> None:
    """Print a state; empty: the copy is kept."""
    with contextlib.suppress(OSError):  # the output may be a file on a full disk
        print(f"{times.at_venue(time.time())} {state or 'The copy is kept'}", flush=True)


def full(path: str) -> str:
    """Return a path that is valid in every folder."""
    return os.path.abspath(os.path.expanduser(path))


def note_folder(folder: str) -> None:
    """Let later commands find the copy without --log-dir."""
    usual = full(LOG_DIR)
    with contextlib.suppress(OSError):  # a disk that is full: they need --log-dir
        os.makedirs(usual, exist_ok=True)
        durable.write_file(os.path.join(usual, KEPT_IN), folder.encode())


def noted_folder() -> str:
    """Return the folder in which the copy was kept last."""
    usual = full(LOG_DIR)
    with contextlib.suppress(OSError, ValueError), open(os.path.join(usual, KEPT_IN), encoding="utf-8") as file:
        noted = file.read().strip()
        return noted if os.path.isdir(noted) else usual
    return usual


# -- the organiser's request ----------------------------------------------------------------------------

SOCKET = "standby.sock"
# The program that keeps the copy listens for a few seconds, and then closes the copy.
TIMEOUT_S = 30.0


class Reply(NamedTuple):
    """What the program that keeps the copy says to a request."""

    reasons: List[str]  # against a takeover
    is_prepared: bool  # it can become the box itself


class Requests:
    """The end of the program that keeps the copy."""

    def __init__(self, folder: str, on_ask: Callable[[bool, List[str]], Reply], on_go: Callable[[], None]) -> None:
        """`on_ask(anyway, arguments)` returns the answer. `anyway`: take over even if the box is heard; `arguments`: of
        the launch file. `on_go` makes this program take over. Both are called in threads. Raises OSError."""
        self._on_ask, self._on_go = on_ask, on_go
        self._lines = queue.Queue()
        self._path = os.path.join(folder, SOCKET)
        with contextlib.suppress(FileNotFoundError):
            os.remove(self._path)
        self._socket = socket.socket(socket.AF_UNIX)
        with _short(folder) as path:
            self._socket.bind(path)
        self._socket.listen()
        threading.Thread(target=self._accept, name="requests", daemon=True).start()

    def report(self, lines: List[str]) -> None:
        """Report the takeover to whoever requested it."""
        self._lines.put(lines)

    def close(self) -> None:
        """Take no further requests."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        with contextlib.suppress(FileNotFoundError):
            os.remove(self._path)

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(connection,), name="request", daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        errors = OSError, ValueError, KeyError, TypeError, queue.Empty
        with contextlib.suppress(*errors), connection, connection.makefile("rw") as file:
            asked = _read(file)
            _write(file, self._on_ask(bool(asked["anyway"]), list(asked["arguments"]))._asdict())
            if _read(file).get("go"):
                self._on_go()
                _write(file, {"lines": self._lines.get(timeout=TIMEOUT_S)})


class TakeoverRequest:
    """A request to the program that keeps the copy."""

    def __init__(self, file: Any, answer: Reply) -> None:
        self._file = file
        self.answer = answer

    def go(self) -> List[str]:
        """Make that program take over; returns what it printed. Raises OSError."""
        _write(self._file, {"go": True})
        try:
            return list(_read(self._file)["lines"])
        except (ValueError, KeyError) as error:
            raise OSError(f"the program that keeps the copy did not take over ({error!r}): see its terminal") from None


@contextlib.contextmanager
def request(folder: str, anyway: bool, arguments: List[str]) -> Iterator[Optional[TakeoverRequest]]:
    """Ask the program that keeps the copy; None if it does not run."""
    with contextlib.ExitStack() as cleanup:
        found = None
        with contextlib.suppress(OSError, ValueError, TypeError):
            connection = cleanup.enter_context(socket.socket(socket.AF_UNIX))
            connection.settimeout(TIMEOUT_S)
            with _short(folder) as path:
                connection.connect(path)
            file = cleanup.enter_context(connection.makefile("rw"))
            _write(file, {"anyway": anyway, "arguments": arguments})
            found = TakeoverRequest(file, Reply(**_read(file)))
        yield found


@contextlib.contextmanager
def _short(folder: str) -> Iterator[str]:
    """A path of the socket: the system allows no more than 107 bytes."""
    directory = os.open(folder, os.O_PATH)
    try:
        yield f"/proc/self/fd/{directory}/{SOCKET}"
    finally:
        os.close(directory)


def _write(file: Any, message: Dict[str, Any]) -> None:
    file.write(json.dumps(message) + "\n")
    file.flush()


def _read(file: Any) -> Dict[str, Any]:
    return json.loads(file.readline())
