"""The definition of a fuzz target, and the limits for the cost of an input."""

import gc
import pathlib
import time
import tracemalloc
from typing import Callable, Iterator, List, NamedTuple, Tuple

CORPUS = pathlib.Path(__file__).resolve().parents[1] / "corpus"

# What one input may cost, processor time and memory.
LIMIT_S = 0.010
LIMIT_BYTES = 10_000_000
# The least of so many measurements counts: others use this computer, too.
_TRIALS = 8

Step = Callable[[], object]


class TooCostly(AssertionError):
    """An input that costs more than an input may."""


class Target(NamedTuple):
    """Code that reads what others wrote.

    `steps` makes of an input the calls that take it, one after the other: each of them is measured, and what is
    between them (to set up, to look at what came of it) is not. They raise nothing, or the target has found a fault.
    The same input makes the same steps, as often as it is asked for.
    """

    name: str
    steps: Callable[[bytes], Iterator[Step]]
    seeds: Callable[[], List[bytes]]  # inputs to begin with
    tokens: Tuple[bytes, ...] = ()  # what inputs are made of
    is_timed: bool = True  # not so for files that are read once, when a program starts

    def play(self, data: bytes) -> None:
        """Take an input."""
        for step in self.steps(data):
            step()

    def check(self, data: bytes, limit_s: float = LIMIT_S) -> Tuple[float, int]:
        """Take an input and measure its costliest step: seconds and bytes. Raises `TooCostly`."""
        seconds = self._seconds(data) if self.is_timed else []
        for _ in range(_TRIALS):
            if max(seconds, default=0.0) <= limit_s:
                break
            seconds = [min(pair) for pair in zip(seconds, self._seconds(data))]
        size = self._bytes(data)
        dearest = max(seconds, default=0.0)
        if dearest > limit_s:
            raise TooCostly(f"{self.name}: step {seconds.index(dearest)} takes {dearest * 1000:.1f} ms")
        if size > LIMIT_BYTES:
            raise TooCostly(f"{self.name}: a step takes {size / 1e6:.1f} MB")
        return dearest, size

    def _seconds(self, data: bytes) -> List[float]:
        """Measure the processor time of each step, without the garbage collector."""
        found = []
        was_enabled = gc.isenabled()
        gc.disable()
        try:
            for step in self.steps(data):
                began = time.process_time()
                step()
                found.append(time.process_time() - began)
        finally:
            if was_enabled:
                gc.enable()
        return found

    def _bytes(self, data: bytes) -> int:
        """Most memory that a step needs."""
        most = 0
        tracemalloc.start()
        try:
            for step in self.steps(data):
                tracemalloc.clear_traces()
                step()
                most = max(most, tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        return most

    def all_seeds(self) -> List[bytes]:
        """Inputs to begin with, those stored in the corpus included."""
        return self.seeds() + self.stored_inputs()

    def stored_inputs(self) -> List[bytes]:
        """Those in the corpus."""
        return [path.read_bytes() for path in self.stored()]

    def stored(self) -> List[pathlib.Path]:
        """The files of this target in the corpus."""
        return sorted((CORPUS / self.name).glob("*"))
