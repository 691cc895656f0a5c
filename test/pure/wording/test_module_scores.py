"""A module's score in words."""

import pytest

from roah_rsbb.model.modules import ScoreValue
from roah_rsbb.wording.sheets import score_line, scores_by_group


@pytest.mark.parametrize("value, unit, text", [
    ("12", "", "12"), ("0.12399999", "m", "0.124 m"), ("2.0", "s", "2 s"), ("-0.0004", "rad", "0 rad"),
    ("true", "", "yes"), ("false", "", "no"), ("null", "m", "–"), ('"mug"', "", "mug"), ('""', "", ""),
    ("[1, 2]", "m", "[1, 2] m"), ("no JSON", "", "no JSON"), ("1e400", "", "inf"), ("NaN", "m", "nan m"),
])
def test_a_value_and_its_unit(value, unit, text):
    assert score_line(ScoreValue("", "x", value, unit)).value == text


def test_the_name_is_the_description_or_made_from_the_name():
    assert score_line(ScoreValue("", "distance_error", "1", "m", "Distance to the waypoint")).name == (
        "Distance to the waypoint"
    )
    assert score_line(ScoreValue("", "distance_error", "1", "m")).name == "distance error"


def test_groups_keep_their_order_and_the_whole_run_comes_first():
    scores = [
        ScoreValue("waypoint 2", "time", "3", "s"), ScoreValue("", "reached", "1", ""),
        ScoreValue("waypoint 1", "time", "4", "s"), ScoreValue("waypoint 2", "reached", "true", ""),
    ]
    assert scores_by_group(scores) == [
        ("Whole run", [("reached", "1")]),
        ("waypoint 2", [("time", "3 s"), ("reached", "yes")]),
        ("waypoint 1", [("time", "4 s")]),
    ]
    assert scores_by_group([]) == []
