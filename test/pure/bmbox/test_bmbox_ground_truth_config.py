"""ground_truth.yaml: markers, markers of teams, and errors in the file."""

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, NoPose, Pose3, Source
from roah_rsbb.bmbox.host.ground_truth_of_frames import Marker, load
from roah_rsbb.rulebook.errors import ConfigErrors

GOOD = """\
reference_frame: testbed
maximum_age: 0.5
markers:
  robot: { frame: mocap_robot, transform: [0.1, 0.0, 0.0, 0.0] }
  person: { frame: mocap_person }
teams:
  Reds:
    robot: { transform: [0.0, 0.2, -1.0, 1.5] }
    hat: { frame: red_hat }
  Blues:
    robot: { frame: blue_robot }
"""


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "ground_truth.yaml"
        path.write_text(text, encoding="utf-8")
        return load(str(path))
    return read


@pytest.fixture
def errors(read):
    """Return the errors in GOOD after this change, as (line, text)."""
    def errors(old, new):
        assert old in GOOD
        with pytest.raises(ConfigErrors) as wrong:
            read(GOOD.replace(old, new, 1))
        return [(e.line, f"found {e.found}; expected {e.expected}") for e in wrong.value.errors]
    return errors


def test_markers_of_everybody(read):
    config = read(GOOD)
    assert (config.reference_frame, config.maximum_age_s) == ("testbed", 0.5)
    assert config.marker("person") == Marker("mocap_person", NO_TRANSFORM)
    assert config.marker("robot", "Greens") == Marker("mocap_robot", Pose3(0.1, 0.0, 0.0, 0.0))


def test_a_team_wears_the_common_marker_in_its_own_way(read):
    assert read(GOOD).marker("robot", "Reds") == Marker("mocap_robot", Pose3(0.0, 0.2, -1.0, 1.5))


def test_a_team_with_a_marker_of_its_own(read):
    # The common transform is of the common marker.
    assert read(GOOD).marker("robot", "Blues") == Marker("blue_robot", NO_TRANSFORM)
    assert read(GOOD).marker("person", "Blues").frame == "mocap_person"


def test_no_marker_names_the_remedy(read):
    with pytest.raises(NoPose, match="^table: has no marker: add 'table: {frame: name}' to the markers in"):
        read(GOOD).marker("table", "Reds")
    with pytest.raises(NoPose, match="hat: has no marker"):
        read(GOOD).marker("hat", "Blues")


def test_any_marker(read):
    assert read(GOOD).any_marker("robot").frame == "mocap_robot"
    assert read(GOOD).any_marker("hat").frame == "red_hat"
    with pytest.raises(NoPose):
        read(GOOD).any_marker("table")


def test_all_markers(read):
    assert [(team, subject, marker.frame) for team, subject, marker in read(GOOD).all_markers()] == [
        ("", "robot", "mocap_robot"), ("", "person", "mocap_person"), ("Reds", "robot", "mocap_robot"),
        ("Reds", "hat", "red_hat"), ("Blues", "robot", "blue_robot"),
    ]


def test_teams_may_be_left_out(read):
    assert read(GOOD[:GOOD.index("teams:")]).teams == {}


@pytest.mark.parametrize("old, new, line, found", [
    ("testbed", "/testbed", 1, "found '/testbed' as reference_frame; expected a frame name without a leading '/'"),
    ("0.5", "0", 2, "found the number '0' as maximum_age; expected a number of seconds above 0 and at most 10"),
    ("frame: mocap_person", "fame: mocap_person", 5, "found the unknown key 'fame' in the marker of 'person'"),
    ("{ frame: mocap_person }", "mocap_person", 5, "found the text 'mocap_person' as the marker of 'person'"),
    ("{ frame: mocap_person }", "{}", 5, "found the marker of 'person' without frame"),
    ("[0.1, 0.0, 0.0, 0.0]", "[0.1, 0.0, 0.0]", 4, "found 3 numbers as transform of the marker of 'robot'"),
    ("[0.0, 0.2, -1.0, 1.5]", "[0.0, x, -1.0, 1.5]", 8, "found the text 'x' as y of transform of the marker"),
    ("-1.0, 1.5", "-1.0, 90", 8, "expected a number of radians"),
    ("frame: blue_robot", "frame: /blue_robot", 11, "frame name without a leading '/'"),
    ("{ transform: [0.0, 0.2, -1.0, 1.5] }", "[]", 8, "found a sequence"),
])
def test_errors_are_named_with_their_line(errors, old, new, line, found):
    (only,) = errors(old, new)
    assert only[0] == line
    assert found in only[1]


def test_a_section_that_is_not_a_map(errors):
    found = errors(GOOD[GOOD.index("teams:"):], "teams: Reds\n")
    assert found == [(6, "found the text 'Reds' as teams; expected a map with a line 'team: markers' for each")]


def test_all_errors_at_once(errors):
    found = errors(GOOD[:GOOD.index("  person")], "maximum_age: fast\nmarkers:\n  robot: { frame: /r }\n")
    assert [line for line, _ in found] == [1, 1, 3]
    assert "without reference_frame" in found[0][1] or "without reference_frame" in found[1][1]


def test_the_shipped_file_has_all_that_the_rules_ask_for():
    config = load(str(SHIPPED / "modules" / "ground_truth.yaml"))
    assert set(config.markers) == {"robot", "person", "positioner", "object", "table"}


@pytest.mark.parametrize("source", [Source.REFEREE, Source.NONE])
def test_without_motion_capture_the_source_is_enough(read, source):
    config = read(f"source: {source.value}\n")
    assert (config.source, config.markers) == (source, {})
    assert read(GOOD + f"source: {source.value}\n").marker("robot").frame == "mocap_robot"  # for the day it is back


def test_motion_capture_is_the_default(read):
    assert read(GOOD).source is read(GOOD + "source: motion_capture\n").source is Source.MOTION_CAPTURE


def test_errors_about_the_source(errors):
    assert errors("maximum_age", "source: refere\nmaximum_age") == [
        (2, "found the text 'refere' as source; expected one of motion_capture, referee, none: did you mean "
            "'referee'?"),
    ]
    found = errors("reference_frame: testbed\nmaximum_age: 0.5", "source: none\nmaximum_age: old")
    assert [line for line, _ in found] == [2]
