"""Measures how long the check itself was prevented from running, so that a busy machine fails no robot."""

import asyncio
from typing import List, Optional, Tuple

PERIOD_S = 0.05
# Timers are never exact.
USUAL_S = 0.02
# Stalls so close together add up: a robot's reaction may fall into all of them.
TOGETHER_S = 2.0


class Stalls:
    """The delays of a timer."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._found: List[Tuple[float, float]] = []  # end (monotonic), seconds
        self._timer: Optional[asyncio.TimerHandle] = None

    def open(self) -> None:
        """Begin to measure."""
        self._timer = self._loop.call_later(PERIOD_S, self._tick, self._loop.time() + PERIOD_S)

    def close(self) -> None:
        """Stop measuring."""
        if self._timer is not None:
            self._timer.cancel()

    def since(self, mono: float) -> float:
        """How long the check was delayed since the monotonic time `mono`, in total (s)."""
        return sum(seconds for end, seconds in self._found if end > mono)

    def worst(self, mono: float) -> float:
        """The largest sum of delays within `TOGETHER_S`, since the monotonic time `mono` (s)."""
        found = [(end, seconds) for end, seconds in self._found if end > mono]
        worst = together = 0.0
        first = 0
        for end, seconds in found:
            together += seconds
            while found[first][0] <= end - TOGETHER_S:
                together -= found[first][1]
                first += 1
            worst = max(worst, together)
        return worst

    def _tick(self, due: float) -> None:
        now = self._loop.time()
        if now - due > USUAL_S:
            self._found.append((now, now - due))
        self._timer = self._loop.call_at(now + PERIOD_S, self._tick, now + PERIOD_S)
