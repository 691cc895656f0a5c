"""HOMF, Object Manipulation (2014): the robot toggles switches in a given order (docs/benchmarks.md, "HOMF").

Switches are numbered from 1 everywhere: for the robot, for the referee and in the parameters.
"""

from typing import Sequence

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, Record, Whole, YesNo
from roah_rsbb.bmbox.framework.score import Value

# The referee's panel shows this many.
MAX_SWITCHES = 10

GOAL = Record({
    "initial_state": ListOf(YesNo("true"), MAX_SWITCHES),
    "switches": ListOf(Whole("1", 1, MAX_SWITCHES)),
})


class HOMF(Module):
    """After each goal the referee enters which switches changed; that time does not count."""

    CODE = "HOMF"
    PARAMETERS = {"goals": ListOf(GOAL), "goal_timeout": GoalTimeout()}
    SCORES = {
        "right": Value("Switches toggled as requested, in order"),
        "wrong": Value("Other changed switches"),
        "damaged": Value("Switches damaged"),
        "execution_time": Value("Execution time", "s"),
    }
    EACH = {
        "time": Value("Time", "s"),
        "timed_out": Value("Timed out"),
        "changed": Value("Switches that changed, in order"),
        "right": Value("Toggled as requested, in order"),
        "wrong": Value("Other changes"),
        "damaged": Value("Damaged"),
    }

    async def execute(self) -> None:
        for name in ("right", "wrong", "damaged"):
            self.score[name] = 0
        count = len(self.parameters.goals)
        for number, goal in enumerate(self.parameters.goals, 1):
            name = f"goal {number}"
            self.status = f"Goal {number} of {count}: toggle {_numbers(goal.switches)}"
            on = [i for i, is_on in enumerate(goal.initial_state, 1) if is_on]
            await self.referee(f"Switch on: {_numbers(on)}; switch off all others of 1 to {len(goal.initial_state)}")
            outcome = await self.goal(
                initial_state=goal.initial_state, switches=goal.switches,
                text=name,
            )
            self.score[name, "time"], self.score[name, "timed_out"] = outcome.executing_s, outcome.timed_out
            self.score["execution_time"] = sum(self.score.each("time"))
            entered = await self.switches("Enter which switches changed, in order, and how many are damaged")
            right = in_order(goal.switches, entered.changed)
            self.score[name, "changed"] = _numbers(entered.changed)
            self.score[name, "right"], self.score[name, "wrong"] = right, len(entered.changed) - right
            self.score[name, "damaged"] = entered.damaged
            for item in ("right", "wrong", "damaged"):
                self.score[item] = sum(self.score.each(item))


def in_order(asked: Sequence[int], done: Sequence[int]) -> int:
    """Count the requested switches that were toggled in the right order: the longest common subsequence."""
    best = [0] * (len(done) + 1)
    for want in asked:
        before = 0
        for i, got in enumerate(done, 1):
            before, best[i] = best[i], before + 1 if want == got else max(best[i], best[i - 1])
    return best[-1]


def _numbers(switches: Sequence[int]) -> str:
    return ", ".join(map(str, switches)) or "none"
