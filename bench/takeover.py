"""Measures a takeover: the box's computer is cut off and killed, and its standby continues (docs/standby.md).

Both computers, a witness and the robots are network namespaces, as in test/net.
"""

import math
import pathlib
import signal
import sys
import tempfile
import time
from typing import Callable, List

HERE = pathlib.Path(__file__).resolve().parent
sys.path += [str(HERE.parent / "test" / "net"), str(HERE.parent / "test" / "pure")]

from crew import RSBB_PORT  # noqa: E402
from namespaces import NoRight, address  # noqa: E402
from support.waiting import wait_until  # noqa: E402
from table import Results, quantile  # noqa: E402
from two_boxes import BOX, LIMIT_S, STANDBY, STANDBY_PORT, WITNESS, Pair  # noqa: E402

COMMAND, AUTOMATIC, HUNG, HANDED_OVER, TWO_BOXES = 5.0, 10.0, 7.0, 7.0, 1.0
SILENCE_S, SHORTEST_S = 5, 2
# Seconds. Robots leave a box that was silent for 5 s, and an organiser does not press faster.
BEFORE_COMMAND_S = 6.0


def measure(results: Results, times: int, robots: int) -> None:
    """Measure some takeovers of each kind. Needs root."""
    for name, target, one in ((f"takeover by command to the last of {robots} robots", COMMAND, _by_command),
                              (f"takeover after {SILENCE_S} s of silence to the last of {robots} robots", AUTOMATIC,
                               _automatic),
                              (f"takeover from a computer whose processes are stopped to the last of {robots} robots",
                               HUNG, _hung),
                              (f"handover of a stopped core that nobody replaces to the last of {robots} robots",
                               HANDED_OVER, _handed_over)):
        try:
            taken = _repeat(one, times, robots)
        except NoRight as reason:
            print(f"bench: {name} cannot be measured: {reason}")
            taken = [[math.nan] * 4]
        parts = list(zip(*taken))
        results.add(f"{name}, longest", "s", max(parts[0]), target)
        results.add(f"{name}, median", "s", quantile(parts[0], 0.5))
        results.add("  until the standby is the box", "s", quantile(parts[1], 0.5))
        results.add("  until its first beacon", "s", quantile(parts[2], 0.5))
        if one is _by_command:
            results.add("both boxes send to robots after the old one's cable is plugged in, longest", "s",
                        max(parts[3]), TWO_BOXES)


def _repeat(one: Callable[[Pair], List[float]], times: int, robots: int) -> List[List[float]]:
    found = []
    for _ in range(times):
        with tempfile.TemporaryDirectory() as folder, Pair(pathlib.Path(folder) / "pair", robots) as pair:
            found.append(one(pair))
    return found


def _by_command(pair: Pair) -> List[float]:
    """The box is only cut off: it hears its successor when its cable is plugged in again."""
    first = pair.begin()
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    pair.box.cut()
    time.sleep(BEFORE_COMMAND_S)
    began = pair.now()
    pair.standby.takeover()
    taken = [pair.wait_followed(began, ports), *_legs(pair, began)]
    plugged = pair.now()
    pair.box.plug()
    return [*taken, pair.assert_box_stops(first, plugged, ports)]


def _automatic(pair: Pair) -> List[float]:
    """The box is lost, with all its processes."""
    pair.begin("--automatic", str(SILENCE_S), "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    began = pair.now()
    pair.lose_box()
    return [pair.wait_followed(began, ports), *_legs(pair, began), 0.0]


def _hung(pair: Pair) -> List[float]:
    """All processes of the box are stopped. They continue after the takeover, and must send nothing."""
    first = pair.begin("--automatic", str(SHORTEST_S), "--witness", address(WITNESS))
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    began = pair.now()
    pair.box.signal(signal.SIGSTOP)
    taken = [pair.wait_followed(began, ports), *_legs(pair, began), 0.0]
    continued = pair.now()
    pair.box.signal(signal.SIGCONT)
    first.wait_printed("has taken over meanwhile: this core ends")
    assert pair.sent_to_robots(BOX, continued) == []
    return taken


def _handed_over(pair: Pair) -> List[float]:
    """All processes of the box are stopped, except the one that copies."""
    pair.begin()
    pair.run()
    pair.wait_ready()
    ports = pair.private_ports(BOX)
    began = pair.now()
    pair.box.let_only_copy()
    return [pair.wait_followed(began, ports), *_legs(pair, began), 0.0]


def _legs(pair: Pair, began: float) -> List[float]:
    """When the new box said its first word, and when it sent its first beacon."""
    wait_until(lambda: pair.capture.of(STANDBY, RSBB_PORT, began), "a beacon of the standby", LIMIT_S)
    return [pair.capture.of(STANDBY, port, began)[0].mono - began for port in (STANDBY_PORT, RSBB_PORT)]
