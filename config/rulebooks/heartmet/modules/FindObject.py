"""Find an object: the robot reports whether the wanted object is on the table, and where it sees it.

Goal: {"trial": 3, "object": "red cup"}.
Result: {"found": true, "box": [310, 122, 44, 60]}: left, top, width and height in the robot's image; [] if not found.
"""

import json

from roah_rsbb.bmbox.framework.module import GoalOutcome, Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, Text, Whole
from roah_rsbb.bmbox.framework.score import Value

YES, NO = "yes", "no"


class FindObject(Module):
    """The wanted object is on the table in half of the trials, in random order.

    A right answer is a point. A box that the referee accepts is another point.
    """

    CODE = "FindObject"
    PARAMETERS = {
        "trials": Whole("10", 1, 100), "objects": ListOf(Text("red cup"), at_most=50), "goal_timeout": GoalTimeout(),
    }
    SCORES = {
        "points": Value("Points"),
        "answers": Value("Right answers"),
        "boxes": Value("Right boxes"),
        "mean_time": Value("Mean time", "s"),
    }
    EACH = {
        "object": Value("Object"), "present": Value("Present"), "answer": Value("Right answer"),
        "box": Value("Right box"), "time": Value("Time", "s"),
    }

    async def execute(self) -> None:
        count = self.parameters.trials
        present = [number % 2 == 0 for number in range(count)]
        self.random.shuffle(present)
        self._sum_up()
        for number, is_there in enumerate(present, 1):
            trial, wanted = f"trial {number}", self.random.choice(self.parameters.objects)
            self.status = f"Trial {number} of {count}: {wanted}"
            self.score[trial, "object"], self.score[trial, "present"] = wanted, is_there
            await self.referee(f"Put objects on the table, {'with' if is_there else 'WITHOUT'} the {wanted}")
            outcome = await self.goal(json.dumps({"trial": number, "object": wanted}), text=f"{trial}: {wanted}")
            self.score[trial, "time"] = outcome.executing_s
            await self._judge(trial, wanted, is_there, outcome)
            self._sum_up()
        self.status = "All trials done"

    async def _judge(self, trial: str, wanted: str, is_there: bool, outcome: GoalOutcome) -> None:
        answer = self.record(outcome, {"found": bool})
        self.score[trial, "answer"] = answer is not None and answer.found == is_there
        self.score[trial, "box"] = False
        self._sum_up()
        box = self.record(outcome, {"box": [float]}) if is_there and answer is not None and answer.found else None
        if box is not None and len(box.box) == 4:
            asked = f"The robot's box is {box.box}. Is the {wanted} in it?"
            self.score[trial, "box"] = await self.referee(asked, (YES, NO)) == YES

    def _sum_up(self) -> None:
        answers, boxes, times = (self.score.each(name) for name in ("answer", "box", "time"))
        self.score["answers"], self.score["boxes"] = answers.count(True), boxes.count(True)
        self.score["points"] = answers.count(True) + boxes.count(True)
        self.score["mean_time"] = sum(times) / len(times) if times else None
