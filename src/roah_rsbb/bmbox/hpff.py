"""HPFF, Person Following: the robot follows a walking person (docs/benchmarks.md, "HPFF")."""

from typing import Any, Dict

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, Source, distance
from roah_rsbb.bmbox.framework.module import Module, RunEnded
from roah_rsbb.bmbox.framework.parameters import Amount, GoalTimeout
from roah_rsbb.bmbox.framework.score import Value

ROBOT, PERSON = "robot", "person"
# The robot gets this time to take its position (s).
POSITION_S = 8.0
PERIOD_S = 0.5
# Between samples that are further apart (the module restarted), no distance is counted.
LONGEST_STEP_S = 1.5
RELIABLE = 0.5
# A run may be this much shorter or longer than the goal's timeout (s).
TOLERANCE_S = 15.0


class HPFF(Module):
    """One goal: follow the person. The robot need not end it.

    Measuring begins in the eighth second of execution. The path between two samples half a second apart counts as
    covered if the distance was between minimum and maximum at both. Without both poses, no path is counted. The
    length of a run is the time from the start to the end of the goal. It also decides whether a
    run failed that the referee stopped or that timed out. Without motion capture, only the length of the run is scored.
    """

    CODE = "HPFF"
    PARAMETERS = {
        "minimum_distance": Amount("metres", "0.15", least=0.0, most=100.0),
        "maximum_distance": Amount("metres", "3.5", above=0.0, most=100.0),
        "desired_distance": Amount("metres", "2.0", above=0.0, most=100.0),
        "goal_timeout": GoalTimeout(),
    }
    SUBJECTS = (ROBOT, PERSON)
    SCORES = {
        "mean_deviation": Value("Mean deviation from the desired distance", "m"),
        "distance_covered": Value("Distance covered while following", "m"),
        "reliability": Value("Reliability (share of samples with both poses)"),
        "samples": Value("Samples"),
        "run_length": Value("Length of the run", "s"),
        "failed_run": Value("Failed run (too short or too long)"),
    }

    async def execute(self) -> None:
        self.kept = {"samples": 0, "both": 0, "deviation": 0.0, "covered": 0.0, "last": None, "last_s": 0.0}
        self._show()
        if self.parameters.minimum_distance >= self.parameters.maximum_distance:
            self.warn("no distance can be scored: in HPFF.yaml, minimum_distance must be less than maximum_distance")
        self.status = "The robot follows the person"
        try:
            await self.note(lambda: "start")
            watch = self._look if self.source is Source.MOTION_CAPTURE else None
            outcome = await self.goal(text="follow the person", watch=watch, every=PERIOD_S)
        except RunEnded:
            self._conclude(self.run.elapsed_s)
            raise
        # The run's time begins with its first step, which needs no referee.
        self._conclude(outcome.ended_utc - self.run.steps[0].outcome.ended_utc)

    def _look(self, executing_s: float) -> None:
        if executing_s < POSITION_S:
            return
        add_sample(self.kept, executing_s, self.peek(ROBOT), self.peek(PERSON), self.parameters)
        self._show()

    def _show(self) -> None:
        sums = self.kept
        self.score["samples"] = sums["samples"]
        self.score["distance_covered"] = sums["covered"] if self.source is Source.MOTION_CAPTURE else None
        self.score["mean_deviation"] = sums["deviation"] / sums["both"] if sums["both"] else None
        self.score["reliability"] = sums["both"] / sums["samples"] if sums["samples"] else None

    def _conclude(self, length_s: float) -> None:
        self._show()
        self.score["run_length"] = length_s
        self.score["failed_run"] = is_failed(length_s, self.goal_timeout)
        if self.score["failed_run"]:
            self.warn(f"failed run: it took {length_s:.0f} s instead of {self.goal_timeout:g} s")
        reliability = self.score["reliability"]
        if self.source is not Source.MOTION_CAPTURE:
            self.warn("without motion capture, only the length of the run is scored")
        elif reliability is None:
            self.warn("the distance could not be measured: there is no score")
        elif reliability < RELIABLE:
            self.warn(f"unreliable: only {reliability:.0%} of the samples have the poses of both robot and person")


def add_sample(sums: Dict[str, Any], executing_s: float, robot: Any, person: Any, parameters: Any) -> None:
    """Add a sample to the sums. A pose is None if it is not available."""
    sums["samples"] += 1
    last, last_s = sums["last"], sums["last_s"]
    sums["last"], sums["last_s"] = None, executing_s
    if robot is None or person is None:
        return
    apart = distance(robot, person)
    sums["both"] += 1
    sums["deviation"] += abs(apart - parameters.desired_distance)
    if not parameters.minimum_distance <= apart <= parameters.maximum_distance:
        return
    sums["last"] = [robot.x, robot.y]
    if last is not None and 0.0 <= executing_s - last_s <= LONGEST_STEP_S:
        sums["covered"] += distance(robot, Pose2D(*last, 0.0))


def is_failed(length_s: float, timeout: float) -> bool:
    """Whether a run of this length is a failed run. `timeout`: of the goal (s); 0: no limit, so no run fails."""
    return bool(timeout) and abs(length_s - timeout) > TOLERANCE_S
