"""The core's reasons, out of the text that rospy makes of them."""

import pytest

from roah_rsbb.ros import refusals

RAISED = "service [/core/connect] responded with an error: "


@pytest.mark.parametrize("said, reasons", [
    ("b'service cannot process request: No robot; Skew'", ["No robot", "Skew"]),
    ("error processing request: No robot", ["No robot"]),
    ("b\"service cannot process request: no zone 'Home'\"", ["no zone 'Home'"]),
    ("b'service cannot process request: \\xc3\\xa9t\\xc3\\xa9 \\xff'", ["été \ufffd"]),
    ("b'broken", ["b'broken"]),
])
def test_the_reasons_are_found(said, reasons):
    assert refusals.was_answered(RAISED + said)
    assert refusals.reasons(RAISED + said) == reasons


def test_a_service_that_is_not_there_gave_no_reasons():
    raised = "service [/core/connect] unavailable"
    assert not refusals.was_answered(raised)
    assert refusals.reason(raised) == raised
