"""HOPF's rules, with scores worked out by hand."""

import math
from functools import partial
from types import SimpleNamespace

import pytest

from helpers.forms import form
from helpers.rehearsed import assert_orders_differ, assert_restarts_change_nothing
from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.hopf import HOPF, pose_score
from roah_rsbb.model.modules import RequestKind

PI = math.pi
TABLE, HERE = Pose3(0.0, 0.0, 0.8, 0.0), Pose3(0.5, 0.25, 0.8, 0.0)


def item(number, class_="mugs", instance="red", transform=NO_TRANSFORM):
    return SimpleNamespace(**{
        "id": number, "class": class_, "instance": instance, "description": f"thing {number}", "transform": transform,
    })


def hopf(items=None, goals=None, table=TABLE, positioner=HERE, **run):
    items = items or [item(1)]
    parameters = {
        "items": items, "goals": goals or len(items), "table_size": SimpleNamespace(x=1.2, y=0.8),
        "goal_timeout": 120.0,
    }
    return Rehearsal(HOPF, parameters, Poses(table=table, positioner=positioner), **run)


def to_goal(r):
    """The referee completes the manual operations before a goal."""
    r.answer()
    r.answer()


def answers(r, text, seconds=10.0):
    to_goal(r)
    r.result(text, seconds)


def result(class_="mugs", instance="red", x=0.5, y=0.25, theta=0.0):
    return f"{{class: {class_}, instance: {instance}, x: {x}, y: {y}, theta: {theta}}}"


@pytest.mark.parametrize("far, turned, score", [
    (0.0, 0.0, 1.0),
    (0.2, 0.0, 0.9),  # 1 - 0.2/2
    (0.0, PI / 2, 0.75),  # 1 - (1/2)/2
    (0.1, PI / 4, 0.825),  # 1 - 0.1/2 - 0.25/2
    (1.0, 0.0, 0.5), (7.0, 0.0, 0.5),  # e_trans is cut at 1
    (0.0, PI, 0.5), (0.0, 4.0, 0.5),  # so is e_rot
    (7.0, PI, 0.0),
])
def test_the_pose_score(far, turned, score):
    assert pose_score(far, turned) == pytest.approx(score)


def test_the_item_is_where_the_positioner_and_its_transform_say_in_the_tables_frame():
    # The table's corner is at (4, 1), turned to the left by a quarter; the positioner is at (3.8, 1.5), turned by
    # half a turn: in the table's frame at (0.5, 0.2), turned by a quarter. The item is 0.1 m before it, turned by
    # another quarter: (0.5, 0.3), turned by half a turn.
    r = hopf([item(1, transform=Pose3(0.1, 0.0, 0.0, PI / 2))], table=Pose3(4.0, 1.0, 0.8, PI / 2),
             positioner=Pose3(3.8, 1.5, 0.8, PI))
    answers(r, result(x=0.5, y=0.3, theta=-3.0))
    assert r.score["goal 1", "distance_error"] == pytest.approx(0.0, abs=1e-9)
    assert r.score["goal 1", "orientation_error"] == pytest.approx(PI - 3.0)  # across ±π, not 6.14
    # 1 - 0/2 - ((π - 3)/π)/2
    assert r.score["pose_score"] == pytest.approx(1 - (PI - 3.0) / PI / 2)


def test_a_whole_run():
    things = [item(1, "mugs", "red"), item(2, "mugs", "blue"), item(3, "cans", "soup"), item(4, "cans", "cola")]
    r = hopf(things)
    by_description = {thing.description: thing for thing in things}

    def asked():
        return by_description[r.module.status.split(": ")[1].split(" (")[0]]

    first = asked()
    # All right, and 0.3 m and 0.4 m off: 0.5 m: 1 - 0.5/2 = 0.75
    answers(r, result(getattr(first, "class"), first.instance, 0.8, 0.65), 10.0)
    second = asked()
    # The class alone is right; 1 m and half a turn off: 0.
    answers(r, result(getattr(second, "class"), "nonsense", 1.5, 0.25, PI), 20.0)
    to_goal(r)
    r.time_out(100.0)
    # Wrong altogether, but where it stands: 1.
    answers(r, result("shoes", "left"), 30.0)
    assert r.finished
    s = r.score
    assert s["class_accuracy"] == 0.5  # 2 of 4
    assert s["instance_accuracy"] == 0.25  # 1 of 4
    assert s["pose_score"] == pytest.approx((0.75 + 0.0 + 0.0 + 1.0) / 4)
    assert s["execution_time"] == 160.0
    assert s.each("class_right") == [True, True, False, False]
    assert s.each("instance_right") == [True, False, False, False]
    assert s.each("distance_error") == pytest.approx([0.5, 1.0, 0.0])
    assert s.each("orientation_error") == pytest.approx([0.0, PI, 0.0], abs=1e-9)
    assert s.each("time") == [10.0, 20.0, 100.0, 30.0]


def test_each_item_is_used_once():
    r = hopf([item(n) for n in range(1, 7)])
    while not r.finished:
        answers(r, result())
    assert sorted(r.score.each("item")) == [f"thing {n}" for n in range(1, 7)]


def test_another_run_has_another_order():
    assert_orders_differ(hopf([item(n) for n in range(1, 7)]), ("goal 1", "item"))


def test_fewer_goals_than_items_are_some_of_the_items():
    r = hopf([item(n) for n in range(1, 7)], goals=2)
    answers(r, result())
    assert r.score["class_accuracy"] == 0.5
    answers(r, result())
    assert (r.finished, r.score["class_accuracy"], r.module.warnings) == (True, 1.0, [])


def test_fewer_items_than_goals_are_as_many_goals():
    r = hopf([item(1)], goals=10)
    assert r.module.warnings == ["there are 1 items for 10 goals: this run has 1 goals"]
    answers(r, result())
    assert (r.finished, r.score["class_accuracy"]) == (True, 1.0)


def test_goals_that_were_not_reached_have_no_result():
    r = hopf([item(n) for n in range(1, 5)])
    answers(r, result())
    r.end("timeout")
    # One of four, although only one was tried.
    assert (r.score["class_accuracy"], r.score["pose_score"]) == (0.25, 0.25)


@pytest.mark.parametrize("text, scores, warned", [
    *((text, (0.0, 0.0, 0.0), "") for text in (
        "", "red mug", "[1, 2]", "{class: [a], instance: {b: c}}", "{x: ]", "!!python/x {}")),
    ("{class: mugs, instance: red}", (1.0, 1.0, 0.0), "has no x, y, theta"),
    ("{x: 0.5, y: 0.25, theta: 0}", (0.0, 0.0, 1.0), ""),
    (result("Mugs", "RED"), (0.0, 0.0, 1.0), None),  # class and instance must be exact
])
def test_what_cannot_be_read_of_a_result_scores_nothing(text, scores, warned):
    r = hopf()
    answers(r, text, 5.0)
    assert r.finished and r.score["execution_time"] == 5.0
    assert (r.score["class_accuracy"], r.score["instance_accuracy"], r.score["pose_score"]) == scores
    assert warned in r.module.warnings[0] if warned is not None else not r.module.warnings


def test_numbers_beyond_all_measure_break_nothing():
    r = hopf([item(n) for n in range(1, 3)])
    answers(r, result(x=1.7e308, y=-1.7e308, theta=1e308))
    answers(r, result(x=1e308, y=1e308))
    assert r.finished
    assert 0.0 <= r.score["pose_score"] <= 0.5
    assert r.score.each("distance_error") == [1000.0, 1000.0]


@pytest.mark.parametrize("missing", ["table", "positioner"])
def test_a_pose_that_cannot_be_had_is_asked_for_again(missing):
    r = hopf()
    pose = r.truth.subjects.pop(missing)
    r.answer()
    assert r.asked.form == form("Try again", *(["Skip"] if missing == "positioner" else []))
    r.answer("Try again")
    assert f"The pose of {missing}" in r.asked.text
    r.truth.subjects[missing] = pose
    r.answer("Try again")
    assert r.asked.text == "Remove the positioner. Leave the item in place"


def test_a_measurement_that_the_referee_skips_costs_the_robot_nothing():
    r = hopf([item(number, "mugs", f"i{number}") for number in (1, 2)])
    r.truth.subjects.pop("positioner")
    r.answer()
    r.answer("Skip")
    r.truth.subjects["positioner"] = HERE
    answered_at_goal(r)
    assert r.score["pose_score"] is None
    r.answer()
    answered_at_goal(r)
    assert r.finished and r.score.each("pose_score") == [None, 1.0]
    assert r.score["pose_score"] == 1.0


@pytest.mark.parametrize("x, y", [(-0.1, 0.4), (1.3, 0.4), (0.6, -0.1), (0.6, 0.9)])
def test_an_item_beside_the_table_is_asked_about(x, y):
    r = hopf(positioner=Pose3(x, y, 0.8, 0.0))
    r.answer()
    assert r.asked.text.startswith(f"The measured item position is not on the table: x {x:.2f} m, y {y:.2f} m on a")
    r.answer("Try again")
    assert r.asked.text.startswith("The measured item position is not on the table")
    r.truth.subjects["positioner"] = HERE
    r.answer("Try again")
    answered_at_goal(r)
    assert r.score["pose_score"] == 1.0


def answered_at_goal(r):
    r.answer()
    r.result(result(), 1.0)


def test_an_item_beside_the_table_may_be_used_unchanged():
    r = hopf(positioner=Pose3(1.4, 0.25, 0.8, 0.0))
    r.answer()
    r.answer("Use this position")
    answered_at_goal(r)
    assert r.score["goal 1", "distance_error"] == pytest.approx(0.9)


def test_a_restart_at_each_step_changes_nothing():
    def act(r, step):
        if r.asked.kind is RequestKind.REFEREE:
            r.truth.subjects["positioner"] = Pose3(0.1 * step, 0.2, 0.8, 0.3 * step)
            r.answer()
        else:
            r.result(result("mugs", "i1", 0.4, 0.2), 5.0 + step)

    assert_restarts_change_nothing(lambda: hopf([item(n, "mugs", f"i{n}") for n in range(1, 4)]),
                                   lambda r: [partial(act, r, step) for step in range(9)])
