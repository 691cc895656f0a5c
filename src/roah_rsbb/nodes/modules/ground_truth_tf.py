"""Ground truth from tf2: frames that a motion-capture system publishes (docs/benchmarks.md, "Benchmarking modules").

`TfGroundTruth` may be used from any thread and never waits for a frame. `ReloadingGroundTruth` also follows changes of
the configuration file. `ZonesGroundTruth` has one for each zone with its own file.
"""

import bisect
import collections
import contextlib
import math
import os
import threading
import time
from typing import Deque, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose3, Source, compose, yaw
from roah_rsbb.bmbox.framework.ground_truth_config import FILE_NAME, GroundTruthConfig, load
from roah_rsbb.bmbox.framework.zone_folders import file_in
from roah_rsbb.nodes.modules.watched_file import WatchedFile
from roah_rsbb.ros.times import ros_time

# tf2 keeps frames for this time; modules ask for poses that are a few seconds old at most.
_KEPT_S = 10.0
# Number of remembered times of publication per frame; at 200 Hz as long as tf2 keeps frames.
_STAMPS_KEPT = 2000
# The time of static frames.
_STATIC = rospy.Time()

_REMEDY_REFERENCE = (
    f"start the motion-capture system, check that it publishes ('rostopic hz /tf'), and check the name in {FILE_NAME}"
)
_REMEDY_NEVER = f"put the marker into the cameras' view, or check the name in {FILE_NAME} ('rosrun tf tf_monitor')"
_REMEDY_OLD = "check that the cameras see the marker"
_NO_SOURCE = f"ground truth is off: poses are not scored (source in {FILE_NAME})"
_REMEDY_CLOCKS = "synchronise the motion-capture computer's clock (chrony)"


class FrameState(NamedTuple):
    """Whether a marker is visible now."""

    team: str  # owner of the marker; empty if common
    subject: str
    frame: str
    pose: Optional[Pose3]  # of the marker itself
    trouble: str  # why there is no pose, with the remedy


class _Stamps:
    """Times at which frames were published, because tf2 interpolates across gaps without notice."""

    def __init__(self, frames: Iterable[str]) -> None:
        self._lock = threading.Lock()
        self._by_frame: Dict[str, Deque[float]] = {}
        self.watch(frames)

    def watch(self, frames: Iterable[str]) -> None:
        """Record these frames from now on."""
        with self._lock:
            old = self._by_frame
            self._by_frame = {frame: old.get(frame, collections.deque(maxlen=_STAMPS_KEPT)) for frame in frames}

    def on_tf(self, message: TFMessage) -> None:
        """Record the times in a message of /tf."""
        with self._lock:
            for transform in message.transforms:
                # Like tf2, ignore a leading '/', which early versions of ROS had.
                stamps = self._by_frame.get(transform.child_frame_id.lstrip("/"))
                if stamps is not None:
                    stamps.append(transform.header.stamp.to_sec())

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds between a time and the nearest publication of the frame; None if it was never published."""
        with self._lock:
            stamps = sorted(self._by_frame.get(frame, ()))
        if not stamps:
            return None
        after = bisect.bisect_left(stamps, at_utc)
        return min(abs(stamp - at_utc) for stamp in stamps[max(after - 1, 0) : after + 1])


def _frames(config: GroundTruthConfig) -> List[str]:
    return [marker.frame for _, _, marker in config.all_markers()]


class TfGroundTruth(GroundTruth):
    """Poses from tf. Create it after `rospy.init_node`."""

    def __init__(self, config: GroundTruthConfig) -> None:
        self.config = config
        self._buffer = tf2_ros.Buffer(rospy.Duration.from_sec(_KEPT_S), debug=False)
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._stamps = _Stamps(_frames(config))
        self._subscriber = rospy.Subscriber("/tf", TFMessage, self._stamps.on_tf)

    def use(self, config: GroundTruthConfig) -> None:
        """Switch to another configuration."""
        self._stamps.watch(_frames(config))
        self.config = config

    def close(self) -> None:
        """Stop listening."""
        self._listener.unregister()
        self._subscriber.unregister()

    def sees(self, frame: str) -> bool:
        """Whether tf knows a frame."""
        # As in tf.TransformListener.frameExists; can_transform(frame, frame) is true for any name.
        return self._buffer._frameExists(frame)

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds between a time and the nearest publication of a marker's frame; None if never published."""
        return self._stamps.gap(frame, at_utc)

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
            age_s = (rospy.get_time() if at_utc is None else at_utc) - stamp
            if abs(age_s) > self.config.maximum_age_s:
                raise NoPose(_age_text(subject, marker.frame, age_s, at_utc))
        return compose(pose, marker.transform)

    def _seen(self, subject: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """A frame's pose at a time, or else its latest pose, with its time; None if it is static."""
        gap = None if at_utc is None else self.gap(frame, at_utc)
        if gap is not None and gap <= self.config.maximum_age_s:
            # Fails if the time is later than the latest pose, which is then used.
            with contextlib.suppress(tf2_ros.TransformException):
                return self._lookup(subject, frame, ros_time(at_utc))[0], at_utc
        try:
            pose, stamp = self._lookup(subject, frame, _STATIC)
        except tf2_ros.TransformException as error:
            raise NoPose(self._missing(subject, frame, error)) from None
        return pose, None if stamp == _STATIC else stamp.to_sec()

    def _lookup(self, subject: str, frame: str, at: rospy.Time) -> Tuple[Pose3, rospy.Time]:
        found = self._buffer.lookup_transform(self.config.reference_frame, frame, at)
        place, turn = found.transform.translation, found.transform.rotation
        try:
            pose = Pose3(place.x, place.y, place.z, yaw((turn.x, turn.y, turn.z, turn.w)))
        except ValueError as error:
            raise NoPose(f"{subject}: frame '{frame}' is published with an invalid rotation: {error}") from None
        if not all(map(math.isfinite, pose)):
            raise NoPose(f"{subject}: frame '{frame}' is published with values that are not finite")
        return pose, found.header.stamp

    # -- the check ------------------------------------------------------------------------------------------

    def frames(self) -> Tuple[FrameState, ...]:
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
        age_s = 0.0 if stamp is None else rospy.get_time() - stamp
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
        is_off = not self.sees(self.config.reference_frame)
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
            if not self.sees(name):
                return f"{subject}: {self._never_seen(name)}"
        if isinstance(error, tf2_ros.ExtrapolationException):
            return (f"{subject}: frame '{frame}' and the frames between it and '{reference}' were not seen at the "
                    f"same time: "
                    f"{_REMEDY_OLD}")
        return f"{subject}: frame '{frame}' has no connection with '{reference}' in tf: {error}"

    def _never_seen(self, frame: str) -> str:
        if frame == self.config.reference_frame:
            return f"reference frame '{frame}' was never seen: {_REMEDY_REFERENCE}"
        return f"frame '{frame}' was never seen: {_REMEDY_NEVER}"


class _TeamGroundTruth(GroundTruth):
    """The ground truth in a run of a team."""

    def __init__(self, whole: TfGroundTruth, team: str) -> None:
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
    """The ground truth of one file. Create it after `rospy.init_node`."""

    def __init__(self, path: str) -> None:
        self._file = WatchedFile(path, lambda: load(path))
        self._tf: Optional[TfGroundTruth] = None
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
        if self._tf is None:
            raise NoPose(f"{FILE_NAME} has no motion capture any more: restore it, or start the run again")
        return self._tf.for_team(team)

    @property
    def source(self) -> Source:
        """See GroundTruth.source. An invalid file keeps *start* off."""
        self.reload()
        return Source.MOTION_CAPTURE if self._file.problems else self._file.content().source

    def close(self) -> None:
        """Stop listening."""
        if self._tf is not None:
            self._tf.close()
            self._tf = None

    def check(self, subjects: Sequence[str]) -> Tuple[List[str], List[str]]:
        """See TfGroundTruth.check; also reports errors in the file."""
        if not subjects:
            return [], []
        self.reload()
        if self._file.problems:
            return self._file.problems, []
        if self._tf is None:
            return [], [_NO_SOURCE] if self.source is Source.NONE else []
        return self._tf.check(subjects)

    def _use(self) -> None:
        if self._file.problems:
            return
        if self._file.content().source is not Source.MOTION_CAPTURE:
            self.close()
        elif self._tf is None:
            self._tf = TfGroundTruth(self._file.content())
        else:
            self._tf.use(self._file.content())


# -- by zone ----------------------------------------------------------------------------------------

class ZonesGroundTruth:
    """The ground truth of each zone: from its own file, or else from the file of all zones (`zone_folders`)."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._by_path: Dict[str, ReloadingGroundTruth] = {}
        self.now("")

    def of_zone(self, zone: str) -> GroundTruth:
        """Return the ground truth that modules use for runs in a zone. It follows changes of the files."""
        return _OfZone(self, zone)

    def check(self, zone: str, subjects: Sequence[str]) -> Tuple[List[str], List[str]]:
        """See ReloadingGroundTruth.check."""
        return self.now(zone).check(subjects)

    def now(self, zone: str) -> ReloadingGroundTruth:
        """Return what applies in a zone now."""
        for path in [path for path in self._by_path if not os.path.lexists(path)]:
            self._by_path.pop(path).close()
        path = file_in(self._folder, zone, FILE_NAME)
        if path not in self._by_path:
            self._by_path[path] = ReloadingGroundTruth(path)
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
