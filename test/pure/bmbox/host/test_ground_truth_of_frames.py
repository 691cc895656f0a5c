"""Poses from frames: ages, troubles with their remedies, and configuration files that change."""

import pytest

from roah_rsbb.bmbox.framework.ground_truth import NoPose, Pose3, Source
from roah_rsbb.bmbox.host.ground_truth_of_frames import (
    Frames,
    FramesGroundTruth,
    GroundTruthConfig,
    Marker,
    NoFrames,
    NotAtOnce,
    NoTransform,
    ZonesGroundTruth,
)
from roah_rsbb.model.modules import RunForModule

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
    elsewhere = FramesGroundTruth(CONFIG._replace(reference_frame="nowhere"), ListedFrames(("m_robot", NOW, HERE)))
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
