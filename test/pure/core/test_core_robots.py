"""Active robots: their addresses and skews, also if somebody forges beacons. Who knows the password wins."""

import random

import pytest

from helpers.all_robots import all_robots_box
from helpers.box_driver import BoxDriver, wire
from helpers.competition import UTC0, competition
from helpers.linked_world import FakeLink, World, assert_legal
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.effects import Level
from roah_rsbb.core.robots import (
    LATE_S,
    MAX_AT_HOST,
    MAX_OF_TEAM,
    MAX_ROBOTS,
    MAX_STRANGERS,
    ActiveRobots,
    RobotId,
)
from roah_rsbb.core.views import document
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import RobotState

TIMEOUT = 30.0


class Field:
    """The list, and the time."""

    def __init__(self):
        self.now = Now(0.0, UTC0)
        self.in_runs = set()
        self.robots = ActiveRobots(TIMEOUT, {"Alpha", "Beta"}, lambda: self.in_runs)

    def hear(self, name="r1", team="Alpha", host="10.0.0.2", after=0.0, skew=0.0, certain=False):
        self.now = self.now.later(after)
        return self.robots.hear(self.now, RobotId(team, name), host, wire(self.now.utc + skew), certain)

    def names(self):
        return [(robot.id.team, robot.id.robot) for robot in self.robots.all(self.now)]


@pytest.fixture
def field():
    return Field()


def test_robots_are_listed_by_team_and_name(field):
    for team, name in (("Beta", "a"), ("Alpha", "z"), ("Alpha", "b")):
        field.hear(name, team)
    assert field.names() == [("Alpha", "b"), ("Alpha", "z"), ("Beta", "a")]


def test_a_robot_that_is_not_heard_for_the_timeout_is_forgotten(field):
    field.hear("r1")
    field.hear("r2", after=TIMEOUT)
    assert field.names() == [("Alpha", "r1"), ("Alpha", "r2")]
    field.now = field.now.later(0.1)
    assert field.names() == [("Alpha", "r2")]


def test_a_robot_that_has_left_its_run_is_never_late_while_it_sends_beacons(field):
    """Its beacons begin to count for its clock when its last message with the password is older."""
    robot = field.hear(certain=True)
    for _ in range(100):
        field.hear(after=0.9)
        for _ in range(9):
            field.now = field.now.later(0.1)
            assert not robot.is_late(field.now)


def test_the_skew_is_the_robots_clock_minus_the_boxs(field):
    assert field.hear(skew=0.25).skew.seconds == pytest.approx(0.25)
    assert field.hear("r2", skew=-3.0).skew.seconds == pytest.approx(-3.0)


def test_the_teams_robot_to_take_is_the_longest_known_that_is_not_late(field):
    field.hear("old")
    field.hear("new", after=1.0)
    assert [r.id.robot for r in field.robots.of_team(field.now, "Alpha")] == ["old", "new"]
    field.hear("new", after=LATE_S)
    assert [r.id.robot for r in field.robots.of_team(field.now, "Alpha")] == ["new", "old"]
    assert field.robots.of_team(field.now, "Beta") == []


def test_a_second_host_under_the_same_name_takes_nothing_over_while_the_first_is_heard(field):
    for _ in range(5):
        field.hear(after=1.0)
        robot = field.hear(host="10.0.0.66", skew=5.0)
        assert robot.host == "10.0.0.2"
        assert list(robot.rivals(field.now)) == ["10.0.0.66"]
        assert robot.skew.seconds == pytest.approx(0.0)


def test_a_robot_that_moved_to_another_host_is_taken_there_soon(field):
    field.hear()
    for _ in range(3):
        assert field.hear(host="10.0.0.7", after=1.0).host == "10.0.0.2"
    robot = field.hear(host="10.0.0.7", after=1.0)
    assert robot.host == "10.0.0.7"
    assert not robot.rivals(field.now)


def test_what_was_decrypted_is_certain(field):
    field.hear()
    robot = field.hear(host="10.0.0.7", certain=True)
    assert robot.host == "10.0.0.7"
    assert not robot.rivals(field.now)


def test_what_was_never_confirmed_gives_way_to_the_host_that_knew_the_password(field):
    field.hear(host="10.0.0.2", certain=True)
    field.hear(host="10.0.0.66", after=LATE_S + 1, skew=3600.0)
    robot = field.hear(host="10.0.0.2", after=1.0)
    assert robot.host == "10.0.0.2"
    assert robot.skew.seconds == pytest.approx(0.0)
    assert robot.rivals(field.now)["10.0.0.66"].skew == pytest.approx(3600.0)
    assert field.hear(host="10.0.0.66", skew=3600.0).skew.seconds == pytest.approx(0.0)


def test_a_flood_of_one_teams_robots_fills_only_its_quota(field):
    for i in range(2 * MAX_ROBOTS):
        field.hear(f"fake{i}", host="10.0.0.66", after=0.04)
    assert len(field.names()) == MAX_AT_HOST
    assert field.hear("r1", "Beta", "10.0.0.3") is not None
    assert field.hear("r1", "Alpha", "10.0.0.2") is not None
    for i in range(MAX_ROBOTS):
        field.hear(f"fake{i}", host="10.0.0.66", after=0.1)
    assert {("Alpha", "r1"), ("Beta", "r1")} < set(field.names())
    field.now = field.now.later(TIMEOUT + 1)
    assert field.hear("another") is not None
    assert field.names() == [("Alpha", "another")]


def test_many_addresses_fill_only_the_quota_of_the_team_that_they_name(field):
    field.hear("r1", "Beta", "10.0.0.3")
    for i in range(MAX_ROBOTS):
        field.hear(f"fake{i}", host=f"10.1.0.{i}", after=0.04)
    assert len(field.names()) == 1 + MAX_OF_TEAM
    squatter = field.robots.take_squatter()
    assert (squatter.team, squatter.robots) == ("Alpha", 1)
    assert field.robots.take_squatter() is None
    field.now = field.now.later(1)
    assert field.hear("r1", host="10.0.0.2") is not None


@pytest.mark.parametrize("how", ["confirmed", "in a run"])
def test_a_robot_that_is_confirmed_or_in_a_run_never_gives_way(field, how):
    robot_id = RobotId("Alpha", "r1")
    field.in_runs |= {robot_id} if how == "in a run" else set()
    field.hear("r1", host="10.0.0.66", certain=how == "confirmed")
    for i in range(2 * MAX_AT_HOST):
        field.hear(f"fake{i}", host="10.0.0.66", after=0.1)
    assert field.robots.find(robot_id) is not None


def test_a_confirmed_robot_is_always_listed(field):
    full = ActiveRobots(TIMEOUT, {f"team {i}" for i in range(MAX_ROBOTS)})
    for i in range(MAX_ROBOTS):
        full.hear(field.now, RobotId(f"team {i}", "r"), f"10.1.0.{i}", wire(field.now.utc))
    assert full.hear(field.now, RobotId("team 1", "r2"), "10.0.0.2", wire(field.now.utc), certain=True) is not None
    assert len(full.all(field.now)) == MAX_ROBOTS


def test_robots_of_the_competition_are_listed_in_a_flood_of_strangers(field):
    for i in range(2 * MAX_ROBOTS):
        field.hear("fake", f"stranger{i}", f"10.1.{i // 250}.{i % 250}", after=0.03)
    assert field.hear("r1", "Beta") is not None
    assert field.hear("r2", "Beta") is not None
    assert ("Beta", "r1") in field.names()
    assert ("Beta", "r2") in field.names()
    assert len(field.names()) == 2 + MAX_STRANGERS


def test_a_robot_is_named_with_its_team():
    assert str(RobotId("Alpha", "r1")) == "r1 of team Alpha"


FORGER = "10.0.0.66"


def _conducts(driver, robot, zone="tbm"):
    """The referee connects the robot at once, starts it, and its run is completed."""
    assert driver.off("connect", zone) == []
    driver.command("connect", zone)
    run = driver.run_in(zone)
    assert run.robot.robot == robot.name
    robot.port = run.port
    robot.says(RobotState.STOP)
    # A robot repeats its state.
    for _ in range(3):
        robot.says(after=0.05)
    assert driver.channels[run.port] == robot.host
    assert driver.off("start", zone) == []
    driver.command("start", zone)
    robot.executes()
    robot.completes()
    assert run.end_reason is EndReason.COMPLETED


@pytest.mark.parametrize("skew", [-3600.0, -0.3, 0.0, 0.15, 0.5, 30.0, 1e9])
@pytest.mark.parametrize("host", [FORGER, "10.0.0.2"], ids=["own address", "the robot's address"])
@pytest.mark.parametrize("first", [True, False], ids=["before", "after"])
def test_a_forged_beacon_prevents_no_run(first, host, skew):
    driver = BoxDriver()
    robot, forger = driver.robot(), driver.robot(host=host, skew=skew)
    for _ in range(8):
        for one in (forger, robot) if first else (robot, forger):
            one.beacon()
            driver.run(0.5)
            assert driver.off("connect") == [] or (one is forger and first)
    forger.beacon()
    _conducts(driver, robot)


@pytest.mark.parametrize("host", [FORGER, "10.0.0.2"], ids=["own address", "the robot's address"])
def test_it_prevents_no_later_run_either(host):
    driver = BoxDriver(competition(tbm=["HGTKMH", "HGTKMH"]))
    robot, forger = driver.robot(), driver.robot(host=host, skew=60.0)
    robot.beacon()
    _conducts(driver, robot)
    for _ in range(10):
        forger.beacon()
        robot.says(after=1.0)
    driver.command("disconnect")
    forger.beacon()
    [seen] = document.robots(driver.box, driver.now).values()
    assert seen.skew == 0.0, "it used the password just now"
    driver.run(0.2)
    robot.beacon()
    _conducts(driver, robot)


def test_a_robot_takes_part_in_a_run_of_all_robots_whatever_is_forged():
    driver = all_robots_box()
    robot, forger = driver.robot(), driver.robot(host=FORGER, skew=60.0)
    for _ in range(3):
        forger.beacon()
        robot.beacon()
        driver.run(1.0)
    assert driver.box.candidates.outsiders(driver.now, driver.box.zones["tbm"]) == []
    driver.command("connect")
    assert [member.robot.robot for member in driver.run_in().members()] == ["r1"]


def test_a_wrong_clock_of_the_robot_itself_is_still_seen_before_connect():
    driver = BoxDriver()
    robot = driver.robot(skew=0.15)
    robot.beacon(5)
    assert "Clock skew of robot r1 of team Alpha is +0.150 s" in driver.off("connect")[0]
    robot.skew = 0.0
    robot.beacon(2)
    assert driver.off("connect") == []


def test_start_takes_the_clock_of_encrypted_messages_only():
    driver = BoxDriver()
    robot, forger = driver.robot(skew=0.5), driver.robot(host=FORGER)
    robot.beacon()
    forger.beacon(3)
    driver.command("connect")
    robot.port = driver.run_in().port
    robot.lives(3)
    assert any("Clock skew of the robot is +0.500 s" in reason for reason in driver.off("start"))


def test_a_forged_beacon_does_not_hide_that_a_robot_has_disappeared():
    driver = BoxDriver()
    robot, forger = driver.executing(), driver.robot(host=FORGER)
    robot.lives(2)
    for _ in range(12):
        driver.run(1.0)
        forger.beacon()
    assert driver.view().warnings[0].startswith("The robot has disappeared: no message for 10 s")
    robot.beacon()
    assert "but its beacons arrive" in driver.view().warnings[0]


def test_both_addresses_and_the_remedy_are_shown():
    driver = BoxDriver()
    robot, forger = driver.robot(), driver.robot(host=FORGER, skew=60.0)
    forger.beacon()
    robot.beacon()
    text = (f"Two robots call themselves r1 of team Alpha: {FORGER} and 10.0.0.2. Connect and start use the one that "
            "knows the password. Give the other one another robot_name, or take it off the network. Their clocks "
            "differ: +60.000 s and +0.000 s")
    assert text in document.box_status(driver.box, driver.now)
    _conducts(driver, robot)
    driver.run(20.0)
    robot.says()
    forger.beacon()
    assert (f"Two robots call themselves r1 of team Alpha: 10.0.0.2 (confirmed by its password) and {FORGER}. "
            in document.box_status(driver.box, driver.now))


def test_many_forged_addresses_are_counted():
    driver = BoxDriver()
    robot = driver.robot()
    for number in range(300):
        driver.robot(host=f"10.1.{number // 250}.{number % 250}", skew=60.0).beacon()
        if number % 20 == 0:
            robot.beacon()
    robot.beacon()
    text = document.box_status(driver.box, driver.now)
    assert "Two robots call themselves r1 of team Alpha: 10.1.0.0 and 10.0.0.2 and " in text
    assert " and 6 more. Connect" in text
    _conducts(driver, robot)


def test_two_clocks_at_one_address_are_reported():
    driver = BoxDriver()
    robot, forger = driver.robot(), driver.robot(skew=60.0)
    for _ in range(3):
        robot.beacon()
        driver.run(0.5)
        forger.beacon()
        driver.run(0.5)
    assert "Beacons of r1 of team Alpha from 10.0.0.2 show two clocks" in document.box_status(driver.box, driver.now)
    assert sum("show two clocks" in text for text in driver.notices(Level.WARNING)) == 1
    driver.run(20.0)
    robot.beacon(10)
    assert document.box_status(driver.box, driver.now) == "OK"


@pytest.mark.parametrize("skews", [[60.0, 60.0, 0.0, 0.0], [0.0, 0.0, 60.0, 60.0], [0.0, -0.9, 0.0, -0.9]])
def test_a_clock_that_is_set_or_a_network_that_delays_is_not_taken_for_two(skews):
    driver = BoxDriver()
    robot = driver.robot()
    for robot.skew in skews:
        robot.beacon()
        driver.run(1.0)
    assert document.box_status(driver.box, driver.now) == "OK"


def test_a_robot_that_knows_the_password_is_connected_rather_than_an_invented_one():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HGTKMH"]))
    ghost, robot = driver.robot(name="a ghost", host=FORGER), driver.robot()
    ghost.beacon()
    driver.run(1.0)
    robot.beacon()
    driver.event(driver.box.act, Target("tbm"), "connect", "", {"robot": robot.name})
    robot.port = driver.run_in().port
    robot.says(RobotState.STOP)
    driver.command("disconnect")
    ghost.beacon()
    _conducts(driver, robot)


@pytest.mark.parametrize("seed", range(5))
def test_runs_of_a_whole_world_with_a_forger(seed):
    """Seeded: a network that loses, doubles, delays and swaps, and a forger with any address and clock."""
    dice = random.Random(seed)
    world = World(competition(tbm=["HGTKMH", "HGTKMH"]),
                  FakeLink(dice, loss=0.2, double=0.2, late=0.2, longest_delay=0.3))
    forger = _Forger(world, dice)
    world.companions.append(forger)
    world.run(2.0)
    robot = world.add_robot(host="10.0.0.2")
    for _ in range(2):
        world.press("connect", limit_s=5.0)
        world.press("start", limit_s=5.0)
        run = world.box.run_in()
        assert world.run_until(lambda run=run: run.phase is Phase.ENDED, 60)
        assert run.end_reason is EndReason.COMPLETED
        assert_legal(world, run.port, robot)
        assert world.box.channels == {run.port: robot.host}
        world.box.command("disconnect")
    assert forger.sent > 50


class _Forger:
    def __init__(self, world, dice):
        self._world, self._dice, self._due, self.sent = world, dice, world.mono, 0

    def deadline(self):
        return self._due

    def poll(self):
        self.sent += 1
        self._due = self._world.mono + self._dice.uniform(0.05, 0.3)
        host = self._dice.choice(["10.0.0.2", "10.0.0.66", f"10.0.1.{self._dice.randrange(250)}"])
        skew = self._dice.choice([0.0, 0.09, 0.15, -0.3, 5.0, -60.0, 3600.0])
        box, now = self._world.box, self._world.box.now
        time = divmod(round((now.utc + skew) * 1e6) * 1000, 10**9)
        box.event(box.box.arrivals.on_robot_beacon, host, "Alpha", "r1", time)
