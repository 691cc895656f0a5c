"""Ground truth from the frames of a motion-capture system (docs/benchmarks.md, "Benchmarking modules").

`Frames` is where frames come from: tf (nodes/modules/tf_frames.py), a simulated system (`DummyFrames`), or nowhere
(`NoFrames`). `FramesGroundTruth` makes poses of them. `ReloadingGroundTruth` also follows changes of the configuration
file. `ZonesGroundTruth` has one for each zone with its own file.
"""

import contextlib
import math
import os
import time
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.ground_truth import NO_TRANSFORM, GroundTruth, NoPose, Pose3, Source, compose
from roah_rsbb.bmbox.framework.parameters import Transform
from roah_rsbb.bmbox.framework.rule_files import WatchedFile, file_in
from roah_rsbb.model.modules import RunForModule
from roah_rsbb.rulebook.errors import Report, quote
from roah_rsbb.rulebook.yaml_fields import choice, describe, fields, number, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, read_yaml

# -- the configuration --------------------------------------------------------------------------------

# A *subject* is what rules ask for ("robot", "person"). A *marker* is the frame that the motion-capture system
# publishes for it, with the transform from the marker to the subject. A team may have its own markers, because they are
# mounted differently on each robot.

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


# -- ground truth -------------------------------------------------------------------------------------

# Frames are kept for this time; modules ask for poses that are a few seconds old at most.
KEPT_S = 10.0

_REMEDY_OLD = "check that the cameras see the marker"
_NO_SOURCE = f"ground truth is off: poses are not scored (source in {FILE_NAME})"
_REMEDY_CLOCKS = "synchronise the motion-capture computer's clock (chrony)"


class NoTransform(Exception):
    """The transform between two frames is not known. The text says what is missing."""


class NotAtOnce(NoTransform):
    """Two frames and those between them were not seen at the same time."""


class Frames:
    """Interface of the frames that a motion-capture system publishes. No method waits for a frame."""

    # What to do about a frame that was never seen.
    REMEDY_REFERENCE = REMEDY_MARKER = ""

    def use(self, config: GroundTruthConfig) -> None:
        """Watch the frames of this configuration from now on."""

    def take(self, runs: Sequence[RunForModule]) -> None:
        """Take the present runs, which only a simulated system needs."""

    def close(self) -> None:
        """Stop watching."""

    def now_utc(self) -> float:
        """The present time on the clock of the frames (UTC seconds)."""
        raise NotImplementedError

    def sees(self, frame: str) -> bool:
        """Whether a frame was ever seen."""
        raise NotImplementedError

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds between a time and the nearest publication of a marker's frame; None if never published."""
        raise NotImplementedError

    def lookup(self, reference: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """The pose of a frame in another one at a time (None: the latest), and its time (None: the frame is static).

        Raises NoTransform, or ValueError if the frame has an invalid rotation.
        """
        raise NotImplementedError


class NoFrames(Frames):
    """A box without ROS, and without a simulated motion-capture system."""

    REMEDY_REFERENCE = REMEDY_MARKER = (
        f"motion capture needs ROS: run the box with ROS, or set 'source: {Source.REFEREE.value}' or "
        f"'source: {Source.NONE.value}' in {FILE_NAME}")

    def now_utc(self) -> float:
        """See `Frames`."""
        return time.time()

    def sees(self, frame: str) -> bool:
        """See `Frames`."""
        return False

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """See `Frames`."""
        return None

    def lookup(self, reference: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """See `Frames`."""
        raise NoTransform("there are no frames")


class FrameState(NamedTuple):
    """Whether a marker is visible now."""

    team: str  # owner of the marker; empty if common
    subject: str
    frame: str
    pose: Optional[Pose3]  # of the marker itself
    trouble: str  # why there is no pose, with the remedy


class FramesGroundTruth(GroundTruth):
    """Poses from frames, with their markers and ages as in a configuration."""

    def __init__(self, config: GroundTruthConfig, frames: Frames) -> None:
        self._frames = frames
        self.use(config)

    def use(self, config: GroundTruthConfig) -> None:
        """Switch to another configuration."""
        self.config = config
        self._frames.use(config)

    def take(self, runs: Sequence[RunForModule]) -> None:
        """See `Frames.take`."""
        self._frames.take(runs)

    def close(self) -> None:
        """See `Frames.close`."""
        self._frames.close()

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """See GroundTruth.pose; the pose is at most `maximum_age_s` away from the requested time."""
        return self._pose(frame, "", at_utc)

    def for_team(self, team: str) -> GroundTruth:
        """See GroundTruth.for_team."""
        return _TeamGroundTruth(self, team)

    def _pose(self, subject: str, team: str, at_utc: Optional[float]) -> Pose3:
        marker = self.config.marker(subject, team)
        pose, stamp = self._seen(subject, marker.frame, at_utc)
        if stamp is not None:
            age_s = (self._frames.now_utc() if at_utc is None else at_utc) - stamp
            if abs(age_s) > self.config.maximum_age_s:
                raise NoPose(_age_text(subject, marker.frame, age_s, at_utc))
        return compose(pose, marker.transform)

    def _seen(self, subject: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """A frame's pose at a time, or else its latest pose, with its time; None if it is static."""
        gap = None if at_utc is None else self._frames.gap(frame, at_utc)
        if gap is not None and gap <= self.config.maximum_age_s:
            # Fails if the time is later than the latest pose, which is then used.
            with contextlib.suppress(NoTransform):
                return self._lookup(subject, frame, at_utc)[0], at_utc
        try:
            return self._lookup(subject, frame, None)
        except NoTransform as error:
            raise NoPose(self._missing(subject, frame, error)) from None

    def _lookup(self, subject: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        try:
            pose, stamp = self._frames.lookup(self.config.reference_frame, frame, at_utc)
        except ValueError as error:
            raise NoPose(f"{subject}: frame '{frame}' is published with an invalid rotation: {error}") from None
        if not all(map(math.isfinite, pose)):
            raise NoPose(f"{subject}: frame '{frame}' is published with values that are not finite")
        return pose, stamp

    # -- the check ------------------------------------------------------------------------------------------

    def states(self) -> Tuple[FrameState, ...]:
        """The state of all markers, for the operator of the motion-capture system."""
        return tuple(
            FrameState(team, subject, marker.frame, *self._found(subject, marker.frame))
            for team, subject, marker in self.config.all_markers()
        )

    def _found(self, subject: str, frame: str) -> Tuple[Optional[Pose3], str]:
        """A frame's present pose, or why it is missing.

        The text omits the age, so that it only changes with the state.
        """
        try:
            pose, stamp = self._seen(subject, frame, None)
        except NoPose as error:
            return None, str(error)
        age_s = 0.0 if stamp is None else self._frames.now_utc() - stamp
        if age_s > self.config.maximum_age_s:
            return None, f"{subject}: frame '{frame}' was last seen at {_clock(stamp)}: {_REMEDY_OLD}"
        if age_s < -self.config.maximum_age_s:
            return None, f"{subject}: frame '{frame}' has times in the future: {_REMEDY_CLOCKS}"
        return pose, ""

    def check(self, subjects: Iterable[str]) -> Tuple[List[str], List[str]]:
        """Check the ground truth of a benchmark: (problems, warnings). The texts change only if their causes do.

        A subject that is not configured is a problem. A missing pose is only a warning: it may be available when the
        rules ask for it (a marker that the referee has yet to place, a motion-capture system that is starting), and
        the rules retry a missing pose.
        """
        problems: List[str] = []
        warnings: List[str] = []
        is_off = not self._frames.sees(self.config.reference_frame)
        if is_off:
            warnings.append(f"ground truth: {self._never_seen(self.config.reference_frame)}")
        for subject in dict.fromkeys(subjects):
            try:
                frame = self.config.any_marker(subject).frame
            except NoPose as error:
                problems.append(f"ground truth: {error}")
                continue
            trouble = "" if is_off else self._found(subject, frame)[1]
            warnings += [f"ground truth: {trouble}"] if trouble else []
        return problems, warnings

    def _missing(self, subject: str, frame: str, error: Exception) -> str:
        reference = self.config.reference_frame
        for name in (reference, frame):
            if not self._frames.sees(name):
                return f"{subject}: {self._never_seen(name)}"
        if isinstance(error, NotAtOnce):
            return (f"{subject}: frame '{frame}' and the frames between it and '{reference}' were not seen at the "
                    f"same time: {_REMEDY_OLD}")
        return f"{subject}: frame '{frame}' has no connection with '{reference}': {error}"

    def _never_seen(self, frame: str) -> str:
        if frame == self.config.reference_frame:
            return f"reference frame '{frame}' was never seen: {self._frames.REMEDY_REFERENCE}"
        return f"frame '{frame}' was never seen: {self._frames.REMEDY_MARKER}"


class _TeamGroundTruth(GroundTruth):
    """The ground truth in a run of a team."""

    def __init__(self, whole: FramesGroundTruth, team: str) -> None:
        self._whole = whole
        self._team = team

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        return self._whole._pose(frame, self._team, at_utc)


def _age_text(subject: str, frame: str, age_s: float, at_utc: Optional[float]) -> str:
    about = f"{subject}: frame '{frame}'"
    if at_utc is not None:
        return f"{about} was not seen at {_clock(at_utc)}; the nearest time is {abs(age_s):.1f} s away: {_REMEDY_OLD}"
    if age_s < 0:
        return f"{about} has a time {-age_s:.1f} s in the future: {_REMEDY_CLOCKS}"
    return f"{about} was last seen {age_s:.1f} s ago: {_REMEDY_OLD}"


def _clock(utc: float) -> str:
    return time.strftime("%H:%M:%S UTC", time.gmtime(utc))


# -- with a configuration file that may change ------------------------------------------------------

class ReloadingGroundTruth:
    """The ground truth of one file, from frames that `make_frames` makes."""

    def __init__(self, path: str, make_frames: Callable[[], Frames]) -> None:
        self._file = WatchedFile(path, lambda: load(path))
        self._make_frames = make_frames
        self._truth: Optional[FramesGroundTruth] = None
        self._use()

    def reload(self) -> None:
        """Reload the file if it changed."""
        if self._file.reload():
            self._use()

    def of_team(self, team: str) -> GroundTruth:
        """The ground truth with the present file; raises NoPose if the file is invalid."""
        self.reload()
        if self._file.problems:
            raise NoPose("; ".join(self._file.problems))
        if self._truth is None:
            raise NoPose(f"{FILE_NAME} has no motion capture any more: restore it, or start the run again")
        return self._truth.for_team(team)

    @property
    def source(self) -> Source:
        """See GroundTruth.source. An invalid file keeps *start* off."""
        self.reload()
        return Source.MOTION_CAPTURE if self._file.problems else self._file.content().source

    def take(self, runs: Sequence[RunForModule]) -> None:
        """See `Frames.take`."""
        if self._truth is not None:
            self._truth.take(runs)

    def close(self) -> None:
        """See `Frames.close`."""
        if self._truth is not None:
            self._truth.close()
            self._truth = None

    def check(self, subjects: Sequence[str]) -> Tuple[List[str], List[str]]:
        """See FramesGroundTruth.check; also reports errors in the file."""
        if not subjects:
            return [], []
        self.reload()
        if self._file.problems:
            return self._file.problems, []
        if self._truth is None:
            return [], [_NO_SOURCE] if self.source is Source.NONE else []
        return self._truth.check(subjects)

    def _use(self) -> None:
        if self._file.problems:
            return
        if self._file.content().source is not Source.MOTION_CAPTURE:
            self.close()
        elif self._truth is None:
            self._truth = FramesGroundTruth(self._file.content(), self._make_frames())
        else:
            self._truth.use(self._file.content())


# -- by zone ----------------------------------------------------------------------------------------

class ZonesGroundTruth:
    """The ground truth of each zone: from its own file, or else from the file of all zones (`zone_folders`)."""

    def __init__(self, folder: str, make_frames: Callable[[], Frames]) -> None:
        self._folder = folder
        self._make_frames = make_frames
        self._by_path: Dict[str, ReloadingGroundTruth] = {}
        self.now("")

    def of_zone(self, zone: str) -> GroundTruth:
        """Return the ground truth that modules use for runs in a zone. It follows changes of the files."""
        return _OfZone(self, zone)

    def check(self, zone: str, subjects: Sequence[str]) -> Tuple[List[str], List[str]]:
        """See ReloadingGroundTruth.check."""
        return self.now(zone).check(subjects)

    def take(self, runs: Sequence[RunForModule]) -> None:
        """Take the present runs: each file's frames get those in its zones (see `Frames.take`)."""
        for path, truth in self._by_path.items():
            truth.take([run for run in runs if file_in(self._folder, run.zone, FILE_NAME) == path])

    def close(self) -> None:
        """See `Frames.close`."""
        for truth in self._by_path.values():
            truth.close()

    def now(self, zone: str) -> ReloadingGroundTruth:
        """Return what applies in a zone now."""
        for path in [path for path in self._by_path if not os.path.lexists(path)]:
            self._by_path.pop(path).close()
        path = file_in(self._folder, zone, FILE_NAME)
        if path not in self._by_path:
            self._by_path[path] = ReloadingGroundTruth(path, self._make_frames)
        return self._by_path[path]


class _OfZone(GroundTruth):
    """The ground truth in a zone, in the run of a team."""

    def __init__(self, zones: ZonesGroundTruth, zone: str, team: str = "") -> None:
        self._zones = zones
        self._zone = zone
        self._team = team

    @property
    def source(self) -> Source:
        return self._zones.now(self._zone).source

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        return self._zones.now(self._zone).of_team(self._team).pose(frame, at_utc)

    def for_team(self, team: str) -> GroundTruth:
        return _OfZone(self._zones, self._zone, team)
