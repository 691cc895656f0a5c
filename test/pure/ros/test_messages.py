"""Reasons of refusals survive the error text of a service call, whatever they contain. Requests that hold too much are
refused before anything is done with them."""

import pytest

genpy = pytest.importorskip("genpy")

from roah_rsbb.ros import messages  # noqa: E402  (only with ROS)
from roah_rsbb.ros.messages import MAX_LIST, MAX_TEXT, too_long  # noqa: E402

RAISED = "service [/core/connect] responded with an error: "


@pytest.mark.parametrize("reasons", [
    ["No robot"],
    ["No robot", "Skew; it may take some seconds"],
    ["the robot is silent; is it on?"],
    ['["looks like a list"]'],
    ["'quoted' \"twice\"", "été"],
    [],
])
def test_every_reason_comes_back_whole(reasons):
    sent = b"service cannot process request: " + messages.error_text(reasons).encode()
    assert messages.reasons(RAISED + repr(sent)) == reasons


def test_a_single_reason_is_sent_unchanged():
    assert messages.error_text(["no zone 'Home'"]) == "no zone 'Home'"


@pytest.mark.parametrize("said, reason", [
    ("error processing request: No robot", "No robot"),
    ("b\"service cannot process request: no zone 'Home'\"", "no zone 'Home'"),
    ("b'service cannot process request: \\xc3\\xa9t\\xc3\\xa9 \\xff'", "été \ufffd"),
    ("b'service cannot process request: No robot; is it on?'", "No robot; is it on?"),
    ("b'service cannot process request: [1, 2]'", "[1, 2]"),
    ("b'broken", "b'broken"),
])
def test_the_text_of_any_other_service_is_one_reason(said, reason):
    assert messages.was_answered(RAISED + said)
    assert messages.reasons(RAISED + said) == [reason]


def test_a_service_that_is_missing_gave_no_reasons():
    raised = "service [/core/connect] unavailable"
    assert not messages.was_answered(raised)
    assert messages.reason(raised) == raised


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
