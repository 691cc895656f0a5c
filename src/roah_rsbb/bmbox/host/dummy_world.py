"""A simulated test bed: poses of all subjects while a dummy robot runs a benchmark.

The dummy set-up has no motion capture. The simulation follows the runs, as the modules do, and moves the subjects: the
robot drives to waypoints and follows the person, items appear on the table, a grasped object rises and moves to its
target. All poses have random errors, so that scores look realistic. There is no ROS and no clock: `step` takes the
time.
"""

import collections
import math
import random
import time
from typing import Callable, Deque, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.ground_truth import (
    Pose2D,
    Pose3,
    Source,
    angle_difference,
    compose,
    distance,
    inverse,
    normalised,
)
from roah_rsbb.bmbox.host.ground_truth_of_frames import KEPT_S, Frames, GroundTruthConfig, Marker, NoTransform
from roah_rsbb.model.modules import RequestKind, RunForModule, Step
from roah_rsbb.rulebook.registry import PROFILES

# -- the test bed -------------------------------------------------------------------------------------

TABLE = Pose3(4.0, 1.0, 0.8, 0.3)  # a corner of its top, in the test bed; metres and radians
TABLE_SIZE = (1.2, 0.8)  # metres, as in HOPF.yaml and HGMF.yaml
# Least distance of items from the table's edges (m).
EDGE_M = 0.2
WALK_CENTRE = Pose2D(3.0, 3.0, 0.0)
WALK_RADIUS_M, WALK_SPEED = 1.5, 0.5  # m, m/s
TARGET_AREA = Pose2D(0.25, 0.25, 0.0)  # where people stand for HPPF
ROBOT_HOME = Pose3(1.0, 1.0, 0.0, 0.0)
FOLLOW_M = 2.0
# So fast that the robot arrives before the dummy robot reports its result.
DRIVE_SPEED, TURN_SPEED = 3.0, 3.0  # m/s, rad/s
GRASP_S, CARRY_S = 0.5, 1.5  # time to lift the object, then to put it at its target
LIFT_M = 0.1
# Standard deviations of the errors.
PLACE_ERROR_M, TURN_ERROR = 0.03, 0.05


class DummyWorld:
    """The poses of robot, person, positioner, object and table; reproducible for the same `seed` and steps."""

    def __init__(self, seed: int = 0) -> None:
        self._random = random.Random(seed)
        self._time_s: Optional[float] = None
        self._seen: Optional[Tuple[str, int, int]] = None  # run, attempt and number of the latest request
        self._walk_angle = self._random.uniform(-math.pi, math.pi)
        self._drive_to: Optional[Pose3] = None
        self._robot = ROBOT_HOME
        self._person = self._standing()
        self._positioner = self._on_table()
        self._object = self._on_table()
        self._carry: Optional[Tuple[Pose3, Pose3]] = None  # from, to; in the test bed
        self._execute_s: Optional[float] = None  # time of the command to execute

    def poses(self) -> Dict[str, Pose3]:
        """All poses in the test bed by subject."""
        return {
            "robot": self._robot, "person": self._person, "positioner": self._positioner, "object": self._object,
            "table": TABLE,
        }

    def step(self, now_s: float, runs: Iterable[RunForModule]) -> None:
        """Advance to a time (seconds of any clock), with the runs as the core publishes them."""
        dt = 0.0 if self._time_s is None else min(max(now_s - self._time_s, 0.0), 1.0)
        self._time_s = now_s
        run = next((run for run in runs if run.running), None)
        step = run.steps[-1] if run is not None and run.steps else None
        if run is not None and step is not None:
            self._look(run, step, now_s)
        else:
            self._execute_s = self._drive_to = None
        following = run is not None and run.benchmark == "HPFF" and self._execute_s is not None
        if run is None or (run.benchmark in PROFILES and run.benchmark != "HPPF"):
            self._walk(dt)
        if following:
            self._drive_to = self._behind_person()
        if self._drive_to is not None and self._execute_s is not None:
            self._robot = _towards(self._robot, self._drive_to, DRIVE_SPEED * dt, TURN_SPEED * dt)
        if self._carry is not None and self._execute_s is not None:
            self._object = _carried(*self._carry, now_s - self._execute_s)

    def _look(self, run: RunForModule, step: Step, now_s: float) -> None:
        """React to the present request."""
        request = step.request
        if self._seen != (run.run, run.attempt, request.number):
            self._seen = (run.run, run.attempt, request.number)
            self._execute_s = None
            self._begin(run.benchmark, step)
        if request.kind == RequestKind.GOAL and step.outcome is None and run.told_utc and self._execute_s is None:
            self._execute_s = now_s

    def _begin(self, benchmark: str, step: Step) -> None:
        """React to a new request: place subjects, or choose the robot's destination.

        In a benchmark that a competition defines, a manual operation may concern any of the subjects.
        """
        request = step.request
        self._carry = self._drive_to = None
        if request.kind == RequestKind.REFEREE:
            is_other = benchmark not in PROFILES
            if is_other or benchmark == "HOPF":
                self._positioner = self._on_table()
            if is_other or benchmark == "HGMF":
                self._object = self._on_table()
            if is_other or benchmark == "HPPF":
                self._person = self._standing()
        elif request.kind == RequestKind.GOAL and request.pose is not None:
            goal = Pose3(request.pose[0], request.pose[1], 0.0, request.pose[2])
            if benchmark == "HGMF":
                self._carry = (self._object, self._nearly(compose(TABLE, goal)))
            else:
                self._drive_to = self._nearly(goal)

    def _on_table(self) -> Pose3:
        x, y = (self._random.uniform(EDGE_M, size - EDGE_M) for size in TABLE_SIZE)
        return compose(TABLE, Pose3(x, y, 0.05, self._random.uniform(-math.pi, math.pi)))

    def _standing(self) -> Pose3:
        return self._nearly(Pose3(*TARGET_AREA[:2], 1.8, self._random.uniform(-math.pi, math.pi)), 5.0)

    def _nearly(self, pose: Pose3, times: float = 1.0) -> Pose3:
        x, y = (self._random.gauss(value, times * PLACE_ERROR_M) for value in pose[:2])
        return Pose3(x, y, pose.z, normalised(self._random.gauss(pose.theta, times * TURN_ERROR)))

    def _walk(self, dt: float) -> None:
        """The person walks in a circle."""
        self._walk_angle = normalised(self._walk_angle + WALK_SPEED / WALK_RADIUS_M * dt)
        to = Pose3(
            WALK_CENTRE.x + WALK_RADIUS_M * math.cos(self._walk_angle),
            WALK_CENTRE.y + WALK_RADIUS_M * math.sin(self._walk_angle),
            1.8, normalised(self._walk_angle + math.pi / 2.0),
        )
        self._person = _towards(self._person, to, 2.0 * WALK_SPEED * dt, TURN_SPEED * dt)

    def _behind_person(self) -> Pose3:
        direction = math.atan2(self._robot.y - self._person.y, self._robot.x - self._person.x)
        return Pose3(
            self._person.x + FOLLOW_M * math.cos(direction), self._person.y + FOLLOW_M * math.sin(direction),
            0.0, normalised(direction + math.pi),
        )


def _towards(pose: Pose3, to: Pose3, metres: float, radians: float) -> Pose3:
    """Move a pose towards another one, by at most this distance and angle."""
    left = distance(pose, to)
    share = 1.0 if left <= metres else metres / left
    turn = angle_difference(to.theta, pose.theta)
    turn = math.copysign(min(abs(turn), radians), turn)
    x, y, z = (here + share * (there - here) for here, there in zip(pose[:3], to[:3]))
    return Pose3(x, y, z, normalised(pose.theta + turn))


def _carried(begin: Pose3, end: Pose3, since_s: float) -> Pose3:
    """The pose of a carried object some seconds after the goal began: up, across, down."""
    if since_s < GRASP_S:
        return begin._replace(z=begin.z + LIFT_M * max(since_s, 0.0) / GRASP_S)
    share = min((since_s - GRASP_S) / CARRY_S, 1.0)
    x, y = (a + share * (b - a) for a, b in zip(begin[:2], end[:2]))
    height = begin.z + LIFT_M if share < 1.0 else begin.z
    return Pose3(x, y, height, normalised(begin.theta + share * angle_difference(end.theta, begin.theta)))


# -- its motion-capture system ------------------------------------------------------------------------

# `seen_markers` is what it sees in a `DummyWorld`. The node of the dummy set-up publishes that to tf. `DummyFrames`
# gives it to modules in the same process.

# Interval of the simulated measurements: the robot moves 6 cm in it.
STEP_S = 0.02


class SeenMarker(NamedTuple):
    """A marker that the system sees."""

    subject: str
    frame: str
    pose: Pose3  # of the marker itself, in the reference frame


def seen_markers(config: GroundTruthConfig, world: DummyWorld, runs: Sequence[RunForModule]) -> List[SeenMarker]:
    """Return all markers in a world during these runs."""
    poses = world.poses()
    team = next((run.team for run in runs if run.running), "")
    return [SeenMarker(subject, marker.frame, compose(poses[subject], inverse(marker.transform)))
            for subject, marker in worn_markers(config, team) if subject in poses]


def worn_markers(config: GroundTruthConfig, team: str) -> Iterator[Tuple[str, Marker]]:
    """Return each frame once, with its subject. A frame that teams share belongs to the running team's robot.

    Without motion capture, nothing carries markers.
    """
    if config.source is not Source.MOTION_CAPTURE:
        return iter(())
    by_frame: Dict[str, Tuple[str, Marker]] = {}
    for owner, subject, marker in config.all_markers():
        if owner == team or marker.frame not in by_frame:
            by_frame[marker.frame] = (subject, marker)
    return iter(by_frame.values())


class DummyFrames(Frames):
    """What the system saw in the last seconds. The world catches up whenever it is asked, so it needs no timer."""

    REMEDY_MARKER = f"the simulated motion capture has {', '.join(DummyWorld().poses())} only"

    def __init__(self, seed: int = 0, utc: Callable[[], float] = time.time) -> None:
        self._world = DummyWorld(seed)
        self._utc = utc
        self._config: Optional[GroundTruthConfig] = None
        self._runs: Tuple[RunForModule, ...] = ()
        self._kept: Deque[Tuple[float, Dict[str, Pose3]]] = collections.deque()  # by time (UTC seconds), then by frame

    def use(self, config: GroundTruthConfig) -> None:
        """See `Frames`."""
        self._config = config
        self._step(self._utc())

    def take(self, runs: Sequence[RunForModule]) -> None:
        """See `Frames`."""
        self._catch_up()
        self._runs = tuple(runs)
        # A module may measure at once what the referee has moved.
        self._step(self._utc())

    def now_utc(self) -> float:
        """See `Frames`."""
        return self._utc()

    def sees(self, frame: str) -> bool:
        """See `Frames`."""
        self._catch_up()
        return frame == self._config.reference_frame or frame in self._kept[-1][1]

    def gap(self, frame: str, at_utc: float) -> Optional[float]:
        """See `Frames`."""
        self._catch_up()
        return min((abs(utc - at_utc) for utc, poses in self._kept if frame in poses), default=None)

    def lookup(self, reference: str, frame: str, at_utc: Optional[float]) -> Tuple[Pose3, Optional[float]]:
        """See `Frames`."""
        self._catch_up()
        when = self._utc() if at_utc is None else at_utc
        found = min(((utc, poses) for utc, poses in self._kept if frame in poses),
                    key=lambda seen: abs(seen[0] - when), default=None)
        if found is None:
            raise NoTransform(f"nothing carries '{frame}'")
        return found[1][frame], found[0]

    def _catch_up(self) -> None:
        """Simulate what happened since the last call. After a longer time than is kept, or if the clock was set back,
        the world continues from now."""
        last, now = self._kept[-1][0], self._utc()
        if not last <= now <= last + KEPT_S:
            self._kept.clear()
            last = now - STEP_S
        while last < now:
            last = min(last + STEP_S, now)
            self._step(last)

    def _step(self, utc: float) -> None:
        self._world.step(utc, self._runs)
        seen = seen_markers(self._config, self._world, self._runs)
        while self._kept and self._kept[-1][0] >= utc:  # the same time with other runs, or the clock was set back
            self._kept.pop()
        self._kept.append((utc, {marker.frame: marker.pose for marker in seen}))
        while self._kept[0][0] < utc - KEPT_S:
            self._kept.popleft()
