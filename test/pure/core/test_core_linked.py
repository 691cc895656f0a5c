"""Box and robots, byte by byte, linked by a network that loses, doubles, delays and swaps datagrams."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.competition import TEAMS, competition, event
from helpers.examples import examples, few
from helpers.linked_world import FakeLink, World, assert_legal
from helpers.module_player import BEAT_S, ScriptedModules
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.modules import OutcomeKind, RequestKind
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx

# They depend on no version. On a second Python, test/pure/robot/test_link.py links box and robot.
pytestmark = pytest.mark.long

STOP, PREPARE, WAITING_RESULT = BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT
TOPICS = {
    "notifications": "/notification", "activation_event": "/activation_event", "visitor": "/visitor",
    "final_command": "/command",
}

LINKS = {
    "perfect": {"jitter": False},
    "swaps a little": {},
    "loses": {"loss": 0.4},
    "doubles": {"double": 0.5},
    "swaps": {"late": 0.5, "longest_delay": 0.3},
    "delays": {"late": 0.3, "longest_delay": 1.5},
    "everything": {"loss": 0.3, "double": 0.3, "late": 0.3, "longest_delay": 1.0},
    "loses most": {"loss": 0.6, "double": 0.2, "late": 0.3, "longest_delay": 0.2},
}


def _world(link, seed, *codes, **of_event):
    config = competition(tbm=[event(code, **of_event) for code in codes])
    return World(config, FakeLink(random.Random(seed), **LINKS[link]))


def _connected(world, zone="tbm", **of_robot):
    robot = world.add_robot(**of_robot)
    world.press("connect", zone)
    return robot


def _ended(world, zone="tbm"):
    return world.box.run_in(zone).phase is Phase.ENDED


@pytest.mark.parametrize("code", ["HGTKMH", "HWV", "HCFGAC"])
@pytest.mark.parametrize("seed", range(few(3)))
@pytest.mark.parametrize("link", LINKS)
def test_every_task_benchmark_completes(link, seed, code):
    world = _world(link, f"{seed}{code}", code)
    robot = _connected(world, skew=random.Random(seed).uniform(-0.05, 0.05))
    world.press("start")
    run = world.box.run_in()
    assert world.run_until(lambda: _ended(world), 300)
    assert run.end_reason is EndReason.COMPLETED
    assert_legal(world, run.port, robot)
    assert robot.tasks >= 1
    assert world.run_until(lambda: robot.session.progress.state is RobotState.STOP, 30)
    assert not [report for report in robot.troubles if report.problem is fx.Problem.UNEXPECTED_STATE]
    world.press("disconnect")
    assert world.run_until(lambda: robot.session.link is None, 30)


def test_on_a_perfect_link_nothing_is_done_twice():
    world = _world("perfect", 0, "HGTKMH")
    robot = _connected(world)
    world.press("start")
    port = world.box.run_in().port
    world.run_until(lambda: _ended(world), 60)
    world.run(2)
    assert world.box_states(port) == [STOP, PREPARE, WAITING_RESULT, STOP]
    assert robot.states == [*RobotState, RobotState.STOP]
    assert robot.troubles == []
    assert world.stale == 0


def test_a_change_is_answered_at_once():
    """Only the network delays the box's answer to a robot's message."""
    world = _world("perfect", 0, "HGTKMH")
    robot = _connected(world, prepare_s=1.0, execute_s=2.0)
    world.press("start")
    started = world.mono
    world.run_until(lambda: robot.tasks, 10)
    assert world.mono - started < 1.0 + 4 * 0.001
    world.run_until(lambda: _ended(world), 10)
    assert world.mono - started < 3.0 + 6 * 0.001


@pytest.mark.parametrize("seed", range(few(3)))
@pytest.mark.parametrize("link", LINKS)
def test_every_string_is_logged_exactly_once(link, seed):
    world = _world(link, seed, "HWV")
    rng = random.Random(seed)
    robot = _connected(world, execute_s=15.0)
    world.press("start")
    port = world.box.run_in().port
    assert world.run_until(lambda: robot.tasks, 60)
    said = _says_strings(world, robot, rng)
    assert world.run_until(lambda: robot.session.link.strings_pending == 0, 120)
    assert {field: world.box.logged(port, topic) for field, topic in TOPICS.items()} == said


def _says_strings(world, robot, rng):
    """The robot sends 25 strings, many of them repeatedly. Returns them by field."""
    said = {field: [] for field in TOPICS}
    for _ in range(25):
        field = rng.choice(sorted(TOPICS))
        said[field].append(rng.choice(["ring", "deli man", "postman"]))
        robot.session.add_string(field, said[field][-1])
        world.run(rng.choice([0.0, 0.01, 0.3]))
    return said


@pytest.mark.parametrize("seed", range(few(5)))
def test_stale_datagrams_come_and_move_nothing(seed):
    """The world itself checks the effect of each stale message: see `World._at_box`."""
    world = _world("everything", seed, "HWV")
    _connected(world)
    world.press("start")
    world.run(20)
    assert world.stale > 5


@pytest.mark.parametrize("seed", range(few(4)))
def test_stop_and_start_again(seed):
    world = _world("everything", seed, "HGTKMH")
    robot = _connected(world, execute_s=8.0)
    port = world.box.run_in().port
    for _ in range(3):
        world.press("start")
        assert world.run_until(lambda: world.box.box_state() is WAITING_RESULT, 60)
        world.run(1.0)
        world.press("stop")
        assert world.run_until(lambda: robot.session.progress.state is RobotState.STOP, 30)
    world.press("start")
    assert world.run_until(lambda: _ended(world), 120)
    assert world.box.run_in().end_reason is EndReason.COMPLETED
    assert_legal(world, port, robot)


@pytest.mark.parametrize("when", [0.5, 1.5, 4.0])
def test_a_robot_that_crashes_and_comes_back_completes(when):
    world = _world("everything", 1, "HGTKMH")
    robot = _connected(world)
    world.press("start")
    world.run(when)
    robot.crash()
    assert world.run_until(lambda: _ended(world), 120)
    assert world.box.run_in().end_reason is EndReason.COMPLETED


@pytest.mark.parametrize("skew", [-5.0, -0.9, 5.0, 3600.0])
def test_a_robot_whose_clock_is_set_in_the_middle_completes(skew):
    world = _world("loses", 3, "HWV")
    robot = _connected(world, execute_s=10.0)
    world.press("start")
    port = world.box.run_in().port
    assert world.run_until(lambda: robot.tasks, 60)
    said = _says_strings(world, robot, random.Random(skew))
    robot.set_clock(skew)
    assert world.run_until(lambda: _ended(world) and robot.session.link.strings_pending == 0, 120)
    assert world.box.run_in().end_reason is EndReason.COMPLETED
    assert {field: world.box.logged(port, topic) for field, topic in TOPICS.items()} == said


def test_two_zones_at_once():
    config = competition(a=["HWV"], b=[event("HGTKMH", team="Beta")])
    world = World(config, FakeLink(random.Random(5), **LINKS["everything"]))
    one = _connected(world, "a")
    two = _connected(world, "b", team="Beta", execute_s=9.0)
    world.press("start", "a")
    world.press("start", "b")
    assert world.run_until(lambda: _ended(world, "a") and _ended(world, "b"), 120)
    for zone, robot in (("a", one), ("b", two)):
        run = world.box.run_in(zone)
        assert run.end_reason is EndReason.COMPLETED
        assert_legal(world, run.port, robot)


BAD = {"loss": 0.25, "double": 0.3, "late": 0.3, "longest_delay": 0.8}
EVENT = {"team": "ALL", "timeout": 120.0, "scoring": ()}


def _world_of_all(seed, teams, link=None):
    """A box with all robots connected; their tasks take up to 20 s."""
    config = competition(teams=teams, tbm=[event("HSUF", **EVENT)])
    world = World(config, FakeLink(random.Random(seed), **(link or {})))
    rng = random.Random(seed)
    for team in teams:
        world.add_robot(team, skew=rng.uniform(-0.03, 0.03), execute_s=rng.uniform(2.0, 20.0))
    ready = f"{len(teams)} robots ready"
    assert world.run_until(lambda: ready in world.box.view().state, 300), world.box.view().state
    world.press("connect")
    return world


def _started(world):
    world.press("start")
    return world.box.run_in()


@pytest.mark.parametrize("seed", range(few(4)))
def test_all_complete_on_a_bad_link(seed):
    world = _world_of_all(seed, TEAMS, BAD)
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


@pytest.mark.parametrize("seed", range(few(3)))
def test_stop_reaches_all_and_all_start_again(seed):
    world = _world_of_all(seed, TEAMS, BAD)
    run = _started(world)
    assert world.run_until(lambda: run.counts().executing == 3, 60)
    world.press("stop")
    stopped = [RobotState.STOP] * 3
    assert world.run_until(lambda: [r.session.progress.state for r in world.robots] == stopped, 30)
    _started(world)
    assert world.run_until(lambda: run.phase is Phase.ENDED, 60)
    assert run.end_reason is EndReason.COMPLETED


WAYPOINTS = [(RequestKind.GOAL, {"goal": f"[{i}, 0, 0]", "pose": (float(i), 0.0, 0.0)}) for i in range(3)]
NO_GOALS = [(RequestKind.GOAL, {}), (RequestKind.NOTE, {"note": "1"}), (RequestKind.GOAL, {})]
LINK = st.fixed_dictionaries({
    "loss": st.floats(0, 0.45), "double": st.floats(0, 0.5), "late": st.floats(0, 0.5),
    "longest_delay": st.floats(0.01, 1.5), "jitter": st.booleans(),
})


class LinkedModules(ScriptedModules):
    """Modules that publish twice a second and are sometimes missing."""

    def __init__(self, world, code, script):
        super().__init__(world.box, code, script)
        self.world = world
        self.next_mono = world.mono

    def deadline(self):
        return self.next_mono

    def poll(self):
        self.next_mono = self.world.mono + BEAT_S
        self.proceed()

    def crash(self, seconds):
        """End the process. Another one starts after this many seconds."""
        self.next_mono = self.world.mono + seconds
        self.node += "'"


def world_of(code, script, link, **kwargs):
    settings = Settings(check_messages_saved=False)
    world = World(competition(tbm=[event(code, timeout=120.0, total_timeout=600.0)]), link, settings)
    modules = LinkedModules(world, code, script)
    world.companions.append(modules)
    return world, modules, world.add_robot(**kwargs)


def completed(world):
    return world.run_until(lambda: world.box.run_in().phase is Phase.ENDED, 590)


@examples(25)
@given(LINK, st.integers(0, 2**32), st.sampled_from(["HNF", "HOPF"]), st.floats(0.01, 2), st.floats(0.01, 6))
def test_every_goal_is_done_once_on_every_link(link, seed, code, prepare_s, execute_s):
    script = WAYPOINTS if code == "HNF" else NO_GOALS
    world, _, robot = world_of(code, script, FakeLink(random.Random(seed), **link), prepare_s=prepare_s,
                               execute_s=execute_s)
    world.press("connect", limit_s=300)
    port = world.box.run_in().port
    world.press("start", limit_s=300)
    assert completed(world)
    run = world.box.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert [step.request.kind for step in run.steps] == [kind for kind, _ in script]
    assert all(step.outcome.kind is OutcomeKind.DONE for step in run.steps)
    assert_legal(world, port, robot, explicit_goal=code == "HNF")


@examples(25)
@given(st.integers(0, 2**32), st.lists(st.tuples(st.floats(0.1, 8), st.floats(0.1, 10)), min_size=1, max_size=4))
def test_a_run_survives_modules_that_crash_again_and_again(seed, crashes):
    world, modules, _ = world_of("HNF", WAYPOINTS, FakeLink(random.Random(seed)))
    world.press("connect")
    world.press("start")
    for after, away in crashes:
        world.run(after)
        modules.crash(away)
        world.run(away)
    assert completed(world)
    run = world.box.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert [step.request.goal for step in run.steps] == [fields["goal"] for _, fields in WAYPOINTS]
