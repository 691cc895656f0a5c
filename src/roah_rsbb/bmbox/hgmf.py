"""HGMF, Grasping and Manipulation: the robot puts objects at given places (docs/benchmarks.md, "HGMF")."""

import random
from types import SimpleNamespace
from typing import Optional

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Pose3, Source, distance, seen_from
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import Amount, GoalTimeout, ListOf, Record, Text, Whole
from roah_rsbb.bmbox.framework.score import Value

OBJECT, TABLE = "object", "table"
YES, NO = "Yes", "No"
PERIOD_S = 0.1
GRASPED_M = 0.03  # an object that rises this much counts as grasped
EDGE_M, OBJECT_M = 0.15, 0.05  # least distance of a target from the table's edges and from the object
# On a smaller table there may be no target far enough from the object.
SMALLEST_TABLE_M = 0.5
# Tolerates rounding errors in GRASPED_M.
_ROUNDING_M = 1e-6


class HGMF(Module):
    """Each object once, in random order. Targets are in the table's frame.

    When a goal ends, by result or timeout, the object's pose is measured. If it is not available, the referee makes
    it available or skips it (an object on the floor); a skipped object has no distance error. The mean is over all
    objects with a distance error, grasped or not. Without motion capture, the referee decides whether an object was
    grasped, or nobody does.
    """

    CODE = "HGMF"
    PARAMETERS = {
        "objects": ListOf(Record({"id": Whole("1", 0, 65535), "description": Text("red mug")})),
        "table_size": Record({"x": Amount("metres", "1.2", least=SMALLEST_TABLE_M, most=10.0),
                              "y": Amount("metres", "0.8", least=SMALLEST_TABLE_M, most=10.0)}),
        "goal_timeout": GoalTimeout(),
    }
    SUBJECTS = (OBJECT, TABLE)
    SCORES = {
        "grasped": Value("Objects grasped"),
        "objects": Value("Objects in total"),
        "distance_error": Value("Mean distance error", "m"),
        "execution_time": Value("Execution time", "s"),
    }
    EACH = {
        "object": Value("Object"),
        "time": Value("Time", "s"),
        "grasped": Value("Grasped"),
        "distance_error": Value("Distance error", "m"),
    }

    async def execute(self) -> None:
        things = self.random.sample(self.parameters.objects, len(self.parameters.objects))
        self.score["objects"] = len(things)
        self._sum_up()
        for number, thing in enumerate(things, 1):
            self.status = f"Object {number} of {len(things)}: {thing.description}"
            await self._one(f"object {number}", thing)
        self.status = "All objects done"

    async def _one(self, group: str, thing: SimpleNamespace) -> None:
        self.score[group, "object"] = thing.description
        await self.referee(f"Place the {thing.description} with markers on the table")
        begin = None
        if self.source is Source.MOTION_CAPTURE:
            begin = await self.pose(OBJECT)
        on_table = None if begin is None else seen_from(await self.pose(TABLE), begin)
        target = draw_target(self.random, self.parameters.table_size, on_table)
        self.kept = {"grasped": None if begin is None else False}
        try:
            outcome = await self.goal(
                [target.x, target.y, thing.id], target,
                text=f"{thing.description} (object {thing.id}) to x {target.x:.2f} m, y {target.y:.2f} m",
                watch=None if begin is None else lambda _executing_s: self._look(group, begin), every=PERIOD_S,
            )
        finally:
            self._show_grasped(group)
        self.score[group, "time"] = outcome.executing_s
        self._sum_up()
        if self.source is Source.REFEREE:
            self.kept["grasped"] = await self.referee("Did the robot lift the object?", (NO, YES)) == YES
            self._show_grasped(group)
        end = await self._end()
        self.score[group, "distance_error"] = None if end is None else distance(end, target)
        self._sum_up()

    async def _end(self) -> Optional[Pose3]:
        """The object's final pose in the table's frame; None if the referee skips it."""
        if self.source is not Source.MOTION_CAPTURE:
            return await self.pose(OBJECT, may_skip=True, base=TABLE)
        end = await self.pose(OBJECT, may_skip=True)
        return None if end is None else seen_from(await self.pose(TABLE), end)

    def _look(self, group: str, begin: Pose3) -> None:
        now = self.peek(OBJECT)
        if now is not None and is_grasped(begin, now):
            self.kept["grasped"] = True
        self._show_grasped(group)

    def _show_grasped(self, group: str) -> None:
        self.score[group, "grasped"] = self.kept["grasped"]
        self._sum_up()

    def _sum_up(self) -> None:
        each = self.score.each
        errors = [error for error in each("distance_error") if error is not None]
        self.score["grasped"] = None if self.source is Source.NONE else each("grasped").count(True)
        self.score["distance_error"] = sum(errors) / len(errors) if errors else None
        self.score["execution_time"] = sum(each("time"))


def is_grasped(begin: Pose3, now: Pose3) -> bool:
    """Whether an object has risen so far that the robot must have lifted it."""
    return now.z - begin.z >= GRASPED_M - _ROUNDING_M


def draw_target(chance: random.Random, table_size: SimpleNamespace, thing: Optional[Pose3]) -> Pose2D:
    """Draw a target on the table, away from its edges and from the object, if its pose is known; metres, in the
    table's frame."""
    while True:
        target = Pose2D(*(chance.uniform(EDGE_M, size - EDGE_M) for size in (table_size.x, table_size.y)), 0.0)
        if thing is None or distance(target, thing) >= OBJECT_M:
            return target
