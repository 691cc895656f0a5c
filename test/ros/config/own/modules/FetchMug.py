"""FetchMug: the robot fetches mugs of different colours."""

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import ListOf, Text
from roah_rsbb.bmbox.framework.score import Value


class FetchMug(Module):
    """Each colour is a goal. The robot reports the colour of the mug that it fetched."""

    CODE = "FetchMug"
    PARAMETERS = {"colours": ListOf(Text("red"))}
    SCORES = {"fetched": Value("Mugs fetched")}
    EACH = {"result": Value("Result"), "time": Value("Time", "s")}

    async def execute(self) -> None:
        self.score["fetched"] = 0
        for colour in self.parameters.colours:
            await self.referee(f"Place the {colour} mug")
            outcome = await self.goal({"fetch": colour}, text=f"the {colour} mug")
            self.score[colour, "result"], self.score[colour, "time"] = outcome.result, outcome.executing_s
            found = self.record(outcome, {"colour": str})
            if found is not None and found.colour == colour:
                self.score["fetched"] += 1
