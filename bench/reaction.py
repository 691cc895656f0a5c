"""Measures reaction times: from an action of a robot or referee until the box sends the resulting state."""

import contextlib
import pathlib
import random
import subprocess
import sys
import threading
import time
from typing import Callable, Iterator, List, Sequence

from fleet import ANSWER_S, Fleet, Robot
from processes import Box, free_port, wait

from roah_rsbb.protocol import BoxState, RobotState

# These reports of a robot in a run change the box's state back and forth.
PROBES = ((RobotState.PREPARING, BoxState.PREPARE), (RobotState.WAITING_GOAL, BoxState.WAITING_RESULT))
# Random pauses over a whole period of 200 ms, so that their ends are spread over the period.
PAUSE_S = (0.02, 0.22)


def connect(box: Box, fleet: Fleet, count: int) -> None:
    """Connect `count` robots, in zones 0 to count - 1."""
    for zone in range(count):
        box.command_when_allowed("connect", zone)
    wait(lambda: all(r.box_state is BoxState.STOP for r in fleet.robots[:count]), "the box has sent STOP to all robots")


def start(box: Box, fleet: Fleet, count: int) -> None:
    """Start the runs of `count` robots, which then execute."""
    for zone in range(count):
        box.command_when_allowed("start", zone)
    wait(lambda: all(r.box_state is BoxState.WAITING_RESULT for r in fleet.robots[:count]), "all robots execute")


def react(fleet: Fleet, robots: Sequence[Robot], probes: int, pause_s=PAUSE_S) -> List[float]:
    """Milliseconds from a RobotState that must change the state until the box sends the new state.

    All robots must execute. They do so again when this returns, so that it can be called again.
    """
    taken: List[float] = []
    dice = random.Random(1)
    begun = {id(robot): 0 for robot in robots}
    for robot in robots:
        robot.follows = False
    for _ in range(probes):
        robot = dice.choice(robots)
        state, expects = PROBES[begun[id(robot)] % 2]
        begun[id(robot)] += 1
        answered = threading.Event()

        def done(ms: float, answered: threading.Event = answered) -> None:
            taken.append(ms)
            answered.set()

        fleet.do(lambda r=robot, s=state, e=expects, d=done: r.report(s, e, d))
        if not answered.wait(ANSWER_S):
            taken.append(float("inf"))
        time.sleep(dice.uniform(*pause_s))
    fleet.do(lambda: [robot.follow() for robot in robots])
    wait(lambda: all(robot.box_state is BoxState.WAITING_RESULT for robot in robots), "all robots execute again")
    return taken


def starts(fleet: Fleet, robot: Robot, command: Callable[[str], None], count: int) -> List[float]:
    """Milliseconds from the referee's start until the box sends PREPARE. `command` carries out start and stop."""
    taken, dice = [], random.Random(2)
    for _ in range(count):
        fleet.ask(lambda: command("stop"), robot, BoxState.STOP)
        wait(lambda: robot.state is RobotState.STOP, "the robot stops")
        time.sleep(dice.uniform(*PAUSE_S))
        taken.append(fleet.ask(lambda: command("start"), robot, BoxState.PREPARE))
    return taken


@contextlib.contextmanager
def ticking_box() -> Iterator:
    """The ticking sender with a robot in a run; yields the fleet, the robot and the referee's command."""
    port = free_port()
    program = pathlib.Path(__file__).with_name("ticking_box.py")
    with subprocess.Popen([sys.executable, str(program), str(port), "password 0"], text=True, bufsize=1,
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process, Fleet(1, None) as fleet:
        process.stdout.readline()
        robot = fleet.robots[0]
        fleet.do(lambda: robot.open(port))

        def command(word: str) -> None:
            process.stdin.write(f"{word}\n")

        command("start")
        wait(lambda: robot.box_state is BoxState.WAITING_RESULT, "the ticking sender's robot executes")
        yield fleet, robot, command
        process.stdin.close()


def side_by_side(ours: Callable[[], List[float]], theirs: Callable[[], List[float]]) -> List[List[float]]:
    """Run both measurements at the same time, so that the load of the machine affects both."""
    found: List[List[float]] = []
    other = threading.Thread(target=lambda: found.append(theirs()))
    other.start()
    mine = ours()
    other.join()
    return [mine, *found]
