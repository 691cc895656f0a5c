"""Planar poses, worked out by hand."""

import math

import pytest

from roah_rsbb.bmbox.framework.ground_truth import (
    NO_TRANSFORM,
    GroundTruth,
    Pose2D,
    Pose3,
    angle_difference,
    compose,
    distance,
    inverse,
    rotation,
    seen_from,
    yaw,
)

PI = math.pi


def assert_same(pose, expected):
    assert pose[:3] == pytest.approx(expected[:3], abs=1e-9)
    assert angle_difference(pose[3], expected[3]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("outer, inner, result", [
    # Turned by nothing: (1 + 3, 2 + 4).
    (Pose3(1, 2, 0.5, 0), Pose3(3, 4, 0.25, 0.1), Pose3(4, 6, 0.75, 0.1)),
    # A quarter turn to the left makes (3, 4) to (-4, 3): (1 - 4, 2 + 3).
    (Pose3(1, 2, 0, PI / 2), Pose3(3, 4, 0, PI / 4), Pose3(-3, 5, 0, 3 * PI / 4)),
    # Half a turn makes (1, 0) to (-1, 0); 3π/4 + π is -π/4.
    (Pose3(0, 0, 0, PI), Pose3(1, 0, 0, 3 * PI / 4), Pose3(-1, 0, 0, -PI / 4)),
    # An eighth: (√2, 0) to (1, 1).
    (Pose3(10, 20, 0, PI / 4), Pose3(math.sqrt(2), 0, 0, 0), Pose3(11, 21, 0, PI / 4)),
])
def test_compose(outer, inner, result):
    assert_same(compose(outer, inner), result)


def test_inverse():
    # From a frame at (1, 2) turned to the left by a quarter, the origin is 2 m behind and 1 m to the left:
    # R(-π/2)·(-1, -2) = (-2, 1).
    assert_same(inverse(Pose3(1, 2, 3, PI / 2)), Pose3(-2, 1, -3, -PI / 2))
    for pose in (Pose3(1, 2, 3, 2.5), Pose3(-4, 0.5, 0, -3.1), NO_TRANSFORM):
        assert_same(compose(pose, inverse(pose)), NO_TRANSFORM)
        assert_same(compose(inverse(pose), pose), NO_TRANSFORM)


def test_seen_from():
    # The table's corner is at (4, 1), turned by a quarter to the left; (3, 3) is 1 m in -x and 2 m in y of it:
    # along the table's x (world's y) 2 m, along its y (world's -x) 1 m.
    assert_same(seen_from(Pose3(4, 1, 0.8, PI / 2), Pose3(3, 3, 1.0, PI)), Pose3(2, 1, 0.2, PI / 2))


@pytest.mark.parametrize("a, b, difference", [
    (0.3, 0.1, 0.2), (0.1, 0.3, -0.2),
    # 3.1 to -3.1 is the short way over π: 2π - 6.2.
    (3.1, -3.1, 6.2 - 2 * PI), (-3.1, 3.1, 2 * PI - 6.2),
    (5 * PI / 2, 0, PI / 2), (0.1, 0.1 + 20 * PI, 0.0),
])
def test_angle_difference(a, b, difference):
    assert angle_difference(a, b) == pytest.approx(difference, abs=1e-9)


def test_distance_is_planar():
    assert distance(Pose3(0, 0, 0, 0), Pose3(3, 4, 12, 1)) == 5.0
    assert distance(Pose2D(1, 1, 0), Pose3(1, 2, 9, 0)) == 1.0


@pytest.mark.parametrize("quaternion, angle", [
    ((0, 0, 0, 1), 0.0),
    ((0, 0, 1, 0), PI),
    # sin and cos of half of a quarter turn, and the same not normalised.
    ((0, 0, math.sqrt(0.5), math.sqrt(0.5)), PI / 2),
    ((0, 0, -2, 2), -PI / 2),
    # A marker that leans (a third of a radian about its x) after a turn of 1 rad about z: the yaw is still 1.
    ((math.cos(0.5) * math.sin(1 / 6), math.sin(0.5) * math.sin(1 / 6),
      math.sin(0.5) * math.cos(1 / 6), math.cos(0.5) * math.cos(1 / 6)), 1.0),
])
def test_yaw(quaternion, angle):
    assert yaw(quaternion) == pytest.approx(angle)


@pytest.mark.parametrize("quaternion", [(0, 0, 0, 0), (0, 0, math.nan, 1), (0, math.inf, 0, 1)])
def test_no_rotation(quaternion):
    with pytest.raises(ValueError, match="is not a rotation"):
        yaw(quaternion)


@pytest.mark.parametrize("angle", [0.0, 1.0, -3.0, PI / 2])
def test_rotation_is_the_way_back_from_yaw(angle):
    assert yaw(rotation(angle)) == pytest.approx(angle)


def test_without_teams_of_its_own_ground_truth_is_the_same_for_all():
    truth = GroundTruth()
    assert truth.for_team("Team") is truth
