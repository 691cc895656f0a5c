"""Fields read values of JSON and typed words, and name the remedy of what does not fit."""

import math
import re

import pytest

from helpers.forms import MEASURED, ODD
from roah_rsbb.model.actions import EVERY
from roah_rsbb.model.fields import (
    BadValue,
    Choice,
    Decimal,
    Number,
    Team,
    Toggle,
    TypedPose,
    TypedText,
    answered,
    field_of,
    form_of,
    form_text,
    read,
    typed_number,
)
from roah_rsbb.model.reason import say

SECONDS = Number("seconds", say("How long"), low=1, high=600)
OPTIONAL = Number("entry", say("Entry"), required=False, low=-1, default=-1)
REASON = TypedText("reason", say("Reason"), characters=10)
CUT = TypedText("reason", say("Reason"), required=False, characters=10, cut=True)
WHO = Choice("who", say("Who"), required=False, choices=("team", "jury"))
QUIET = Toggle("quiet", say("Quiet"), required=False)
TEAM = Team("team", say("Team"))
POSE, MAYBE = TypedPose("pose", say("Pose")), TypedPose("pose", say("Pose"), required=False)


@pytest.mark.parametrize("field, value", [
    (SECONDS, 0), (SECONDS, 601), (SECONDS, True), (SECONDS, 2.5), (SECONDS, "60"), (SECONDS, None), (SECONDS, [1]),
    (OPTIONAL, -2), (OPTIONAL, "x"), (OPTIONAL, False),
    (REASON, "x" * 11), (REASON, 5), (REASON, "\ud800"), (REASON, ""),
    (MEASURED, 2.6), (MEASURED, float("nan")), (MEASURED, True), (MEASURED, "high"), (MEASURED, ""), (MEASURED, None),
    (POSE, "1 2"), (POSE, "1 2 3 4"), (POSE, ""), (POSE, "one 2 3"), (POSE, "nan 0 0"), (POSE, "1e999 0 0"),
    (POSE, "2000 0 0"), (POSE, "0 0 400"), (POSE, "1,2,3"), (POSE, [1, 2]), (POSE, [1, 2, True]), (POSE, "0 0 inf"),
    (POSE, [1, 2, 90]), (POSE, [0.0, float("nan"), 0.0]), (POSE, {}),
    (WHO, "nobody"), (WHO, 1), (QUIET, 0), (QUIET, "yes"), (TEAM, ""), (TEAM, "x" * 501),
])
def test_what_does_not_fit_is_refused_with_the_name_of_the_field(field, value):
    with pytest.raises(BadValue) as bad:
        read([field], {field.name: value})
    assert str(field.label) in str(bad.value)


@pytest.mark.parametrize("field, value, found", [
    (SECONDS, 1, 1), (SECONDS, 600, 600), (Number("n", say("N")), 0, 0), (OPTIONAL, 0, 0), (OPTIONAL, -1, -1),
    (MEASURED, 1, 1.0), (MEASURED, " 1,5 ", 1.5), (POSE, [1, 2.5, 3], [1.0, 2.5, 3.0]), (MAYBE, None, None),
    (REASON, "why", "why"), (CUT, "x" * 99, "x" * 10), (WHO, "jury", "jury"), (WHO, "", ""), (QUIET, True, True),
    (QUIET, False, False), (TEAM, "Alpha", "Alpha"),
])
def test_what_fits_is_read(field, value, found):
    assert read([field], {field.name: value}) == {field.name: found}
    assert type(read([field], {field.name: value})[field.name]) is type(found)


def test_a_pose_is_typed_with_degrees():
    assert POSE.parse(" 1,5  −2.25 -180 ") == pytest.approx([1.5, -2.25, -math.pi])


def test_a_whole_number_is_typed_with_the_minus_of_any_keyboard():
    assert Number("n", say("N"), low=-9).parse("−3") == -3


@pytest.mark.parametrize("word, number", [
    ("0,125", "0.125"), ("01,000", "01.000"), ("1,25", "1.25"), ("1,2500", "1.2500"), ("1234,567", "1234.567"),
    ("1,000", "1,000"), ("−12,345", "−12,345"), ("+999,999", "+999,999"), ("1.234", "1.234"), ("1.230", "1,230")])
def test_a_number_that_can_be_two_is_none(word, number):
    assert typed_number(word) == number
    assert "," not in typed_number(word, -0.5, 0.5)
    if "," in number:
        with pytest.raises(BadValue, match=f"'{re.escape(word)}' can mean"):
            Decimal("n", say("N"), low=-1e6).read(word)


def test_what_is_left_out_of_a_modules_form():
    assert answered([WHO, MAYBE, QUIET], {"pose": "", "who": ""}) == {"who": "team", "pose": None, "quiet": False}
    assert answered([WHO], {"who": "jury"}) == {"who": "jury"}
    with pytest.raises(BadValue, match="Pose is missing"):
        answered([POSE], {"pose": ""})


def test_a_form_survives_json():
    assert form_of(form_text([MEASURED, *ODD])) == (MEASURED, *ODD)
    assert (form_text([]), form_of("")) == ("", ())


def test_what_is_left_out():
    assert read([OPTIONAL, CUT, WHO, QUIET], {}) == {"entry": -1, "reason": "", "who": "", "quiet": False}
    for field in (SECONDS, REASON, TEAM, Toggle("sure", say("Sure"))):
        with pytest.raises(BadValue, match="is missing"):
            read([field], {})


def test_a_number_that_is_given_keeps_to_its_bounds_also_if_it_may_be_left_out():
    field = Number("a", say("A"), required=False, low=5, high=10)
    assert (read([field], {}), read([field], {"a": 5})) == ({"a": 0}, {"a": 5})
    with pytest.raises(BadValue, match="from 5 to 10"):
        read([field], {"a": 0})


def test_an_unknown_field_names_those_that_there_are():
    with pytest.raises(BadValue, match="no field 'second': it has reason, seconds"):
        read([SECONDS, REASON], {"second": 1})
    with pytest.raises(BadValue, match="no field 'x': it has none"):
        read([], {"x": 1})


@pytest.mark.parametrize("field, word, found", [
    (SECONDS, "60", 60), (SECONDS, "601", None), (SECONDS, "soon", None), (QUIET, "Yes", True), (QUIET, "no", False),
    (QUIET, "perhaps", None), (WHO, "team", "team"), (WHO, "x", None), (REASON, "why", "why"), (REASON, "x" * 11, None),
])
def test_typed_words(field, word, found):
    if found is None:
        with pytest.raises(BadValue):
            field.parse(word)
    else:
        assert field.parse(word) == found


@pytest.mark.parametrize("name", EVERY)
def test_the_form_of_every_field_survives_json(name):
    for field in EVERY[name].fields:
        assert field_of(field.form()) == field
