"""Reasons of refusals survive the error text of a service call, whatever they contain."""

import pytest

pytest.importorskip("genpy")

from roah_rsbb.ros import messages  # noqa: E402  (only with ROS)

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
