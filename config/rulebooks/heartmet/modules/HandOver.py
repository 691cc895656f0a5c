"""Hand over an object: the robot offers an object and releases it only into the person's hand.

Goal: {"trial": 3, "object": "mug"}. The robot must find out itself how the person behaves.
Result: {"offered": true, "released": true}.
"""

import itertools
import json

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, Text
from roah_rsbb.bmbox.framework.score import Value

WITH_PERSON, WITH_ROBOT, DROPPED = "with the person", "with the robot", "dropped"
TAKES = "takes the object"


class HandOver(Module):
    """Each combination of object, posture and reaction once, in random order.

    A handover succeeds if the object is where it belongs: with a person who takes it, or else still with the robot; and
    if the robot reports what it did.
    """

    CODE = "HandOver"
    PARAMETERS = {
        "objects": ListOf(Text("mug"), at_most=10), "postures": ListOf(Text("sitting"), at_most=5),
        "reactions": ListOf(Text(TAKES), at_most=5), "goal_timeout": GoalTimeout(),
    }
    SCORES = {
        "handovers": Value("Successful handovers"), "dropped": Value("Objects dropped"),
        "reports": Value("Right reports"),
    }
    EACH = {
        "trial": Value("Trial"), "object_is": Value("The object is"), "success": Value("Success"),
        "report": Value("Right report"), "time": Value("Time", "s"),
    }

    async def execute(self) -> None:
        kinds = list(itertools.product(self.parameters.objects, self.parameters.postures, self.parameters.reactions))
        self.random.shuffle(kinds)
        self._sum_up()
        for number, (thing, posture, reaction) in enumerate(kinds, 1):
            trial = f"trial {number}"
            self.score[trial, "trial"] = f"{thing}, {posture}, {reaction}"
            self.status = f"Trial {number} of {len(kinds)}: {thing}, {posture}, {reaction}"
            await self.referee(f"Give the robot the {thing}. Ask the person: {posture}, {reaction}")
            outcome = await self.goal(json.dumps({"trial": number, "object": thing}), text=f"{trial}: {thing}")
            said = self.record(outcome, {"offered": bool, "released": bool})
            self.score[trial, "time"] = outcome.executing_s
            where = await self.referee(f"Where is the {thing}?", (WITH_PERSON, WITH_ROBOT, DROPPED))
            right = where == (WITH_PERSON if reaction == TAKES else WITH_ROBOT)
            self.score[trial, "object_is"] = where
            self.score[trial, "report"] = said is not None and said.released == (where != WITH_ROBOT)
            self.score[trial, "success"] = right and said is not None and said.offered
            self._sum_up()
        self.status = "All trials done"

    def _sum_up(self) -> None:
        self.score["handovers"] = self.score.each("success").count(True)
        self.score["dropped"] = self.score.each("object_is").count(DROPPED)
        self.score["reports"] = self.score.each("report").count(True)
