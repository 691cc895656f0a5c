"""Requests that hold too much are refused before anything is done with them."""

import pytest

genpy = pytest.importorskip("genpy")

from roah_rsbb.ros.messages import MAX_LIST, MAX_TEXT, too_long  # noqa: E402  (only with ROS)

LONG = "x" * (MAX_TEXT + 1)


class Score(genpy.Message):
    __slots__ = ("desc", "value")

    def __init__(self, desc):
        self.desc, self.value = desc, 1


class Request(genpy.Message):
    __slots__ = ("picture", "score", "texts", "zone")

    def __init__(self, zone="Home", score="door", texts=(), picture=b""):
        self.zone, self.score, self.texts, self.picture = zone, Score(score), list(texts), picture


@pytest.mark.parametrize("request_, problem", [
    (Request(), ""),
    (Request("x" * MAX_TEXT, "x" * MAX_TEXT, ["x" * MAX_TEXT] * MAX_LIST, b"x" * 10 * MAX_TEXT), ""),
    (Request(LONG), f"zone has {MAX_TEXT + 1} characters: at most {MAX_TEXT} are accepted"),
    (Request(score=LONG), f"desc has {MAX_TEXT + 1} characters: at most {MAX_TEXT} are accepted"),
    (Request(texts=["a", LONG]), f"texts has {MAX_TEXT + 1} characters: at most {MAX_TEXT} are accepted"),
    (Request(texts=["a"] * (MAX_LIST + 1)), f"texts has {MAX_LIST + 1} entries: at most {MAX_LIST} are accepted"),
])
def test_too_long_values_are_named(request_, problem):
    assert too_long(request_) == problem
