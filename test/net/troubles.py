"""What goes wrong in a run. Each trouble is a function of the round and the benchmark, and happens in the robot's
first goal; it returns when it is over."""

import contextlib
import time
from typing import Callable, Iterator, List

import wire
from crew import ROBOT, Impostor, Robot, Stranger, foreign_beacon
from crew import wire as wire_time
from namespaces import Station, other_address

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState

OUTAGE_S = 10.0
PULLED_S = 3.0
OFF_S = 1.0
WILD_S = 1.0
WILD_TIMES = (-1, 2 ** 32, -2 ** 62, 2 ** 62)
# A clock that is only a little wrong.
FORGED_S = 0.3
# The port of no run.
NO_PORT = 9999
LIMIT_S = 60.0


def outage(the_round, code: str) -> None:
    """For ten seconds nothing gets through."""
    _, cable = _executing(the_round, code)
    usual, cable.how = cable.how, wire.GONE
    began = time.time()
    time.sleep(OUTAGE_S)
    cable.how = usual
    the_round.outages[code].append((began, time.time()))


def pulled_cable(the_round, code: str) -> None:
    """The robot's own system knows that there is no network."""
    robot, _ = _executing(the_round, code)
    began = time.time()
    the_round.lan.unplug(robot.station.number, True)
    time.sleep(PULLED_S)
    the_round.lan.unplug(robot.station.number, False)
    the_round.outages[code].append((began, time.time()))


def reboot(the_round, code: str) -> None:
    """The robot is switched off and on, and knows nothing."""
    robot, _ = _executing(the_round, code, held=True)
    began = time.time()
    robot.end()
    robot.held = False
    time.sleep(OFF_S)
    robot.begin()
    the_round.reboots[code] += 1
    robot.wait_did_again(RobotState.PREPARING, began, LIMIT_S)
    the_round.outages[code].append((began, time.time()))


def new_address(the_round, code: str) -> None:
    """The robot's address changes, as by another access point's DHCP."""
    robot, _ = _executing(the_round, code)
    number = robot.station.number
    began = time.time()
    the_round.lan.move(number, robot.address, other_address(number))
    robot.address = other_address(number)
    # The box believes that it is the robot once nothing came from the old address for a while (core, link).
    the_round.outages[code].append((began, began + 2.5))


def wild_clock(the_round, code: str) -> None:
    """The robot's clock shows times that cannot be, and then the right one again."""
    robot, _ = _executing(the_round, code)
    began = time.time()
    for seconds in WILD_TIMES[:2]:
        robot.clock_s = seconds
        time.sleep(WILD_S)
    robot.clock_s = None
    # Set back, it is believed once some messages came in order (core, timeline).
    the_round.outages[code].append((began, time.time() + 5.0))


def impostors(the_round, code: str) -> None:
    """A host with the password impersonates the robot, and so does a second robot of the same name."""
    robot, cable = _executing(the_round, code)
    port = the_round.box.last_details(code).port
    with contextlib.ExitStack() as leaving:
        # Whoever has the password speaks for a robot that is silent for two and a half seconds (core, link). However
        # long the machine stops, the box hears the robot first.
        cables = [the_round.lan.wire(station.number) for station in (the_round.impostor, the_round.twin)]
        for each in cables:
            leaving.enter_context(each.follows(cable, port))
        leaving.callback(Impostor(the_round.impostor, robot.team, port, the_round.lan.box).close)
        leaving.callback(Robot(the_round.twin, robot.team, 1.0, 1).end)
        before = [each.out.passed for each in cables]
        the_round.wait_ended(code)
        assert all(each.out.passed > count for each, count in zip(cables, before)), "both spoke to the box"


def second_robot(the_round, code: str) -> None:
    """Another robot of the same team, with a different name."""
    robot, _ = _executing(the_round, code)
    second = Robot(the_round.twin, robot.team, 1.0, 1, name="Second")
    try:
        the_round.wait_ended(code)
    finally:
        second.end()
    assert not second.states, f"it is in no run, but was {second.states}"


def _executing(the_round, code: str, held: bool = False):
    """Wait until the robot executes its first goal. `held`: it does not complete it before it is released."""
    robot = the_round.robots[code]
    robot.wait_did(RobotState.EXECUTING, LIMIT_S)
    robot.held = held
    return robot, the_round.lan.wire(robot.station.number)


@contextlib.contextmanager
def strangers(station: Station, teams: List[str]) -> Iterator[None]:
    """A second box that lists everybody's robot, beacons of invented robots, and tablets that cannot be."""
    listed = [(team, ROBOT, NO_PORT) for team in teams]

    def messages() -> list:
        found = [foreign_beacon(*listed)]
        for seconds in WILD_TIMES:
            found += [pb.RobotBeacon(team_name=team, robot_name="Wild", time=wire_time(seconds)) for team in teams]
            found.append(pb.TabletBeacon(
                last_call=wire_time(seconds), last_pos=wire_time(seconds), x=float("nan"), y=1e300))
        return found

    with _sends(station, messages, period_s=1.0):
        yield


@contextlib.contextmanager
def forged_robots(station: Station, teams: List[str]) -> Iterator[None]:
    """Beacons with wrong clocks under every robot's name, from before its first own one."""
    def messages() -> list:
        return [pb.RobotBeacon(team_name=team, robot_name=ROBOT, time=wire_time(seconds))
                for seconds in (*WILD_TIMES, time.time() + FORGED_S) for team in teams]

    with _sends(station, messages, period_s=0.5):
        yield


@contextlib.contextmanager
def _sends(station: Station, messages: Callable[[], list], period_s: float) -> Iterator[None]:
    stranger = Stranger(station, messages, period_s)
    try:
        yield
    finally:
        stranger.close()


