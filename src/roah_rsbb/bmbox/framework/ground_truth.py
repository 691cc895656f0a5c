"""The ground truth: true poses, with which benchmarking modules compare the robots' results.

Theory of operation. A module asks for the pose of a *subject*: "robot", "person", "positioner", "object", "table".
The implementation (bmbox/host/ground_truth_of_frames.py, or a dictionary in tests) knows from its configuration which
frame that is and how the marker is mounted, so rules contain no frame names. A pose is planar with a height: x, y, z
in metres and theta, the yaw, in radians, in the reference frame of the test bed. A missing pose raises `NoPose`.

A competition without motion capture says so in its configuration (`Source`). Then `GroundTruth` gives no poses.
"""

import enum
import math
from typing import NamedTuple, Optional, Sequence, Tuple


class Pose2D(NamedTuple):
    """A pose in the plane."""

    x: float  # metres
    y: float  # metres
    theta: float  # radians


class Pose3(NamedTuple):
    """A pose in the plane with a height. As a transform: rotate by theta, then move by x, y, z."""

    x: float  # metres
    y: float  # metres
    z: float  # metres
    theta: float  # radians


NO_TRANSFORM = Pose3(0.0, 0.0, 0.0, 0.0)


class Source(enum.Enum):
    """Where poses come from (docs/organiser.md, "Without motion capture")."""

    MOTION_CAPTURE = "motion_capture"
    REFEREE = "referee"  # the referee measures and enters them
    NONE = "none"  # poses are not scored


class NoPose(Exception):
    """The pose is not available. The text names subject and frame, and whether it is missing or too old."""


class GroundTruth:
    """Interface of a source of poses."""

    @property
    def source(self) -> Source:
        """Where poses come from. Only motion capture gives them here."""
        return Source.MOTION_CAPTURE

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """The pose of a subject ("robot", "person", …) in the reference frame of the test bed; metres and radians.

        `at_utc`: UTC seconds in the past; None: now. Raises NoPose.
        """
        raise NotImplementedError

    def for_team(self, team: str) -> "GroundTruth":
        """The ground truth for the run of a team, whose robot may have its own markers."""
        return self


def normalised(angle: float) -> float:
    """The same angle in [−π, π]; radians, finite."""
    return math.remainder(angle, 2.0 * math.pi)


def angle_difference(a: float, b: float) -> float:
    """a − b in [−π, π]; radians, finite."""
    return normalised(normalised(a) - normalised(b))


def distance(a, b) -> float:
    """Planar distance between two poses of either kind; metres."""
    return math.hypot(a.x - b.x, a.y - b.y)


def compose(outer: Pose3, inner: Pose3) -> Pose3:
    """Transform `inner`, given in the frame `outer`, into the frame in which `outer` is given."""
    cos, sin = math.cos(outer.theta), math.sin(outer.theta)
    return Pose3(
        outer.x + cos * inner.x - sin * inner.y,
        outer.y + sin * inner.x + cos * inner.y,
        outer.z + inner.z,
        normalised(outer.theta + inner.theta),
    )


def inverse(pose: Pose3) -> Pose3:
    """The inverse transform: compose(pose, inverse(pose)) is the identity."""
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return Pose3(
        -cos * pose.x - sin * pose.y,
        sin * pose.x - cos * pose.y,
        -pose.z,
        normalised(-pose.theta),
    )


def seen_from(origin: Pose3, pose: Pose3) -> Pose3:
    """Transform a pose into the frame `origin`; both are given in the same frame."""
    return compose(inverse(origin), pose)


def yaw(quaternion: Sequence[float]) -> float:
    """The angle around the vertical axis of a quaternion (x, y, z, w), normalised or not; radians.

    Raises ValueError unless there are four finite numbers that are not all zero.
    """
    x, y, z, w = quaternion
    norm = x * x + y * y + z * z + w * w
    if not math.isfinite(norm) or norm <= 0.0:
        raise ValueError(f"({x}, {y}, {z}, {w}) is not a rotation")
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def rotation(theta: float) -> Tuple[float, float, float, float]:
    """The quaternion (x, y, z, w) of a rotation around the vertical axis; radians."""
    return (0.0, 0.0, math.sin(theta / 2.0), math.cos(theta / 2.0))
