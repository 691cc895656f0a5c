"""The box of this process, as its faces see a box over the door."""

import asyncio
import concurrent.futures
from typing import Any, Callable, Optional

from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.client.client import UNANSWERED, Answer, Done, answer_of
from roah_rsbb.document.calls import Caller
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document

STOP = "stop"


class InProcessClient:
    """What `Client` is over the door, without a connection. The document is that of the box, and nothing is written or
    read. Call everything in the loop's thread."""

    why = ""
    """Why there is no connection: there always is one."""

    def __init__(self, door: BoxDoor, now: Callable[[], Now], on_change: Callable[[], object], face: str) -> None:
        """`now`: the box's clocks. For the rest see `Client`."""
        self._door, self._on_change, self._caller = door, on_change, Caller(face, "this process")
        self.now = now

    def start(self) -> None:
        """Begin to follow the document."""
        self._door.on_news = self._on_change

    def close(self) -> None:
        """Follow it no more."""
        self._door.on_news = lambda: None

    @property
    def document(self) -> Optional[Document]:
        """The document."""
        return self._door.document

    @property
    def is_old(self) -> bool:
        """Whether the document may no longer be true."""
        return self._door.is_old

    def call(self, name: str, done: Optional[Done] = None, **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Make a call; see `Client.call`."""
        future: concurrent.futures.Future[Answer] = concurrent.futures.Future()
        future.set_running_or_notify_cancel()

        def end(asked: "asyncio.Future[Any]") -> None:
            future.set_result(UNANSWERED if asked.cancelled() else answer_of(asked.result()))
            if done is not None:
                done(future.result())

        self._door.ask(name, arguments, self._caller).add_done_callback(end)
        return future

    def stop(self, zone: str, run: str, done: Optional[Done] = None,
             **arguments: Any) -> "concurrent.futures.Future[Answer]":
        """Stop a run, before anything else is done; see `Client.stop`."""
        return self.call(STOP, done, zone=zone, run=run, **arguments)
