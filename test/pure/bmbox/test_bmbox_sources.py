"""Benchmarks without motion capture: the referee enters poses, or nobody does."""

import math

import pytest

from helpers.config_files import SHIPPED
from helpers.forms import form
from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Source
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rehearsal import Rehearsal
from roah_rsbb.bmbox.hgmf import HGMF
from roah_rsbb.bmbox.hnf import HNF
from roah_rsbb.bmbox.hopf import HOPF
from roah_rsbb.bmbox.hpff import HPFF
from roah_rsbb.bmbox.hppf import HPPF
from roah_rsbb.model.fields import BadValue, TypedPose
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.reason import say


class Without(GroundTruth):
    """No motion capture. Nobody may ask it for a pose."""

    def __init__(self, source):
        self._source = source

    @property
    def source(self):
        return self._source

    def pose(self, frame, at_utc=None):
        raise NoPose("nobody may ask for this")


def rehearsal(kind, source):
    path = str(SHIPPED / "modules" / f"{kind.CODE}.yaml")
    parameters = vars(read_parameters(path, kind.CODE, kind.PARAMETERS))
    return Rehearsal(kind, parameters, Without(source), goal_timeout=120.0)


def conduct(r, *results):
    """Take the run to its end: the usual answer to each question, and these results. Returns the questions."""
    left, asked = list(results), []
    while not r.finished:
        assert not r.failed, r.failed
        if r.asked.kind is RequestKind.REFEREE:
            asked.append(r.asked.text)
            r.answer("1.0 0.5 0" if any(isinstance(field, TypedPose) for field in r.asked.fields) else "")
        else:
            r.result(left.pop(0) if left else "", seconds=10.0)
    return asked


@pytest.mark.parametrize("kind, questions_per_goal", [(HNF, 0), (HOPF, 2), (HPPF, 1), (HGMF, 1), (HPFF, 0)])
def test_without_poses_no_goal_has_an_additional_question(kind, questions_per_goal):
    r = rehearsal(kind, Source.NONE)
    asked = conduct(r, *["{class: cups, instance: red_cup, person_name: Annie, x: 1, y: 2, theta: 0}"] * 10)
    goals = sum(step.request.kind is RequestKind.GOAL for step in r.run.steps)
    assert len(asked) == goals * questions_per_goal + (1 if kind is HNF else 0)
    assert not any("pose" in text.lower() and "starting" not in text for text in asked)
    for name in ("distance_error", "orientation_error", "pose_score", "grasped"):
        if name in kind.EACH:
            assert set(r.score.each(name)) <= {None}
    for name in ("position_accuracy", "distance_error", "pose_score", "mean_deviation", "distance_covered", "grasped"):
        if name in kind.SCORES:
            assert r.score[name] is None


def test_the_rest_is_scored_without_poses():
    r = rehearsal(HNF, Source.NONE)
    conduct(r)
    assert (r.score["reached"], r.score["execution_time"]) == (3, 30.0)
    r = rehearsal(HOPF, Source.NONE)
    conduct(r, "{class: cups, instance: red_cup}")
    assert 0.0 <= r.score["class_accuracy"] <= 1.0
    r = rehearsal(HPPF, Source.NONE)
    conduct(r, *["{person_name: Annie, x: 1, y: 2}"] * 4)
    assert (r.score["detected"], r.score["recognised"]) == (4, 1)


def test_the_referee_enters_where_the_robot_is():
    r = rehearsal(HNF, Source.REFEREE)
    r.answer()
    r.result(seconds=10.0)
    assert r.asked.text == ("Measure the pose of the robot in the test bed. Enter x, y and its direction, in metres "
                            "and degrees: 1.25 0.40 90. Leave it empty to skip it")
    assert r.asked.fields == (TypedPose("pose", say("Pose"), required=False),)
    with pytest.raises(BadValue, match="Pose: x and y in metres, then the direction in degrees"):
        r.answer("left of the sofa")
    r.answer("1,3 0,9 -90")  # the waypoint is 1.0 0.5 0°: 0.5 m, a quarter turn
    assert r.score["waypoint 1", "distance_error"] == pytest.approx(0.5)
    assert r.score["waypoint 1", "orientation_error"] == pytest.approx(math.pi / 2)
    r.result(seconds=10.0)
    r.answer()
    r.restart()
    assert r.asked.text == "waypoint 3"
    assert r.score["waypoint 2", "distance_error"] is None


def test_the_referee_measures_on_the_table():
    r = rehearsal(HOPF, Source.REFEREE)
    r.answer()
    assert "of the positioner from the table's corner" in r.asked.text
    r.answer("0.4 0.3 0")
    r.answer()  # removes the positioner
    item = r.score["goal 1", "item"]
    transform = next(i.transform for i in r.module.parameters.items if i.description == item)
    x, y = 0.4 + transform.x, 0.3 + transform.y
    r.result(f"{{x: {x}, y: {y}, theta: {transform.theta}}}", seconds=5.0)
    assert r.score["goal 1", "pose_score"] == pytest.approx(1.0)


def test_the_referee_sees_whether_the_object_was_lifted():
    r = rehearsal(HGMF, Source.REFEREE)
    r.answer()  # places it
    goal = r.asked.pose
    r.result(seconds=5.0)
    assert (r.asked.text, r.asked.form) == ("Did the robot lift the object?", form("No", "Yes"))
    r.answer("Yes")
    r.answer(f"{goal[0] + 0.3} {goal[1]} 0")
    assert r.score["object 1", "grasped"] is True
    assert r.score["object 1", "distance_error"] == pytest.approx(0.3)


def test_the_referee_measures_where_a_person_stood_after_the_result():
    r = rehearsal(HPPF, Source.REFEREE)
    r.answer()
    assert r.asked.kind is RequestKind.GOAL
    r.result("{person_name: X, x: 1.0, y: 2.0}", seconds=5.0)
    assert "pose of the person in the test bed" in r.asked.text
    r.answer("1 2.5 0")
    assert r.score["person 1", "distance_error"] == pytest.approx(0.5)


def test_rules_of_a_competition_see_the_source():
    class Own(Module):
        CODE = "OWN"

        async def execute(self):
            self.status = f"{self.source.value} {await self.pose('robot')}"

    assert Rehearsal(Own, truth=Without(Source.NONE)).module.status == "none None"
