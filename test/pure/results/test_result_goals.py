"""The goals of a run, and how long the robots worked on each."""

import json

import pytest

from helpers.results_of import task_record
from roah_rsbb.journal.reader import JournalEntry
from roah_rsbb.results.events import goals
from roah_rsbb.results.runs import RobotPart, RunResult

RECORD = task_record("Alpha", 1)
GOAL, STATE = "/rsbb_log/bmbox/goal", "/rsbb_log/rsbb_state_str"


def goals_of(*events):
    """The goals of a run with these events: kind, value, session, mono, UTC."""
    entries = tuple(
        JournalEntry(number, session, utc, mono, "fbm", RECORD.identity, 6667, "", kind, value)
        for number, (kind, value, session, mono, utc) in enumerate(events, 1))
    return goals(RunResult(1, RECORD, (RobotPart(6667, "Alpha", "r1", "", ()),), entries))


def given(text, *when):
    return GOAL, json.dumps({"text": text}), *when


def test_the_next_goal_and_the_states_of_the_box_end_a_goal():
    found = goals_of(
        given("first", 1, 1.0, 101.0), (STATE, "WAITING_RESULT", 1, 3.0, 103.0), given("second", 1, 8.0, 108.0),
        (STATE, "WAITING_RESULT", 1, 9.0, 109.0), ("/rsbb_log/result", "done", 1, 9.5, 109.5),
        (STATE, "PREPARE", 1, 10.5, 110.5), (STATE, "STOP", 1, 20.0, 120.0), given("third", 1, 21.0, 121.0))
    assert [(goal.text, goal.seconds, goal.result) for goal in found] == [
        ("first", 5.0, ""), ("second", 1.5, "done"), ("third", None, "")]


@pytest.mark.parametrize("step", [-3600.0, 7200.0])
def test_a_step_of_the_clock_does_not_change_how_long_a_goal_took(step):
    goal, = goals_of(given("one", 1, 1.0, 101.0), (STATE, "WAITING_RESULT", 1, 3.0, 103.0),
                     (STATE, "STOP", 1, 8.0, 108.0 + step))
    assert goal.seconds == 5.0


def test_a_goal_over_a_restart_of_the_computer():
    goal, = goals_of(given("one", 1, 501.0, 101.0), (STATE, "WAITING_RESULT", 1, 503.0, 103.0),
                     (STATE, "STOP", 2, 8.0, 143.0))
    assert goal.seconds == 40.0
