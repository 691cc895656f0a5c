"""Measures STOP beside floods, as a ratio to the idle machine: from the call to the datagram with STOP to the robot."""

import contextlib
import pathlib
import random
import signal
import sys
import time
from typing import Callable, Iterator, List, NamedTuple, Sequence

from fleet import Fleet
from processes import Box, Measured, wait
from reaction import PAUSE_S
from table import Results, quantile

from roah_rsbb.protocol import BoxState

FLOOD = pathlib.Path(__file__).with_name("flood.py")
SETTLE_S = 1.0  # from the first datagram or call until the measurement
# Zones whose runs are stopped.
STOPPED = 10


class Round(NamedTuple):
    """The STOPs of one round (ms), idle and beside a flood."""

    idle: List[float]
    flooded: List[float]
    rate: float  # of the flood, 1/s


@contextlib.contextmanager
def flood(kind: str, *arguments: object) -> Iterator[List[float]]:
    """Run a flood. Yields a list that has its rate (1/s) afterwards."""
    rate: List[float] = []
    process = Measured(sys.executable, str(FLOOD), kind, *map(str, arguments))
    process.wait_printed("begun")
    time.sleep(SETTLE_S)
    yield rate
    if process.ended_mono is not None:
        raise SystemExit(f"bench: the flood of {kind} ended before the measurement: {process.text}")
    process.signal(signal.SIGTERM)
    process.wait_ended()
    rate.append(float(process.lines[-1]))


class Stopped:
    """A box and its robots, of which the first `STOPPED` are stopped, and the others are flooded."""

    def __init__(self, box: Box, fleet: Fleet) -> None:
        self._box = box
        self._fleet = fleet
        self._dice = random.Random(7)

    @property
    def flooded(self) -> List[int]:
        """The numbers of the zones that are not stopped."""
        return list(range(STOPPED, self._box.zones))

    def rounds(self, count: int, stop: Callable[[int], None], kind: str, *arguments: object) -> List[Round]:
        """Measure in turns on the idle machine and beside the flood. `stop` stops the run in a zone."""
        found = []
        for _ in range(count):
            self._restart()
            idle = self._stops(stop)
            self._restart()
            with flood(kind, *arguments) as rate:
                flooded = self._stops(stop)
            found.append(Round(idle, flooded, rate[0]))
        return found

    def _restart(self) -> None:
        """Start all runs, those that were flooded with a new sheet, and let the box settle."""
        for zone in self.flooded:
            for command in ("stop", "disconnect", "connect"):
                self._box.command_when_allowed(command, zone)
        for zone, robot in enumerate(self._fleet.robots):
            if robot.box_state is not BoxState.WAITING_RESULT:
                self._box.command_when_allowed("start", zone)
        wait(lambda: all(robot.box_state is BoxState.WAITING_RESULT for robot in self._fleet.robots),
             "all robots execute")
        time.sleep(SETTLE_S)

    def _stops(self, stop: Callable[[int], None]) -> List[float]:
        taken = []
        for zone in range(STOPPED):
            time.sleep(self._dice.uniform(*PAUSE_S))
            taken.append(self._fleet.ask(lambda z=zone: stop(z), self._fleet.robots[zone], BoxState.STOP))
        return taken


def add(results: Results, name: str, rounds: Sequence[Round]) -> None:
    """Add what the rounds found. A ratio is the median of those of the rounds."""
    for label, values in (("idle", [ms for one in rounds for ms in one.idle]),
                          ("flooded", [ms for one in rounds for ms in one.flooded])):
        results.add(f"{name}, {label}, median", "ms", quantile(values, 0.5))
        results.add(f"{name}, {label}, 99 %", "ms", quantile(values, 0.99), 20 if label == "flooded" else None)
    for label, share in (("median", 0.5), ("99 %", 0.99)):
        ratios = [quantile(one.flooded, share) / quantile(one.idle, share) for one in rounds]
        results.add(f"{name}, {label}, flooded / idle", "", quantile(ratios, 0.5))
    results.add(f"{name}: the flood's rate", "1/s", quantile([one.rate for one in rounds], 0.5))
