"""HOMF's and STB's rules."""

from types import SimpleNamespace

import pytest

from helpers.rehearsed import assert_restarts_change_nothing
from roah_rsbb.bmbox.framework.rehearsal import Rehearsal
from roah_rsbb.bmbox.homf import HOMF, in_order
from roah_rsbb.bmbox.stb import STB
from roah_rsbb.model.modules import RequestKind

GOALS = [
    SimpleNamespace(initial_state=[False, True, False], switches=[1, 3, 2]),
    SimpleNamespace(initial_state=[False, False, False], switches=[2]),
]


def homf():
    return Rehearsal(HOMF, {"goals": GOALS, "goal_timeout": 60.0})


def test_a_whole_homf_run():
    r = homf()
    assert r.asked.text == "Switch on: 2; switch off all others of 1 to 3"
    r.answer()
    asked = r.asked
    assert (asked.initial_state, asked.switches, asked.timeout) == ((False, True, False), (1, 3, 2), 60.0)
    assert (asked.goal, asked.explicit_goal) == ("", True)
    r.result(seconds=30.0)
    assert r.asked.kind is RequestKind.SWITCHES
    r.switches(1, 3, 3, 2, damaged=1)  # 1, 3, 2 in order; one change more
    assert r.asked.text == "Switch on: none; switch off all others of 1 to 3"
    r.answer()
    r.time_out(seconds=60.0)
    r.switches()
    s = r.score
    assert (r.finished, s["right"], s["wrong"], s["damaged"], s["execution_time"]) == (True, 3, 1, 1, 90.0)
    assert s.each("changed") == ["1, 3, 3, 2", "none"]
    assert s.each("timed_out") == [False, True]


@pytest.mark.parametrize("asked, done, right", [
    ([], [], 0), ([1], [], 0), ([], [1], 0), ([1, 2, 3], [1, 2, 3], 3), ([1, 2, 3], [3, 2, 1], 1),
    ([1, 2, 3], [1, 4, 3], 2), ([1, 1], [1], 1), ([1, 2, 1], [2, 1, 1], 2), ([2, 1], [1, 2, 1], 2),
])
def test_switches_in_order(asked, done, right):
    assert in_order(asked, done) == right


def test_restarts_of_homf():
    assert_restarts_change_nothing(homf, lambda r: [
        r.answer, lambda: r.result(seconds=30.0), lambda: r.switches(1, damaged=2), r.answer,
        lambda: r.time_out(60.0), lambda: r.switches(3, 2)])


def test_stb_shows_every_step():
    r = Rehearsal(STB, {"goals": ["GOAL 1", "GOAL 2"], "goal_timeout": 15.0})
    assert r.asked.text == "First Manual Operation"
    r.answer()
    assert (r.asked.goal, r.asked.timeout) == ("{details: 4, goal: GOAL 1}", 15.0)
    r.result("SOME RESULT", seconds=3.0)
    assert r.asked.goal == "{details: 4, goal: GOAL 2}"
    assert r.module.status == "Goal 2 of 2: GOAL 2"
    r.time_out(seconds=12.5)
    assert r.asked.text == "Last Manual Operation"
    assert not r.finished
    r.answer()
    assert (r.finished, r.score["completed"], r.score["execution_time"]) == (True, 1, 15.5)
    assert r.score.each("result") == ["SOME RESULT", None]


def test_stb_stopped_keeps_what_there_is():
    r = Rehearsal(STB, {"goals": ["GOAL 1", "GOAL 2"], "goal_timeout": 15.0})
    r.answer()
    r.result("x", seconds=3.0)
    r.end()
    assert (r.score["completed"], r.finished) == (1, False)
