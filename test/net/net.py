"""The network with everybody on it, and one round of all benchmarks."""

import concurrent.futures
import contextlib
import fcntl
import os
import pathlib
import threading
import time
from typing import Callable, Dict, List, Tuple

import wire
from crew import EXECUTE_S, USUAL_EXECUTE_S, Robot, Tablet
from namespaces import Lan
from support.waiting import happened, wait_until

from box import SPEECH, TEAMS, Box
from referee import Referee, Result

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "build" / "net"
BOX, FLOODER, TABLET, STRANGER, TWIN, IMPOSTOR, OTHER_BOX, FORGER = 1, 2, 3, 4, 5, 6, 7, 8
FIRST_ROBOT = 11
ROUNDS = 40
LIMIT_S = 300.0

Trouble = Callable[["Round", str], None]


class Net:
    """The network, made once for all tests: the process that made it is the box's host."""

    def __init__(self, seed: int, kind: str) -> None:
        """`kind`: of the box. Raises `NoRight` where such a network cannot be made."""
        self.seed = seed
        self.numbers = {code: FIRST_ROBOT + place for place, code in enumerate(TEAMS)}
        others = TABLET, STRANGER, TWIN, IMPOSTOR, OTHER_BOX, FORGER
        self.lan = Lan(BOX, [*self.numbers.values(), *others], [FLOODER], seed)
        FOLDER.mkdir(parents=True, exist_ok=True)
        self._lock = os.open(FOLDER, os.O_RDONLY)
        fcntl.flock(self._lock, fcntl.LOCK_EX)  # another such run of this checkout ends first
        self.box = Box(FOLDER / "box", ROUNDS, kind)
        self.tablet = Tablet(self.lan.stations[TABLET])
        self.rounds = 0

    def close(self) -> None:
        """End all of it."""
        self.tablet.close()
        self.box.close()
        self.lan.close()
        os.close(self._lock)

    def impair(self, how: wire.Impairment) -> None:
        """Make the way to every robot and to the tablet this bad."""
        for number in (*self.numbers.values(), TABLET):
            self.lan.wire(number).how = how


class Round:
    """One run of each benchmark, side by side; use it as a context. Robots stay until its end."""

    def __init__(self, net: Net, codes: List[str]) -> None:
        net.rounds += 1
        self.net, self.lan, self.box = net, net.lan, net.box
        self.number = net.rounds
        self.codes = codes
        self.twin, self.impostor = self.lan.stations[TWIN], self.lan.stations[IMPOSTOR]
        self.outages: Dict[str, List[Tuple[float, float]]] = {code: [] for code in codes}
        self.reboots = dict.fromkeys(codes, 0)
        self.when_connected: Callable[[], object] = lambda: None  # called once, before any run is started
        self._ended = dict.fromkeys(codes, False)
        self.robots = {
            code: Robot(
                self.lan.stations[net.numbers[code]], TEAMS[code], EXECUTE_S.get(code, USUAL_EXECUTE_S), net.seed)
            for code in codes
        }

    def __enter__(self) -> "Round":
        return self

    def __exit__(self, *_: object) -> None:
        for robot in self.robots.values():
            robot.end()
            if robot.address != robot.station.address:
                self.lan.move(robot.station.number, robot.address, robot.station.address)

    def wait_ended(self, code: str) -> None:
        """Wait for the end of a run."""
        wait_until(lambda: self._ended[code], f"{code} is over", LIMIT_S)

    def conduct(self, troubles: Dict[str, Trouble]) -> Dict[str, Result]:
        """All runs, each with its trouble."""
        for code in troubles:
            self.robots[code].held = True  # a trouble begins in its first goal, however busy the machine is
        connected = threading.Barrier(len(self.codes) + 1)
        with concurrent.futures.ThreadPoolExecutor(2 * len(self.codes)) as pool:
            runs = {code: pool.submit(self._conduct, code, connected) for code in self.codes}
            work = []
            # Broken by a run that failed, which raises its own reason below.
            with contextlib.suppress(threading.BrokenBarrierError):
                connected.wait(LIMIT_S)
                # What was before a robot's first beacon is past, for it. And one that hears another box first is that
                # one's for some seconds: a late beacon from before it was connected makes it leave its channel.
                settled = time.monotonic() + wire.LATE_S + wire.BAD.longest_s
                wait_until(lambda: time.monotonic() > settled and all(
                    robot.did("home") and robot.is_in_run for robot in self.robots.values()),
                    "all robots heard the box, and nothing from before")
                self.when_connected()
                self.net.tablet.call()
                # A trouble may make a robot follow another box for a moment, and what was before then is past, for it.
                wait_until(lambda: all(robot.did("call") for robot in self.robots.values()), "all heard the call")
                work = [pool.submit(trouble, self, code) for code, trouble in troubles.items()]
            failures = [run.exception() for run in (*runs.values(), *work)]
        # Those that only waited for one that failed say nothing.
        failures = [each for each in failures if each and not isinstance(each, threading.BrokenBarrierError)]
        if failures:
            raise failures[0]
        return {code: run.result() for code, run in runs.items()}

    def speech(self) -> Result:
        """The run of all robots at once."""
        return Referee(self.box, SPEECH, self.number).conduct(len(self.robots))

    def _conduct(self, code: str, connected: threading.Barrier) -> Result:
        referee = Referee(self.box, code, self.number)
        try:
            referee.connect()
            # A robot without a run follows any box that lists it, as the other box does.
            self.box.wait_details(code, lambda d: d.is_on("start"), "its robot answers", LIMIT_S)
            connected.wait(LIMIT_S)
            referee.start()
            return referee.finish()
        except BaseException:
            connected.abort()
            raise
        finally:
            self._ended[code] = True
            happened()
