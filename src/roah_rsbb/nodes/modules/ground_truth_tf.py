"""Ground truth from tf2: frames that a motion-capture system publishes (docs/benchmarks.md, "Benchmarking modules").

Safe to ask from any thread; nothing here waits for a frame.
"""

import bisect
import collections
import contextlib
import math
import threading
import time
from typing import Deque, Dict, Iterable, List, NamedTuple, Optional, Tuple

import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth, NoPose, Pose3, compose, yaw
from roah_rsbb.bmbox.framework.ground_truth_config import FILE_NAME, GroundTruthConfig
from roah_rsbb.ros.times import ros_time

# What a module asks about is at most seconds old; tf2 keeps this much.
_KEPT_S = 10.0
# Of each frame, when it was published; at 200 Hz as long as tf2 keeps it.
_STAMPS_KEPT = 2000
# A static frame has no time of its own.
_STATIC = rospy.Time()

_REMEDY_REFERENCE = (
    f"start the motion-capture system, see that it publishes ('rostopic hz /tf'), and compare the name in {FILE_NAME}"
)
_REMEDY_NEVER = f"put the marker into the cameras' view, or compare the name with {FILE_NAME} ('rosrun tf tf_monitor')"
_REMEDY_OLD = "see that the cameras have the marker in view"
_REMEDY_CLOCKS = "synchronise the motion-capture computer's clock (chrony)"


class FrameState(NamedTuple):
    """Whether a marker is seen now."""

    team: str  # whose marker it is; empty: everybody's
    subject: str
    frame: str
    pose: Optional[Pose3]  # of the marker itself
    trouble: str  # why there is none, with the remedy


class _Stamps:
    """When frames were published: tf2 would invent a pose for the middle of a gap, and not tell."""

    def __init__(self, frames: Iterable[str]) -> None:
        self._lock = threading.Lock()
        self._by_frame: Dict[str, Deque[float]] = {}
        self.watch(frames)

    def watch(self, frames: Iterable[str]) -> None:
        """From now on take note of these frames."""
        with self._lock:
            old = self._by_frame
            self._by_frame = {frame: old.get(frame, collections.deque(maxlen=_STAMPS_KEPT)) for frame in frames}

    def on_tf(self, message: TFMessage) -> None:
        """Take note of a message of /tf."""
        with self._lock:
            for transform in message.transforms:
                # Of ROS's early days: tf2 drops a '/' at the beginning, too.
                stamps = self._by_frame.get(transform.child_frame_id.lstrip("/"))
                if stamps is not None:
                    stamps.append(transform.header.stamp.to_sec())

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds from a time to the nearest at which the frame was published; None: it was never heard of."""
        with self._lock:
            stamps = sorted(self._by_frame.get(frame, ()))
        if not stamps:
            return None
        after = bisect.bisect_left(stamps, at_utc)
        return min(abs(stamp - at_utc) for stamp in stamps[max(after - 1, 0) : after + 1])


def _frames(config: GroundTruthConfig) -> List[str]:
    return [marker.frame for _, _, marker in config.all_markers()]


class TfGroundTruth(GroundTruth):
    """Where things are, from tf. Made after `rospy.init_node`."""

    def __init__(self, config: GroundTruthConfig) -> None:
        self.config = config
        self._buffer = tf2_ros.Buffer(rospy.Duration.from_sec(_KEPT_S), debug=False)
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._stamps = _Stamps(_frames(config))
        self._subscriber = rospy.Subscriber("/tf", TFMessage, self._stamps.on_tf)

    def use(self, config: GroundTruthConfig) -> None:
        """From now on go by another configuration."""
        self._stamps.watch(_frames(config))
        self.config = config

    def close(self) -> None:
        """Listen no more."""
        self._listener.unregister()
        self._subscriber.unregister()

    def sees(self, frame: str) -> bool:
        """Whether tf has heard of a frame at all."""
        # What tf.TransformListener.frameExists calls, too; can_transform(frame, frame) is true of any name.
        return self._buffer._frameExists(frame)

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """Seconds from a time to the nearest at which a marker's frame was published; None: it never was."""
        return self._stamps.gap(frame, at_utc)

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """See GroundTruth.pose; at most `maximum_age_s` away from the time that is asked for."""
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
                raise NoPose(_age_text(subject, marker.frame, stamp, age_s, at_utc))
        return compose(pose, marker.transform)

    def _seen(self, subject: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """A frame's pose at a time, or its latest where that must do, and when it was; None: it is static."""
        gap = None if at_utc is None else self.gap(frame, at_utc)
        if gap is not None and gap <= self.config.maximum_age_s:
            # Fails where the time is later than the latest of the frame: that one may do.
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
            raise NoPose(f"{subject}: frame '{frame}' is published with a rotation that is none: {error}") from None
        if not all(map(math.isfinite, pose)):
            raise NoPose(f"{subject}: frame '{frame}' is published with numbers that are not finite")
        return pose, found.header.stamp

    # -- the check ------------------------------------------------------------------------------------------

    def frames(self) -> Tuple[FrameState, ...]:
        """The state of all markers, for who looks after the motion-capture system."""
        return tuple(
            FrameState(team, subject, marker.frame, *self._found(subject, marker.frame))
            for team, subject, marker in self.config.all_markers()
        )

    def _found(self, subject: str, frame: str) -> Tuple[Optional[Pose3], str]:
        """A frame's pose now, or why there is none: without its age, so that the text stays while nothing changes."""
        try:
            pose, stamp = self._seen(subject, frame, None)
        except NoPose as error:
            return None, str(error)
        age_s = 0.0 if stamp is None else rospy.get_time() - stamp
        if age_s > self.config.maximum_age_s:
            return None, f"{subject}: frame '{frame}' was last seen at {_clock(stamp)}: {_REMEDY_OLD}"
        if age_s < -self.config.maximum_age_s:
            return None, f"{subject}: frame '{frame}' comes with times in the future: {_REMEDY_CLOCKS}"
        return pose, ""

    def check(self, subjects: Iterable[str]) -> Tuple[List[str], List[str]]:
        """What is wrong with what a benchmark needs, as (problems, warnings); the texts change only if that does.

        A problem is a subject that is not configured. What is not seen now may be there later, when the rules ask
        for it (a marker that the referee puts into its place, a motion-capture system that is still starting), and
        a pose that cannot be had then is asked for again: so that is a warning.
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
            return (f"{subject}: frame '{frame}' and what is between it and '{reference}' were not seen at one time: "
                    f"{_REMEDY_OLD}")
        return f"{subject}: frame '{frame}' has no connection with '{reference}' in tf: {error}"

    def _never_seen(self, frame: str) -> str:
        if frame == self.config.reference_frame:
            return f"reference frame '{frame}' was never seen: {_REMEDY_REFERENCE}"
        return f"frame '{frame}' was never seen: {_REMEDY_NEVER}"


class _TeamGroundTruth(GroundTruth):
    """The ground truth in a team's run."""

    def __init__(self, whole: TfGroundTruth, team: str) -> None:
        self._whole = whole
        self._team = team

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        return self._whole._pose(frame, self._team, at_utc)


def _age_text(subject: str, frame: str, stamp: float, age_s: float, at_utc: Optional[float]) -> str:
    about = f"{subject}: frame '{frame}'"
    if at_utc is not None:
        return f"{about} was not seen at {_clock(at_utc)}; {abs(age_s):.1f} s away is the nearest: {_REMEDY_OLD}"
    if age_s < 0:
        return f"{about} comes with a time {-age_s:.1f} s in the future: {_REMEDY_CLOCKS}"
    return f"{about} was last seen {age_s:.1f} s ago: {_REMEDY_OLD}"


def _clock(utc: float) -> str:
    return time.strftime("%H:%M:%S UTC", time.gmtime(utc))
