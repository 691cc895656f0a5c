"""HNF, Navigation: the robot drives to several waypoints in order (docs/benchmarks.md, "HNF")."""

import math
from typing import List

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, angle_difference, distance
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, PlanePose
from roah_rsbb.bmbox.framework.score import Value

ROBOT = "robot"


class HNF(Module):
    """Waypoints in the test bed's frame. A waypoint is reached if the robot reports it before the timeout."""

    CODE = "HNF"
    PARAMETERS = {"starting_pose": PlanePose(), "waypoints": ListOf(PlanePose()), "goal_timeout": GoalTimeout()}
    SUBJECTS = (ROBOT,)
    SCORES = {
        "reached": Value("Waypoints reached"),
        "timed_out": Value("Waypoints timed out"),
        "position_accuracy": Value("Position accuracy (mean distance error, reached waypoints)", "m"),
        "orientation_accuracy": Value("Orientation accuracy (reached waypoints)", "rad"),
        "execution_time": Value("Execution time", "s"),
    }
    EACH = {
        "time": Value("Time", "s"),
        "timed_out": Value("Timed out"),
        "distance_error": Value("Distance error", "m"),
        "orientation_error": Value("Orientation error", "rad"),
    }

    async def execute(self) -> None:
        self.score["reached"] = self.score["timed_out"] = 0
        distances: List[float] = []
        angles: List[float] = []
        await self.referee(f"Place the robot at the starting pose: {in_words(self.parameters.starting_pose)}")
        count = len(self.parameters.waypoints)
        for number, waypoint in enumerate(self.parameters.waypoints, 1):
            name = f"waypoint {number}"
            self.status = f"Waypoint {number} of {count}: {in_words(waypoint)}"
            outcome = await self.goal(pose=waypoint, text=name)
            self.score["timed_out" if outcome.timed_out else "reached"] += 1
            self.score[name, "time"] = outcome.executing_s
            self.score[name, "timed_out"] = outcome.timed_out
            self.score["execution_time"] = sum(self.score.each("time"))
            pose = await self.pose(ROBOT, may_skip=True)
            if pose is None:
                continue
            far, turned = distance(pose, waypoint), abs(angle_difference(pose.theta, waypoint.theta))
            self.score[name, "distance_error"], self.score[name, "orientation_error"] = far, turned
            if not outcome.timed_out:
                distances.append(far)
                angles.append(turned)
                self.score["position_accuracy"] = sum(distances) / len(distances)
                self.score["orientation_accuracy"] = mean_angle(angles)
        self.status = "All waypoints done"


def mean_angle(errors: List[float]) -> float:
    """Circular mean of unsigned angles (radians): atan2(|Σ sin|Δθ||, Σ cos Δθ)."""
    return math.atan2(abs(sum(math.sin(abs(e)) for e in errors)), sum(math.cos(e) for e in errors))


def in_words(pose: Pose2D) -> str:
    """Describe a pose to the referee."""
    return f"x {pose.x:.2f} m, y {pose.y:.2f} m, {math.degrees(pose.theta):.0f}°"
