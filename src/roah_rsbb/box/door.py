"""The door of the box: one way in, one way out, for panels, terminals, displays and the web gateway.

A WebSocket in the core's loop. Each client is sent the document (`document/document.py`), and calls what the core
offers: `{"id": 7, "call": "act", …arguments}`. The answer has the id, and the `number` of the document that contains
what the call did; the change is sent before the answer (`document/calls.py`). A malformed request is answered with
`{"error": text}`. `{"whole": true}` asks for the whole document. A client may offer further calls (`box/offers.py`):
`{"offer": ["pair"]}`. It is asked `{"asked": 3, "call": "pair", …}` and answers with the number.

STOP is carried out as soon as it is read. Of all other calls of all clients, each turn of the loop carries out one, and
the connection of a call that waits for its turn is not read. A client has a second connection for STOP (`?face=stop`),
which is sent no document. Neither is `?face=helper`.
"""

import asyncio
import collections
import concurrent.futures
import hmac
import json
import logging
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional, Sequence, Set, Tuple, Union

from tornado import web

from roah_rsbb.box.offers import Offers
from roah_rsbb.client.places import new_token
from roah_rsbb.core.box import Box
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import NOTHING_ALLOWED, Publicity
from roah_rsbb.document.calls import (
    HELPER,
    MAX_MESSAGE_BYTES,
    Answered,
    Call,
    Caller,
    InThread,
    Later,
    Waiting,
    carried_out,
    waited,
)
from roah_rsbb.document.document import DocumentReader, Written
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.web.limits import Places
from roah_rsbb.web.serving import BoundedServer, BoundedSocket, bind, frame

PATH = "/door"
STOP = "stop"  # the call, and the face of the connections for it
REFEREE = "referee"  # the face with reserved places
MAX_CLIENTS, MAX_REFEREES = 80, 20  # together 100; as many more connections for STOP
_PING_S = 20.0
# Of a client that does not read them.
MAX_ANSWERS = 100
# Different errors of calls that are logged.
MAX_LOGGED = 100
# Calls that wait for the disks at the same time.
MAX_THREADS = 64

_log = logging.getLogger(__name__)
_Asker = Union["_Client", "_Own"]
# Seconds. Shortest time between what clients are sent: of events, because many robots change something in each; and of
# calls, whose effect a referee waits for.
GAP_S, CALLS_GAP_S = 0.05, 0.005
# Nor does making and sending it take more than a fourth of the time: STOP may come meanwhile.
REST = 3.0
SIGN_S = 0.5


class _Request:
    """A request of a client. `error`: why it is malformed; empty: it is not."""

    def __init__(self, client: "_Asker", message: Union[str, bytes], is_known: Callable[[str], bool]) -> None:
        try:
            found = json.loads(message)
        except (ValueError, RecursionError):
            found = None
        self.client = client
        self.arguments: Dict[str, Any] = found if isinstance(found, dict) else {}
        self.is_for_whole = self.arguments.get("whole") is True
        self.id, self.name = self.arguments.pop("id", None), self.arguments.pop("call", None)
        # It offers calls, or answers one that it offers. In a call, these are arguments.
        self.is_of_offer = self.id is None and self.name is None and ("offer" in self.arguments
                                                                      or "asked" in self.arguments)
        self.error = ""
        if self.is_of_offer:
            return
        if type(self.id) not in (int, str):
            self.id, self.error = None, 'a JSON object such as {"id": 7, "call": "act"} is expected'
        elif not isinstance(self.name, str) or not is_known(self.name):
            self.error = f"there is no call {self.name!r:.40}: the box is of another version"


class Door:
    """Lets clients in. Call everything in the loop's thread."""

    def __init__(self, loop: asyncio.AbstractEventLoop, token: str, calls: Mapping[str, Call], now: Callable[[], Now],
                 written: Written, check: Callable[[], None] = lambda: None) -> None:
        """`calls`: what clients may call, by name. `check` is called before anything leaves: see `Fence.check`."""
        self.now, self.written, self.check = now, written, check
        self.loop = loop
        self.token = token
        """Whoever has it is let in."""
        self._calls = dict(calls)
        self._offers = Offers(loop, lambda name: name in self._calls,
                              lambda client, message: client.send(self.now(), _dumped(message)))
        self._clients: Dict[str, Places[_Client]] = {
            face: Places(lambda client: client.close(1013, "too many clients"), most)
            for face, most in (("", MAX_CLIENTS), (REFEREE, MAX_REFEREES), (STOP, MAX_CLIENTS + MAX_REFEREES))}
        self._queue: Deque[Any] = collections.deque()  # requests, each with what lets its connection be read again
        self._turn: Optional[asyncio.Handle] = None  # in which the next one is carried out
        self._threads = concurrent.futures.ThreadPoolExecutor(MAX_THREADS, "answers")
        self._waiting = 0  # calls in threads
        self._logged: Set[str] = set()
        self.server = BoundedServer(web.Application(
            [(PATH, _Client, {"door": self})], websocket_max_message_size=MAX_MESSAGE_BYTES,
            websocket_ping_interval=_PING_S, log_function=lambda handler: None))

    def open(self, host: str, port: int = 0) -> int:
        """Open it (port 0: any free one); returns the port. Raises `ServeError`, whose text names the remedy."""
        listening = bind(host, port, "the door of the box", "door")
        self.server.add_sockets(listening)
        bound: int = listening[0].getsockname()[1]
        return bound

    def add_calls(self, calls: Mapping[str, Call]) -> None:
        """Let clients make further calls, which change nothing of the box."""
        self._calls.update(calls)

    def close(self) -> None:
        """End all connections."""
        self.server.stop()
        for client in self._all():
            client.end()
        if self._turn is not None:
            self._turn.cancel()
        self._threads.shutdown(wait=False)

    @property
    def is_followed(self) -> bool:
        """Whether there is a client."""
        return any(len(places) for places in self._clients.values())

    def update(self) -> None:
        """Make `written` current: an answer names its number."""

    def publish(self) -> object:
        """Send what has changed to all clients that have taken the message before. Call it after each event."""
        now = self.now()
        for client in self._all():
            client.send(now)  # one moment, so that all are sent the same text

    def sign(self) -> None:
        """Send the clocks to those that were sent nothing since the last time. Call it twice a second."""
        now = self.now()
        for client in self._all():
            client.sign(now)

    def is_allowed(self, given: str) -> bool:
        """Whether a header Authorization has the token."""
        return hmac.compare_digest(given.encode(), f"Bearer {self.token}".encode())

    def add(self, client: "_Client", face: str, address: str) -> None:
        """Give a client a place. Referees also take those of others."""
        is_full = face == REFEREE and len(self._clients[REFEREE]) >= MAX_REFEREES
        self._clients[face if face in self._clients and not is_full else ""].add(client, address)

    def remove(self, client: "_Client") -> None:
        """Free the place of a client, and withdraw what it offered; has no effect if it has none."""
        for places in self._clients.values():
            places.remove(client)
        self._offers.gone(client)

    def take(self, client: "_Asker", message: Union[str, bytes]) -> "asyncio.Future[None]":
        """Take a message of a client. Its next one is read when the result is done: not in this turn of the loop."""
        request = _Request(client, message, lambda name: name in self._calls or self._offers.knows(name))
        read_on: asyncio.Future[None] = self.loop.create_future()
        if request.is_for_whole and isinstance(client, _Client):
            client.send_whole()
        elif request.error:
            self._answer(request, json.dumps({"error": request.error}))
        elif request.name != STOP:
            self._queue.append((request, read_on))
            self._wake()
            return read_on
        else:
            self._carry_out(request)
        self.loop.call_soon(_read_on, read_on)
        return read_on

    def ask(self, name: str, arguments: Mapping[str, Any], caller: Caller) -> "asyncio.Future[Dict[str, Any]]":
        """Carry out a call of this process as one of a client; returns its answer, as a client is sent it."""
        own = _Own(caller, self.loop.create_future())
        self.take(own, json.dumps({**arguments, "id": 0, "call": name}))
        return own.answer

    def announce(self, name: str, arguments: Mapping[str, Any], caller: Caller) -> None:
        """Pass a call to the client that offers it, in this step of the loop. Nobody hears of the answer."""
        self._offers.pass_on(name, arguments, caller, lambda answered: None)

    def _wake(self) -> None:
        if self._turn is None and self._queue:
            self._turn = self.loop.call_soon(self._carry_out_next)

    def _carry_out_next(self) -> None:
        self._turn = None
        request, read_on = self._queue.popleft()
        self._wake()
        if isinstance(request.client, _Own) or request.client in self._all():  # otherwise, nobody waits for it
            waits = self._carry_out(request)
            if waits is not None and self._waiting >= MAX_THREADS:
                waits.add_done_callback(lambda done: _read_on(read_on))
                return
        _read_on(read_on)

    def _carry_out(self, request: _Request) -> "Optional[asyncio.Future[Any]]":
        """Carry a call out, and answer it; returns the wait for the disks before the answer, if there is one."""
        if request.is_of_offer:
            self._take_of_offer(request.client, request.arguments)
            return None
        if request.name not in self._calls:
            self._offers.pass_on(request.name, request.arguments, request.client.caller,
                                 lambda answered: self._answer(request, _dumped(answered)))
            return None
        found = self._guarded(request, lambda: carried_out(
            self._calls[request.name], request.arguments, request.client.caller))
        if isinstance(found, str):
            self._answer(request, found)
            return None
        self._waiting += 1
        waits = self.loop.run_in_executor(self._threads, self._guarded, request, lambda: waited(found))
        waits.add_done_callback(lambda done: self._waited(request, done))
        return waits

    def _take_of_offer(self, client: "_Client", message: Mapping[str, Any]) -> None:
        if "offer" in message:
            self._offers.offer(client, message["offer"], message.get("node"))
        else:
            self._offers.answered(client, message["asked"], message)

    def _waited(self, request: _Request, done: "asyncio.Future[Any]") -> None:
        self._waiting -= 1
        if not done.cancelled():
            self._answer(request, done.result())

    def _guarded(self, request: _Request, make: Callable[[], Union[Later, Answered]]) -> Union[Later, str]:
        """Return an answer as JSON, whatever goes wrong in a call."""
        try:
            found = make()
            return found if isinstance(found, (InThread, Waiting)) else json.dumps(found)
        except Exception as error:
            text = self.report_bug(f"{request.name} ({type(error).__name__}: {error})", error)
            return json.dumps({"error": text})

    def report_bug(self, what: str, error: Exception) -> str:
        """Log an internal error, once; returns the text."""
        text = f"internal error, please report it: {what}"
        if text not in self._logged and len(self._logged) < MAX_LOGGED:
            self._logged.add(text)
            _log.error("%s", text, exc_info=error)
        return text

    def _answer(self, request: _Request, found: str) -> None:
        self.update()
        request.client.send(self.now(), f'{{"id":{json.dumps(request.id)},"number":{self.written.number},{found[1:]}')

    def _all(self) -> List["_Client"]:
        return [client for places in self._clients.values() for client in places]


def _dumped(message: Mapping[str, Any]) -> str:
    """Return what a client sent as JSON again."""
    try:
        return json.dumps(message)
    except RecursionError:
        return '{"error": "this message is nested too deeply"}'


def _read_on(read_on: "asyncio.Future[None]") -> None:
    if not read_on.done():
        read_on.set_result(None)


class _Own:
    """Whoever makes a call in this process."""

    def __init__(self, caller: Caller, answer: "asyncio.Future[Dict[str, Any]]") -> None:
        self.caller, self.answer = caller, answer

    def send(self, now: Now, text: str) -> None:
        """Take the answer."""
        if not self.answer.done():
            self.answer.set_result(json.loads(text))


class _Client(BoundedSocket):
    """The connection of a client."""

    def initialize(self, door: Door) -> None:
        self._door = door
        self._follower: Optional[DocumentReader] = None
        self._answers: Deque[str] = collections.deque()
        self._was_sent = False  # something since the last sign of life
        offered = self.request.headers.get("Sec-WebSocket-Extensions", "")
        names = (one.split(";")[0].strip() for one in offered.split(","))
        self._deflates = "permessage-deflate" in names and "server_max_window_bits" not in offered

    def prepare(self) -> None:
        """Refuse whoever does not have the token, and pages of browsers: these go to the web gateway."""
        headers = self.request.headers
        is_page = "Origin" in headers or "Sec-WebSocket-Origin" in headers
        if is_page or not self._door.is_allowed(headers.get("Authorization", "")):
            self.set_status(403)
            self.finish("The door opens for programs that have the token of this box.\n")
            return
        self.caller = Caller(self.get_query_argument("face", ""), self.request.remote_ip or "")

    def get_compression_options(self) -> Optional[Dict[str, Any]]:
        """What tornado needs to read compressed messages; what is sent is compressed by `frame`."""
        return {"compression_level": 1, "mem_level": 1} if self._deflates else None

    def open(self, *_args: str, **_kwargs: str) -> None:
        """Give the client a place, and send the document."""
        self.begin(self._door.server.keep)
        self._follower = None if self.caller.face in (STOP, HELPER) else DocumentReader()
        self._door.add(self, self.caller.face, self.caller.address)
        now = self._door.now()
        self.send(now, self._door.written.message(now) if self.caller.face == HELPER else "")

    def on_message(self, message: Union[str, bytes]) -> Any:
        """Tornado reads the next message when the result is done."""
        return self._door.take(self, message)

    def on_close(self) -> None:
        """Free the place."""
        self.on_lost()

    def on_lost(self) -> None:
        """Free the place."""
        self._door.remove(self)

    def on_sent(self) -> None:
        """Send what has changed meanwhile."""
        self.send(self._door.now())

    def sign(self, now: Now) -> None:
        """Send a sign of life. End a client that takes nothing."""
        if self.busy_since is None:
            if not self._was_sent:
                self.send(now, self._door.written.message(now))
            self._was_sent = False
        elif self.is_stuck(self._door.loop.time()):
            self.end()

    def send_whole(self) -> None:
        """Send the whole document."""
        if self._follower is not None:
            self._follower.forget()
            self.send(self._door.now())

    def send(self, now: Now, text: str = "") -> None:
        """Send what has changed and then a text, as soon as the message before is sent."""
        if text:
            self._answers.append(text)
        if self.busy_since is None:
            change = self._follower.next(self._door.written, now) if self._follower is not None else None
            texts = [*([change] if change is not None else []), *self._answers]
            self._answers.clear()
            if texts:
                self._door.check()
                self._was_sent = True
                self.write_frames(b"".join(frame(one, self._deflates) for one in texts), self._door.loop.time())
        elif len(self._answers) > MAX_ANSWERS:
            self.end()


class BoxDoor(Door):
    """Keeps the document of a box current, besides. Call everything in the loop's thread."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, box: Box, uuid: str, host: str, now: Callable[[], Now],
        log_files: Callable[[], Mapping[int, str]], unsaved: Callable[[], Sequence[UnsavedParts]],
        calls: Mapping[str, Call], check: Callable[[], None], publicity: Publicity = NOTHING_ALLOWED,
    ) -> None:
        """`host`: broadcast address in use; `log_files`, `unsaved`: see `Documents.look`; `calls`, `check`: see `Door`;
        `publicity`: what the public may see."""
        super().__init__(loop, new_token(), calls, now, Written(Document), check)
        self._log_files, self._unsaved = log_files, unsaved
        self._documents = Documents(box, uuid, host, publicity)
        self._box = box
        self._seen: Optional[Tuple[int, int]] = None  # what the document was made of
        self._soon: Optional[asyncio.TimerHandle] = None
        self._sent_mono = self._rest_until_mono = float("-inf")
        self.document = self._documents.last
        self.is_old = False
        """Whether the document may no longer be true, because of an error of this program."""
        self.on_news: Callable[[], object] = lambda: None
        """Called when the document, or whether it is old, has changed."""
        self._said: Tuple[int, bool] = 0, False  # of `on_news`: number, is old

    def open(self, host: str, port: int = 0) -> int:
        """See `Door`."""
        bound = super().open(host, port)
        self._sign()
        return bound

    def changed(self) -> None:
        """Note that an event changed something: clients are sent it soon."""
        self._publish_within(GAP_S)

    def called(self) -> None:
        """Note that a referee has made a call, whose effect others wait for."""
        self._publish_within(CALLS_GAP_S)

    def _publish_within(self, gap_s: float) -> None:
        due = max(self.loop.time(), self._sent_mono + gap_s, self._rest_until_mono)
        if self._soon is None or due < self._soon.when():
            if self._soon is not None:
                self._soon.cancel()
            self._soon = self.loop.call_at(due, self.publish)

    def publish(self) -> Document:
        """Send clients what has changed; returns the document."""
        if self._soon is not None:
            self._soon.cancel()
        self._soon, self._sent_mono = None, self.loop.time()
        self.update()
        super().publish()
        now_mono = self.loop.time()
        self._rest_until_mono = now_mono + REST * (now_mono - self._sent_mono)
        if (self.written.number, self.is_old) != self._said:
            self._said = self.written.number, self.is_old
            self.on_news()
        return self.document

    def update(self) -> None:
        """See `Door`. What only time changes is looked at once a second."""
        now = self.now()  # of the box, which in a replay is that of the run
        seen = self._box.happenings, int(now.mono)
        if seen != self._seen:
            self._seen = seen
            self._look(now)

    def _look(self, now: Now) -> None:
        """Make the document again. If that fails, which is an error of this program, clients see that it is old."""
        try:
            self.document = self._documents.look(now, self._log_files(), self._unsaved())
            self.written.update(self.document, now)
            self.is_old = False
            fault = self._documents.fault
            if fault is not None:
                self.report_bug(f"the public sees nothing new ({fault!r})", fault)
        except Exception as error:
            self.is_old = True
            self.report_bug(str(error), error)

    def _sign(self) -> None:
        self.loop.call_later(SIGN_S, self._sign)
        self.publish()
        if not self.is_old:
            self.sign()
