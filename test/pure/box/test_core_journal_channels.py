"""A run whose private channel is no longer available does not continue, and does not prevent the core's start."""


import pytest

from helpers.all_robots import robots_of, take_ports
from helpers.competition import competition, event
from helpers.journaled import JournaledDriver
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal.records import Batch
from roah_rsbb.protocol import RobotState

ALL_ROBOTS = competition(a=[event("HSUF", team="ALL", timeout=120.0, scoring=())], b=["HWV"])


def box(tmp_path, config):
    return JournaledDriver(tmp_path, config, Settings(listen_duration=0.0))


def why_not(driver):
    return [text for text in driver.box.warnings(driver.now) if "cannot continue" in text]


def test_a_robot_whose_team_has_no_password_any_more(tmp_path):
    driver = box(tmp_path, ALL_ROBOTS)
    robots = robots_of(driver)
    driver.command("connect", "a")
    take_ports(driver, robots)
    for robot in robots:
        robot.says(RobotState.STOP)
    left_out = robots[-1].team
    rest = competition(teams=[team for team in ("Alpha", "Beta", "Gamma") if team != left_out], **{
        plan.name: plan.events for plan in ALL_ROBOTS.zones
    })
    driver.kill(config=rest)
    assert driver.run_in("a") is None
    assert driver.channels == {}
    assert len(why_not(driver)) == 1 and f"team {left_out} has no password any more" in why_not(driver)[0]


@pytest.mark.parametrize("port", [0, -1, 65536, 10**12, 6667])
def test_a_port_that_cannot_be_a_runs(tmp_path, port):
    """6667 is the other run's: the file is damaged."""
    driver = box(tmp_path, competition(a=["HGTKMH"], b=[event("HWV", team="Beta")]))
    driver.executing("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    state = driver.journal._writer.contents.states["zone:b"].state
    driver.journal.write(Batch(states={"zone:b": {**state, "run": {**state["run"], "port": port}}}))
    driver.kill()
    assert driver.run_in("b") is None
    assert driver.run_in("a") is not None
    assert list(driver.channels) == [6667]
    assert f"its port {port} cannot be used" in why_not(driver)[0]
