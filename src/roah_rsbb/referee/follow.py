"""Following the box: what happens, as it happens, also when the core falls silent and comes back."""

import time
from typing import List, Optional

from roah_rsbb.referee.changes import Change, changes

# The core publishes every 100 ms: after this long without a message something is wrong.
SILENT_S = 2.0


class Follower:
    """Tells what changed. `link` is a `roah_rsbb.referee.link.Link`, or behaves like one."""

    def __init__(self, link, zone: Optional[str] = None) -> None:
        self._link = link
        self._zone = zone
        self._silent = False
        self.box = link.box

    def step(self, limit_s: float) -> List[Change]:
        """What happened until the next snapshot, or within `limit_s` if none comes."""
        self._link.next(limit_s)
        new = self._link.box
        found: List[Change] = []
        silent = self._link.silence_s > SILENT_S
        if silent != self._silent:
            self._silent = silent
            found.append(Change(time.time(), "core", "", {"what": "silent" if silent else "back"}))
        if new is not self.box:
            found += changes(self.box, new, self._zone)
            self.box = new
        return found
