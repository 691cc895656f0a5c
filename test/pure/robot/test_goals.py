"""Goals of all generations of boxes, and results that all of them read."""

import math
import time

import pytest
import yaml

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot.goals import (
    BadGoal,
    Goal,
    HopfResult,
    HppfResult,
    Pose,
    check_result,
    read_goal,
    write_result,
)


def _goal(code, **fields):
    goal_tx = pb.BenchmarkState.GOAL_TX
    return read_goal(pb.BenchmarkState(benchmark_type=code, benchmark_state=goal_tx, **fields))


@pytest.mark.parametrize("text", [
    "- -2.125\n- -1.607\n- 1.558\n",  # as the original box (yaml-cpp) writes
    "[-2.125, -1.607, 1.558]",
    "[ -2.125,-1.607 ,+1.558 ,]\n",
    "[-2.125,\n -1.607,\n 1.558]",
    "---\n- -2125e-3\n- -1.607\n- 1558.0E-3\n",
    "--- [-2.125, -1.607, 1.558]",
    "  - -2.125\n  - -1.607\n  - 1.558",
    "- -2.125\r\n- -1.607\r\n- 1.558\r\n",
])
def test_a_waypoint_in_every_style_of_2019(text):
    assert _goal("HNF", generic_goal=text) == Goal(text=text, pose=Pose(-2.125, -1.607, 1.558))
    # The small reader here agrees with a whole YAML library.
    assert yaml.safe_load(text)[1:2] == [-1.607]


def test_a_waypoint_of_2015():
    goal = _goal("HNF", target_pose_x=1.5, target_pose_y=-2.0, target_pose_theta=0.25)
    assert goal == Goal(pose=Pose(1.5, -2.0, 0.25))


def test_a_box_that_sends_both_forms_is_read_once_and_exactly():
    goal = _goal("HNF", target_pose_x=1.125, target_pose_y=2, target_pose_theta=3, generic_goal="[1.1, 2, 3]")
    assert goal.pose == Pose(1.125, 2.0, 3.0)


def test_half_a_waypoint_of_2015_is_ignored():
    assert _goal("HNF", target_pose_x=9, generic_goal="[1, 2, 3]").pose == Pose(1.0, 2.0, 3.0)


@pytest.mark.parametrize("text", [
    "", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, three]", "- 1\n- 2\n", "- 1\n- 2\n- 3\n- 4\n", "1, 2, 3",
    "[1, 2, .nan]", "[1, 2, 1e999]", "{x: 1, y: 2, theta: 3}", "[1 2 3]", "[1, 2, 3", "-1\n-2\n-3",
    "[1_0, 2, 3]", None,
])
def test_an_invalid_waypoint_is_refused_with_the_expected_form(text):
    with pytest.raises(BadGoal, match=r"expected \[x, y, theta\]"):
        _goal("HNF", **({} if text is None else {"generic_goal": text}))


def test_a_waypoint_of_2015_must_be_finite():
    with pytest.raises(BadGoal, match="not finite"):
        _goal("HNF", target_pose_x=math.nan, target_pose_y=0, target_pose_theta=0)


@pytest.mark.parametrize(
    "text", ["[" + "1" * 60_000, "[1," + " " * 60_000 + "x", "- 1" + "\n" * 60_000 + "x"],
    ids=["digits", "spaces", "lines"],
)
def test_a_hostile_goal_takes_no_time(text):
    before = time.process_time()
    with pytest.raises(BadGoal) as bad:
        _goal("HNF", generic_goal=text)
    assert time.process_time() - before < 1.0
    assert len(str(bad.value)) < 500


def test_an_object_and_where_it_goes():
    text = "- 0.35\n- -0.2\n- 3\n"
    assert _goal("HGMF", generic_goal=text) == Goal(text=text, pose=Pose(0.35, -0.2, 0.0), object_id=3)


@pytest.mark.parametrize("text", ["[0, 0, 1.5]", "[0, 0, -1]", "[0, 0, 65536]", "[0, 0]", "[0, 0, apple]"])
def test_an_object_is_a_small_number(text):
    with pytest.raises(BadGoal):
        _goal("HGMF", generic_goal=text)


def test_a_goal_of_stb_is_any_text():
    text = "details: 4\ngoal: GOAL 1\n"
    assert _goal("STB", generic_goal=text) == Goal(text=text)


def test_a_goal_of_homf_is_switches():
    assert _goal("HOMF", initial_state=[True, False], switches=[1, 0, 1]) == Goal(
        initial_state=(True, False), switches=(1, 0, 1)
    )


def _written(result):
    message = pb.RobotState()
    write_result(message, result)
    return message


HOPF = HopfResult("cups", "red_cup", Pose(0.1, -0.2, 1.23))


def test_a_result_of_hopf_in_both_forms():
    message = _written(HOPF)
    assert (message.object_class, message.object_name) == ("cups", "red_cup")
    assert (message.object_pose_x, message.object_pose_y, message.object_pose_theta) == (0.1, -0.2, 1.23)
    assert yaml.safe_load(message.generic_result) == {
        "class": "cups", "instance": "red_cup", "x": 0.1, "y": -0.2, "theta": 1.23
    }


@pytest.mark.parametrize("name", [
    "Annie", "", "yes", "null", "1.5", "a: b", "{x}", "# no comment", "O'Hara \"the\" \\one\\", "Zoë 😀",
    "- x", "&a *b",
])
def test_a_result_of_hppf_is_read_back_whatever_the_name(name):
    message = _written(HppfResult(name, Pose(1, 2, 3)))
    assert yaml.safe_load(message.generic_result) == {"person_name": name, "x": 1.0, "y": 2.0, "theta": 3.0}
    assert not message.HasField("object_class")


@pytest.mark.parametrize("number", [1e-7, -1e300, 1.5e-9, 0, -0.0, 123456789.125, 3.141592653589793])
def test_a_number_is_read_back_as_the_same_number(number):
    read = yaml.safe_load(_written(HppfResult("A", Pose(number, 0.0, 0.0))).generic_result)["x"]
    assert isinstance(read, float) and read == number


def test_a_text_is_sent_unchanged_and_none_is_left_out():
    assert _written("SOME RESULT").generic_result == "SOME RESULT"
    assert not _written(None).HasField("generic_result")


@pytest.mark.parametrize("code, result", [
    ("HOPF", HOPF), ("HOPF", None), ("HOPF", "[]"), ("HPPF", HppfResult("A", Pose(0, 0, 0))),
    ("STB", "x"), ("HNF", None),
])
def test_results_that_fit(code, result):
    check_result(code, result)


@pytest.mark.parametrize("code, result, found", [
    ("HNF", HOPF, "HopfResult is not a result of HNF"),
    ("HOPF", HppfResult("A", Pose(0, 0, 0)), "HppfResult is not a result of HOPF"),
    ("HOPF", {"class": "cups"}, "not {'class': 'cups'}"),
    ("HOPF", HOPF._replace(pose=Pose(math.inf, 0, 0)), "finite"),
    ("HOPF", HOPF._replace(pose=(1, 2)), "cannot be sent|unpack"),
    ("HOPF", HOPF._replace(object_class=7), "cannot be sent"),
    ("HOPF", HOPF._replace(object_name="a\nb"), "unprintable"),
    ("HOPF", HOPF._replace(object_name="x" * 450), "at most 900"),
    ("STB", "x" * 900, "at most 900"),
    ("STB", "\ud800", "."),
])
def test_results_that_do_not_fit_say_why(code, result, found):
    with pytest.raises(ValueError, match=found):
        check_result(code, result)
