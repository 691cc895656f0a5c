"""Measures reaction times: from an action of a robot or referee until the box sends the resulting state."""

import random
import threading
import time
from typing import Callable, List, Sequence

from fleet import ANSWER_S, Fleet, Robot
from processes import Box, wait

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
