"""HOPF, Object Perception: the robot reports which object is on the table, and where (docs/benchmarks.md, "HOPF")."""

import math
from types import SimpleNamespace
from typing import Optional

from roah_rsbb.bmbox.framework.ground_truth import Pose3, angle_difference, compose, distance
from roah_rsbb.bmbox.framework.module import TRY_AGAIN, GoalOutcome, Module
from roah_rsbb.bmbox.framework.parameters import FARTHEST_M, Amount, GoalTimeout, ListOf, Record, Text, Transform, Whole
from roah_rsbb.bmbox.framework.score import Value

POSITIONER, TABLE = "positioner", "table"
KEEP = "Use this position"


class HOPF(Module):
    """One item per goal, each item at most once. A positioner with markers gives the item's true pose.

    All accuracies are shares of all goals of the run; a goal that timed out counts as wrong. With fewer items than
    configured goals, the run has one goal per item, and the referee is warned. Class and instance must match the
    configured texts exactly. A result without a pose is still scored for its class, and vice versa.
    """

    CODE = "HOPF"
    PARAMETERS = {
        "items": ListOf(Record({
            "id": Whole("1", 0, 65535), "class": Text("mug"), "instance": Text("red_mug"),
            "description": Text("red mug"), "transform": Transform(),
        })),
        "table_size": Record({"x": Amount("metres", "1.2", above=0.0, most=10.0),
                              "y": Amount("metres", "0.8", above=0.0, most=10.0)}),
        "goals": Whole("10", 1, 100),
        "goal_timeout": GoalTimeout(),
    }
    SUBJECTS = (POSITIONER, TABLE)
    SCORES = {
        "class_accuracy": Value("Class accuracy (share of the goals)"),
        "instance_accuracy": Value("Instance accuracy (share of the goals)"),
        "pose_score": Value("Pose score (mean over the goals, at most 1)"),
        "execution_time": Value("Execution time", "s"),
    }
    EACH = {
        "item": Value("Item"),
        "time": Value("Time", "s"),
        "class_right": Value("Class correct"),
        "instance_right": Value("Instance correct"),
        "distance_error": Value("Distance error", "m"),
        "orientation_error": Value("Orientation error", "rad"),
        "pose_score": Value("Pose score, at most 1"),
    }

    async def execute(self) -> None:
        items = self.parameters.items
        goals = min(self.parameters.goals, len(items))
        if goals < self.parameters.goals:
            self.warn(f"there are {goals} items for {self.parameters.goals} goals: this run has {goals} goals")
        for number, item in enumerate(self.random.sample(items, goals), 1):
            name = f"goal {number}"
            self.status = f"Goal {number} of {goals}: {item.description} (item {item.id})"
            self.score[name, "item"] = item.description
            await self.referee(f"Place the positioner and the item on the table: {item.description} (item {item.id})")
            truth = await self._item_on_table(item)
            await self.referee("Remove the positioner. Leave the item in place")
            outcome = await self.goal(text=f"{name}: {item.description}")
            self._judge(name, item, truth, outcome)
            self._sum_up(goals)
        self.status = "All goals done"

    async def _item_on_table(self, item: SimpleNamespace) -> Optional[Pose3]:
        """The item's pose in the table's frame; None without ground truth, or if the referee skips it. If it is not on
        the table, the referee decides what to do."""
        size = self.parameters.table_size
        while True:
            positioner = await self.pose(POSITIONER, may_skip=True, base=TABLE)
            if positioner is None:
                return None
            pose = compose(positioner, item.transform)
            if 0.0 <= pose.x <= size.x and 0.0 <= pose.y <= size.y:
                return pose
            asked = (f"The measured item position is not on the table: x {pose.x:.2f} m, y {pose.y:.2f} m on a table "
                     f"of {size.x:g} m by {size.y:g} m. Check the positioner and the markers")
            if await self.referee(asked, (TRY_AGAIN, KEEP)) == KEEP:
                return pose

    def _judge(self, name: str, item: SimpleNamespace, truth: Optional[Pose3], outcome: GoalOutcome) -> None:
        """Score one goal."""
        self.score[name, "time"] = outcome.executing_s
        said = self.record(outcome, {"class": str, "instance": str})
        self.score[name, "class_right"] = said is not None and said.class_ == getattr(item, "class")
        self.score[name, "instance_right"] = said is not None and said.instance == item.instance
        self.score[name, "pose_score"] = None if truth is None else 0.0
        seen = self.record(outcome, {"x": float, "y": float, "theta": float})
        if seen is not None and truth is not None:
            # Limits what a robot reports, so that sums stay finite.
            far = min(distance(seen, truth), FARTHEST_M)
            turned = abs(angle_difference(seen.theta, truth.theta))
            self.score[name, "distance_error"], self.score[name, "orientation_error"] = far, turned
            self.score[name, "pose_score"] = pose_score(far, turned)

    def _sum_up(self, goals: int) -> None:
        each = self.score.each
        self.score["class_accuracy"] = each("class_right").count(True) / goals
        self.score["instance_accuracy"] = each("instance_right").count(True) / goals
        scores = [score for score in each("pose_score") if score is not None]
        measured = goals - each("pose_score").count(None)  # the robot cannot help what the referee skips
        self.score["pose_score"] = sum(scores) / measured if scores else None
        self.score["execution_time"] = sum(each("time"))


def pose_score(distance_m: float, angle: float) -> float:
    """The score of a pose from 0 to 1: 1 − e_trans/2 − e_rot/2. `angle` is in radians and not negative.

    e_trans is the distance in metres, e_rot the angle as a share of π; both are limited to 1.
    """
    return 1.0 - min(distance_m, 1.0) / 2.0 - min(angle / math.pi, 1.0) / 2.0
