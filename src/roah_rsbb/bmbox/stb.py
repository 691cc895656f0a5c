"""STB, the Simple Test Benchmark: a manual operation, two goals, a manual operation (docs/benchmarks.md, "STB")."""

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import GoalTimeout, ListOf, Text
from roah_rsbb.bmbox.framework.score import Value


class STB(Module):
    """Uses a manual operation before and after the goals."""

    CODE = "STB"
    PARAMETERS = {"goals": ListOf(Text("GOAL 1")), "goal_timeout": GoalTimeout()}
    SCORES = {"completed": Value("Goals completed"), "execution_time": Value("Execution time", "s")}
    EACH = {"result": Value("Result"), "time": Value("Time", "s")}

    async def execute(self) -> None:
        self.score["completed"] = 0
        await self.referee("First Manual Operation")
        for number, goal in enumerate(self.parameters.goals, 1):
            name = f"goal {number}"
            self.status = f"Goal {number} of {len(self.parameters.goals)}: {goal}"
            outcome = await self.goal({"goal": goal, "details": 4}, text=goal)
            self.score[name, "time"] = outcome.executing_s
            self.score[name, "result"] = None if outcome.timed_out else outcome.result
            if not outcome.timed_out:
                self.score["completed"] += 1
            self.score["execution_time"] = sum(self.score.each("time"))
        self.status = "All goals done"
        await self.referee("Last Manual Operation")
