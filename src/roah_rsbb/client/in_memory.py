"""A box in the same process, as its clients see it: for simulations."""

import json
from typing import Any, Callable, Generic, Mapping, Optional, Type, TypeVar

from roah_rsbb.client.client import Answer, answer_of
from roah_rsbb.document.calls import Call, Caller, InThread, Waiting, carried_out, waited
from roah_rsbb.document.document import DocumentReader, Followed, Written
from roah_rsbb.model.clock import Now

D = TypeVar("D")


class InMemory(Generic[D]):
    """What `Client` is over the door, without a connection. All that passes is JSON, as there."""

    def __init__(self, root: Type[D], written: Written, calls: Mapping[str, Call], now: Callable[[], Now]) -> None:
        self.now = now
        self._written, self._calls = written, calls
        self._follower, self._followed = DocumentReader(), Followed(root)

    @property
    def document(self) -> Optional[D]:
        """The present document."""
        text = self._follower.next(self._written, self.now())
        if text is not None:
            self._followed.take(json.loads(text))
        return self._followed.document

    def call(self, name: str, **arguments: Any) -> Answer:
        """Make a call; returns its answer, also of one that waits for the disks."""
        found = carried_out(self._calls[name], json.loads(json.dumps(arguments)), Caller("in memory"))
        answer = waited(found) if isinstance(found, (InThread, Waiting)) else found
        return answer_of(json.loads(json.dumps({"number": self._written.number, **answer})))
