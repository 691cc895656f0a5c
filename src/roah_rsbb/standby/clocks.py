"""How far the clocks of the standby are ahead of the box's, measured while both are connected.

On another computer, the clocks of runs continue by its monotonic clock, if it was not started again since it heard the
box: a step of its UTC must not end a run. Otherwise they continue by UTC. Without the Internet, the clocks of two
computers can differ by seconds, which would be added to each run.
"""

import collections
import contextlib
import json
import os
from typing import Deque, NamedTuple, Optional, Tuple

from roah_rsbb.ground import durable
from roah_rsbb.ground.linux import boot_id
from roah_rsbb.model.clock import Now

FILE = "clock.json"
# Messages of some seconds. The one that took the shortest time to arrive shows the difference best.
SAMPLES = 20
# Smaller changes are not written.
CHANGE_S = 0.05


class Ahead(NamedTuple):
    """By how many seconds the clocks of this computer are ahead of those of another one."""

    utc_s: float = 0.0
    mono_s: Optional[float] = None  # None: one of the two computers was started again since, or it was not measured


NOT_MEASURED = Ahead()


class ClockDifference:
    """The difference from the clocks of the box, in a file of the standby."""

    def __init__(self, folder: str, boot: str) -> None:
        """`boot`: identifies the start of the box's computer."""
        self._folder, self._boot = folder, boot
        self._utc: Deque[float] = collections.deque(maxlen=SAMPLES)
        self._mono: Deque[float] = collections.deque(maxlen=SAMPLES)
        self._written: Optional[Tuple[float, float]] = None

    def hear(self, sent: Now, came: Now) -> None:
        """Take the time at which the box sent a message, by its clocks, and the time at which it arrived. Never
        raises."""
        self._utc.append(came.utc - sent.utc)
        self._mono.append(came.mono - sent.mono)
        ahead = min(self._utc), min(self._mono)
        if self._written is None or any(abs(a - b) >= CHANGE_S for a, b in zip(ahead, self._written)):
            found = {"boot": self._boot, "ahead_s": ahead[0], "own_boot": boot_id(), "mono_ahead_s": ahead[1]}
            with contextlib.suppress(OSError):
                durable.write_file(os.path.join(self._folder, FILE), json.dumps(found).encode("ascii"))
                self._written = ahead


def ahead_of(folder: str, boot: str, own_boot: str) -> Ahead:
    """Return how far the clocks of this computer are ahead of those of another one, as far as it was measured.

    `boot` and `own_boot` identify the starts of the other computer and of this one.
    """
    try:
        with open(os.path.join(folder, FILE), encoding="ascii") as file:
            found = json.load(file)
        if not boot or found["boot"] != boot:
            return NOT_MEASURED
        mono_s = found.get("mono_ahead_s") if own_boot and found.get("own_boot") == own_boot else None
        return Ahead(float(found["ahead_s"]), None if mono_s is None else float(mono_s))
    except (OSError, ValueError, KeyError, TypeError):
        return NOT_MEASURED
