"""Active robots: their addresses and skews."""

import pytest

from helpers.box_driver import wire
from helpers.competition import UTC0
from roah_rsbb.core.robots import (
    LATE_S,
    MAX_AT_HOST,
    MAX_NAME,
    MAX_OF_TEAM,
    MAX_ROBOTS,
    MAX_STRANGERS,
    ActiveRobots,
    RobotId,
    Squatter,
)
from roah_rsbb.model.clock import Now

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
