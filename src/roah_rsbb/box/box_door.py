"""The document of a box, kept current for the clients of its door (docs/door.md)."""

import asyncio
from typing import Any, Callable, Dict, Mapping, Optional, Sequence, Tuple

from roah_rsbb.box.door import Door
from roah_rsbb.client.places import new_token
from roah_rsbb.core.box import Box
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import NOTHING_ALLOWED, Publicity
from roah_rsbb.document.calls import Call, Caller
from roah_rsbb.document.document import Written
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.results import UnsavedParts

# Seconds. Shortest time between what clients are sent: of events, because many robots change something in each; and of
# calls, whose effect a referee waits for.
GAP_S, CALLS_GAP_S = 0.05, 0.005
SIGN_S = 0.5


class BoxDoor:
    """Keeps the document of a box current, and its door open. Call everything in the loop's thread."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, box: Box, uuid: str, host: str, now: Callable[[], Now],
        log_files: Callable[[], Mapping[int, str]], unsaved: Callable[[], Sequence[UnsavedParts]],
        calls: Mapping[str, Call], check: Callable[[], None], publicity: Publicity = NOTHING_ALLOWED,
    ) -> None:
        """`host`: broadcast address in use; `log_files`, `unsaved`: see `Documents.look`; `calls`, `check`: see `Door`;
        `publicity`: what the public may see."""
        self._loop, self._now, self._log_files, self._unsaved = loop, now, log_files, unsaved
        self._documents = Documents(box, uuid, host, publicity)
        self._box = box
        self._seen: Optional[Tuple[int, int]] = None  # what the document was made of
        self._written = Written(Document)
        self.token = new_token()
        """Whoever has it is let in."""
        self._soon: Optional[asyncio.TimerHandle] = None
        self._sent_mono = float("-inf")
        self._calls = {name: self._current(call) for name, call in calls.items()}
        self._door = Door(loop, self.token, self._calls, now, self._written, check)
        self.document = self._documents.last
        self._is_current = True
        self.on_news: Callable[[], object] = lambda: None
        """Called when the document, or whether it is old, has changed."""
        self._said: Tuple[int, bool] = 0, True  # of `on_news`: number, is current

    def open(self, host: str) -> int:
        """Let clients in; returns the port. Raises `ServeError`, whose text names the remedy."""
        port = self._door.open(host)
        self._sign()
        return port

    def add_calls(self, calls: Mapping[str, Call]) -> None:
        """Let clients make further calls, which change nothing of the box."""
        self._calls.update(calls)

    @property
    def is_followed(self) -> bool:
        """Whether there is a client."""
        return self._door.is_followed

    @property
    def number(self) -> int:
        """The number of the document."""
        return self._written.number

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true, because of an error of this program."""
        return not self._is_current

    def ask(self, name: str, arguments: Mapping[str, Any], caller: Caller) -> "asyncio.Future[Dict[str, Any]]":
        """Carry out a call of this process: see `Door.ask`."""
        return self._door.ask(name, arguments, caller)

    def announce(self, name: str, arguments: Mapping[str, Any], caller: Caller) -> None:
        """See `Door.announce`."""
        self._door.announce(name, arguments, caller)

    @property
    def rate(self) -> float:
        """How fast the clocks pass; of a replay."""
        return self._written.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._written.rate = rate

    def close(self) -> None:
        """End all connections."""
        self._door.close()

    def changed(self) -> None:
        """Note that an event changed something: clients are sent it soon."""
        self._publish_within(GAP_S)

    def called(self) -> None:
        """Note that a referee has made a call, whose effect others wait for."""
        self._publish_within(CALLS_GAP_S)

    def _publish_within(self, gap_s: float) -> None:
        due = max(self._loop.time(), self._sent_mono + gap_s)
        if self._soon is None or due < self._soon.when():
            if self._soon is not None:
                self._soon.cancel()
            self._soon = self._loop.call_at(due, self.publish)

    def publish(self) -> Document:
        """Send clients what has changed; returns the document. What only time changes is looked at once a second."""
        if self._soon is not None:
            self._soon.cancel()
        self._soon, self._sent_mono = None, self._loop.time()
        now = self._now()  # of the box, which in a replay is that of the run
        seen = self._box.happenings, int(now.mono)
        if seen != self._seen:
            self._seen = seen
            self._look(now)
        self._door.publish()
        if (self.number, self._is_current) != self._said:
            self._said = self.number, self._is_current
            self.on_news()
        return self.document

    def _look(self, now: Now) -> None:
        """Make the document again. If that fails, which is an error of this program, clients see that it is old."""
        try:
            self.document = self._documents.look(now, self._log_files(), self._unsaved())
            self._written.update(self.document, now)
            self._is_current = True
            fault = self._documents.fault
            if fault is not None:
                self._door.report_bug(f"the public sees nothing new ({fault!r})", fault)
        except Exception as error:
            self._is_current = False
            self._door.report_bug(str(error), error)

    def _current(self, call: Call) -> Call:
        """Return a call after which the document contains what it did."""
        def carried_out(arguments, caller):
            try:
                return call(arguments, caller)
            finally:
                self._look(self._now())
                self.called()

        return carried_out

    def _sign(self) -> None:
        self._loop.call_later(SIGN_S, self._sign)
        self.publish()
        if self._is_current:
            self._door.sign()
