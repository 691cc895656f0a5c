"""Poses from frames: ages, troubles with their remedies, and configuration files that change."""

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, NoPose, Pose3, Source
from roah_rsbb.bmbox.host.ground_truth_of_frames import (
    Frames,
    FramesGroundTruth,
    GroundTruthConfig,
    Marker,
    NoFrames,
    NotAtOnce,
    NoTransform,
    ZonesGroundTruth,
    load,
)
from roah_rsbb.model.modules import RunForModule
from roah_rsbb.rulebook.errors import ConfigErrors

NOW = 1_800_000_000.0
HERE, THERE = Pose3(1.0, 2.0, 0.0, 0.0), Pose3(3.0, 2.0, 0.0, 0.0)
CONFIG = GroundTruthConfig("testbed", 0.5, {"robot": Marker("m_robot")}, {"Reds": {"robot": Marker("m_reds", HERE)}})
FILE = "reference_frame: testbed\nmaximum_age: 0.5\nmarkers: {robot: {frame: %s}}\n"


class ListedFrames(Frames):
    """Frames of a list: (frame, time, pose)."""

    REMEDY_REFERENCE, REMEDY_MARKER = "start it", "place it"

    def __init__(self, *listed, error=None):
        self.listed = listed
        self.error = error  # of each lookup
        self.runs = self.config = None
        self.is_closed = False

    def use(self, config):
        self.config = config

    def take(self, runs):
        self.runs = runs

    def close(self):
        self.is_closed = True

    def now_utc(self):
        return NOW

    def sees(self, frame):
        return frame == "testbed" or any(name == frame for name, _, _ in self.listed)

    def gap(self, frame, at_utc):
        return min((abs(utc - at_utc) for name, utc, _ in self.listed if name == frame and utc is not None),
                   default=None)

    def lookup(self, reference, frame, at_utc):
        if self.error is not None:
            raise self.error
        found = [(pose, utc) for name, utc, pose in self.listed if name == frame and at_utc in (None, utc)]
        if not found:
            raise NoTransform("nothing there")
        return found[-1]


def truth(*listed, **options):
    return FramesGroundTruth(CONFIG, ListedFrames(*listed, **options))


def test_the_latest_pose_counts_and_a_team_has_its_own_marker():
    found = truth(("m_robot", NOW - 2.0, THERE), ("m_robot", NOW - 0.4, HERE), ("m_reds", NOW, THERE))
    assert found.pose("robot") == HERE
    assert found.for_team("Reds").pose("robot") == Pose3(4.0, 4.0, 0.0, 0.0)
    assert found.for_team("Blues").pose("robot") == HERE
    assert found.check(["robot"]) == ([], [])
    found.use(CONFIG._replace(markers={}))
    assert found.check(["robot"]) == ([], []), "the marker of a team alone will do"


def test_an_earlier_pose():
    found = truth(("m_robot", NOW - 5.0, THERE), ("m_robot", NOW, HERE))
    assert found.pose("robot", NOW - 5.0) == THERE
    assert found.pose("robot", NOW + 0.3) == HERE, "the latest one is near enough"
    with pytest.raises(NoPose, match=r"^robot: frame 'm_robot' was not seen at .*; the nearest time is 3\.0 s away: "):
        found.pose("robot", NOW - 3.0)


def test_a_static_frame_is_never_too_old():
    found = truth(("m_robot", None, HERE))
    assert found.pose("robot") == found.pose("robot", NOW - 100.0) == HERE
    assert found.check(["robot"]) == ([], [])


@pytest.mark.parametrize(("stamp", "pose", "checked"), [
    (NOW - 0.75, r"was last seen 0\.8 s ago: check that the cameras", "was last seen at 07:59:59 UTC: check that"),
    (NOW + 0.75, r"has a time 0\.8 s in the future: synchronise", "has times in the future: synchronise"),
])
def test_a_pose_that_is_too_old_or_too_new(stamp, pose, checked):
    found = truth(("m_robot", stamp, HERE))
    with pytest.raises(NoPose, match=pose):
        found.pose("robot")
    problems, warnings = found.check(["robot"])
    assert (problems, len(warnings)) == ([], 1)
    assert warnings[0].startswith(f"ground truth: robot: frame 'm_robot' {checked}")


@pytest.mark.parametrize(("error", "text"), [
    (NoTransform("why"), "frame 'm_robot' has no connection with 'testbed': why"),
    (NotAtOnce("why"), "and the frames between it and 'testbed' were not seen at the same time: check that"),
    (ValueError("all zero"), "frame 'm_robot' is published with an invalid rotation: all zero"),
])
def test_a_pose_that_cannot_be_found(error, text):
    with pytest.raises(NoPose) as caught:
        truth(("m_robot", NOW, HERE), error=error).pose("robot")
    assert str(caught.value).startswith("robot: ") and text in str(caught.value)


def test_a_pose_that_is_not_finite():
    with pytest.raises(NoPose, match="values that are not finite"):
        truth(("m_robot", NOW, HERE._replace(x=float("inf")))).pose("robot")


def test_frames_name_the_remedy():
    with pytest.raises(NoPose, match="^robot: frame 'm_robot' was never seen: place it$"):
        truth().pose("robot")
    elsewhere = FramesGroundTruth(CONFIG._replace(reference_frame="nowhere"), ListedFrames())
    assert elsewhere.check(["robot"]) == (
        [], ["ground truth: reference frame 'nowhere' was never seen: start it"])


def test_a_subject_without_a_marker_is_a_problem():
    problems, warnings = truth(("m_robot", NOW, HERE)).check(["robot", "table"])
    assert (len(problems), warnings) == (1, [])
    assert problems[0].startswith("ground truth: table: has no marker: add 'table: {frame: name}'")


def test_without_ros_and_simulation_the_remedy_names_the_sources():
    found = FramesGroundTruth(CONFIG, NoFrames())
    with pytest.raises(NoPose, match="'testbed' was never seen: motion capture needs ROS: .*'source: referee'"):
        found.pose("robot")
    assert all("motion capture needs ROS" in state.trouble for state in found.states())


class Made(list):
    """The frames that were made."""

    def make(self):
        self.append(ListedFrames(("m_robot", NOW, HERE), ("m_other", NOW, THERE)))
        return self[-1]


def test_the_file_is_followed(tmp_path):
    path, made = tmp_path / "ground_truth.yaml", Made()
    path.write_text(FILE % "m_robot", "utf-8")
    zones = ZonesGroundTruth(str(tmp_path), made.make)
    zone = zones.of_zone("North").for_team("Reds")
    assert (zone.source, zone.pose("robot")) == (Source.MOTION_CAPTURE, HERE)
    path.write_text(FILE % "m_other", "utf-8")
    assert zone.pose("robot") == THERE
    path.write_text("markers: 1\n", "utf-8")
    with pytest.raises(NoPose, match=r"ground_truth\.yaml:1: "):
        zone.pose("robot")
    assert zones.check("North", ["robot"])[0] != []
    path.write_text("source: none\n", "utf-8")
    assert zone.source is Source.NONE
    assert zones.check("North", ["robot"]) == ([], ["ground truth is off: poses are not scored (source in "
                                                    "ground_truth.yaml)"])
    with pytest.raises(NoPose, match="has no motion capture any more"):
        zone.pose("robot")
    assert [frames.is_closed for frames in made] == [True]
    path.write_text(FILE % "m_robot", "utf-8")
    assert zone.pose("robot") == HERE
    assert [frames.is_closed for frames in made] == [True, False]
    zones.close()
    assert [frames.is_closed for frames in made] == [True, True]


def test_a_zone_has_its_own_frames_and_gets_its_own_runs(tmp_path):
    made = Made()
    (tmp_path / "ground_truth.yaml").write_text(FILE % "m_robot", "utf-8")
    (tmp_path / "North").mkdir()
    (tmp_path / "North" / "ground_truth.yaml").write_text(FILE % "m_other", "utf-8")
    zones = ZonesGroundTruth(str(tmp_path), made.make)
    assert (zones.of_zone("North").pose("robot"), zones.of_zone("South").pose("robot")) == (THERE, HERE)
    north, south, east = (RunForModule(zone, 1, zone, "HNF", "Reds", 1, 1, True) for zone in ("North", "South", "East"))
    zones.take((north, south, east))
    assert [frames.runs for frames in made] == [[south, east], [north]]
    (tmp_path / "North" / "ground_truth.yaml").unlink()
    assert zones.of_zone("North").pose("robot") == HERE
    assert [frames.is_closed for frames in made] == [False, True]


# -- ground_truth.yaml: markers, markers of teams, and errors in the file -----------------------------

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
