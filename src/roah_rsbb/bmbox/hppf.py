"""HPPF, People Perception: the robot reports who stands in front of it, and where (docs/benchmarks.md, "HPPF")."""

from types import SimpleNamespace
from typing import Optional

from roah_rsbb.bmbox.framework.ground_truth import Pose3, Source, distance
from roah_rsbb.bmbox.framework.module import SKIP, TRY_AGAIN, Module
from roah_rsbb.bmbox.framework.parameters import FARTHEST_M, GoalTimeout, ListOf, Text
from roah_rsbb.bmbox.framework.score import Value

PERSON = "person"


class HPPF(Module):
    """Each person once, in random order.

    A person counts as detected if the result contains a readable name or position. The person's true position is the
    one measured at the time of the result. If it is unknown, the person returns to the same place, or the referee
    skips the measurement; then there is no distance error. The mean is over all people with a distance error.
    """

    CODE = "HPPF"
    PARAMETERS = {"people": ListOf(Text("Annie")), "goal_timeout": GoalTimeout()}
    SUBJECTS = (PERSON,)
    SCORES = {
        "detected": Value("People detected"),
        "recognised": Value("People recognised"),
        "distance_error": Value("Mean distance error", "m"),
        "execution_time": Value("Execution time", "s"),
    }
    EACH = {
        "name": Value("Name"),
        "time": Value("Time", "s"),
        "detected": Value("Detected"),
        "recognised": Value("Recognised"),
        "distance_error": Value("Distance error", "m"),
    }

    async def execute(self) -> None:
        people = self.random.sample(self.parameters.people, len(self.parameters.people))
        self._sum_up()
        for number, name in enumerate(people, 1):
            group = f"person {number}"
            self.status = f"Person {number} of {len(people)}: {name}"
            self.score[group, "name"] = name
            await self.referee(f"Ask {name} to enter the target area")
            if self.source is Source.MOTION_CAPTURE:
                await self.pose(PERSON)  # checks that it is available before the team's time runs
            outcome = await self.goal(text=f"{group}: {name}")
            said = self.record(outcome, {"person_name": str})
            seen = self.record(outcome, {"x": float, "y": float})
            self.score[group, "time"] = outcome.executing_s
            self.score[group, "detected"] = said is not None or seen is not None
            self.score[group, "recognised"] = said is not None and is_same_name(said.person_name, name)
            self._sum_up()
            if seen is not None:
                self._measure_error(group, seen, await self._stood(name, outcome.ended_utc))
                self._sum_up()
        self.status = "All people done"

    async def _stood(self, name: str, utc: float) -> Optional[Pose3]:
        """Where the person stood at the time of the result; None if the referee skips it."""
        pose = await self.pose_at(PERSON, utc)
        if pose is not None or self.source is not Source.MOTION_CAPTURE:
            return pose
        asked = (f"The position of {name} at the time of the robot's result is unknown. Ask {name} to return to "
                 "that place, then try again")
        if await self.referee(asked, (TRY_AGAIN, SKIP)) == SKIP:
            return None
        return await self.pose(PERSON, may_skip=True)

    def _measure_error(self, group: str, seen: SimpleNamespace, truth: Optional[Pose3]) -> None:
        # Limits what a robot reports, so that sums stay finite.
        self.score[group, "distance_error"] = None if truth is None else min(distance(seen, truth), FARTHEST_M)

    def _sum_up(self) -> None:
        each = self.score.each
        errors = [error for error in each("distance_error") if error is not None]
        self.score["detected"] = each("detected").count(True)
        self.score["recognised"] = each("recognised").count(True)
        self.score["distance_error"] = sum(errors) / len(errors) if errors else None
        self.score["execution_time"] = sum(each("time"))


def is_same_name(a: str, b: str) -> bool:
    """Whether two names are equal, ignoring case and surrounding blanks."""
    return a.strip().casefold() == b.strip().casefold()
