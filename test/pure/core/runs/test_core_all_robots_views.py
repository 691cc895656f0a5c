"""HSUF: what is shown and logged for all robots and for each robot."""

import pytest

from helpers.all_robots import (
    R1,
    R2,
    R3,
    connect_all,
    connected,
    live_all,
    robots_of,
    running,
)
from helpers.competition import event
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.effects import Level
from roah_rsbb.core.views import document
from roah_rsbb.model import run_log
from roah_rsbb.model.reason import Refused


def test_log_and_online_data_of_all_are_shown_with_the_robots_names():
    driver, robots = running()
    robots[0].says(notifications=("one",))
    robots[2].says(notifications=("three",))
    view = driver.view()
    assert [line.split(" ", 1)[1] for line in view.online_data.splitlines()] == [
        f"{R1}: notifications: one", f"{R3}: notifications: three",
    ]
    assert f"{R2}: WAITING_RESULT: Robot prepared, executing" in view.log
    assert view.log.count("Started with 3 of 3 robots") == 1


def test_notices_name_robot_and_zone():
    driver, robots = running()
    driver.taken()
    driver.run(4)
    notices = driver.taken(effects.Notice)
    assert {(n.text, n.zone) for n in notices} == {
        (f"{name}: No message from the robot for 3 s", "tbm") for name in (R1, R2, R3)
    }


def test_the_score_sheet_is_the_runs_and_every_robots_log_has_it():
    scored = event("HSUF", team="ALL", timeout=120.0)
    driver, robots = connected(scored)
    driver.command("disconnect")
    driver.command("next")
    connect_all(driver, robots_of(driver))
    driver.score("Penalized", "bumps", 2)
    assert [(item.desc, item.value) for item in driver.view().items][-1] == ("bumps", 2)
    ports = [run.port for run in driver.box.zones.members()]
    assert [driver.logged(port, run_log.SCORE) for port in ports] == [[("Penalized", "bumps", 2)]] * 3
    assert driver.view().log.count("Score: Penalized: bumps 0 -> 2") == 1
    with pytest.raises(Refused, match="no scoring group"):
        driver.score("Nothing", "bumps", 2)


def test_device_commands_are_ignored_and_said_once_a_robot():
    driver, robots = running()
    driver.taken()
    for _ in range(3):
        robots[1].says(switch_1=True)
    warnings = driver.notices(Level.WARNING)
    assert len(warnings) == 1
    assert warnings[0].startswith(R2)


def test_manual_operations_and_switches_are_refused():
    driver, _ = running()
    with pytest.raises(Refused, match="zone 'tbm' has no manual operation now"):
        driver.event(driver.box.act, Target("tbm"), "operation")
    with pytest.raises(Refused, match="which has no switches"):
        driver.event(driver.box.act, Target("tbm"), "confirm_switches")


def test_a_step_of_the_boxs_clock_makes_all_skews_be_measured_again():
    driver, robots = connected()
    driver.set_clock(100)
    driver.event(driver.box.tick)
    assert all(member.link.skew is None for member in driver.run_in().members())
    for robot in robots:
        robot.says()
    assert driver.off("start") == []


def test_robots_in_it_stay_active():
    driver, robots = running()
    live_all(driver, robots, 40)
    assert [seen.robot for seen in document.robots(driver.box, driver.now).values()] == ["r1", "r2", "r3"]


def test_it_is_in_the_publics_schedule():
    driver, _ = connected()
    assert [line.running for line in document.coming_events(driver.box)] == [True, False]
