"""An asyncio loop in simulated time: with a network in memory, programs run in milliseconds."""

import asyncio
import selectors

# A check of all scenarios needs fewer.
MOST_SELECTS = 500_000
MONO0, UTC0 = 1000.0, 1_800_000_000.0


class _NoFiles(selectors.SelectSelector):
    """Waits for no file: the time passes instead."""

    def __init__(self, advance):
        super().__init__()
        self._advance = advance
        self._selects = 0

    def select(self, timeout=None):
        if timeout is None:
            raise AssertionError("nothing is due: the programs wait for something that never comes")
        self._selects += 1
        if self._selects > MOST_SELECTS:
            raise AssertionError("the programs are busy without an end")
        self._advance(max(timeout, 0.0))
        return []


class SimulatedLoop(asyncio.SelectorEventLoop):
    """Its time jumps to whatever is due next."""

    def __init__(self):
        self._mono = MONO0
        super().__init__(_NoFiles(self._pass))

    def _pass(self, seconds):
        self._mono += seconds

    def time(self):
        return self._mono

    def utc(self):
        """The true time."""
        return UTC0 + self._mono - MONO0

    def stall(self, seconds):
        """The machine does something else for a while."""
        self._mono += seconds
