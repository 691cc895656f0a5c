"""A module's score: declared, typed, sent."""

import json

import pytest

from roah_rsbb.bmbox.framework.score import Score, Value
from roah_rsbb.model.modules import ScoreValue


def score():
    return Score({"reached": Value("Reached"), "error": Value("Error", "m")}, {"time": Value("Time", "s")})


def test_values_of_the_whole_run_are_null_until_they_are_set():
    assert score().values() == (
        ScoreValue("", "reached", "null", "", "Reached"), ScoreValue("", "error", "null", "m", "Error")
    )


def test_values_keep_their_type_unit_and_order():
    s = score()
    s["waypoint 2", "time"] = 1.5
    s["reached"] = 3
    s["waypoint 1", "time"] = None
    s["waypoint 2", "time"] = 2.5
    assert [(v.group, v.name, json.loads(v.value), v.unit) for v in s.values()] == [
        ("", "reached", 3, ""), ("", "error", None, "m"), ("waypoint 2", "time", 2.5, "s"),
        ("waypoint 1", "time", None, "s"),
    ]
    assert s["reached"] == 3
    assert s["waypoint 2", "time"] == 2.5
    assert s["waypoint 9", "time"] is None
    assert s.each("time") == [2.5, None]


@pytest.mark.parametrize("key", ["time", "reachd", ("waypoint 1", "reached")])
def test_an_undeclared_name_is_an_error_that_lists_the_declared_ones(key):
    s = score()
    with pytest.raises(KeyError, match="which has (reached, error|time)"):
        s[key] = 1
    with pytest.raises(KeyError):
        s[key]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), [1], {"a": 1}, object()])
def test_an_invalid_value_is_an_error(value):
    with pytest.raises(ValueError, match="score reached cannot be"):
        score()["reached"] = value
