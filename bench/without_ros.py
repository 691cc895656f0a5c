"""Measures the box without ROS, `roah-rsbb run`, in turns with the nodes of the box with ROS."""

import contextlib
import os
import socket
import sys
import time
from typing import Dict, List, NamedTuple, Tuple
from unittest import mock

import reaction
import rospy
from addresses import BROADCAST
from fleet import REGULAR_S, Fleet
from processes import START_S, Box, Measured, wait
from table import quantile

from roah_rsbb.client.client import Client
from roah_rsbb.client.places import OWN_VARIABLE, read_place
from roah_rsbb.model.document import Document

TURNS = 5
WARM_S = 1.0  # time until all robots send evenly
LISTEN_S = 0.2


class BoxWithoutRos(Box):
    """The whole box in one process, with its pages: no functionality benchmark is scheduled, so the rules of these have
    no process. Use it as a context manager."""

    OPTIONS: Tuple[str, ...] = ("--unsupervised",)

    def _started(self, profile: str, settings: Dict[str, object]) -> Measured:
        self._door_file = str(self._folder / "door.json")
        (self._folder / "competition.launch").write_text("<launch/>", "utf-8")
        given = {**settings, "listen_duration": LISTEN_S, "standings_file": "none", "web": "true", "tablet_port": 0,
                 "devices": "false"}
        self.began_mono = time.monotonic()
        with mock.patch.dict(os.environ, {OWN_VARIABLE: self._door_file}):
            return Measured(
                sys.executable, "-m", "roah_rsbb.tools.team", "run", str(self._folder), *self.OPTIONS,
                "--no-browser", *(f"{name}:={value}" for name, value in given.items()))

    def __enter__(self) -> "BoxWithoutRos":
        self._client: Client[Document] = Client(Document, lambda: read_place(self._door_file), face="referee")
        self._client.start()
        self._client.wait(lambda document: True, START_S)
        return self

    def __exit__(self, *error: object) -> None:
        self._client.close()
        super().__exit__(*error)

    @property
    def processes(self) -> List[Measured]:
        """The only one."""
        return [self.process]

    def command(self, command: str, zone: int) -> None:
        """A referee's command, as a panel gives it. Raises ServiceException, as that of the core node does."""
        answer = self._client.call("act", action=command, zone=f"zone {zone}", given={}).result()
        if answer.reasons or not answer.is_answered:
            raise rospy.ServiceException(", ".join(map(str, answer.reasons)))


class BoxWithRos(Box):
    """The same box, with ROS. Use it as a context manager."""

    def __init__(self, zones: int) -> None:
        super().__init__(zones, has_pages=True)

    def __enter__(self) -> "BoxWithRos":
        super().__enter__()
        wait(lambda: rospy.has_param("/roah_rsbb_web/url"), "the web pages are served")
        return self

    @property
    def processes(self) -> List[Measured]:
        """The only one."""
        return [self.process]


class Sides(NamedTuple):
    """What was measured of the box with ROS, and of the one without."""

    node: List[float]
    without: List[float]

    @property
    def ratio(self) -> float:
        """The median ratio of a turn."""
        return quantile([without / node for node, without in zip(self.node, self.without)], 0.5)


@contextlib.contextmanager
def both_in_runs(robots: int):
    """Both boxes, each with robots that execute."""
    with contextlib.ExitStack() as stack:
        sides = []
        for kind in (BoxWithRos, BoxWithoutRos):
            box = stack.enter_context(kind(robots))
            fleet = stack.enter_context(Fleet(robots, box.port))
            reaction.connect(box, fleet, robots)
            reaction.start(box, fleet, robots)
            sides.append((box, fleet))
        yield sides


def share(processes: List[Measured], seconds: float) -> float:
    """Share of a processor (per cent) that all of them use in the next `seconds`."""
    began, used = time.monotonic(), sum(process.cpu_s() for process in processes)
    time.sleep(seconds)
    return 100.0 * (sum(process.cpu_s() for process in processes) - used) / (time.monotonic() - began)


def shares(sides, period_s: float, seconds: float) -> Sides:
    """Shares of a processor (per cent) in turns, while robots send with this period (s)."""
    found = Sides([], [])
    for _ in range(TURNS):
        for (box, fleet), values in zip(sides, found):
            fleet.keep_sending(period_s)
            time.sleep(WARM_S)
            values.append(share(box.processes, seconds))
            fleet.keep_sending(REGULAR_S)
    return found


def first_beacon_s() -> float:
    """Seconds from the start of the process to its first beacon, of which it listens for `LISTEN_S`."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        box = BoxWithoutRos(1)
        ear.bind((BROADCAST, box.port))
        ear.settimeout(START_S)
        try:
            ear.recv(65535)
            return time.monotonic() - box.began_mono
        finally:
            Box.__exit__(box)
