"""Runs of all robots at once, for the tests of HSUF."""

from helpers.box_driver import BoxDriver
from helpers.competition import TEAMS, competition, event
from roah_rsbb.core.settings import Settings
from roah_rsbb.states import RobotState


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
    """Tell robots their ports from the beacon; one that is not listed gets None."""
    listed = {(r.team, r.robot): r.port for r in driver.box.beacon().robots}
    for robot in robots:
        robot.port = listed.get((robot.team, robot.name))


def connect_all(driver, robots):
    """Connect; every robot that is in the run says STOP."""
    driver.command("connect")
    take_ports(driver, robots)
    for robot in robots:
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
    """All say the same once a second, for so many seconds."""
    for _ in range(seconds):
        driver.run(1.0)
        for robot in robots:
            robot.says(after=0.0)
