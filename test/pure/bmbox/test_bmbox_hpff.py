"""HPFF's rules, with scores worked out by hand."""

from types import SimpleNamespace

import pytest

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.hpff import HPFF, add_sample, is_failed

LIMITS = {"minimum_distance": 0.15, "maximum_distance": 3.5, "desired_distance": 2.0, "goal_timeout": 300.0}

ROBOT, PERSON = Pose3(0.0, 0.0, 0.0, 0.0), Pose3(2.0, 0.0, 1.8, 0.0)
STEP = 0.125  # seconds; sums of them are exact


def hpff(robot=ROBOT, person=PERSON, **limits):
    return Rehearsal(HPFF, {**LIMITS, **limits}, Poses(robot=robot, person=person))


def times_out(r):
    """The goal ends with its timeout, 300 s after the start."""
    r.utc = r.run.steps[0].outcome.ended_utc + 300.0
    r.time_out(290.0)


class Sums:
    """The sums of samples half a second apart."""

    def __init__(self):
        self.sums = {"samples": 0, "both": 0, "deviation": 0.0, "covered": 0.0, "last": None, "last_s": 0.0}
        self.at_s = 8.0
        self.parameters = SimpleNamespace(**LIMITS)

    def add(self, robot_x, apart, after_s=0.5):
        """A robot on the x axis and a person beside it; None: not seen."""
        self.at_s += after_s
        robot = None if robot_x is None else Pose2D(robot_x, 0.0, 0.0)
        person = None if apart is None else Pose2D(robot_x or 0.0, apart, 0.0)
        add_sample(self.sums, self.at_s, robot, person, self.parameters)
        return self.sums


def test_the_deviation_is_from_the_desired_distance_either_way():
    s = Sums()
    for apart in (2.0, 1.5, 3.25, 6.0):
        sums = s.add(0.0, apart)
    # 0 + 0.5 + 1.25 + 4 (also beyond the maximum)
    assert (sums["samples"], sums["both"], sums["deviation"]) == (4, 4, 5.75)


def test_the_way_counts_between_minimum_and_maximum_only():
    s = Sums()
    assert s.add(0.0, 2.0)["covered"] == 0.0
    assert s.add(0.4, 2.0)["covered"] == pytest.approx(0.4)
    assert s.add(0.6, 3.5)["covered"] == pytest.approx(0.6)  # exactly the maximum is between
    assert s.add(1.6, 3.6)["covered"] == pytest.approx(0.6)  # too far
    assert s.add(2.0, 2.0)["covered"] == pytest.approx(0.6)  # it was too far when this way began
    assert s.add(2.1, 0.15)["covered"] == pytest.approx(0.7)
    assert s.add(2.2, 0.14)["covered"] == pytest.approx(0.7)  # too near
    assert s.add(2.3, 1.0)["covered"] == pytest.approx(0.7)
    assert s.add(2.1, 1.0)["covered"] == pytest.approx(0.9)  # backwards is a way, too


def test_no_way_is_assumed_where_a_pose_is_missing():
    s = Sums()
    s.add(0.0, 2.0)
    s.add(None, 2.0)
    assert s.add(1.0, 2.0)["covered"] == 0.0
    s.add(1.1, None)
    sums = s.add(1.2, 2.0)
    assert sums["covered"] == 0.0
    assert s.add(1.3, 2.0)["covered"] == pytest.approx(0.1)
    assert (s.sums["samples"], s.sums["both"]) == (6, 4)


def test_no_way_is_assumed_where_the_module_was_away():
    s = Sums()
    s.add(0.0, 2.0)
    assert s.add(1.0, 2.0, after_s=1.6)["covered"] == 0.0
    assert s.add(2.0, 2.0, after_s=1.4)["covered"] == 1.0


@pytest.mark.parametrize("length, failed", [
    (300.0, False), (285.0, False), (284.9, True), (315.0, False), (315.1, True), (0.0, True),
])
def test_a_failed_run_is_over_15_s_short_or_long(length, failed):
    assert is_failed(length, 300.0) is failed
    assert is_failed(length, 0.0) is False


def test_a_whole_run():
    r = hpff()
    assert (r.asked.goal, r.asked.pose, r.asked.timeout) == ("", None, 300.0)
    r.executes(8.0, STEP)
    assert (r.score["samples"], r.score["mean_deviation"], r.score["reliability"]) == (0, None, None)
    r.executes(0.5, STEP)  # at 8.0 s
    assert r.score["samples"] == 1
    r.truth.subjects.update(robot=Pose3(0.0, 0.3, 0.0, 0.0), person=Pose3(1.0, 0.3, 1.8, 0.0))
    r.executes(0.5, STEP)  # 0.3 m on its way, 1 m from the person
    assert (r.score["samples"], r.score["mean_deviation"], r.score["distance_covered"]) == (2, 0.5, 0.3)
    r.truth.subjects["person"] = None
    r.executes(1.0, STEP)
    assert (r.score["samples"], r.score["reliability"]) == (4, 0.5)
    times_out(r)
    assert r.finished
    assert (r.score["mean_deviation"], r.score["distance_covered"], r.score["reliability"]) == (0.5, 0.3, 0.5)
    assert (r.score["run_length"], r.score["failed_run"], r.module.warnings) == (300.0, False, [])


def test_two_samples_a_second_from_the_eighth_second_on():
    r = hpff()
    r.executes(20.125, STEP)
    assert r.score["samples"] == 25  # 8.0, 8.5, … 20.0


def test_no_samples_at_all():
    r = hpff()
    times_out(r)  # in PREPARE
    s = r.score
    assert (s["samples"], s["mean_deviation"], s["reliability"], s["distance_covered"]) == (0, None, None, 0.0)
    assert s["failed_run"] is False
    assert r.module.warnings == ["the distance could not be measured: there is no score"]


def test_samples_without_poses():
    r = hpff(robot=None, person=None)
    r.executes(10.0)
    times_out(r)
    assert (r.score["mean_deviation"], r.score["reliability"]) == (None, 0.0)
    assert "unreliable: only 0%" in r.module.warnings[0]


def test_a_robot_that_ends_it_early_failed():
    r = hpff()
    r.executes(100.0)
    r.result(seconds=100.0)
    assert (r.finished, r.score["failed_run"]) == (True, True)
    assert r.score["run_length"] == pytest.approx(100.0)
    assert r.module.warnings == ["failed run: it took 100 s instead of 300 s"]


def test_a_robot_that_ends_it_in_the_last_seconds_did_not():
    r = hpff()
    r.utc += 20.0  # it prepares so long: that is part of the run
    r.executes(268.0, step=0.5)
    r.result(seconds=268.0)
    assert (r.score["run_length"], r.score["failed_run"]) == (pytest.approx(288.0), False)


@pytest.mark.parametrize("reason, elapsed, failed", [
    ("stopped", 200.0, True), ("stopped", 290.0, False), ("timeout", 305.0, False), ("no_messages_saved", 5.0, True),
])
def test_a_run_that_ends_otherwise_is_judged_by_its_length(reason, elapsed, failed):
    r = hpff()
    r.executes(10.125, STEP)
    r.end(reason, elapsed_s=elapsed)
    assert (r.score["failed_run"], r.score["run_length"]) == (failed, elapsed)
    assert (r.score["samples"], r.score["mean_deviation"], r.score["reliability"]) == (5, 0.0, 1.0)
    assert not r.finished


def test_limits_that_leave_nothing_between_them_are_reported():
    assert "no distance can be scored" in hpff(minimum_distance=3.5).module.warnings[0]
    assert hpff(minimum_distance=3.4).module.warnings == []


def test_a_stop_right_after_a_restart_loses_nothing():
    r = hpff(person=Pose3(1.5, 0.0, 0.0, 0.0))
    r.executes(9.125, STEP)
    r.restart()
    r.end("stopped", elapsed_s=290.0)
    assert (r.score["samples"], r.score["mean_deviation"], r.score["failed_run"]) == (3, 0.5, False)


@pytest.mark.parametrize("restart", ["before the goal's end", "after it"])
def test_the_end_survives_a_restart(restart):
    r = hpff(person=Pose3(1.5, 0.0, 0.0, 0.0))
    r.executes(9.125, STEP)
    if restart == "before the goal's end":
        r.restart()
    times_out(r)
    whole = r.score.values()
    r.restart()
    assert r.finished
    assert r.score.values() == whole
    assert (r.score["samples"], r.score["mean_deviation"], r.score["run_length"]) == (3, 0.5, 300.0)
