"""Runs of all robots at once, for the tests of HSUF."""

from helpers.box_driver import BoxDriver
from helpers.competition import TEAMS, competition, event
from roah_rsbb.core.settings import Settings
from roah_rsbb.protocol import RobotState

R1, R2, R3 = "r1 of team Alpha", "r2 of team Beta", "r3 of team Gamma"
SKEW = "Clock skew of the robot is +0.500 s, but must be below 0.100 s: synchronise the robot's clock"
NO_ANSWER = "Robot has not answered on the private channel yet"


def all_robots_box(*more, teams=TEAMS, settings=None, timeout=120.0, **of_driver):
    """A box with an HSUF in zone `tbm` (and more events after it), and a task benchmark in zone `other`."""
    first = event("HSUF", team="ALL", timeout=timeout, scoring=())
    config = competition(teams=teams, tbm=[first, *more], other=["HGTKMH"])
    return BoxDriver(config, settings or Settings(), **of_driver)


def robots_of(driver, teams=TEAMS):
    """A robot of each team, whose beacon was heard."""
    robots = [driver.robot(team, f"r{i}", f"10.0.0.{i + 1}") for i, team in enumerate(teams, 1)]
    for robot in robots:
        robot.beacon()
    return robots


def take_ports(driver, robots):
    """Give robots their ports from the beacon; a robot that is not listed gets None."""
    listed = {(r.team, r.robot): r.port for r in driver.box.beacon().robots}
    for robot in robots:
        robot.port = listed.get((robot.team, robot.name))


def listed(driver, robots):
    """Connect, and give the robots their ports; none has said a word."""
    driver.command("connect")
    take_ports(driver, robots)
    return robots


def connect_all(driver, robots):
    """Connect, and let every robot in the run report STOP."""
    for robot in listed(driver, robots):
        if robot.port is not None:
            robot.says(RobotState.STOP)
    return robots


def start_all(driver, robots):
    """Start, and take all robots to where they execute."""
    driver.command("start")
    for robot in robots:
        robot.executes()
    return robots


def live_all(driver, robots, seconds):
    """Let all robots repeat their reports once a second for this many seconds."""
    for _ in range(seconds):
        driver.run(1.0)
        for robot in robots:
            robot.says(after=0.0)


def connected(*more, **of_box):
    """A box and its robots, connected."""
    driver = all_robots_box(*more, **of_box)
    return driver, connect_all(driver, robots_of(driver))


def running(*more, **of_box):
    """The same, started: all execute."""
    driver, robots = connected(*more, **of_box)
    return driver, start_all(driver, robots)


def box_states(driver, robots):
    """Return the box's message for each robot."""
    return [driver.box.zones.run_at(robot.port).message.state for robot in robots]


def ends(driver):
    """Each robot's end; None: none yet."""
    return [member.end_reason for member in driver.run_in().members()]


def counts(driver):
    """Robots that prepare, execute, have stopped."""
    return tuple(driver.run_in().counts())


def state_lines(driver):
    """Return the texts for the referee."""
    return driver.view().state.splitlines()
