"""HPFF, Person Following: the robot stays behind a person who walks (docs/benchmarks.md, "HPFF")."""

from typing import Any, Dict

from roah_rsbb.bmbox.framework.ground_truth import Pose2D, distance
from roah_rsbb.bmbox.framework.module import Module, RunEnded
from roah_rsbb.bmbox.framework.parameters import Number, Seconds
from roah_rsbb.bmbox.framework.score import Value

ROBOT, PERSON = "robot", "person"
# Seconds after the goal was sent, in which the robot takes its position.
POSITION_S = 8.0
PERIOD_S = 0.5
# What lies between two samples that are further apart (the module was started again) is not known.
LONGEST_STEP_S = 1.5
RELIABLE = 0.5
# Seconds by which a run may be shorter or longer than the goal's timeout.
TOLERANCE_S = 15.0


class HPFF(Module):
    """One goal: follow. The robot need not end it.

    Distances are measured from the eighth second of executing on. A way that the robot went counts as covered if
    it was between minimum and maximum at both ends, half a second apart; where a pose is missing, no way is assumed.
    A run's length is from the start to the end of the goal; one that the referee stops, or that runs out of time
    altogether, is judged by it, too.
    """

    CODE = "HPFF"
    PARAMETERS = {
        "minimum_distance": Number("metres", "0.15", least=0.0, most=100.0),
        "maximum_distance": Number("metres", "3.5", above=0.0, most=100.0),
        "desired_distance": Number("metres", "2.0", above=0.0, most=100.0),
        "goal_timeout": Seconds("300"),
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
            self.warn("no way will count: minimum_distance is not below maximum_distance in HPFF.yaml")
        self.status = "The robot follows the person"
        try:
            await self.note(lambda: "start")
            outcome = await self.goal(
                timeout=self.parameters.goal_timeout, text="follow the person", watch=self._look, every=PERIOD_S
            )
        except RunEnded:
            self._conclude(self.run.elapsed_s)
            raise
        # The run's time begins with its first step: nothing is asked of the referee.
        self._conclude(outcome.ended_utc - self.run.steps[0].outcome.ended_utc)

    def _look(self, executing_s: float) -> None:
        if executing_s < POSITION_S:
            return
        add_sample(self.kept, executing_s, self.peek(ROBOT), self.peek(PERSON), self.parameters)
        self._show()

    def _show(self) -> None:
        sums = self.kept
        self.score["samples"] = sums["samples"]
        self.score["distance_covered"] = sums["covered"]
        self.score["mean_deviation"] = sums["deviation"] / sums["both"] if sums["both"] else None
        self.score["reliability"] = sums["both"] / sums["samples"] if sums["samples"] else None

    def _conclude(self, length_s: float) -> None:
        self._show()
        self.score["run_length"] = length_s
        self.score["failed_run"] = is_failed(length_s, self.parameters.goal_timeout)
        if self.score["failed_run"]:
            self.warn(f"failed run: it took {length_s:.0f} s, and should take {self.parameters.goal_timeout:g} s")
        reliability = self.score["reliability"]
        if reliability is None:
            self.warn("the distance was never measured: there is no score")
        elif reliability < RELIABLE:
            self.warn(f"unreliable: only {reliability:.0%} of the samples have the poses of both robot and person")


def add_sample(sums: Dict[str, Any], executing_s: float, robot: Any, person: Any, parameters: Any) -> None:
    """Add a sample to the sums so far; a pose that is None could not be had."""
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
    """Whether a run of this length is a failed run."""
    return abs(length_s - timeout) > TOLERANCE_S
