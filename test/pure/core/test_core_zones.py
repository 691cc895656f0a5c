"""A zone's way through its schedule, several zones and robots at once, and a whole week."""

from types import SimpleNamespace

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import UTC0, competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.views import document
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


def test_a_robot_stays_active_while_it_is_heard_on_its_private_channel():
    driver = BoxDriver()
    robot = driver.executing()
    robot.lives(100)
    assert list(document.robots(driver.box, driver.now)) == ["r1 of team Alpha"]
    driver.run(31)
    assert document.robots(driver.box, driver.now) == {}


def _week(zones, teams):
    """A schedule of task benchmarks for 7 days with 8 runs: every zone has its own teams."""
    codes = ("HGTKMH", "HWV", "HCFGAC")
    plans = {}
    for z in range(zones):
        plans[f"zone{z}"] = [
            event(codes[(d + n) % 3], team=f"Team{z}.{n % teams}", round=d + 1, run=n + 1,
                  scheduled=UTC0 + d * 86400 + n * 3600.0)
            for d in range(7) for n in range(8)
        ]
    return competition(teams=[e.team for events in plans.values() for e in events], **plans)


@pytest.mark.long
def test_a_week():
    """Every robot takes its 600 s in one run of four, which times out; else it completes after 200 s."""
    config = _week(zones=3, teams=4)
    driver = BoxDriver(config)
    ports = set()
    events_run = {plan.name: [] for plan in config.zones}
    start = driver.now.utc
    reasons = []
    for number in range(7 * 8):
        zones = {plan.name: plan.events[number] for plan in config.zones}
        due = next(iter(zones.values())).scheduled
        driver.run(max(0.0, due - driver.now.utc))
        robots = {}
        for i, (zone, planned) in enumerate(zones.items()):
            assert driver.box.zones[zone].event == planned
            robots[zone] = driver.connected(zone, team=planned.team, name="r", host=f"10.0.0.{i + 2}")
            driver.command("start", zone)
            robots[zone].executes()
        for robot in robots.values():
            driver.run(200 / 3)
            if number % 4 == 3:
                continue
            robot.says(notifications=("done",))
            robot.completes()
        driver.run(600)
        for zone, robot in robots.items():
            reasons.append(driver.run_in(zone).end_reason)
            ports.add(robot.port)
            driver.command("disconnect", zone)
            events_run[zone].append(driver.bags[robot.port])
            if number % 4 == 3 and not driver.box.zones[zone].at_last:
                driver.command("next", zone)
    assert len(ports) == 3 * 7 * 8
    assert ports == set(range(6667, 6667 + len(ports)))
    assert reasons.count(EndReason.TIMEOUT) == 3 * 14
    assert reasons.count(EndReason.COMPLETED) == 3 * 42
    assert len(driver.taken(effects.TimeoutRung)) == 3 * 14
    assert driver.now.utc - start > 6 * 86400
    assert driver.channels == {}
    for zone in events_run:
        notified = [sum(topic == "/notification" for topic, _ in bag) for bag in events_run[zone]]
        assert notified == [0 if number % 4 == 3 else 1 for number in range(7 * 8)]
