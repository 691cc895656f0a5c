"""Messages as the box sees them, as robots understand them, and as they stand in run logs."""

import pytest
import yaml

from roah_rsbb.model.messages import NEVER, BoxMessage, GoalMessage, RobotReport
from roah_rsbb.protocol import BoxState, RobotState


def test_a_robots_message_in_the_log_holds_what_was_sent():
    report = RobotReport((12, 5), 3, RobotState.EXECUTING)
    assert yaml.safe_load(report.lines()) == {"time": [12, 5], "messages_saved": 3, "state": "EXECUTING"}


def test_every_field_of_a_robots_message_can_be_read_back_from_the_log():
    report = RobotReport(
        (-1, 2**63 - 1), 2**32 - 1, RobotState.RESULT_TX, notifications=("a: b", 'say "hi"\n'), activation_event=("é",),
        visitor=("- x",), final_command=("#",), switch_1=True, switch_2=False, switch_3=True, dimmer=0, blinds=100,
        display_map=False, generic_result="{x: 1}\n", object_class="cups", object_name="null", object_pose_x=1.5,
        object_pose_y=-0.25, object_pose_theta=3.0,
    )
    read = yaml.safe_load(report.lines())
    expected = report._asdict()
    expected["state"] = "RESULT_TX"
    assert read == {name: list(value) if isinstance(value, tuple) else value for name, value in expected.items()}


def test_the_boxs_message_in_the_log():
    message = BoxMessage("HWV", BoxState.PREPARE, (12, 5))
    assert yaml.safe_load(message.lines()) == {"benchmark": "HWV", "state": "PREPARE", "acknowledgement": [12, 5]}
    assert BoxMessage("HWV", BoxState.STOP).acknowledgement == NEVER == (0, 0)


MESSAGE = BoxMessage("HNF", BoxState.GOAL_TX, (1, 2), GoalMessage(text="1"))


def test_the_same_with_another_acknowledgement_is_a_repetition():
    assert MESSAGE.repeats(MESSAGE._replace(acknowledgement=(3, 4)))
    assert not MESSAGE.repeats(None)


@pytest.mark.parametrize("change", [
    {"state": BoxState.WAITING_RESULT}, {"goal": GoalMessage(text="2")}, {"benchmark": "HGMF"},
])
def test_all_else_is_news(change):
    assert not MESSAGE._replace(**change).repeats(MESSAGE)
