"""A copy of the journal whose state is reported, and what is new in it logged."""

import logging
import math
import time
from typing import Callable, NamedTuple

from roah_rsbb.copies.follower import Follower

_log = logging.getLogger(__name__)


class CopyNews(NamedTuple):
    """The state of a copy."""

    place: str
    journal: str  # identity of the journal that it copies
    behind_s: float  # since it was complete; inf: it never was
    missing_bytes: int
    trouble: str  # why it is not complete, with the remedy; empty: nothing prevents it
    notice: str  # what referees must know besides


class ReportedCopy:
    """A copy, and what was logged about it."""

    def __init__(self, place: str, follower: Follower, notice: Callable[[], str] = lambda: "") -> None:
        """Start to copy. `notice` returns what referees must know besides."""
        self.place = place
        self.follower = follower
        self._notice = notice
        self._trouble = self._aside = ""
        follower.start()

    def news(self) -> CopyNews:
        """Return the present state, and log what is new in it."""
        progress = self.follower.progress
        if progress.trouble != self._trouble:
            if progress.trouble:
                _log.warning("%s: %s", self.place, progress.trouble)
            self._trouble = progress.trouble
        if progress.aside and progress.aside != self._aside:
            _log.warning("%s: the earlier copy is not of this journal, or is damaged. It is kept as %s",
                         self.place, progress.aside)
            self._aside = progress.aside
        behind_s = math.inf if progress.complete_mono is None else time.monotonic() - progress.complete_mono
        return CopyNews(self.place, progress.journal, behind_s, progress.missing_bytes, progress.trouble,
                        self._notice())
