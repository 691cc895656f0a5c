"""What a scenario is."""

import enum
from typing import Awaitable, Callable, NamedTuple

from roah_rsbb.check.play import Play


class Depth(enum.Enum):
    """How thorough a check is."""

    BASIC = "basic"
    FULL = "full"


class Scenario(NamedTuple):
    """One entry of the tables."""

    name: str
    title: str
    run: Callable[[Play, str], Awaitable[None]]  # the play, and the benchmark's code
    level: Depth = Depth.FULL
    code: str = ""  # the benchmark; empty: the first of --benchmarks
    needs_robot: bool = True  # skip it if the robot was not found
    bad_network: bool = False  # the scenario makes the network bad, so times and losses are not judged
