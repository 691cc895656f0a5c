"""The score sheets of runs: fetched from the core when they are looked at, and again when they changed."""

import time
from typing import Callable, Dict, Optional, Tuple

from roah_rsbb.msg import RunSheet, RunSummary
from roah_rsbb.rqt.model.calls import Calls, Outcome
from roah_rsbb.srv import GetRunSheet

# A sheet that could not be had is asked for again after this long.
AGAIN_S = 2.0
MAX_KEPT = 20


class RunSheets:
    """The sheets that a panel shows."""

    def __init__(self, owner: object, calls: Calls, news: Callable[[], None]) -> None:
        """`news()` is called when a sheet has come, for `owner`."""
        self._owner = owner
        self._calls = calls
        self._news = news
        self._sheets: Dict[str, RunSheet] = {}
        self._asked: Dict[str, Tuple[int, float]] = {}  # revision that was asked for, and when (monotonic s)
        self.error = ""  # why the last one could not be had

    def sheet(self, summary: RunSummary) -> Optional[RunSheet]:
        """What is known of a run, at once; a newer one is fetched if there is one."""
        known = self._sheets.get(summary.identity)
        if known is None or known.summary.revision != summary.revision:
            self._ask(summary)
        return known

    def _ask(self, summary: RunSummary) -> None:
        now, identity = time.monotonic(), summary.identity
        revision, asked = self._asked.get(identity, (None, 0.0))
        if revision == summary.revision and now - asked < AGAIN_S:
            return
        self._asked[identity] = (summary.revision, now)
        self._calls.service(
            self._owner, "/core/run_sheet", GetRunSheet, (summary.zone, identity),
            lambda outcome: self._on_sheet(identity, outcome),
        )

    def _on_sheet(self, identity: str, outcome: Outcome) -> None:
        self.error = outcome.error
        if outcome.result is not None:
            self._sheets.pop(identity, None)
            self._sheets[identity] = outcome.result.sheet
            while len(self._sheets) > MAX_KEPT:
                self._sheets.pop(next(iter(self._sheets)))
        self._asked = {i: asked for i, asked in self._asked.items() if i in self._sheets or i == identity}
        self._news()
