"""HGMF's rules, with scores worked out by hand."""

import json
import math
import random
from types import SimpleNamespace

import pytest

from helpers.forms import form
from helpers.rehearsed import assert_orders_differ, assert_restarts_change_nothing
from roah_rsbb.bmbox.framework.ground_truth import Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.hgmf import HGMF, draw_target, is_grasped
from roah_rsbb.model.modules import RequestKind

TABLE = Pose3(0.0, 0.0, 0.8, 0.0)
HERE = Pose3(0.5, 0.25, 0.8, 0.0)
STEP = 0.125  # seconds; sums of them are exact


def hgmf(*names, table=TABLE, thing=HERE):
    parameters = {
        "objects": [SimpleNamespace(id=i, description=name) for i, name in enumerate(names or ["cup"], 1)],
        "table_size": SimpleNamespace(x=1.2, y=0.8), "goal_timeout": 120.0,
    }
    return Rehearsal(HGMF, parameters, Poses(object=thing, table=table))


def puts(r, x_off=0.0, y_off=0.0):
    """The object is off its target, in the table's frame (which is not turned)."""
    x, y, _ = r.asked.pose
    r.truth.subjects["object"] = Pose3(x + x_off, y + y_off, 0.8, 0.0)


def lifts(r, height):
    """The object rises where it is, for a second."""
    lying = r.truth.subjects["object"]
    r.truth.subjects["object"] = lying._replace(z=lying.z + height)
    r.executes(1.0, STEP)
    r.truth.subjects["object"] = lying


def test_the_steps_of_an_object():
    r = hgmf()
    assert (r.score["grasped"], r.score["objects"], r.score["execution_time"]) == (0, 1, 0)
    assert r.asked.text == "Place the cup with markers on the table"
    r.answer()
    assert (r.asked.kind, r.asked.timeout) == (RequestKind.GOAL, 120.0)
    x, y, theta = r.asked.pose
    assert (json.loads(r.asked.goal), theta) == ([x, y, 1], 0.0)  # [x, y, object_id]
    assert r.asked.text == f"cup (object 1) to x {x:.2f} m, y {y:.2f} m"
    r.result(seconds=3.0)
    assert r.finished


def test_a_target_is_inside_the_edges_and_not_at_the_object():
    chance = random.Random(7)
    thing = Pose3(0.25, 0.2, 0.0, 0.0)
    targets = [draw_target(chance, SimpleNamespace(x=0.5, y=0.6), thing) for _ in range(2000)]
    assert all(0.15 <= t.x <= 0.35 and 0.15 <= t.y <= 0.45 and t.theta == 0.0 for t in targets)
    assert all(math.hypot(t.x - 0.25, t.y - 0.2) >= 0.05 for t in targets)
    # Nowhere else are they kept away.
    assert min(t.x for t in targets) < 0.16 and max(t.y for t in targets) > 0.44
    assert min(math.hypot(t.x - 0.25, t.y - 0.2) for t in targets) < 0.06


@pytest.mark.parametrize("rise, grasped", [(0.0, False), (0.029, False), (0.03, True), (0.3, True), (-0.5, False)])
def test_grasped_is_3_cm_higher(rise, grasped):
    assert is_grasped(Pose3(0, 0, 0.8, 0), Pose3(0, 0, 0.8 + rise, 0)) is grasped


def test_a_whole_run():
    r = hgmf("cup", "box", "can", "bottle")
    r.answer()
    lifts(r, 0.05)
    assert (r.score["object 1", "grasped"], r.score["grasped"]) == (True, 1)  # shown at once
    puts(r, x_off=0.03, y_off=-0.04)  # 0.05 m off
    r.result(seconds=10.0)
    r.answer()
    lifts(r, 0.02)  # pushed, and not lifted
    puts(r, y_off=0.25)
    r.result(seconds=20.0)
    r.answer()
    lifts(r, 0.1)  # lifted, and dropped somewhere when the time was up
    puts(r, x_off=0.3)
    r.time_out(100.0)
    r.answer()
    puts(r)  # by a miracle
    r.result(seconds=0.0)
    assert r.finished
    s = r.score
    assert (s["grasped"], s["objects"], s["execution_time"]) == (2, 4, 130.0)
    assert s.each("grasped") == [True, False, True, False]
    assert s.each("distance_error") == pytest.approx([0.05, 0.25, 0.3, 0.0])
    assert s["distance_error"] == pytest.approx(0.15)  # (0.05 + 0.25 + 0.3 + 0) / 4
    assert sorted(s.each("object")) == ["bottle", "box", "can", "cup"]


def test_places_are_in_the_tables_frame():
    # The table's corner is at (4, 1), turned to the left by a quarter: its x is the test bed's y.
    r = hgmf(table=Pose3(4.0, 1.0, 0.8, math.pi / 2), thing=Pose3(3.75, 1.5, 0.8, 0.0))
    r.answer()
    x, y, _ = r.asked.pose
    # (x, y) on the table is (4 - y, 1 + x) in the test bed; 0.1 m beside it.
    r.truth.subjects["object"] = Pose3(4.0 - y, 1.0 + x + 0.1, 0.8, 0.0)
    r.result(seconds=1.0)
    assert r.score["distance_error"] == pytest.approx(0.1)


@pytest.mark.long
def test_a_target_keeps_away_from_the_object_in_the_tables_frame():
    # The same table; the object is in the middle of a small one, at about (0.25, 0.25).
    for n in range(200):
        parameters = {**vars(hgmf().module.parameters), "table_size": SimpleNamespace(x=0.5, y=0.5)}
        along = 0.25 + n * 1e-4
        truth = Poses(object=Pose3(3.75, 1.0 + along, 0.8, 0.0), table=Pose3(4.0, 1.0, 0.8, math.pi / 2))
        r = Rehearsal(HGMF, parameters, truth)
        r.answer()
        x, y, _ = r.asked.pose
        assert math.hypot(x - along, y - 0.25) >= 0.05 - 1e-9


def test_a_short_lift_is_seen():
    r = hgmf()
    r.answer()
    r.executes(0.5, STEP)
    r.truth.subjects["object"] = HERE._replace(z=0.9)
    r.executes(STEP, STEP)  # it was up for an eighth of a second
    r.truth.subjects["object"] = HERE
    r.executes(0.5, STEP)
    assert r.score["grasped"] == 1
    assert r.module.kept == {"grasped": True}


def test_an_object_that_is_not_seen_meanwhile_is_not_grasped():
    r = hgmf()
    r.answer()
    r.truth.subjects["object"] = None
    r.executes(2.0, STEP)
    r.truth.subjects["object"] = HERE
    r.result(seconds=2.0)
    assert (r.finished, r.score["grasped"]) == (True, 0)


@pytest.mark.parametrize("missing", ["object", "table"])
def test_a_pose_that_cannot_be_had_at_first_is_asked_for(missing):
    r = hgmf()
    pose = r.truth.subjects.pop(missing)
    r.answer()
    assert (r.asked.kind, r.asked.form) == (RequestKind.REFEREE, form("Try again"))
    r.truth.subjects[missing] = pose
    r.answer()
    assert r.asked.kind is RequestKind.GOAL


def test_an_object_lost_at_the_end_is_asked_for_or_skipped():
    r = hgmf("cup", "box")
    for answer in ("Try again", "Skip"):
        r.answer()
        lifts(r, 0.1)
        r.truth.subjects["object"] = None
        r.result(seconds=5.0)
        assert r.asked.form == form("Try again", "Skip")
        assert r.score["execution_time"] == sum(r.score.each("time")) > 0.0
        r.truth.subjects["object"] = HERE
        r.answer(answer)
    assert r.finished
    assert r.score["grasped"] == 2
    errors = r.score.each("distance_error")
    assert errors[0] >= 0.05 and errors[1] is None
    assert r.score["distance_error"] == errors[0]


def test_another_run_has_another_order():
    assert_orders_differ(hgmf("cup", "box", "can", "bottle"), ("object 1", "object"))


def test_a_restart_at_each_step_changes_nothing():
    """Two objects: the first is lifted before a restart in its goal, the second is not."""
    assert_restarts_change_nothing(lambda: hgmf("cup", "box"), lambda r: [
        r.answer, lambda: lifts(r, 0.1), lambda: puts(r, x_off=0.1), lambda: r.result(seconds=5.0),
        r.answer, lambda: lifts(r, 0.01), lambda: puts(r, y_off=0.2), lambda: r.time_out(100.0)])


def test_a_stop_right_after_a_restart_loses_nothing():
    r = hgmf()
    r.answer()
    lifts(r, 0.1)
    r.restart()
    r.end("stopped")
    assert r.score["grasped"] == 1
