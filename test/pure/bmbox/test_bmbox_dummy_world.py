"""The simulated test bed: movements, times and errors."""

import math

import pytest

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, angle_difference, distance, seen_from
from roah_rsbb.bmbox.host.dummy_world import EDGE_M, FOLLOW_M, TABLE, TABLE_SIZE, TARGET_AREA, DummyWorld
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
