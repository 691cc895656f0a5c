"""Every entry of the robot's state table (docs/protocol.md, "State machines")."""

import itertools

import pytest

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot.machine import (
    BOX_TABLE,
    EVENT_TABLE,
    Act,
    IllegalEvent,
    RobotEvent,
    Transition,
    box_transition,
    event_transition,
    override_goal_message,
    override_message,
    unexpected_state_text,
)

# The table as the protocol has it: rows are what the box sends, columns the robot's present state.
TABLE = """
                STOP        PREPARING   WAITING_GOAL      EXECUTING   RESULT_TX
STOP            STOP        STOP:HALT   STOP:HALT         STOP:HALT   STOP:END
PREPARE         PREPARING:PREPARE PREPARING WAITING_GOAL  EXECUTING   PREPARING:PREPARE
GOAL_TX         STOP:ERROR  STOP:ERROR  EXECUTING:EXECUTE EXECUTING   RESULT_TX
WAITING_RESULT  STOP:ERROR  STOP:ERROR  EXECUTING:EXECUTE_NO_GOAL EXECUTING RESULT_TX
"""


def _entries():
    header, *rows = [line.split() for line in TABLE.strip().splitlines()]
    for row in rows:
        for column, cell in zip(header, row[1:]):
            state, _, act = cell.partition(":")
            yield BoxState[row[0]], RobotState[column], Transition(RobotState[state], Act[act or "KEEP"])


@pytest.mark.parametrize("received, state, expected", _entries())
def test_every_entry(received, state, expected):
    benchmarks = ["HGTKMH", "HWV", "HCFGAC", "HOPF", "HPPF", "HPFF", "HGMF", "HOMF", "STB"]
    assert {box_transition(benchmark, received, state) for benchmark in benchmarks} == {expected}


@pytest.mark.parametrize("code", ["HNF", "FetchMug"])
@pytest.mark.parametrize("received, state, expected", _entries())
def test_in_hnf_and_other_codes_prepare_ends_the_goal_and_nothing_else_differs(code, received, state, expected):
    if (received, state) == (BoxState.PREPARE, RobotState.EXECUTING):
        expected = Transition(RobotState.PREPARING, Act.PREPARE)
    assert box_transition(code, received, state) == expected


def test_the_tables_have_exactly_these_entries():
    assert set(BOX_TABLE) == set(itertools.product(BoxState, RobotState))
    assert EVENT_TABLE == {
        (RobotEvent.PREPARATION_COMPLETE, RobotState.PREPARING): RobotState.WAITING_GOAL,
        (RobotEvent.GOAL_COMPLETE, RobotState.EXECUTING): RobotState.RESULT_TX,
    }


@pytest.mark.parametrize("event, state", itertools.product(RobotEvent, RobotState))
def test_own_events(event, state):
    if (event, state) in EVENT_TABLE:
        assert event_transition(event, state) is EVENT_TABLE[event, state]
        return
    only = {RobotEvent.PREPARATION_COMPLETE: "PREPARING", RobotEvent.GOAL_COMPLETE: "EXECUTING"}[event]
    with pytest.raises(IllegalEvent, match=f"{event.value}: only possible in {only}, but the robot is in {state.name}"):
        event_transition(event, state)


def test_an_error_says_what_came_and_what_the_robot_was_doing():
    text = unexpected_state_text(BoxState.GOAL_TX, RobotState.PREPARING)
    assert "GOAL_TX" in text and "PREPARING" in text


# -- the messages that simulate the box ---------------------------------------------------------------

def test_a_benchmark_by_its_number() -> None:
    message = override_message(11, 2, (3, 4), [True, False], [2])
    assert (message.benchmark_type, message.benchmark_state) == ("HOMF", pb.BenchmarkState.GOAL_TX)
    assert (message.acknowledgement.sec, message.acknowledgement.nsec) == (3, 4)
    assert (list(message.initial_state), list(message.switches)) == ([True, False], [2])


def test_number_zero_and_an_empty_code_end_the_override() -> None:
    assert override_message(0, 1, (0, 0), [], []) is None
    assert override_goal_message("", 1, (0, 0), "[1, 2, 3]") is None


def test_a_goal_by_its_code() -> None:
    assert override_goal_message("HNF", 2, (0, 0), "[1, 2, 3]").generic_goal == "[1, 2, 3]"
    assert not override_goal_message("Own", 3, (0, 0), "").HasField("generic_goal")


def test_errors_name_what_is_possible() -> None:
    with pytest.raises(IllegalEvent, match="unknown benchmark number 12: choose from 1 HGTKMH, 2 HWV"):
        override_message(12, 1, (0, 0), [], [])
    with pytest.raises(IllegalEvent, match="unknown benchmark state 4: choose from 0 STOP, 1 PREPARE"):
        override_goal_message("HNF", 4, (0, 0), "")
    with pytest.raises(IllegalEvent, match=r"expected \[x, y, theta\]"):
        override_goal_message("HNF", 2, (0, 0), "over there")
