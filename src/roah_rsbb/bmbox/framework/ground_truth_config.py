"""The file ground_truth.yaml: which frames of the motion-capture system belong to which subjects.

A *subject* is what rules ask for ("robot", "person"). A *marker* is the frame that the motion-capture system publishes
for it, with the transform from the marker to the subject. A team may have its own markers, because they are mounted
differently on each robot.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, NoPose, Pose3, Source
from roah_rsbb.bmbox.framework.parameters import Transform
from roah_rsbb.rulebook.errors import Report, quote
from roah_rsbb.rulebook.yaml_fields import choice, describe, fields, number, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, read_yaml

FILE_NAME = "ground_truth.yaml"
_SOURCES = tuple(source.value for source in Source)
# Without motion capture, these may be left out.
_OF_MOTION_CAPTURE = {
    "reference_frame": "testbed", "maximum_age": "0.5", "markers": "{robot: {frame: mocap_robot}}",
}
_SHAPE = "a map with reference_frame, maximum_age and markers"
_MARKERS_SHAPE = "a map with a line 'subject: {frame: name}' for each marker, such as 'robot: {frame: mocap_robot}'"
_TRANSFORM = Transform()


class Marker(NamedTuple):
    """The frame that belongs to a subject."""

    frame: str
    transform: Pose3 = NO_TRANSFORM  # from the marker to the subject


class GroundTruthConfig(NamedTuple):
    """The content of the file."""

    reference_frame: str
    maximum_age_s: float  # older measurements are not used
    markers: Dict[str, Marker]  # by subject
    teams: Dict[str, Dict[str, Marker]]  # by team, then by subject; default: `markers`
    source: Source = Source.MOTION_CAPTURE

    def marker(self, subject: str, team: str = "") -> Marker:
        """The marker of a subject in a team's run. Raises NoPose if it has none."""
        marker = self.teams.get(team, {}).get(subject) or self.markers.get(subject)
        if marker is None:
            raise NoPose(f"{subject}: has no marker: add '{subject}: {{frame: name}}' to the markers in {FILE_NAME}")
        return marker

    def any_marker(self, subject: str) -> Marker:
        """The common marker of a subject, or else the first team's. Raises NoPose if there is none."""
        owners = [team for team, markers in self.teams.items() if subject in markers]
        return self.marker(subject, "" if subject in self.markers or not owners else owners[0])

    def all_markers(self) -> Tuple[Tuple[str, str, Marker], ...]:
        """All markers as (team or "", subject, marker)."""
        common = [("", subject, marker) for subject, marker in self.markers.items()]
        own = [(team, subject, m) for team, markers in self.teams.items() for subject, m in markers.items()]
        return tuple(common + own)


def load(path: str) -> GroundTruthConfig:
    """Read the file; raises ConfigErrors with all errors."""
    report = Report()
    root = read_yaml(path, report, "the ground truth's configuration", _SHAPE)
    config = _config(report, root)
    report.raise_errors()
    assert config is not None, "without errors there is a configuration"
    return config


def _config(report: Report, root: Optional[Node]) -> Optional[GroundTruthConfig]:
    optional = {"teams": "{Team: {robot: {transform: [0.1, 0.0, 0.0, 0.0]}}}", "source": Source.MOTION_CAPTURE.value}
    is_measured = _word(root, "source") not in (Source.REFEREE.value, Source.NONE.value)
    required, optional = (_OF_MOTION_CAPTURE, optional) if is_measured else ({}, {**_OF_MOTION_CAPTURE, **optional})
    found = fields(report, root, "the ground truth's configuration", required, optional)
    if found is None:
        return None
    source = Source.MOTION_CAPTURE.value
    if "source" in found:
        source = choice(report, found["source"], "source", _SOURCES, f"one of {', '.join(_SOURCES)}") or source
    reference_frame = _frame(report, found.get("reference_frame"), "reference_frame")
    maximum_age_s = number(report, found.get("maximum_age"), "maximum_age", "seconds", above=0.0, most=10.0)
    markers = _markers(report, found.get("markers"), "markers", {})
    teams = {
        key.text: _markers(report, value, f"markers of team {quote(key.text)}", markers)
        for key, value in _pairs(report, found.get("teams"), "teams", "a map with a line 'team: markers' for each")
    }
    if not is_measured:
        return GroundTruthConfig(reference_frame or "", maximum_age_s or 0.0, markers, teams, Source(source))
    if reference_frame is None or maximum_age_s is None:
        return None
    return GroundTruthConfig(reference_frame, maximum_age_s, markers, teams)


def _word(node: Optional[Node], wanted: str) -> str:
    """Return the text of a key's value; empty if it has none."""
    pairs = node.pairs if isinstance(node, Mapping) else ()
    return next((value.text for key, value in pairs if key.text == wanted and isinstance(value, Scalar)), "")


def _pairs(report: Report, node: Optional[Node], what: str, shape: str) -> Tuple[Tuple[Scalar, Node], ...]:
    if node is None:
        return ()
    if not isinstance(node, Mapping):
        report.error(node.place, f"{describe(node)} as {what}", shape)
        return ()
    return node.pairs


def _markers(report: Report, node: Optional[Node], what: str, common: Dict[str, Marker]) -> Dict[str, Marker]:
    """Read the markers by subject. One without a frame uses the common marker's frame with another transform."""
    markers = {}
    for key, value in _pairs(report, node, what, _MARKERS_SHAPE):
        shared = common.get(key.text)
        name = f"the marker of {quote(key.text)}"
        required = {} if shared else {"frame": "mocap_" + key.text}
        optional = {"transform": _TRANSFORM.example, **({"frame": shared.frame} if shared else {})}
        found = fields(report, value, name, required, optional) or {}
        frame, transform = shared.frame if shared else None, NO_TRANSFORM
        if "frame" in found:
            frame = _frame(report, found["frame"], f"frame of {name}")
        if "transform" in found:
            transform = _TRANSFORM.read(report, found["transform"], f"transform of {name}")
        # Keep a marker with errors, so that a team's marker without a frame is no further error.
        markers[key.text] = Marker(frame or "", transform or NO_TRANSFORM)
    return markers


def _frame(report: Report, node: Optional[Node], what: str) -> Optional[str]:
    name = text(report, node, what, 200)
    if name is not None and name.startswith("/"):
        report.error(node.place, f"{quote(name)} as {what}", "a frame name without a leading '/', as in tf2")
        return None
    return name
