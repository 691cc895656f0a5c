"""HPPF's rules, with scores worked out by hand."""

from functools import partial

import pytest

from helpers.forms import form
from helpers.rehearsed import assert_orders_differ, assert_restarts_change_nothing
from roah_rsbb.bmbox.framework.ground_truth import NoPose, Pose3
from roah_rsbb.bmbox.framework.rehearsal import Poses, Rehearsal
from roah_rsbb.bmbox.hppf import HPPF, is_same_name
from roah_rsbb.model.modules import RequestKind

HERE = Pose3(1.0, 1.0, 1.8, 0.0)


class PosesAtTimes(Poses):
    """Present and past poses. A past pose of None is unknown."""

    past = {}
    asked_utc = None

    def pose(self, frame, at_utc=None):
        if at_utc is None:
            return super().pose(frame)
        self.asked_utc = at_utc
        pose = self.past.get(frame, self.subjects.get(frame))
        if pose is None:
            raise NoPose(f"{frame}: was not seen then")
        return pose


def hppf(*people, person=HERE):
    return Rehearsal(HPPF, {"people": list(people or ["Annie"]), "goal_timeout": 120.0}, PosesAtTimes(person=person))


def entering(r):
    """Return the name of the person who must enter."""
    return r.asked.text[len("Ask "):-len(" to enter the target area")]


def result(name, x=1.0, y=1.0):
    return f"{{person_name: {name}, x: {x}, y: {y}, theta: 0.0}}"


def test_the_steps_of_a_person():
    r = hppf()
    assert (r.score["detected"], r.score["recognised"], r.score["execution_time"]) == (0, 0, 0)
    assert r.asked.text == "Ask Annie to enter the target area"
    r.answer()
    assert (r.asked.kind, r.asked.goal, r.asked.timeout) == (RequestKind.GOAL, "", 120.0)
    r.result(result("Annie"), 4.0)
    assert r.finished


def test_a_whole_run():
    r = hppf("Annie", "Deli Man", "PostMan", "Dr. Kimble")
    entered = [entering(r)]
    r.answer()
    r.result(result(entered[-1], 1.3, 1.4), 10.0)  # 0.3 and 0.4 m off: 0.5 m
    entered.append(entering(r))
    r.truth.subjects["person"] = Pose3(-1.0, 0.5, 1.8, 2.0)
    r.answer()
    r.result(result("somebody", -1.0, -0.5), 20.0)  # another name, 1 m off
    entered.append(entering(r))
    r.answer()
    r.time_out(100.0)
    entered.append(entering(r))
    r.answer()
    r.result(result(entered[-1].upper(), -1.0, 0.5), 30.0)  # case is ignored
    assert r.finished
    assert sorted(entered) == ["Annie", "Deli Man", "Dr. Kimble", "PostMan"]
    s = r.score
    assert s.each("name") == entered
    assert (s["detected"], s["recognised"], s["execution_time"]) == (3, 2, 160.0)
    assert s.each("distance_error") == pytest.approx([0.5, 1.0, 0.0])
    assert s["distance_error"] == pytest.approx(0.5)  # (0.5 + 1 + 0) / 3
    assert s.each("detected") == [True, True, False, True]
    assert s.each("recognised") == [True, False, False, True]


def test_another_run_has_another_order():
    assert_orders_differ(hppf("A", "B", "C", "D"), ("person 1", "name"))


@pytest.mark.parametrize("a, b, same", [
    ("annie", "Annie", True), ("ANNIE ", " annie", True), ("STRASSE", "straße", True),
    ("Ann", "Annie", False), ("", "Annie", False),
])
def test_the_same_name(a, b, same):
    assert is_same_name(a, b) is same


def test_where_the_person_was_at_the_time_of_the_result_counts():
    r = hppf()
    r.answer()
    r.executes(3.0)
    r.truth.past = {"person": Pose3(1.0, 3.0, 1.8, 0.0)}  # and now at (1, 1) again
    ended = r.utc
    r.result(result("Annie"), 3.0)
    assert r.truth.asked_utc == ended
    assert r.score["person 1", "distance_error"] == pytest.approx(2.0)


def test_the_referee_is_asked_for_an_unseen_person_before_the_goal():
    r = hppf(person=None)
    r.answer()
    assert (r.asked.kind, r.asked.form) == (RequestKind.REFEREE, form("Try again"))
    r.answer()
    assert r.asked.kind is RequestKind.REFEREE
    r.truth.subjects["person"] = HERE
    r.answer()
    assert r.asked.kind is RequestKind.GOAL


@pytest.fixture
def lost_at_the_result():
    r = hppf("Annie")
    r.answer()
    r.truth.past = {"person": None}
    r.truth.subjects["person"] = Pose3(9.0, 9.0, 1.8, 0.0)  # wherever Annie has gone by now
    r.result(result("Annie", 1.0, 2.0), 4.0)
    return r


def test_a_pose_lost_at_the_result_is_asked_for_and_not_invented(lost_at_the_result):
    r = lost_at_the_result
    assert r.asked.text.startswith("The position of Annie at the time of the robot's result is unknown")
    assert (r.score["recognised"], r.score["detected"], r.score["distance_error"]) == (1, 1, None)
    assert r.module.warnings == ["person: was not seen then"]
    r.truth.subjects["person"] = HERE
    r.answer("Try again")
    assert (r.finished, r.score["distance_error"]) == (True, 1.0)


def test_a_pose_that_stays_lost_may_be_skipped(lost_at_the_result):
    r = lost_at_the_result
    r.truth.subjects["person"] = None
    r.answer("Try again")
    assert r.asked.form == form("Try again", "Skip")
    r.answer("Skip")
    assert (r.finished, r.score["distance_error"]) == (True, None)


@pytest.mark.parametrize("text, detected, recognised, error", [
    *((text, 0, 0, None) for text in ("", "Annie", "{name: Annie}", "{person_name: [Annie]}", "{person_name: *a}")),
    ("{person_name: annie}", 1, 1, None), ("{x: 1.0, y: 1.5}", 1, 0, 0.5)])
def test_what_can_be_read_of_a_result_counts(text, detected, recognised, error):
    r = hppf()
    r.answer()
    r.result(text, 3.0)
    s = r.score
    assert (r.finished, s["detected"], s["recognised"], s["distance_error"]) == (True, detected, recognised, error)
    assert s["execution_time"] == 3.0 and r.module.warnings


def test_places_beyond_all_measure_break_nothing():
    r = hppf("Annie", "PostMan")
    for _ in range(2):
        r.answer()
        r.result(result("Annie", 1.7e308, -1.7e308), 1.0)
    assert (r.finished, r.score["distance_error"]) == (True, 1000.0)


def test_a_restart_at_each_step_changes_nothing():
    def act(r, step):
        r.truth.past = {"person": None} if step == 3 else {}
        r.truth.subjects["person"] = Pose3(0.1 * step, 0.2, 1.8, 0.0)
        if r.asked.kind is RequestKind.REFEREE:
            r.answer()
        else:
            r.result(result("annie", 0.4, 0.2), 5.0 + step)

    assert_restarts_change_nothing(lambda: hppf("Annie", "PostMan", "Deli Man"),
                                   lambda r: [partial(act, r, step) for step in range(7)])
