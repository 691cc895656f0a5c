"""A zone's way through its schedule, several zones and robots at once, and a whole week."""

from types import SimpleNamespace

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState


def _zone(*codes):
    return Zone(competition(tbm=codes).zones[0])


@pytest.mark.parametrize("auto_next", [True, False])
@pytest.mark.parametrize("reason", [None, *EndReason])
def test_only_a_run_that_ran_to_its_end_moves_the_zone_on(auto_next, reason):
    zone = _zone("HGTKMH", "HWV")
    text = "12:00:00Z STOP\n"
    zone.run = SimpleNamespace(end_reason=reason, log=text, online_data=text)
    zone.leave(auto_next)
    moved = auto_next and reason in (
        EndReason.COMPLETED, EndReason.GOALS_TIMED_OUT, EndReason.NO_SHOW, EndReason.WITHDRAWN)
    assert (zone.index, zone.run) == (int(moved), None)
    # The log of the last run stays to be read, until the zone shows another event.
    assert zone.last_run == (None if moved else (reason, text, text))


def test_two_zones_at_once_do_not_touch_each_other():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta", timeout=30.0)]))
    one = driver.executing("a")
    two = driver.executing("b", team="Beta", name="r2", host="10.0.0.3")
    assert one.port != two.port
    one.says(notifications=("mine",))
    two.says(notifications=("yours",))
    assert driver.logged(one.port, "/notification") == ["mine"]
    assert driver.logged(two.port, "/notification") == ["yours"]
    driver.score("Penalized", "bumps", 3, zone="a")
    bumps = [next(item.value for item in driver.view(zone).items if item.desc == "bumps") for zone in "ab"]
    assert bumps == [3, 0]
    driver.run(31)
    assert driver.run_in("b").end_reason is EndReason.TIMEOUT
    assert driver.taken(effects.TimeoutRung) == [effects.TimeoutRung("b")]
    assert driver.run_in("a").phase is Phase.RUNNING
    one.completes()
    assert driver.run_in("a").end_reason is EndReason.COMPLETED
    driver.command("disconnect", "a")
    assert driver.run_in("b") is not None


def test_a_message_on_another_runs_port_is_that_runs():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    one = driver.connected("a")
    two = driver.connected("b", team="Beta", name="r2")
    driver.command("start", "a")
    driver.command("start", "b")
    one.says(RobotState.WAITING_GOAL)
    assert (driver.box_state("a"), driver.box_state("b")) == (BoxState.WAITING_RESULT, BoxState.PREPARE)
    two.port = 9999
    two.says(RobotState.WAITING_GOAL)
    assert driver.box_state("b") is BoxState.PREPARE


def test_a_robot_is_in_one_run_at_a_time_in_the_whole_box():
    driver = BoxDriver(competition(a=["HWV"], b=["HGTKMH"]))
    driver.connected("a")
    driver.run(1)
    assert driver.off("connect", "b") == ["Robot r1 of team Alpha is in a run in zone a"]
    with pytest.raises(Refused):
        driver.command("connect", "b")
    driver.command("disconnect", "a")
    assert driver.off("connect", "b") == []
    driver.command("connect", "b")


def test_two_robots_of_one_team_can_be_in_two_zones():
    driver = BoxDriver(competition(a=["HWV"], b=["HGTKMH"], c=["HCFGAC"]))
    one, two = driver.robot(name="r1", host="10.0.0.2"), driver.robot(name="r2", host="10.0.0.3")
    one.beacon()
    driver.run(0.5)
    two.beacon()
    driver.command("connect", "a")
    driver.command("connect", "b")
    assert (driver.run_in("a").robot.robot, driver.run_in("b").robot.robot) == ("r1", "r2")
    assert driver.off("connect", "c") == [
        "Robot r1 of team Alpha is in a run in zone a", "Robot r2 of team Alpha is in a run in zone b"
    ]
