"""The box of this process, as a face in another thread sees a box over the door."""

import asyncio
import concurrent.futures
import time
from typing import Any, Callable, Optional

from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.client.client import TIMEOUT_S, UNANSWERED, Answer, Done, answer_of
from roah_rsbb.document.calls import Caller
from roah_rsbb.model.actions import STOP
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document


class InProcessClient:
    """What `Client` is over the door, without a connection: the document is that of the box, and nothing is written or
    read. Any thread may use it."""

    why = ""
    """Why there is no connection: there always is one."""

    def __init__(self, door: BoxDoor, box_loop: asyncio.AbstractEventLoop, loop: asyncio.AbstractEventLoop,
                 on_change: Callable[[], object], face: str) -> None:
        """`box_loop`: the loop of the box. `on_change` is called in `loop` when the document has changed, or whether it
        is old. `face`: see `Client`."""
        self._door, self._box_loop, self._loop = door, box_loop, loop
        self._on_change, self._caller = on_change, Caller(face, "this process")

    def start(self) -> None:
        """Begin to follow the document."""
        self._door.on_news = lambda: self._loop.call_soon_threadsafe(self._on_change)

    def close(self) -> None:
        """Follow it no more."""
        self._door.on_news = lambda: None

    @property
    def document(self) -> Optional[Document]:
        """The document, which is never changed but replaced."""
        return self._door.document

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true."""
        return self._door.is_old

    @staticmethod
    def now() -> Now:
        """Return the box's clocks, which are those of this process."""
        return Now(time.monotonic(), time.time())

    def call(self, name: str, done: Optional[Done] = None, **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Make a call. `done` is called in the box's loop with the answer, for which it waits `TIMEOUT_S`."""
        future: concurrent.futures.Future[Answer] = concurrent.futures.Future()
        future.set_running_or_notify_cancel()
        if done is not None:
            future.add_done_callback(lambda ended: done(ended.result()))
        self._box_loop.call_soon_threadsafe(self._ask, name, arguments, future)
        return future

    def stop(self, zone: str, run: str, done: Optional[Done] = None,
             **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Stop a run, before all calls that wait for their turn; see `Client.stop`."""
        return self.call(STOP, done, zone=zone, run=run, **arguments)

    def _ask(self, name: str, arguments: Any, future: "concurrent.futures.Future[Answer]") -> None:
        def end(answer: Answer) -> None:
            late.cancel()
            if not future.done():
                future.set_result(answer)

        late = self._box_loop.call_later(TIMEOUT_S, end, UNANSWERED)
        self._door.ask(name, arguments, self._caller).add_done_callback(
            lambda asked: end(UNANSWERED if asked.cancelled() else answer_of(asked.result())))
