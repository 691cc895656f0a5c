"""Whole runs in simulated time: the real box, the real rules and shipped parameters, and all else pretended."""

import json

import pytest

from helpers.config_files import SHIPPED
from helpers.dummy_set_up import ZONE, DummySetUp
from helpers.examples import ALL
from roah_rsbb.bmbox.framework.ground_truth import Pose3, compose, seen_from
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import modules
from roah_rsbb.bmbox.host.dummy_world import TABLE_SIZE
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.records import EndReason

# Seconds from one crash of the modules to the next. The two longest runs are without crashes in `make test-all` only;
# test_bmbox_hopf.py and test_bmbox_hpff.py prove their scores.
RESTARTS = [None, 1.7]


def shipped(code):
    """The shipped parameters of a benchmark."""
    return read_parameters(str(SHIPPED / "modules" / f"{code}.yaml"), code, modules()[code].PARAMETERS)


def completed(set_up, **how):
    set_up.go(**how)
    assert set_up.run.end_reason is EndReason.COMPLETED, set_up.driver.notices()
    return {(s.group, s.name): json.loads(s.value) for s in set_up.run.scores}


@pytest.mark.long
@pytest.mark.parametrize("restart_every_s", RESTARTS if ALL else RESTARTS[1:])
def test_hopf(restart_every_s):
    def result():
        """Return the correct result for a red cup, at a position that is 0.3 m and 0.4 m away from any cup."""
        notes = [json.loads(step.request.note)["pose"] for step in set_up.run.steps
                 if step.request.kind is RequestKind.NOTE]
        table, positioner = (Pose3(*pose) for pose in notes[-2:])
        item = compose(positioner, shipped("HOPF").items[0].transform)
        x, y, _, theta = seen_from(table, item)
        return f"{{class: cups, instance: red_cup, x: {x + 0.3}, y: {y + 0.4}, theta: {theta}}}"

    set_up = DummySetUp("HOPF", result)
    score = completed(set_up, restart_every_s=restart_every_s)
    # 3 of the 10 items are cups, one of them red.
    assert (score["", "class_accuracy"], score["", "instance_accuracy"]) == (0.3, 0.1)
    cups = [group for (group, name), value in score.items() if name == "class_right" and value]
    assert [score[group, "pose_score"] for group in cups] == pytest.approx([0.75] * 3)
    assert score["", "execution_time"] == pytest.approx(10 * 3.0, abs=2.0)


@pytest.mark.long
@pytest.mark.parametrize("restart_every_s", RESTARTS)
def test_hppf(restart_every_s):
    def result():
        x, y, _, theta = set_up.truth.of_zone(ZONE).pose("person")
        return f"{{person_name: annie, x: {x - 0.3}, y: {y + 0.4}, theta: {theta}}}"

    set_up = DummySetUp("HPPF", result)
    score = completed(set_up, restart_every_s=restart_every_s)
    assert (score["", "detected"], score["", "recognised"]) == (4, 1)
    assert score["", "distance_error"] == pytest.approx(0.5)


@pytest.mark.long
@pytest.mark.parametrize("restart_every_s", [None, 50.0] if ALL else [50.0])
def test_hpff(restart_every_s):
    set_up = DummySetUp("HPFF", None, goal=300.0, total=305.0)
    score = completed(set_up, period_s=0.25, restart_every_s=restart_every_s)
    assert score["", "run_length"] == pytest.approx(300.0, abs=1.0)
    assert (score["", "failed_run"], score["", "reliability"]) == (False, 1.0)
    # 8 to 299 s of executing, twice a second; a restart may add one.
    assert 575 <= score["", "samples"] <= 595
    assert score["", "mean_deviation"] < 0.2
    # The person walks half a metre a second, the robot on a circle that is no longer.
    assert 30.0 < score["", "distance_covered"] < 160.0


@pytest.mark.long
@pytest.mark.parametrize("restart_every_s", RESTARTS)
def test_hgmf(restart_every_s):
    set_up = DummySetUp("HGMF")
    score = completed(set_up, restart_every_s=restart_every_s)
    assert (score["", "grasped"], score["", "objects"]) == (4, 4)
    assert 0.0 < score["", "distance_error"] < 0.15
    assert score["", "execution_time"] == pytest.approx(4 * 3.0, abs=1.0)


@pytest.mark.parametrize("restart_every_s", RESTARTS)
def test_hnf(restart_every_s):
    score = completed(DummySetUp("HNF"), restart_every_s=restart_every_s)
    assert (score["", "reached"], score["", "timed_out"]) == (3, 0)
    assert 0.0 < score["", "position_accuracy"] < 0.15
    assert 0.0 < score["", "orientation_accuracy"] < 0.2


def test_a_stopped_run_keeps_its_score_and_the_next_begins_at_0():
    set_up = DummySetUp("HGMF")
    while ("grasped", "1") not in [(s.name, s.value) for s in set_up.run.scores]:
        set_up.step()
    set_up.driver.command("stop")
    set_up.step()
    assert ("grasped", "1") in [(s.name, s.value) for s in set_up.run.scores]
    set_up.driver.command("start")
    assert completed(set_up)["", "grasped"] == 4


@pytest.mark.parametrize("code", ["HOPF", "HGMF"])
def test_the_worlds_table_matches_the_shipped_parameters(code):
    assert (shipped(code).table_size.x, shipped(code).table_size.y) == TABLE_SIZE
