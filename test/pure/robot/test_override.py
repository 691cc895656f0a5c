"""The messages that simulate the box."""

import pytest

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot.machine import IllegalEvent, override_goal_message, override_message


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
