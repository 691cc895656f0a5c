"""The schema of a document describes what is written, with the words of its types."""

from typing import NamedTuple, Optional

import pytest
from hypothesis import given

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from helpers.examples import examples
from helpers.toy_document import ZONES, Box, Toy
from roah_rsbb.core.views.document import Documents
from roah_rsbb.document.schema import schema
from roah_rsbb.document.written import write
from roah_rsbb.model.document import Document


@examples()
@given(ZONES)
def test_what_is_written_fits_the_schema(zone):
    jsonschema = pytest.importorskip("jsonschema")
    found = schema(Toy)
    jsonschema.Draft7Validator.check_schema(found)
    validator = jsonschema.Draft7Validator(found)
    validator.validate(write(Toy(Box("e"), {"Home": zone})))
    for wrong in ({"count": "1"}, {"light": "blue"}, {"pose": [1.0]}, {"why": [1]}, {"name": None}):
        assert not validator.is_valid({"zones": {"Home": {**write(zone), **wrong}}})


class Tree(NamedTuple):
    """A value within another of its type."""

    name: str
    inner: "Optional[Tree]" = None


def test_a_type_is_defined_once_with_its_docstring():
    tree = {"$ref": "#/definitions/Tree"}
    assert schema(Tree) == {
        "$schema": "http://json-schema.org/draft-07/schema#", **tree, "definitions": {"Tree": {
            "description": "A value within another of its type.", "type": "object", "required": ["name"],
            "properties": {"name": {"type": "string"}, "inner": {"anyOf": [tree, {"type": "null"}]}}}}}


def test_the_document_of_a_box_fits_its_schema():
    jsonschema = pytest.importorskip("jsonschema")
    driver = BoxDriver(competition(tbm=["HWV"]))
    driver.executing()
    driver.score("Penalized", "bumps", 1)
    found = write(Documents(driver.box, "uuid", "10.0.0.255").look(driver.now))
    validator = jsonschema.Draft7Validator(schema(Document))
    validator.validate(found)
    found["zones"]["tbm"]["warnings"] = 7
    assert not validator.is_valid(found)
