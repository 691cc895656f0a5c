"""Recognise an activity: a person does something, and the robot reports what it is.

Goal: {"trial": 3, "activities": ["drinking", "reading"]}, the activities to choose from.
Result: {"activity": "reading"}.
"""

import json

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, Text, Whole
from roah_rsbb.bmbox.framework.score import Value


class SeeActivity(Module):
    """Each trial draws an activity at random, so an activity may come again."""

    CODE = "SeeActivity"
    PARAMETERS = {
        "trials": Whole("10", 1, 100),
        "activities": ListOf(Text("drinking"), at_most=20),
        "goal_timeout": GoalTimeout(),
    }
    SCORES = {
        "correct": Value("Correct trials"),
        "accuracy": Value("Accuracy"),
        "mean_time": Value("Mean time", "s"),
    }
    EACH = {
        "activity": Value("Activity"), "answer": Value("Answer"), "correct": Value("Correct"),
        "time": Value("Time", "s"),
    }

    async def execute(self) -> None:
        count = self.parameters.trials
        self._sum_up()
        for number in range(1, count + 1):
            trial, activity = f"trial {number}", self.random.choice(self.parameters.activities)
            self.status = f"Trial {number} of {count}: {activity}"
            self.score[trial, "activity"] = activity
            await self.referee(f"Ask the volunteer to begin: {activity}")
            goal = {"trial": number, "activities": self.parameters.activities}
            outcome = await self.goal(json.dumps(goal), text=f"{trial}: {activity}")
            found = self.record(outcome, {"activity": str})
            self.score[trial, "time"] = outcome.executing_s
            self.score[trial, "answer"] = None if found is None else found.activity
            self.score[trial, "correct"] = found is not None and found.activity == activity
            self._sum_up()
        self.status = "All trials done"

    def _sum_up(self) -> None:
        correct, times = self.score.each("correct"), self.score.each("time")
        self.score["correct"] = correct.count(True)
        self.score["accuracy"] = correct.count(True) / self.parameters.trials
        self.score["mean_time"] = sum(times) / len(times) if times else None
