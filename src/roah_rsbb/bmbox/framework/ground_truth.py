"""Where things really are: what benchmarking modules measure robots against.

Theory of operation. A module asks for the pose of a *subject*: "robot", "person", "positioner", "object",
"table". Which frame that is, and how the marker sits on what carries it, is configuration of whoever answers
(nodes/ground_truth_tf.py; a dictionary in tests), so that rules hold no names of frames. Poses are planar with a
height: x, y, z in metres and theta, the yaw, in radians, seen from the reference frame of the test bed. A pose
that cannot be had is `NoPose`, never an invented one.
"""

import math
from typing import NamedTuple, Optional, Sequence, Tuple


class Pose2D(NamedTuple):
    """A pose in the plane."""

    x: float  # metres
    y: float  # metres
    theta: float  # radians


class Pose3(NamedTuple):
    """A pose in the plane, and how high above it; as a transform: turn by theta, then move by x, y, z."""

    x: float  # metres
    y: float  # metres
    z: float  # metres
    theta: float  # radians

    @property
    def planar(self) -> Pose2D:
        """The pose without its height."""
        return Pose2D(self.x, self.y, self.theta)


NO_TRANSFORM = Pose3(0.0, 0.0, 0.0, 0.0)


class NoPose(Exception):
    """A pose that cannot be had; the text names subject and frame, and says whether it is missing or how old it is."""


class GroundTruth:
    """What answers where things are."""

    def pose(self, frame: str, at_utc: Optional[float] = None) -> Pose3:
        """Where a subject ("robot", "person", …) is, in the reference frame of the test bed; metres and radians.

        at_utc: UTC seconds of the past (a little of the present is fine); None: now. Raises NoPose.
        """
        raise NotImplementedError

    def for_team(self, team: str) -> "GroundTruth":
        """The same for the run of a team, whose robot carries its marker in its own way."""
        return self


def normalised(angle: float) -> float:
    """The same angle in [−π, π]; radians, finite."""
    return math.remainder(angle, 2.0 * math.pi)


def angle_difference(a: float, b: float) -> float:
    """a − b the short way round, in [−π, π]; radians, finite."""
    return normalised(normalised(a) - normalised(b))


def distance(a, b) -> float:
    """Between two poses of either kind, in the plane; metres."""
    return math.hypot(a.x - b.x, a.y - b.y)


def compose(outer: Pose3, inner: Pose3) -> Pose3:
    """Where `inner`, given in the frame that stands at `outer`, is in the frame in which `outer` is given."""
    cos, sin = math.cos(outer.theta), math.sin(outer.theta)
    return Pose3(
        outer.x + cos * inner.x - sin * inner.y,
        outer.y + sin * inner.x + cos * inner.y,
        outer.z + inner.z,
        normalised(outer.theta + inner.theta),
    )


def inverse(pose: Pose3) -> Pose3:
    """The transform back: compose(pose, inverse(pose)) is no transform."""
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return Pose3(
        -cos * pose.x - sin * pose.y,
        sin * pose.x - cos * pose.y,
        -pose.z,
        normalised(-pose.theta),
    )


def seen_from(origin: Pose3, pose: Pose3) -> Pose3:
    """A pose in the frame that stands at `origin`, where both are given in one frame (an item in the table's)."""
    return compose(inverse(origin), pose)


def yaw(quaternion: Sequence[float]) -> float:
    """Angle around the vertical axis of a rotation (x, y, z, w), which need not be normalised; radians.

    Raises ValueError where it is no rotation: not four finite numbers, or all of them zero.
    """
    x, y, z, w = quaternion
    norm = x * x + y * y + z * z + w * w
    if not math.isfinite(norm) or norm <= 0.0:
        raise ValueError(f"({x}, {y}, {z}, {w}) is no rotation")
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def rotation(theta: float) -> Tuple[float, float, float, float]:
    """The quaternion (x, y, z, w) of a turn around the vertical axis; radians."""
    return (0.0, 0.0, math.sin(theta / 2.0), math.cos(theta / 2.0))
