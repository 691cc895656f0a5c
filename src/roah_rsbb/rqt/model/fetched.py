"""What a panel asks of a run: requested when it is first shown, and again when it changed."""

import time
from typing import Any, Callable, Dict, NamedTuple, Optional, Tuple

from roah_rsbb.rqt.model.calls import CallOutcome, Calls

# After a failure it is requested again after this long.
AGAIN_S = 2.0
MAX_KEPT = 20


class _Known(NamedTuple):
    asked_mono: float  # when it was requested
    revision: int  # that the core published then
    answer: Any


class Fetched:
    """The newest answers of one service, by the identities of runs."""

    def __init__(
        self, owner: object, calls: Calls, service: str, kind: type, news: Callable[[], None]
    ) -> None:
        """`news()` is called when an answer has arrived for `owner`."""
        self._owner = owner
        self._calls = calls
        self._service = service
        self._kind = kind
        self._news = news
        self._known: Dict[str, _Known] = {}
        self._asked: Dict[str, Tuple[int, float]] = {}  # requested revision, and when (monotonic s)
        self.error = ""  # why the last request failed

    def newest(self, identity: str, revision: int, request: tuple) -> Optional[Any]:
        """Return the known answer about a run at once, and request a newer one if the core published this revision
        after it was requested."""
        known = self._known.get(identity)
        if known is None or known.revision != revision:
            self._ask(identity, revision, request)
        return None if known is None else known.answer

    def _ask(self, identity: str, revision: int, request: tuple) -> None:
        now = time.monotonic()
        last, asked = self._asked.get(identity, (None, 0.0))
        if last == revision and now - asked < AGAIN_S:
            return
        self._asked[identity] = (revision, now)
        self._calls.service(
            self._owner, self._service, self._kind, request,
            lambda outcome: self._on_answer(identity, revision, now, outcome),
        )

    def _on_answer(self, identity: str, revision: int, asked_mono: float, outcome: CallOutcome) -> None:
        known = self._known.get(identity)
        if known is not None and asked_mono < known.asked_mono:
            return  # a later request was answered first: this answer may be older
        self.error = outcome.error
        if outcome.result is not None:
            self._known.pop(identity, None)
            self._known[identity] = _Known(asked_mono, revision, outcome.result)
            while len(self._known) > MAX_KEPT:
                self._known.pop(next(iter(self._known)))
        self._asked = {i: asked for i, asked in self._asked.items() if i in self._known or i == identity}
        self._news()
