"""Values are read back from their JSON as they were, what does not fit is refused with its place, moments move with a
new start of the computer, and the schema describes what is written."""

import json
from decimal import Decimal
from typing import Any, Dict, List, NamedTuple, Optional, Set, Union

import pytest
from hypothesis import given

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from helpers.examples import examples
from helpers.toy_document import LOW, PLAIN, ZONES, Box, Light, Robot, Toy, Zone
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.as_json import BadData, from_json, schema, to_json
from roah_rsbb.model.clock import Anchor, Mono, Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.fields import TypedText
from roah_rsbb.model.reason import Reason, say


@examples()
@given(ZONES)
def test_what_is_written_is_read_back(zone):
    found = from_json(Zone, json.loads(json.dumps(to_json(zone))))
    assert found == zone
    assert [(one.template, one.values) for one in found.why] == [(one.template, one.values) for one in zone.why]


def test_what_is_usual_is_left_out():
    assert to_json(Zone("Home")) == {"name": "Home"}
    zone = Zone("Home", Light.GREEN, robots=(Robot("r1", 0.0),), marks={"a": 1})
    assert to_json(zone) == {
        "name": "Home", "light": "GREEN", "robots": [{"name": "r1", "charge": 0.0}], "marks": {"a": 1}}


def test_a_reason_keeps_its_values_only_where_one_is_declared():
    low = LOW(robot="r1", number=5)
    assert to_json(Zone(low, why=(low, PLAIN, "typed"))) == {
        "name": "r1 has 5 %", "why": [["{robot} has {number} %", {"robot": "r1", "number": 5}], str(PLAIN), "typed"]}
    assert type(to_json(Zone(low))["name"]) is str
    found = from_json(Zone, to_json(Zone("Home", why=(low, "typed"))))
    assert all(isinstance(reason, Reason) for reason in found.why) and found.why[0].values == low.values


def test_what_a_newer_box_knows_is_ignored_and_what_an_older_one_lacks_is_usual():
    assert from_json(Toy, {"weather": 1, "box": {"event": "e", "more": {}}}) == Toy(Box("e"))


def test_a_number_is_read_from_a_whole_one():
    found = from_json(Zone, {"name": "Home", "pose": [1, 2]})
    assert found.pose == (1.0, 2.0) and type(found.pose[0]) is float


@pytest.mark.parametrize(("data", "text"), [
    ([], "found [], expected an object"),
    ({"zones": {"Home": {}}}, "zones.Home: name missing"),
    ({"zones": {"Home": {"name": 1}}}, "zones.Home.name: found 1, expected a text"),
    ({"zones": {"Home": {"name": "", "count": True}}}, "zones.Home.count: found True, expected a whole number"),
    ({"zones": {"Home": {"name": "", "count": None}}}, "zones.Home.count: found None, expected a whole number"),
    ({"zones": {"Home": {"name": "", "is_open": 1}}}, "zones.Home.is_open: found 1, expected true or false"),
    ({"zones": {"Home": {"name": "", "light": "blue"}}}, "zones.Home.light: found 'blue': 'blue'"),
    ({"zones": {"Home": {"name": "", "pose": [1.0]}}}, "zones.Home.pose: found 1 values, expected 2"),
    ({"zones": {"Home": {"name": "", "robots": [{"name": "a"}, {"name": "b", "charge": "c"}]}}},
     "zones.Home.robots.1.charge: found 'c', expected a number"),
    ({"zones": {"Home": {"name": "", "why": [1]}}}, "zones.Home.why.0: found 1, expected a text"),
    ({"zones": {"Home": {"name": "", "fields": [{"kind": "text"}]}}},
     "zones.Home.fields.0: found {'kind': 'text'}: 'label'"),
    ({"results": {}}, "results: found {}, expected a list"),
])
def test_what_does_not_fit_is_refused_with_its_place(data, text):
    with pytest.raises(BadData) as raised:
        from_json(Toy, data)
    assert str(raised.value) == text


def test_a_field_of_another_kind_is_refused():
    class Form(NamedTuple):
        field: TypedText

    label = say("Reason")
    assert from_json(Form, to_json(Form(TypedText("reason", label)))) == Form(TypedText("reason", label))
    with pytest.raises(BadData, match="found a field of the kind toggle, expected text"):
        from_json(Form, {"field": {"kind": "toggle", "name": "reason", "label": "Reason"}})


@pytest.mark.parametrize("hint", [Set[int], Union[int, str], Optional[bytes], Dict[int, str]])
def test_what_json_cannot_hold_is_refused(hint):
    class Wrong(NamedTuple):
        value: hint

    with pytest.raises(TypeError, match="JSON cannot hold"):
        to_json(Wrong(None))


# -- the schema

@examples()
@given(ZONES)
def test_what_is_written_fits_the_schema(zone):
    jsonschema = pytest.importorskip("jsonschema")
    found = schema(Toy)
    jsonschema.Draft7Validator.check_schema(found)
    validator = jsonschema.Draft7Validator(found)
    validator.validate(to_json(Toy(Box("e"), {"Home": zone})))
    for wrong in ({"count": "1"}, {"light": "blue"}, {"pose": [1.0]}, {"why": [1]}, {"name": None}):
        assert not validator.is_valid({"zones": {"Home": {**to_json(zone), **wrong}}})


class Tree(NamedTuple):
    """A value within another of its type."""

    name: str
    inner: "Optional[Tree]" = None
    answer: Any = None


def test_a_type_may_contain_itself_and_is_defined_once_with_its_docstring():
    assert from_json(Tree, to_json(Tree("a", Tree("b", answer=[1])))) == Tree("a", Tree("b", answer=[1]))
    tree = {"$ref": "#/definitions/Tree"}
    assert schema(Tree) == {
        "$schema": "http://json-schema.org/draft-07/schema#", **tree, "definitions": {"Tree": {
            "description": "A value within another of its type.", "type": "object", "required": ["name"],
            "properties": {
                "name": {"type": "string"}, "inner": {"anyOf": [tree, {"type": "null"}]}, "answer": {}}}}}


def test_the_document_of_a_box_fits_its_schema():
    jsonschema = pytest.importorskip("jsonschema")
    driver = BoxDriver(competition(tbm=["HWV"]))
    driver.executing()
    driver.score("Penalized", "bumps", 1)
    found = to_json(Documents(driver.box, "uuid", "10.0.0.255").look(driver.now))
    validator = jsonschema.Draft7Validator(schema(Document))
    validator.validate(found)
    found["zones"]["tbm"]["warnings"] = 7
    assert not validator.is_valid(found)


# -- what is saved of the core

class Inner(NamedTuple):
    limit: Decimal
    seen: Optional[Mono] = None


class State(NamedTuple):
    inner: Inner
    said: List[Inner] = []
    at: Optional[Now] = None


STATE = State(Inner(Decimal("1.50"), Mono(10.0)), [Inner(Decimal(2))], Now(20.0, 1e9))


def test_moments_are_moved_and_nothing_else():
    data = json.loads(json.dumps(to_json(STATE)))
    assert from_json(State, data) == STATE
    assert from_json(State, data, -5.0) == STATE._replace(inner=Inner(Decimal("1.50"), Mono(5.0)), at=Now(15.0, 1e9))


@pytest.mark.parametrize(("data", "text"), [
    ({}, "inner missing"), (None, "found None, expected an object"),
    ({"inner": {"limit": 1}}, "inner.limit: found 1, expected a text"),
    ({"inner": {"limit": "NaN"}}, "inner.limit: found 'NaN': it is not a number"),
    ({"inner": {"limit": "one"}}, "inner.limit: found 'one': "),
    ({"inner": {"limit": "1", "seen": float("nan")}}, "inner.seen: found nan, expected a time"),
    ({"inner": {"limit": "1"}, "said": {}}, "said: found {}, expected a list"),
    ({"inner": {"limit": "1"}, "said": [{"limit": "1"}, {}]}, "said.1: limit missing"),
    ({"inner": {"limit": "1"}, "at": {"mono": 1.0}}, "at: utc missing"),
    ({"inner": {"limit": "1"}, "at": {"mono": 1.0, "utc": float("inf")}}, "at.utc: found inf, expected a time"),
])
def test_an_invalid_saved_state(data, text):
    with pytest.raises(BadData) as raised:
        from_json(State, data)
    assert str(raised.value).startswith(text)


def test_a_boot_keeps_its_monotonic_clock_whatever_utc_did():
    assert Anchor(100.0, 1e9, "boot").shift(Now(107.0, 5e8), "boot") == 0.0


def test_a_new_boot_has_a_new_clock():
    # 60 s passed by UTC: what was due at 100 + 90 is due in 30 s.
    shift = Anchor(100.0, 1e9, "one").shift(Now(12.0, 1e9 + 60), "two")
    assert 190.0 + shift == 12.0 + 30.0


def test_a_clock_that_went_back_over_a_new_boot_means_no_time_passed():
    shift = Anchor(100.0, 1e9, "one").shift(Now(12.0, 1e9 - 3600), "two")
    assert 100.0 + shift == 12.0
