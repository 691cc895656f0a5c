"""The organiser's request to take over, to the program that keeps the copy: it has listened to the box all the time."""

import contextlib
import json
import os
import queue
import socket
import threading
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional

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
