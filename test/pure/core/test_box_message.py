"""How a robot understands a message of the box."""

import pytest

from roah_rsbb.model.messages import BoxMessage, GoalMessage
from roah_rsbb.protocol import BoxState

MESSAGE = BoxMessage("HNF", BoxState.GOAL_TX, (1, 2), GoalMessage(text="1"))


def test_the_same_with_another_acknowledgement_is_a_repetition():
    assert MESSAGE.repeats(MESSAGE._replace(acknowledgement=(3, 4)))
    assert not MESSAGE.repeats(None)


@pytest.mark.parametrize("change", [
    {"state": BoxState.WAITING_RESULT}, {"goal": GoalMessage(text="2")}, {"benchmark": "HGMF"},
])
def test_all_else_is_news(change):
    assert not MESSAGE._replace(**change).repeats(MESSAGE)
