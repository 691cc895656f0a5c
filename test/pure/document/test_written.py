"""Values are read back from their JSON as they were, and what does not fit is refused with its place."""

import json
from typing import Any, List, NamedTuple, Optional, Set, Union

import pytest
from hypothesis import given

from helpers.examples import examples
from helpers.toy_document import LOW, PLAIN, ZONES, Box, Light, Robot, Toy, Zone
from roah_rsbb.document.written import BadDocument, read, write
from roah_rsbb.model.fields import TypedText
from roah_rsbb.model.reason import Reason, say


@examples()
@given(ZONES)
def test_what_is_written_is_read_back(zone):
    found = read(Zone, json.loads(json.dumps(write(zone))))
    assert found == zone
    assert [(one.template, one.values) for one in found.why] == [(one.template, one.values) for one in zone.why]


def test_what_is_usual_is_left_out():
    assert write(Zone("Home")) == {"name": "Home"}
    zone = Zone("Home", Light.GREEN, robots=(Robot("r1", 0.0),), marks={"a": 1})
    assert write(zone) == {
        "name": "Home", "light": "green", "robots": [{"name": "r1", "charge": 0.0}], "marks": {"a": 1}}


def test_a_reason_keeps_its_values_only_where_one_is_declared():
    low = LOW(robot="r1", number=5)
    assert write(Zone(low, why=(low, PLAIN, "typed"))) == {
        "name": "r1 has 5 %", "why": [["{robot} has {number} %", {"robot": "r1", "number": 5}], str(PLAIN), "typed"]}
    assert type(write(Zone(low))["name"]) is str
    found = read(Zone, write(Zone("Home", why=(low, "typed"))))
    assert all(isinstance(reason, Reason) for reason in found.why) and found.why[0].values == low.values


def test_what_a_newer_box_knows_is_ignored_and_what_an_older_one_lacks_is_usual():
    assert read(Toy, {"weather": 1, "box": {"event": "e", "more": {}}}) == Toy(Box("e"))


def test_a_number_is_read_from_a_whole_one():
    found = read(Zone, {"name": "Home", "pose": [1, 2]})
    assert found.pose == (1.0, 2.0) and type(found.pose[0]) is float


@pytest.mark.parametrize(("data", "text"), [
    ([], "found [], expected an object"),
    ({"zones": {"Home": {}}}, "zones.Home: name missing"),
    ({"zones": {"Home": {"name": 1}}}, "zones.Home.name: found 1, expected a text"),
    ({"zones": {"Home": {"name": "", "count": True}}}, "zones.Home.count: found True, expected a whole number"),
    ({"zones": {"Home": {"name": "", "count": None}}}, "zones.Home.count: found None, expected a whole number"),
    ({"zones": {"Home": {"name": "", "is_open": 1}}}, "zones.Home.is_open: found 1, expected true or false"),
    ({"zones": {"Home": {"name": "", "light": "blue"}}}, "zones.Home.light: found 'blue': 'blue' is not a valid Light"),
    ({"zones": {"Home": {"name": "", "pose": [1.0]}}}, "zones.Home.pose: found 1 values, expected 2"),
    ({"zones": {"Home": {"name": "", "robots": [{"name": "a"}, {"name": "b", "charge": "c"}]}}},
     "zones.Home.robots.1.charge: found 'c', expected a number"),
    ({"zones": {"Home": {"name": "", "why": [1]}}}, "zones.Home.why.0: found 1, expected a text"),
    ({"zones": {"Home": {"name": "", "fields": [{"kind": "text"}]}}},
     "zones.Home.fields.0: found {'kind': 'text'}: 'label'"),
    ({"results": {}}, "results: found {}, expected a list"),
])
def test_what_does_not_fit_is_refused_with_its_place(data, text):
    with pytest.raises(BadDocument) as raised:
        read(Toy, data)
    assert str(raised.value) == text


def test_a_field_of_another_kind_is_refused():
    class Form(NamedTuple):
        field: TypedText

    label = say("Reason")
    assert read(Form, write(Form(TypedText("reason", label)))) == Form(TypedText("reason", label))
    with pytest.raises(BadDocument, match="found a field of the kind toggle, expected text"):
        read(Form, {"field": {"kind": "toggle", "name": "reason", "label": "Reason"}})


@pytest.mark.parametrize("hint", [List[int], Set[int], Union[int, str], Optional[bytes], object])
def test_what_a_document_cannot_hold_is_refused(hint):
    class Wrong(NamedTuple):
        value: hint

    with pytest.raises(TypeError, match="a document cannot hold"):
        write(Wrong(None))


def test_a_type_may_contain_itself():
    assert read(Tree, write(Tree(Tree(answer=[1])))) == Tree(Tree(answer=[1]))


class Tree(NamedTuple):
    """A value within another of its type."""

    inner: "Optional[Tree]" = None
    answer: Any = None
