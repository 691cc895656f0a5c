"""The conformance check of a robot: the comm node with a dummy behind it."""

import asyncio
from typing import List
from unittest import mock

from support.box_case import NetworkCase
from support.dummy_launch import dummy
from support.robots import BOX, BROADCAST, PASSWORDS, RSBB_PORT
from support.waiting import LIMIT_S

from roah_rsbb.check import engine, play, scenarios
from roah_rsbb.check.report import ScenarioResult, Verdict

TEAM = "Alpha"
# How long the check waits for the robot. Here it waits for events: a busy machine is no fault.
_LIMITS = {
    play: ("ANSWER_S", "OBEY_S", "LEAVE_S", "STOP_S", "STOP_LOST_S", "SILENT_S", "GONE_S"),
    scenarios: ("LEAVE_S", "REPEATED_S"), engine: ("SILENT_S", "SAVING_S"),
}


class TestCheck(NetworkCase):
    maxDiff = None

    def check(self, *names: str) -> List[ScenarioResult]:
        """The results of some scenarios."""
        options = play.Options(TEAM, PASSWORDS[TEAM], "Robot", BROADCAST, RSBB_PORT, BOX, benchmarks=("HOPF",),
                               patience=LIMIT_S, wait=LIMIT_S)

        async def run() -> List[ScenarioResult]:
            played = play.Play(asyncio.get_event_loop(), options)
            played.open()
            try:
                check = engine.Engine(played, [one for one in scenarios.SCENARIOS if one.name in names])
                await check.run()
            finally:
                played.close()
            return check.results

        for module, limits in _LIMITS.items():
            for name in limits:
                patch = mock.patch.object(module, name, LIMIT_S)
                patch.start()
                self.addCleanup(patch.stop)
        return asyncio.run(run())

    def test_the_comm_node_passes(self) -> None:
        """Goals, results, STOP, and a box that restarts."""
        self._leaving(dummy(execute_duration=2.0))
        names = ["find", "run", "stop-executing", "run-hnf", "restart"]
        results = self.check(*names)
        self.assertEqual([one.name for one in results], names)
        # On a busy machine, the dummy may be ready before the check can stop it.
        findings = [finding for one in results for finding in one.findings]
        self.assertEqual([one for one in findings if one.verdict is not Verdict.SKIPPED], [])

    def test_a_dummy_that_saves_nothing_fails(self) -> None:
        self._leaving(dummy(save_nothing=True))
        results = self.check("find", "run")
        self.assertEqual([[finding.cause.name for finding in one.findings] for one in results], [[], ["NOTHING_SAVED"]])
