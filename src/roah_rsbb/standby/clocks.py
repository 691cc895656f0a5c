"""How far the clock of the standby is ahead of the box's, measured while both are connected.

On another computer, the clocks of runs continue by UTC. Without the Internet, the clocks of two computers can differ by
seconds, which would be added to each run.
"""

import collections
import contextlib
import json
import os
from typing import Deque, Optional

from roah_rsbb import durable

FILE = "clock.json"
# Messages of some seconds. The one that took the shortest time to arrive shows the difference best.
SAMPLES = 20
# Smaller changes are not written.
CHANGE_S = 0.05


class ClockDifference:
    """The difference from the clock of the box, in a file of the standby."""

    def __init__(self, folder: str, boot: str) -> None:
        """`boot`: identifies the start of the box's computer."""
        self._folder, self._boot = folder, boot
        self._samples: Deque[float] = collections.deque(maxlen=SAMPLES)
        self._written: Optional[float] = None

    def hear(self, box_utc: float, own_utc: float) -> None:
        """Take the time at which the box sent a message, and the time at which it arrived. Never raises."""
        self._samples.append(own_utc - box_utc)
        ahead = min(self._samples)
        if self._written is None or abs(ahead - self._written) >= CHANGE_S:
            with contextlib.suppress(OSError):
                durable.write_file(os.path.join(self._folder, FILE),
                                   json.dumps({"boot": self._boot, "ahead_s": ahead}).encode("ascii"))
                self._written = ahead


def ahead_of(folder: str, boot: str) -> float:
    """Return by how many seconds the clock of this computer is ahead of that of another one; 0 if it was not measured.

    `boot`: identifies the start of the other computer.
    """
    try:
        with open(os.path.join(folder, FILE), encoding="ascii") as file:
            found = json.load(file)
        return float(found["ahead_s"]) if boot and found["boot"] == boot else 0.0
    except (OSError, ValueError, KeyError, TypeError):
        return 0.0
