"""Simulated frames: what they show now and before, and what moves them."""

import math

import pytest

from roah_rsbb.bmbox.framework.ground_truth import NoPose, Pose3
from roah_rsbb.bmbox.host.dummy_world import ROBOT_HOME, STEP_S, TABLE, DummyFrames
from roah_rsbb.bmbox.host.ground_truth_of_frames import KEPT_S, FramesGroundTruth, GroundTruthConfig, Marker
from roah_rsbb.model.modules import Request, RequestKind, RunForModule, Step

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
