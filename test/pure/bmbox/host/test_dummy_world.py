"""The simulated test bed: movements, times and errors."""

import math

import pytest

from roah_rsbb.bmbox.framework.ground_truth import NoPose, Pose2D, Pose3, angle_difference, distance, seen_from
from roah_rsbb.bmbox.host.dummy_world import (
    EDGE_M,
    FOLLOW_M,
    ROBOT_HOME,
    STEP_S,
    TABLE,
    TABLE_SIZE,
    TARGET_AREA,
    DummyFrames,
    DummyWorld,
)
from roah_rsbb.bmbox.host.ground_truth_of_frames import KEPT_S, FramesGroundTruth, GroundTruthConfig, Marker
from roah_rsbb.model.modules import OutcomeKind, Request, RequestKind, RequestOutcome, RunForModule, Step


class World:
    """A dummy world, and the one run that it sees, in steps of a twentieth of a second."""

    def __init__(self, benchmark, seed=0):
        self.world = DummyWorld(seed)
        self.now_s = 0.0
        self.run = RunForModule("run", 1, "zone", benchmark, "Team", 1, 1, running=True)

    def pass_time(self, seconds):
        for _ in range(round(seconds * 20)):
            self.world.step(self.now_s, [self.run])
            self.now_s += 0.05
        return self.world.poses()

    def asks(self, kind, seconds=1.0, **fields):
        steps = tuple(step._replace(outcome=RequestOutcome(OutcomeKind.DONE)) for step in self.run.steps)
        request = Request(len(steps) + 1, kind, **fields)
        self.run = self.run._replace(steps=(*steps, Step(request)), told_utc=0.0)
        return self.pass_time(seconds)

    def executes(self, seconds=2.5):
        self.run = self.run._replace(told_utc=1.8e9)
        return self.pass_time(seconds)


def test_all_that_rules_ask_for_is_there():
    assert set(DummyWorld().poses()) == {"robot", "person", "positioner", "object", "table"}


def test_the_robot_drives_to_a_waypoint_when_it_must_execute():
    w = World("HNF")
    before = w.asks(RequestKind.GOAL, pose=(4.0, 3.0, 3.0))["robot"]
    assert w.pass_time(3.0)["robot"] == before  # it only prepares
    after = w.executes()["robot"]
    assert 0.0 < distance(after, Pose2D(4.0, 3.0, 0.0)) < 0.2
    assert 0.0 < abs(angle_difference(after.theta, 3.0)) < 0.3
    assert w.pass_time(1.0)["robot"] == after


def test_it_is_on_its_way_and_does_not_jump():
    w = World("HNF")
    last = w.asks(RequestKind.GOAL, pose=(4.0, 3.0, 3.0))["robot"]
    for _ in range(50):
        now = w.executes(0.05)["robot"]
        assert distance(now, last) <= 3.0 * 0.05 + 1e-9
        last = now


def test_the_robot_follows_the_person():
    w = World("HPFF")
    w.asks(RequestKind.GOAL)
    w.executes(8.0)
    last = w.executes(0.5)["robot"]
    for _ in range(100):
        poses = w.executes(0.5)
        robot, person = poses["robot"], poses["person"]
        assert distance(robot, person) == pytest.approx(FOLLOW_M, abs=0.2)
        assert distance(robot, last) < 0.8  # it goes at the person's pace
        to_person = math.atan2(person.y - robot.y, person.x - robot.x)
        assert abs(angle_difference(robot.theta, to_person)) < 0.4  # and looks at the person
        last = robot


def test_the_person_walks():
    w = World("HPFF")
    w.pass_time(20.0)
    before = w.pass_time(0.05)["person"]
    after = w.pass_time(1.0)["person"]
    assert 0.4 < distance(before, after) < 0.6
    assert w.pass_time(1.0)["person"] != after


def test_people_stand_in_the_target_area():
    w = World("HPPF")
    places = []
    for _ in range(2):
        places.append(w.asks(RequestKind.REFEREE)["person"])
        w.asks(RequestKind.GOAL)
        assert w.executes(3.0)["person"] == places[-1]  # still
    assert places[0] != places[1]
    assert all(distance(place, TARGET_AREA) < 1.0 for place in places)


@pytest.mark.parametrize("benchmark, subject", [("HOPF", "positioner"), ("HGMF", "object")])
def test_the_referee_puts_things_onto_the_table(benchmark, subject):
    w = World(benchmark)
    places = [seen_from(TABLE, w.asks(RequestKind.REFEREE)[subject]) for _ in range(20)]
    assert len(set(places)) == 20
    for place in places:
        assert EDGE_M <= place.x <= TABLE_SIZE[0] - EDGE_M
        assert EDGE_M <= place.y <= TABLE_SIZE[1] - EDGE_M


def test_a_pose_that_is_noted_moves_nothing():
    w = World("HOPF")
    before = w.asks(RequestKind.REFEREE)["positioner"]
    assert w.asks(RequestKind.NOTE)["positioner"] == before


def test_an_object_rises_and_moves_to_its_target():
    w = World("HGMF")
    lying = w.asks(RequestKind.REFEREE)["object"]
    assert w.asks(RequestKind.GOAL, pose=(0.3, 0.2, 0.0), seconds=3.0)["object"] == lying
    assert w.executes(0.7)["object"].z > lying.z + 0.03
    left = []
    for _ in range(7):
        now = seen_from(TABLE, w.executes(0.2)["object"])
        left.append(math.hypot(now.x - 0.3, now.y - 0.2))
    assert left[0] > left[3] > left[-1]
    end = w.executes(0.6)["object"]
    assert end.z == lying.z
    off = seen_from(TABLE, end)
    assert 0.0 < math.hypot(off.x - 0.3, off.y - 0.2) < 0.15
    # It stays there when the goal is over.
    assert w.asks(RequestKind.NOTE)["object"] == end


def test_the_same_seed_is_the_same_world():
    def play(seed):
        w = World("HNF", seed)
        w.asks(RequestKind.GOAL, pose=(2.0, 1.0, 0.0))
        return w.executes()

    assert play(1) == play(1)
    assert play(1) != play(2)


def test_a_new_attempt_is_noticed():
    w = World("HOPF")
    before = w.asks(RequestKind.REFEREE)["positioner"]
    w.run = w.run._replace(attempt=2)
    assert w.pass_time(0.1)["positioner"] != before


def test_without_a_run_only_the_person_moves():
    world = DummyWorld()
    world.step(0.0, [])
    before = world.poses()
    world.step(0.5, [RunForModule("run", 1, "zone", "HNF", "Team", 1, 1, running=False)])
    after = world.poses()
    assert {name for name in before if before[name] != after[name]} == {"person"}


def test_a_clock_that_jumps_moves_nothing_far():
    w = World("HNF")
    w.asks(RequestKind.GOAL, pose=(4.0, 3.0, 3.0))
    before = w.executes(0.1)["robot"]
    for now_s in (-1000.0, 1e9):
        w.now_s = now_s
        after = w.pass_time(0.05)["robot"]
        assert distance(before, after) <= 3.0 + 1e-9


def test_in_a_benchmark_of_a_competition_everything_moves_that_rules_may_ask_for():
    w = World("FetchMug")
    before = w.pass_time(1.0)
    after = w.asks(RequestKind.REFEREE, text="Place the mug, and ask Annie to enter")
    assert all(before[subject] != after[subject] for subject in ("positioner", "object", "person"))
    assert distance(after["person"], TARGET_AREA) < 1.0
    assert w.pass_time(2.0) == after, "the person keeps the place"
    w.asks(RequestKind.GOAL, pose=(4.0, 3.0, 3.0))
    assert distance(w.executes()["robot"], Pose2D(4.0, 3.0, 0.0)) < 0.2


# -- simulated frames: what they show now and before, and what moves them -----------------------------

ON_TOP = Pose3(0.0, 0.0, -1.2, math.pi / 2)
CONFIG = GroundTruthConfig(
    "testbed", 0.5, {"robot": Marker("m_robot"), "table": Marker("m_table"), "cat": Marker("m_cat")},
    {"Reds": {"robot": Marker("m_robot", ON_TOP)}})
FAR = (7.0, 1.0, 0.0)
DRIVES = RunForModule("HNF-1", 1, "zone", "HNF", "Reds", 1, 1, True, told_utc=1000.0, steps=(
    Step(Request(1, RequestKind.GOAL, pose=FAR)),))


class Simulated:
    """The frames at the test's time."""

    def __init__(self):
        self.utc = 1000.0
        self.frames = DummyFrames(1, lambda: self.utc)
        self.truth = FramesGroundTruth(CONFIG, self.frames)


@pytest.fixture
def simulated():
    return Simulated()


def test_subjects_are_seen_at_once_through_their_markers(simulated):
    assert simulated.truth.pose("table") == TABLE
    assert simulated.truth.pose("robot") == ROBOT_HOME
    assert simulated.truth.check(["robot", "table"]) == ([], [])


def test_a_shared_marker_is_on_the_robot_of_the_running_team(simulated):
    simulated.truth.take([DRIVES])
    assert tuple(simulated.truth.for_team("Reds").pose("robot")) == pytest.approx(ROBOT_HOME)
    assert simulated.truth.pose("robot").z == pytest.approx(1.2), "of other robots, it is not on the ground"


def test_what_the_world_does_not_have_is_named(simulated):
    with pytest.raises(NoPose, match="^cat: frame 'm_cat' was never seen: the simulated motion capture has robot, per"):
        simulated.truth.pose("cat")


def test_the_robot_drives_and_its_way_can_be_looked_up(simulated):
    robot = simulated.truth.for_team("Reds")
    simulated.truth.take([DRIVES])
    simulated.utc += 1.0
    assert robot.pose("robot").x == pytest.approx(ROBOT_HOME.x + 3.0, abs=3.0 * 2 * STEP_S)
    simulated.utc += 3.0
    assert robot.pose("robot").x == pytest.approx(FAR[0], abs=0.2)
    assert robot.pose("robot", 1001.0).x == pytest.approx(ROBOT_HOME.x + 3.0, abs=3.0 * 2 * STEP_S)
    assert robot.pose("robot", 1000.0).x == ROBOT_HOME.x


def test_only_the_last_seconds_are_kept(simulated):
    for _ in range(3):
        simulated.utc += KEPT_S / 2
        simulated.truth.pose("robot")
    assert simulated.frames.gap("m_robot", 1000.0) == pytest.approx(KEPT_S / 2, abs=2 * STEP_S)
    with pytest.raises(NoPose, match="was not seen at"):
        simulated.truth.pose("robot", 1000.0)


@pytest.mark.parametrize("jump_s", [-3600.0, -0.01, 86400.0])
def test_a_clock_that_jumps_costs_no_pose(simulated, jump_s):
    simulated.truth.take([DRIVES])
    simulated.utc += 1.0
    simulated.truth.pose("robot")
    simulated.utc += jump_s
    assert simulated.truth.check(["robot", "table"]) == ([], [])
    assert simulated.truth.pose("table") == TABLE
    assert len(simulated.frames._kept) < 60


def test_another_configuration_takes_effect_at_once(simulated):
    simulated.truth.use(CONFIG._replace(markers={"robot": Marker("m_new")}, teams={}))
    assert simulated.truth.pose("robot") == ROBOT_HOME
