"""HSUF on links that lose, double, delay and swap datagrams: box and robots, byte by byte."""

import random

import pytest

from helpers.competition import TEAMS, competition, event
from helpers.examples import few
from helpers.linked_world import FakeLink, World, assert_legal
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import RobotState

BAD = {"loss": 0.25, "double": 0.3, "late": 0.3, "longest_delay": 0.8}
EVENT = {"team": "ALL", "timeout": 120.0, "scoring": ()}


def _world(seed, teams, link=None, max_datagram=1024, longest_s=20.0):
    """A box with all robots connected; their tasks take up to `longest_s`."""
    config = competition(teams=teams, tbm=[event("HSUF", **EVENT)])
    world = World(config, FakeLink(random.Random(seed), **(link or {})), Settings(max_datagram=max_datagram))
    rng = random.Random(seed)
    for team in teams:
        world.add_robot(team, skew=rng.uniform(-0.03, 0.03), execute_s=rng.uniform(2.0, longest_s))
    ready = f"{len(teams)} robots ready"
    assert world.run_until(lambda: ready in world.box.view().state, 300), world.box.view().state
    world.press("connect")
    return world


def _started(world):
    world.press("start")
    return world.box.run_in()


@pytest.mark.long
@pytest.mark.parametrize("seed", range(few(4)))
def test_all_complete_on_a_bad_link(seed):
    world = _world(seed, TEAMS, BAD)
    run = _started(world)
    members = run.members()
    assert world.run_until(lambda: run.phase is Phase.ENDED, 110)
    assert run.end_reason is EndReason.COMPLETED
    for member, robot in zip(members, world.robots):
        assert member.robot == (robot.team, robot.name)
        assert member.end_reason is EndReason.COMPLETED
        assert_legal(world, member.port, robot)
    world.press("disconnect")
    assert world.run_until(lambda: all(robot.port is None for robot in world.robots), 30)


@pytest.mark.long
def test_thirty_robots_complete():
    # Without jitter many datagrams arrive at the same time, so that there are fewer moments to simulate.
    world = _world(1, [f"Team{i:02}" for i in range(30)], {"jitter": False}, max_datagram=2000, longest_s=6.0)
    run = _started(world)
    assert world.run_until(lambda: run.phase is Phase.ENDED, 60)
    assert run.desc == "All robots have ended (30 completed)"
    assert all(robot.tasks == 1 for robot in world.robots)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(few(3)))
def test_a_robot_that_crashes_and_returns_starts_again_and_the_others_do_not(seed):
    world = _world(seed, TEAMS)
    run = _started(world)
    assert world.run_until(lambda: all(robot.tasks for robot in world.robots), 30)
    world.robots[1].crash()
    assert world.run_until(lambda: run.phase is Phase.ENDED, 60)
    assert run.end_reason is EndReason.COMPLETED
    assert [robot.tasks for robot in world.robots] == [1, 2, 1]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(few(3)))
def test_stop_reaches_all_and_all_start_again(seed):
    world = _world(seed, TEAMS, BAD)
    run = _started(world)
    assert world.run_until(lambda: run.counts().executing == 3, 60)
    world.press("stop")
    stopped = [RobotState.STOP] * 3
    assert world.run_until(lambda: [r.session.progress.state for r in world.robots] == stopped, 30)
    _started(world)
    assert world.run_until(lambda: run.phase is Phase.ENDED, 60)
    assert run.end_reason is EndReason.COMPLETED


@pytest.mark.long
def test_a_robot_that_leaves_before_the_start_does_not_block_it():
    world = _world(1, TEAMS)
    gone = world.robots.pop(0)
    world.run(4.0)
    run = _started(world)
    assert world.run_until(lambda: run.phase is Phase.ENDED, 60)
    assert run.desc == "All robots have ended (2 completed)"
    assert gone.tasks == 0


@pytest.mark.long
def test_the_timeout_reaches_all():
    world = _world(2, TEAMS, BAD)
    for robot in world.robots[1:]:
        robot.execute_s = 1000.0
    run = _started(world)
    assert world.run_until(lambda: run.phase is Phase.ENDED, 130)
    assert run.end_reason is EndReason.TIMEOUT
    stopped = [RobotState.STOP] * 3
    assert world.run_until(lambda: [r.session.progress.state for r in world.robots] == stopped, 30)
