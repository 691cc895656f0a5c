"""A test bed that only pretends: where things would be while a dummy robot goes through a benchmark.

For the dummy set-up, which has no motion capture. The world looks at the runs, as the modules do, and moves what
the rules would see moving: the robot drives to waypoints and follows the person, a referee's hand puts things onto
the table, an object that is to be grasped rises and goes where it should. Nothing is perfect, so that scores look
as they do in a competition. No ROS and no clock: `step` takes the time.
"""

import math
import random
from typing import Dict, Iterable, Optional, Tuple

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3, angle_difference, compose, distance, normalised
from roah_rsbb.core.modules.messages import RequestKind, RunForModule, Step

TABLE = Pose3(4.0, 1.0, 0.8, 0.3)  # a corner of its top; metres and radians in the test bed
TABLE_SIZE = (1.2, 0.8)  # metres, as in HOPF.yaml and HGMF.yaml
# Things are put so far inside the table's edges, metres.
EDGE_M = 0.2
WALK_CENTRE = Pose2D(3.0, 3.0, 0.0)
WALK_RADIUS_M, WALK_SPEED = 1.5, 0.5  # m, m/s
TARGET_AREA = Pose2D(0.25, 0.25, 0.0)  # where people stand to be recognised
ROBOT_HOME = Pose3(1.0, 1.0, 0.0, 0.0)
FOLLOW_M = 2.0
# The robot is there before the dummy robot says so, from wherever it was: these are not a real robot's.
DRIVE_SPEED, TURN_SPEED = 3.0, 3.0  # m/s, rad/s
GRASP_S, CARRY_S = 0.5, 1.5  # until the object is up, and then until it is down at its target
LIFT_M = 0.1
# How far off it all is (standard deviation).
PLACE_ERROR_M, TURN_ERROR = 0.03, 0.05


class DummyWorld:
    """Where robot, person, positioner, object and table are; the same each time for the same `seed` and steps."""

    def __init__(self, seed: int = 0) -> None:
        self._random = random.Random(seed)
        self._time_s: Optional[float] = None
        self._seen: Optional[Tuple[str, int, int]] = None  # run, attempt and number of the request last looked at
        self._walk_angle = self._random.uniform(-math.pi, math.pi)
        self._drive_to: Optional[Pose3] = None
        self._robot = ROBOT_HOME
        self._person = self._standing()
        self._positioner = self._on_table()
        self._object = self._on_table()
        self._carry: Optional[Tuple[Pose3, Pose3]] = None  # from where to where, in the test bed
        self._told_s: Optional[float] = None  # when the robot was told to execute

    def poses(self) -> Dict[str, Pose3]:
        """Where everything is, by subject, in the test bed."""
        return {
            "robot": self._robot, "person": self._person, "positioner": self._positioner, "object": self._object,
            "table": TABLE,
        }

    def step(self, now_s: float, runs: Iterable[RunForModule]) -> None:
        """Go on to a time (seconds of any clock), with the runs as the core tells them."""
        dt = 0.0 if self._time_s is None else min(max(now_s - self._time_s, 0.0), 1.0)
        self._time_s = now_s
        run = next((run for run in runs if run.running), None)
        step = run.steps[-1] if run is not None and run.steps else None
        if run is not None and step is not None:
            self._look(run, step, now_s)
        else:
            self._told_s = self._drive_to = None
        following = run is not None and run.benchmark == "HPFF" and self._told_s is not None
        if run is None or run.benchmark != "HPPF":
            self._walk(dt)
        if following:
            self._drive_to = self._behind_person()
        if self._drive_to is not None and self._told_s is not None:
            self._robot = _towards(self._robot, self._drive_to, DRIVE_SPEED * dt, TURN_SPEED * dt)
        if self._carry is not None and self._told_s is not None:
            self._object = _carried(*self._carry, now_s - self._told_s)

    def _look(self, run: RunForModule, step: Step, now_s: float) -> None:
        """See what is asked for now."""
        request = step.request
        if self._seen != (run.run, run.attempt, request.number):
            self._seen = (run.run, run.attempt, request.number)
            self._told_s = None
            self._begin(run.benchmark, step)
        if request.kind == RequestKind.GOAL and step.outcome is None and run.told_utc and self._told_s is None:
            self._told_s = now_s

    def _begin(self, benchmark: str, step: Step) -> None:
        """A new request: the referee puts things where they should be, the robot knows where to go."""
        request = step.request
        self._carry = self._drive_to = None
        if request.kind == RequestKind.REFEREE:
            if benchmark == "HOPF":
                self._positioner = self._on_table()
            elif benchmark == "HGMF":
                self._object = self._on_table()
            elif benchmark == "HPPF":
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
    """A pose that has come so much nearer to another one."""
    left = distance(pose, to)
    share = 1.0 if left <= metres else metres / left
    turn = angle_difference(to.theta, pose.theta)
    turn = math.copysign(min(abs(turn), radians), turn)
    x, y, z = (here + share * (there - here) for here, there in zip(pose[:3], to[:3]))
    return Pose3(x, y, z, normalised(pose.theta + turn))


def _carried(begin: Pose3, end: Pose3, since_s: float) -> Pose3:
    """Where an object is, so many seconds after the robot began: up, across, down."""
    if since_s < GRASP_S:
        return begin._replace(z=begin.z + LIFT_M * max(since_s, 0.0) / GRASP_S)
    share = min((since_s - GRASP_S) / CARRY_S, 1.0)
    x, y = (a + share * (b - a) for a, b in zip(begin[:2], end[:2]))
    height = begin.z + LIFT_M if share < 1.0 else begin.z
    return Pose3(x, y, height, normalised(begin.theta + share * angle_difference(end.theta, begin.theta)))
