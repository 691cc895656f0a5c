"""Reasons are texts in English, and values that survive JSON and copies."""

import copy
import json
import pickle

import pytest

from roah_rsbb.model.actions import ACTIONS, Shown
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.fields import Choice
from roah_rsbb.model.reason import Reason, Template, decode, encode, joined, reason_of, say

SKEW = say("Clock skew of {robot} is {skew}")
ROBOT = say("the robot")


def test_a_template_without_places_is_a_reason():
    assert ROBOT == "the robot" and isinstance(ROBOT, Reason)
    assert (ROBOT.template, dict(ROBOT.values)) == ("the robot", {})


def test_a_reason_is_the_text_and_knows_what_it_is_made_of():
    reason = SKEW(robot=ROBOT, skew="+0.2 s")
    assert reason == "Clock skew of the robot is +0.2 s" and hash(reason) == hash(str(reason))
    assert (reason.template, reason.values["skew"]) == (SKEW, "+0.2 s")


@pytest.mark.parametrize("values", [{"robot": "r"}, {"other": 1}, {"robot": object(), "skew": {}}])
def test_wrong_values_leave_a_text(values):
    assert isinstance(Reason(SKEW, values), str)


@pytest.mark.parametrize("reason", [
    ROBOT, SKEW(robot=ROBOT, skew="+0.2 s"), SKEW(robot="{x}", skew=3), joined([ROBOT, SKEW(robot="r", skew=1)]),
    reason_of("a text of a robot: {0}"), say("{n} of {all}")(n=1, all=2.5), say("")
])
def test_json_and_copies_keep_it(reason):
    found = decode(json.loads(json.dumps(encode(reason))))
    for same in (found, copy.deepcopy(reason), pickle.loads(pickle.dumps(reason))):
        assert same == reason and same.template == reason.template
        assert {name: str(value) for name, value in same.values.items()} == {
            name: str(value) for name, value in reason.values.items()}
        assert [isinstance(value, Reason) for value in same.values.values()] == [
            isinstance(value, Reason) for value in reason.values.values()]
    assert type(copy.copy(ROBOT)) is Template


@pytest.mark.parametrize("found", [7, None, [], ["a"], ["a", 1], [{}, {}], {"a": 1}])
def test_something_else_in_json_is_a_text(found):
    assert isinstance(decode(found), Reason)


def test_actions_survive_json():
    robots = (Choice("robot", ACTIONS["connect"].fields[0].label, False, ("r1", "r2")),)
    for action in (Shown((SKEW(robot="r1", skew="+1 s"),), True, robots), Shown(("why",), False), Shown()):
        found = from_json(Shown, json.loads(json.dumps(to_json(action))))
        assert found == action
        assert [getattr(one, "values", None) for one in found.off][:1] in ([], [{}], [{"robot": "r1", "skew": "+1 s"}])
    assert to_json(Shown()) == {}, "what is usual takes no bytes"


def test_what_a_newer_box_may_send_is_read():
    found = from_json(Shown, {
        "fields": [{"kind": "colour", "name": "c", "label": "Colour", "required": True}], "more": 1})
    assert (found.fields[0].kind, found.fields[0].label) == ("text", "Colour")
