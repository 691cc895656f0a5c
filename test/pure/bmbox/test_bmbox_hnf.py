"""HNF's rules, with scores worked out by hand."""

import math

import pytest

from helpers.forms import form
from helpers.rehearsed import assert_restarts_change_nothing
from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.hnf import HNF, mean_angle

WAYPOINTS = [Pose2D(1.0, 0.0, 0.0), Pose2D(2.0, 2.0, math.pi), Pose2D(0.0, 0.0, -math.pi / 2)]


ORIGIN = Pose3(0.0, 0.0, 0.0, 0.0)


def hnf(robot=ORIGIN):
    parameters = {"starting_pose": Pose2D(0.5, -0.25, math.pi / 2), "waypoints": WAYPOINTS, "goal_timeout": 120.0}
    return Rehearsal(HNF, parameters, Poses(robot=robot))


def test_waypoints_go_out_in_both_forms_with_the_timeout():
    r = hnf()
    assert r.asked.text == "Place the robot at the starting pose: x 0.50 m, y -0.25 m, 90°"
    r.answer()
    assert (r.asked.goal, r.asked.pose, r.asked.timeout) == ("[1.0, 0.0, 0.0]", (1.0, 0.0, 0.0), 120.0)
    assert r.module.status == "Waypoint 1 of 3: x 1.00 m, y 0.00 m, 0°"


def test_a_whole_run():
    r = hnf(robot=Pose3(1.3, 0.4, 0.2, 0.1))
    r.answer()
    r.result(seconds=10.0)  # 0.3 and 0.4 m off: 0.5 m; 0.1 rad
    r.truth.subjects["robot"] = Pose3(2.0, 2.1, 0.2, -math.pi + 0.3)
    r.result(seconds=20.0)  # 0.1 m; from π to −π + 0.3 are 0.3 rad, not 5.98
    r.truth.subjects["robot"] = Pose3(3.0, 4.0, 0.2, math.pi / 2)
    r.time_out(seconds=90.0)  # 5 m; π rad
    assert r.finished
    s = r.score
    assert (s["reached"], s["timed_out"], s["execution_time"]) == (2, 1, 120.0)
    assert s.each("distance_error") == pytest.approx([0.5, 0.1, 5.0])
    assert s.each("orientation_error") == pytest.approx([0.1, 0.3, math.pi])
    assert s.each("timed_out") == [False, False, True]
    assert s.each("time") == [10.0, 20.0, 90.0]
    # Of those reached only: (0.5 + 0.1) / 2; the mean direction of 0.1 and 0.3 rad is 0.2 rad.
    assert s["position_accuracy"] == pytest.approx(0.3)
    assert s["orientation_accuracy"] == pytest.approx(0.2)


@pytest.mark.parametrize("errors, mean", [
    ([0.0], 0.0), ([0.1, 0.3], 0.2), ([math.pi / 2, math.pi / 2], math.pi / 2), ([math.pi], math.pi),
    # sin 0 + sin π/2 = 1, cos 0 + cos π/2 = 1
    ([0.0, math.pi / 2], math.pi / 4),
    # Without a sign they do not cancel out: 0.4 to the left and 0.4 to the right are 0.4 off.
    ([-0.4, 0.4], 0.4),
])
def test_the_mean_of_angles(errors, mean):
    assert mean_angle(errors) == pytest.approx(mean)


def test_all_waypoints_timed_out():
    r = hnf()
    r.answer()
    for seconds in (60.0, 60.0, 0.0):  # the last one in PREPARE: it never drove
        r.time_out(seconds)
    s = r.score
    assert (r.finished, s["reached"], s["timed_out"], s["execution_time"]) == (True, 0, 3, 120.0)
    assert (s["position_accuracy"], s["orientation_accuracy"]) == (None, None)
    assert s.each("distance_error") == pytest.approx([1.0, math.hypot(2, 2), 0.0])


def test_an_unseen_robot_is_asked_for_again():
    r = hnf()
    r.answer()
    r.truth.subjects["robot"] = None
    r.result(seconds=5.0)
    assert (r.asked.text, r.asked.form) == (
        "The pose of robot is not available. Solve the problem, then try again", form("Try again", "Skip")
    )
    r.answer("Try again")
    assert r.asked.form == form("Try again", "Skip")
    r.truth.subjects["robot"] = Pose3(1.0, 0.0, 0.0, 0.0)
    r.answer()
    assert r.score["waypoint 1", "distance_error"] == 0.0
    assert r.asked.pose == WAYPOINTS[1]


def test_a_pose_that_is_skipped_is_never_invented():
    r = hnf(robot=None)
    r.answer()
    r.result(seconds=5.0)
    r.answer("Skip")
    assert r.asked.pose == WAYPOINTS[1]
    r.truth.subjects["robot"] = Pose3(2.0, 2.5, 0.0, math.pi)
    r.result(seconds=6.0)
    s = r.score
    assert (s["reached"], s["waypoint 1", "distance_error"]) == (2, None)
    assert s["position_accuracy"] == pytest.approx(0.5), "of the one that was measured"


def test_a_restart_anywhere_changes_no_score():
    def acts(r):
        robot = r.truth.subjects
        return [
            r.answer, lambda: r.result(seconds=3.0), lambda: robot.update(robot=Pose3(2.0, 1.0, 0.0, 3.0)),
            lambda: r.result(seconds=4.0), lambda: robot.update(robot=None), lambda: r.time_out(50.0),
            lambda: r.answer("Try again"), lambda: robot.update(robot=Pose3(5.0, 5.0, 0.0, 1.0)), r.answer,
        ]

    assert_restarts_change_nothing(hnf, acts)
