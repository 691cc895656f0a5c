"""Runs scenarios one after the other, and collects their results."""

import asyncio
from typing import Callable, List, Optional, Sequence

from roah_rsbb.check import monitor
from roah_rsbb.check.findings import Finding, ScenarioResult, Verdict
from roah_rsbb.check.play import GaveUp, Play
from roah_rsbb.check.scenarios import basic, boxes, goals, network
from roah_rsbb.check.scenarios.scenario import Depth, Scenario
from roah_rsbb.rulebook.registry import PROFILES

# If the check itself was stopped for longer than this (s) during a scenario, it does not judge the robot's times in it.
BUSY_S = 0.3
# Datagrams that a bad network delayed must not arrive in the next scenario.
LATE_S = 0.5

OnResult = Callable[[ScenarioResult], None]


def all_scenarios() -> List[Scenario]:
    """Return all scenarios, in their order."""
    return [*basic.SCENARIOS, *goals.SCENARIOS, *boxes.SCENARIOS, *network.SCENARIOS]


def scenarios_of(level: Depth, benchmarks: Sequence[str], names: Optional[Sequence[str]] = None) -> List[Scenario]:
    """Return the scenarios of a level, in order. `names`: only these, and the search for the robot."""
    if names is not None:
        return [one for one in all_scenarios() if one.name in names or not one.needs_robot]
    if level is Depth.BASIC:
        return [one for one in all_scenarios() if one.level is Depth.BASIC]
    others = {code for code in PROFILES if code not in benchmarks}
    done = f"run-{benchmarks[0].lower()}"  # by the scenario "run"
    return [one for one in all_scenarios() if one.code not in others and one.name != done]


class Engine:
    """One check from its beginning to its end."""

    def __init__(
        self, play: Play, scenarios: Sequence[Scenario], on_begin: OnResult = lambda result: None,
        on_end: OnResult = lambda result: None,
    ) -> None:
        """`on_begin` and `on_end` are called around each scenario, for the display."""
        self.play = play
        self.results: List[ScenarioResult] = []
        self._scenarios = scenarios
        self._on_begin = on_begin
        self._on_end = on_end

    async def run(self) -> None:
        """Run all scenarios. If cancelled, stop the robot, keep the results so far, and raise CancelledError."""
        play = self.play
        try:
            for scenario in self._scenarios:
                await self._run(scenario)
        except asyncio.CancelledError:
            await play.tidy()
            raise

    async def _run(self, scenario: Scenario) -> None:
        play = self.play
        code = scenario.code or play.options.benchmarks[0]
        result = play.result = ScenarioResult(scenario.name, scenario.title, play.now)
        began, since = play.loop.time(), monitor.mark(play)
        play.judges_times = not scenario.bad_network
        self._on_begin(result)
        try:
            if scenario.needs_robot and not play.robot:
                play.skip("The robot was not found")
            await scenario.run(play, code)
        except GaveUp:
            pass
        except asyncio.CancelledError:
            result.findings.append(Finding(Verdict.SKIPPED, None, "", "The check was interrupted", play.now))
            self._end(result, began)
            raise
        monitor.judge(play, since, code)
        await play.tidy()
        if scenario.bad_network:
            await play.rest(LATE_S)
        if play.stalls.worst(began) > BUSY_S:
            _unjudge(result)
        self._end(result, began)

    def _end(self, result: ScenarioResult, began: float) -> None:
        result.seconds = self.play.loop.time() - began
        self.results.append(result)
        self._on_end(result)


def _unjudge(result: ScenarioResult) -> None:
    """Turn failures that the checker's busy machine may have caused into "not judged"."""
    result.findings = [
        one._replace(verdict=Verdict.UNJUDGED, came=f"{one.came}; but the checker's machine was too busy to judge")
        if one.verdict is Verdict.FAILED and one.cause is not None and one.cause.timed else one
        for one in result.findings]
