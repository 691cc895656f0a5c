"""Measures the core in turns with a bare loop (`bare.py`) that receives the same datagrams."""

import contextlib
import pathlib
import sys
from typing import Dict, Iterator, List, NamedTuple, Tuple

import load
from fleet import REGULAR_S, Fleet
from processes import Box, Measured, free_port, wait
from table import quantile

TURNS = 5
WARM_S = 1.0  # time until all robots send evenly


class Compared(NamedTuple):
    """Shares of a processor (per cent) at one rate of datagrams, in each turn."""

    core: List[float]  # without a subscriber
    followed: List[float]  # with a ROS subscriber of the message for panels
    bare: List[float]

    def ratio(self, values: List[float]) -> float:
        """The median ratio of the core's share to that of the bare loop in the same turn."""
        return quantile([core / bare for core, bare in zip(values, self.bare)], 0.5)


@contextlib.contextmanager
def bare_loop(robots: int) -> Iterator[Tuple[Measured, Fleet]]:
    """The bare loop, and robots that execute."""
    port = free_port()
    process = Measured(sys.executable, str(pathlib.Path(__file__).parent / "bare.py"), str(port), str(robots))
    try:
        with Fleet(robots, port) as fleet:
            wait(lambda: all(robot.box_state is not None for robot in fleet.robots), "the bare loop answers all robots")
            yield process, fleet
    finally:
        process.close()


def compare(box: Box, fleet: Fleet, periods_s: Tuple[float, ...], seconds: float) -> Dict[float, Compared]:
    """Compare while robots send with each of the periods (s); each measurement takes `seconds`."""
    found = {period_s: Compared([], [], []) for period_s in periods_s}
    with bare_loop(len(fleet.robots)) as (bare, other_fleet):
        for _ in range(TURNS):
            for period_s, compared in found.items():
                compared.bare.append(_share(bare, other_fleet, period_s, seconds))
                compared.core.append(_share(box.process, fleet, period_s, seconds))
                with contextlib.closing(load.Pace()):
                    compared.followed.append(_share(box.process, fleet, period_s, seconds))
    return found


def _share(process: Measured, fleet: Fleet, period_s: float, seconds: float) -> float:
    fleet.keep_sending(period_s)
    process.cpu_percent(WARM_S)
    try:
        return process.cpu_percent(seconds)
    finally:
        fleet.keep_sending(REGULAR_S)
