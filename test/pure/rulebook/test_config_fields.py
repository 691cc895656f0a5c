"""Typed values, as the files of benchmarking modules use them beyond what the box's own files need."""

import pytest

from helpers.config_files import line_of
from roah_rsbb.rulebook import yaml_fields
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.rulebook.yaml_lines import read_yaml
from roah_rsbb.wording.texts import nearest

TEXT = """
table_size: {x: 1.2, y: 0.8}
waypoints:
  - [1, -2.5, .5e1]
  - [0, 1e999]
"""


@pytest.fixture
def report():
    return Report()


@pytest.fixture
def tree(tmp_path, report):
    path = tmp_path / "HNF.yaml"
    path.write_text(TEXT)
    root = read_yaml(str(path), report, "the parameters of HNF", "'waypoints: ...'")
    return yaml_fields.fields(report, root, "the parameters", {"table_size": "{}", "waypoints": "[]"}, {})


def test_nested_numbers(tree, report):
    size = yaml_fields.fields(report, tree["table_size"], "table_size", {"x": "1.2", "y": "0.8"}, {})
    assert [yaml_fields.number(report, size[key], key, unit="metres", above=0) for key in "xy"] == [1.2, 0.8]
    waypoint = yaml_fields.sequence(report, tree["waypoints"], "waypoints", "[x, y, theta]")[0]
    assert [yaml_fields.number(report, node, "waypoint") for node in waypoint.items] == [1, -2.5, 5]
    report.raise_errors()


def test_bounds_and_unit_are_in_the_message(tree, report):
    waypoint = yaml_fields.sequence(report, tree["waypoints"], "waypoints", "[x, y, theta]")[0]
    assert yaml_fields.number(report, waypoint.items[1], "x", unit="metres", least=-2.5, most=-2.5) == -2.5
    assert yaml_fields.number(report, waypoint.items[1], "x", unit="metres", least=-2, most=2) is None
    assert yaml_fields.number(report, waypoint.items[1], "x", above=-2.5) is None
    with pytest.raises(ConfigErrors) as caught:
        report.raise_errors()
    line = line_of(TEXT, "-2.5")
    assert [(e.line, e.column, e.found, e.expected) for e in caught.value.errors] == [
        (line, 9, "the number '-2.5' as x", "a number of metres at least -2 and at most 2"),
        (line, 9, "the number '-2.5' as x", "a number above -2.5"),
    ]


def test_a_number_without_bounds_is_finite(tree, report):
    waypoint = yaml_fields.sequence(report, tree["waypoints"], "waypoints", "[x, y, theta]")[1]
    assert yaml_fields.number(report, waypoint.items[1], "y") is None
    assert len(report.errors) == 1


def test_a_missing_or_reported_value_gives_no_error(report):
    assert yaml_fields.number(report, None, "x") is None
    assert yaml_fields.text(report, None, "x") is None
    assert yaml_fields.integer(report, None, "x", 0, 1) is None
    assert yaml_fields.choice(report, None, "x", ("a",), "a") is None
    assert yaml_fields.utc_time(report, None, "x") is None
    assert yaml_fields.sequence(report, None, "x", "y") is None
    assert yaml_fields.fields(report, None, "x", {}, {}) is None
    report.raise_errors()


def test_the_nearest_word_is_looked_for_among_few(report):
    """With ten thousand teams and as many unknown ones the search would take an hour."""
    words = [str(number) for number in range(1000, 1200)]
    assert nearest("Tema", ["Other", "team"]) == "team"
    assert nearest("Tema", ["Team", *words]) == "Team"
    assert nearest("Tema", [*words, "Team"]) is None
