"""Score sheets of runs: requested when they are first shown, and again when they changed."""

import time
from typing import Callable, Dict, NamedTuple, Optional

from roah_rsbb.document.written import read
from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.rqt.model.calls import CallOutcome, Calls
from roah_rsbb.rqt.qt import QTimer, QWidget

# After a failure it is requested again after this long.
AGAIN_MS = 2000
MAX_KEPT = 20


class _Known(NamedTuple):
    asked_mono: float  # when it was requested
    revision: int  # that the core published then
    sheet: RunSheet


class Sheets:
    """The newest score sheets, by the identities of runs."""

    def __init__(self, owner: QWidget, calls: Calls, news: Callable[[], None]) -> None:
        """`news()` is called when one has arrived for `owner`."""
        self._owner = owner
        self._calls = calls
        self._news = news
        self._known: Dict[str, _Known] = {}
        self._asked: Dict[str, int] = {}  # requested revisions
        self._again = QTimer(owner, singleShot=True, interval=AGAIN_MS, timeout=self._ask_again)

    def newest(self, run: Optional[RunLine]) -> Optional[RunSheet]:
        """Return the known sheet of a run at once, and request a newer one if the core published its revision after it
        was requested. None: no run, or nothing is known."""
        if run is None:
            return None
        identity, revision = run.identity, run.revision
        known = self._known.get(identity)
        if (known is None or known.revision != revision) and self._asked.get(identity) != revision:
            self._asked[identity] = revision
            now = time.monotonic()
            self._calls.call(self._owner, "sheet", lambda outcome: self._on_answer(identity, revision, now, outcome),
                             zone=run.zone, run=identity)
        return None if known is None else known.sheet

    def _ask_again(self) -> None:
        self._asked.clear()
        self._news()

    def _on_answer(self, identity: str, revision: int, asked_mono: float, outcome: CallOutcome) -> None:
        known = self._known.get(identity)
        if known is not None and asked_mono < known.asked_mono:
            return  # a later request was answered first: this answer may be older
        if outcome.error:
            self._again.start()
        else:
            self._known.pop(identity, None)
            self._known[identity] = _Known(asked_mono, revision, read(RunSheet, outcome.result))
            while len(self._known) > MAX_KEPT:
                self._known.pop(next(iter(self._known)))
        self._asked = {i: asked for i, asked in self._asked.items() if i in self._known or i == identity}
        self._news()
