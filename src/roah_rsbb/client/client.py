"""A client of the door of a box (`box/door.py`): keeps its document current, and makes calls.

It connects again for ever, and asks before each attempt where the door is, because the box may have moved to its
standby. STOP has a connection of its own, so that a large document on its way delays none. A client may offer calls of
its own to all others.
"""

import asyncio
import concurrent.futures
import contextlib
import json
import logging
import threading
import time
import urllib.parse
from typing import Any, Awaitable, Callable, Dict, Generic, Mapping, NamedTuple, Optional, Set, Tuple, Type, TypeVar

from tornado import httpclient, websocket

from roah_rsbb.client.places import DoorPlace, NotFound
from roah_rsbb.document.calls import MAX_MESSAGE_BYTES as MAX_SENT_BYTES
from roah_rsbb.document.calls import Call, Caller, InThread, Waiting, carried_out, waited
from roah_rsbb.document.document import Followed, Gap
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Reason, decoded, reason_of

# How much slower than ours the box's clock may run: 200 ppm is a bad quartz.
DRIFT = 2e-4


class BoxClock:
    """Estimate of the box's clock from its messages.

    A message carries the clock at the moment when it was sent. The message with the least delay gives the best
    estimate. The estimate is never behind by more than that delay, however late other messages arrive.
    """

    def __init__(self) -> None:
        self._offset: Optional[float] = None  # box's clock minus our monotonic clock
        self._last_clock = 0.0
        self._last_mono = 0.0

    def sample(self, mono: float, clock: float) -> None:
        """A message sent at `clock` (box, UTC seconds) arrived at `mono` (monotonic seconds)."""
        offset = clock - mono
        if self._offset is None or clock < self._last_clock:
            self._offset = offset
        else:
            self._offset = max(offset, self._offset - DRIFT * (mono - self._last_mono))
        self._last_clock, self._last_mono = clock, mono

    def now(self, mono: float) -> float:
        """Return the box's clock at `mono` in UTC seconds; 0.0 before the first sample."""
        return 0.0 if self._offset is None else mono + self._offset


D = TypeVar("D")
Done = Callable[["Answer"], object]

TIMEOUT_S = 5.0
# Signs of life come twice a second: without one for so long, what is shown is old, and later the connection is lost.
OLD_S, SILENT_S = 1.2, 5.0
# The first message is the whole document, which takes long on a slow link.
WHOLE_S = 30.0
CONNECT_S = 5.0
# Between attempts to connect. After a connection that lived for so long, the first is at once.
FIRST_S, LAST_S, LIVED_S = 0.2, 2.0, 1.0
# STOP takes the next way if one does not open, or answer, within so long.
STOP_S = 1.0
MAX_MESSAGE_BYTES = 64 * 1024 * 1024

FORBIDDEN = 403
_MAIN, _STOP = "main", "stop"  # the two connections; the second is also its face

NOT_OFFERED = "the box has not answered yet"

_log = logging.getLogger(__name__)


class Answer(NamedTuple):
    """The answer to a call."""

    number: int = 0  # of the document that contains what the call did, see `Client.is_confirmed`
    answer: Any = None
    reasons: Tuple[Reason, ...] = ()  # why it was refused; empty: it was not
    is_answered: bool = True  # otherwise, nobody knows whether it was carried out
    is_known: bool = True  # otherwise, it was done and counts, but is not on the disks: `reasons` say why


UNANSWERED = Answer(is_answered=False)


class Offer(NamedTuple):
    """Calls that a client offers. They are carried out in the client's loop, as those of the door in the box's."""

    calls: Mapping[str, Call]
    node: str = ""  # the name of this program, for another one that wants to offer the same


def answer_of(message: Dict[str, Any]) -> Answer:
    """Return the answer in a message of the door."""
    reasons = decoded(message.get("refused", ())) or ([reason_of(message["error"])] if "error" in message else [])
    return Answer(message["number"], message.get("answer"), tuple(reasons), True, message.get("known", True))


class _Heard(NamedTuple):
    """The clocks in a message, in seconds."""

    here_mono: float  # when it arrived, by the clock of this computer
    mono: float
    utc: float
    rate: float


class _Link:
    """A connection to the door, and the calls that wait for their answer."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self._waiting: Dict[int, asyncio.Future[Answer]] = {}
        self._last_id = 0

    async def ask(self, request: str) -> Answer:
        """Send a request, an object in JSON without its id; returns its answer."""
        self._last_id += 1
        own_id, answer = self._last_id, asyncio.get_event_loop().create_future()
        self._waiting[own_id] = answer
        try:
            self.send(f'{{"id":{own_id},{request[1:]}')
            found: Answer = await answer
            return found
        finally:
            del self._waiting[own_id]

    def send(self, text: str) -> None:
        """Send a message."""
        with contextlib.suppress(websocket.WebSocketClosedError):
            sent = asyncio.ensure_future(self.socket.write_message(text))
            sent.add_done_callback(lambda ended: ended.cancelled() or ended.exception())  # `read_message` reports it

    def on_answer(self, message: Dict[str, Any]) -> None:
        """Take the answer to a call, unless nobody waits for it any more."""
        waiting = self._waiting.get(message["id"])
        if waiting is not None and not waiting.done():
            waiting.set_result(answer_of(message))

    def close(self) -> None:
        """End it; nothing more is answered."""
        self.socket.close()
        for waiting in self._waiting.values():
            if not waiting.done():
                waiting.set_result(UNANSWERED)


class Client(Generic[D]):
    """A box from afar. All but `wait` may be used in any thread, and `document` is never changed but replaced."""

    def __init__(self, root: Type[D], find: Callable[[], DoorPlace], on_change: Callable[[], object] = lambda: None,
                 loop: Optional[asyncio.AbstractEventLoop] = None, face: str = "",
                 offer: Optional[Offer] = None) -> None:
        """`root`: type of the document. `find` says where the door is or raises `NotFound`; it is called in a thread.
        `on_change` is called in the loop's thread when the document, its number or `why` has changed. `loop`: in which
        to run; None: in a thread of its own. `face`: what this is, such as referee. `offer`: calls for all
        other clients."""
        self.why = "there is no connection to the box yet"  # why there is none, with the remedy; empty: there is one
        self.not_offered = NOT_OFFERED  # why the calls are not offered; empty: they are
        self.news = 0  # rises whenever something has changed, or failed, and with `wake`; see `wait_news`
        self._find, self._on_change, self._face, self._offer = find, on_change, face, offer
        self._followed: Followed[D] = Followed(root)
        self._changed = threading.Condition()
        self._clock = BoxClock()
        self._heard: Optional[_Heard] = None
        self._place: Optional[DoorPlace] = None
        self._links: Dict[str, _Link] = {}  # by the way: _MAIN, _STOP
        self._asked_whole = False
        self._search: Optional[asyncio.Future[DoorPlace]] = None  # the last one for STOP
        # Loops look at it: `wait_for` loses a cancellation that comes together with a result.
        self._is_closed = False
        self._tasks: Set[asyncio.Task[Any]] = set()
        self._loop = loop if loop is not None else asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run_loop, name="client", daemon=True) if loop is None else None

    def start(self) -> None:
        """Begin to connect."""
        self._loop.call_soon_threadsafe(lambda: self._spawn(self._run()))
        if self._thread is not None:
            self._thread.start()

    def close(self) -> None:
        """End the connection; calls that wait get no answer. In the thread of the loop, if that was given."""
        self._is_closed = True
        if self._thread is None:
            self._end()
        elif self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()

    @property
    def document(self) -> Optional[D]:
        """The document; None: none has come yet."""
        return self._followed.document

    @property
    def number(self) -> int:
        """The number of the document; 0: none has come yet. Read it first: the document may then be newer."""
        return self._followed.number

    @property
    def heard_mono(self) -> float:
        """When the box was last heard, in seconds of this computer's monotonic clock; -inf: never."""
        heard = self._heard
        return float("-inf") if heard is None else heard.here_mono

    @property
    def silence_s(self) -> float:
        """How long ago, in seconds, the box sent the last message that has arrived: on a slow link, before it was
        heard; inf: never."""
        heard = self._heard
        if heard is None:
            return float("inf")
        late_s = self._clock.now(heard.here_mono) - heard.mono if heard.rate == 1.0 else 0.0
        return time.monotonic() - heard.here_mono + late_s

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true."""
        return self.silence_s > OLD_S

    def now(self) -> Now:
        """Return an estimate of the box's clocks; zeros: it was never heard."""
        heard, here = self._heard, time.monotonic()
        if heard is None:
            return Now(0.0, 0.0)
        mono = self._clock.now(here) if heard.rate == 1.0 else heard.mono + (here - heard.here_mono) * heard.rate
        return Now(mono, mono + heard.utc - heard.mono)

    def is_confirmed(self, number: int) -> bool:
        """Whether the document contains what was done with this number (of an `Answer`)."""
        return self._followed.number >= number

    def wait(self, condition: Callable[[D], object], timeout_s: float) -> D:
        """Wait, in another thread than that of the loop, until a condition holds for the document, and return that.
        Raises TimeoutError."""
        def found() -> Optional[D]:
            document = self.document
            return document if document is not None and condition(document) else None

        with self._changed:
            document = self._changed.wait_for(found, timeout_s)
        if document is None:
            raise TimeoutError(self.why or f"the box did not do that within {timeout_s:g} s")
        return document

    def wait_news(self, since: int, timeout_s: float) -> int:
        """Wait, in another thread than that of the loop, until `news` is no longer `since`, but at most that long;
        returns `news`."""
        with self._changed:
            self._changed.wait_for(lambda: self.news != since, max(0.0, timeout_s))
            return self.news

    def wake(self) -> None:
        """Wake whoever waits for news."""
        with self._changed:
            self.news += 1
            self._changed.notify_all()

    def call(self, name: str, done: Optional[Done] = None, timeout_s: float = TIMEOUT_S, again: bool = False,
             **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Make a call. `done` is called in the loop's thread with the answer, for which it waits that long. `again`:
        try until the time is over; only for what the box does once, such as a mark with an id. Raises ValueError for an
        argument `id`: that of a mark is one of the values `given`."""
        if "id" in arguments:
            raise ValueError("id is the door's own: the id of a mark goes into given")
        request = json.dumps({**arguments, "call": name})
        ask = self._ask_again if again else self._ask
        return self._begin(lambda: ask(_MAIN, request), done, timeout_s)

    def stop(self, zone: str, run: str, done: Optional[Done] = None, timeout_s: float = TIMEOUT_S,
             **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Stop a run, on the first way to the box that answers. Without one, try until the time is over."""
        request = json.dumps({**arguments, "zone": zone, "run": run, "call": _STOP})
        return self._begin(lambda: self._ask_stop(request), done, timeout_s)

    def _begin(self, ask: Callable[[], Awaitable[Answer]], done: Optional[Done],
               timeout_s: float) -> "concurrent.futures.Future[Answer]":
        future: concurrent.futures.Future[Answer] = concurrent.futures.Future()
        future.set_running_or_notify_cancel()
        if done is not None:
            future.add_done_callback(lambda ended: done(ended.result()))

        def end(task: "asyncio.Task[Answer]") -> None:
            error = None if task.cancelled() else task.exception()
            if error is not None and not isinstance(error, asyncio.TimeoutError):
                _log.error("internal error, please report it", exc_info=error)
            future.set_result(UNANSWERED if task.cancelled() or error is not None else task.result())

        try:
            self._loop.call_soon_threadsafe(
                lambda: self._spawn(asyncio.wait_for(ask(), timeout_s)).add_done_callback(end))
        except RuntimeError:  # the loop has ended
            future.set_result(UNANSWERED)
        return future

    async def _ask(self, way: str, request: str) -> Answer:
        return await self._links[way].ask(request) if way in self._links else UNANSWERED

    async def _ask_again(self, way: str, request: str) -> Answer:
        while not self._is_closed:
            answer = await self._ask(way, request)
            if answer.is_answered:
                return answer
            await asyncio.sleep(FIRST_S)
        return UNANSWERED

    async def _ask_stop(self, request: str) -> Answer:
        while not self._is_closed:
            if _STOP not in self._links and self._place is not None:
                try:
                    await self._open_stop(self._place)
                except Exception:
                    with contextlib.suppress(Exception):  # then the other way is taken
                        await self._open_stop(await asyncio.wait_for(asyncio.shield(self._elsewhere()), STOP_S))
            for way in (_STOP, _MAIN):
                with contextlib.suppress(asyncio.TimeoutError):
                    answer = await asyncio.wait_for(self._ask(way, request), STOP_S)
                    if answer.is_answered:
                        return answer
            await asyncio.sleep(FIRST_S)
        return UNANSWERED

    async def _run(self) -> None:
        """Connect again and again."""
        delay_s = 0.0
        while not self._is_closed:
            await asyncio.sleep(delay_s)
            began_mono = time.monotonic()
            self.why = await self._attempt()
            self._publish()
            delay_s = min(max(FIRST_S, 2 * delay_s), LAST_S) if self.heard_mono < began_mono + LIVED_S else 0.0

    async def _attempt(self) -> str:
        """Connect, and follow the document; returns why it ended, with the remedy."""
        box = "the box"
        try:
            place = self._place = await self._loop.run_in_executor(None, self._find)
            box = f"the box at {place.url}"
            link = self._links[_MAIN] = await self._open(place, self._face, CONNECT_S)
            return await self._read(_MAIN, link, place)
        except NotFound as error:
            return str(error)
        except Exception as error:
            if getattr(error, "code", 0) == FORBIDDEN:
                return f"{box} refuses this program, whose token is another one: copy the file of its door again"
            return f"no connection to {box} ({str(error) or type(error).__name__}): check that it runs, and the network"
        finally:
            for link in self._links.values():
                link.close()
            self._links, self.not_offered = {}, NOT_OFFERED

    async def _open(self, place: DoorPlace, face: str, within_s: float) -> _Link:
        request = httpclient.HTTPRequest(
            f"{place.url}?{urllib.parse.urlencode({'face': face})}", headers={"Authorization": f"Bearer {place.token}"},
            connect_timeout=within_s, request_timeout=within_s)
        return _Link(await websocket.websocket_connect(
            request, compression_options={}, max_message_size=MAX_MESSAGE_BYTES))

    def _elsewhere(self) -> "asyncio.Future[DoorPlace]":
        """Find the door for STOP while the connection to where it was last found hangs; one search at a time."""
        if self._search is None or self._search.done():
            self._search = self._loop.run_in_executor(None, self._find)
            self._search.add_done_callback(lambda ended: ended.cancelled() or ended.exception())
        return self._search

    async def _open_stop(self, place: DoorPlace) -> None:
        link = await self._open(place, _STOP, STOP_S)
        if _STOP in self._links:  # another one was quicker, and a call may be on its way there
            link.close()
        else:
            self._links[_STOP] = link
            self._spawn(self._read(_STOP, link, place))

    async def _prepare_stop(self, place: DoorPlace) -> None:
        with contextlib.suppress(Exception):  # STOP itself tries again
            await self._open_stop(place)

    async def _read(self, way: str, link: _Link, place: DoorPlace) -> str:
        """Take the messages of a connection until its end; returns why it ended, with the remedy."""
        try:
            is_first = way == _MAIN
            while not self._is_closed:
                text = await asyncio.wait_for(link.socket.read_message(), WHOLE_S if is_first else SILENT_S)
                if text is None:
                    reason = link.socket.close_reason or "without a reason"
                    return f"the box at {place.url} has closed the connection ({reason}): check that it runs"
                message = json.loads(text)
                if "id" in message:
                    link.on_answer(message)
                elif "asked" in message:
                    self._spawn(self._answer_asked(link, message))
                elif "offer" in message:
                    self.not_offered = "; ".join(message.get("refused", ()))
                    self._publish()
                elif way == _MAIN:
                    self._take(link, message, is_first)
                    if is_first:
                        self._spawn(self._prepare_stop(place))
                        if self._offer is not None:
                            link.send(json.dumps({"offer": list(self._offer.calls), "node": self._offer.node}))
                    is_first = False
            return "the connection was ended here"
        except asyncio.TimeoutError:
            return f"the box at {place.url} is silent: check that it runs, and the network"
        except (ValueError, KeyError, TypeError) as error:
            return f"the box at {place.url} is of another version than this program ({error}): install the same"
        finally:
            link.close()
            if self._links.get(way) is link:
                del self._links[way]

    async def _answer_asked(self, link: _Link, message: Dict[str, Any]) -> None:
        """Carry out one of the calls that this client offers, and answer it."""
        name, number = message["call"], message["asked"]
        try:
            assert self._offer is not None, "it offers this call"
            found = carried_out(self._offer.calls[name], message["arguments"],
                                Caller(message["face"], message["address"]))
            if isinstance(found, (InThread, Waiting)):
                found = await self._loop.run_in_executor(None, waited, found)
            text = json.dumps({"asked": number, **found})
            if len(text) > MAX_SENT_BYTES:
                text = json.dumps({"asked": number, "error": f"the answer to {name} is too long for the box"})
        except Exception as error:
            _log.exception("internal error, please report it: %s", name)
            text = json.dumps({"asked": number, "error": f"internal error, please report it: {name} ({error})"})
        link.send(text)

    def _take(self, link: _Link, message: Dict[str, Any], is_first: bool) -> None:
        """Take a message with the clocks, and perhaps what has changed."""
        heard = _Heard(time.monotonic(), message["mono"], message["utc"], message["rate"])
        if is_first or self._heard is None or self._heard.rate != heard.rate:
            self._clock = BoxClock()  # it may be another computer, or a replay that went slower
        try:
            self._followed.take(message)
            is_gap = False
        except Gap:
            is_gap = True
        self._asked_whole = self._asked_whole and not is_first
        self._clock.sample(heard.here_mono, heard.mono)
        self._heard = heard  # not of a box whose document cannot be read
        if is_gap:
            if not self._asked_whole:
                link.send('{"whole":true}')
            self._asked_whole = True
        elif "number" in message:
            self._asked_whole, self.why = False, ""
            self._publish()

    def _publish(self) -> None:
        self.wake()
        try:
            self._on_change()
        except Exception:  # the connection must not end for it
            _log.exception("internal error, please report it")

    def _spawn(self, work: Awaitable[Any]) -> "asyncio.Task[Any]":
        task = asyncio.ensure_future(work, loop=self._loop)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    def _end(self) -> None:
        for task in self._tasks:
            task.cancel()

    def _run_loop(self) -> None:
        """The thread of a client that has a loop of its own."""
        asyncio.set_event_loop(self._loop)
        self._loop.run_forever()
        tasks = asyncio.all_tasks(self._loop)
        for task in tasks:
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*tasks, return_exceptions=True))
        self._loop.run_until_complete(asyncio.sleep(0))  # what followed from that
        self._loop.close()
