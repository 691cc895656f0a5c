"""The check of a robot, beside the dummy robot, in simulated time."""

import asyncio
import contextlib

from helpers.simulated_air import SimulatedLoop
from roah_rsbb.check.engine import Engine, scenarios_of
from roah_rsbb.check.play import Options, Play
from roah_rsbb.check.scenarios import Depth
from roah_rsbb.comm import channels
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy import DummyOptions, DummyRobot

TEAM, NAME, PASSWORD = "Team", "Robot", "PASSWORD"
BOX, ROBOT, BROADCAST, SECOND = "127.0.0.1", "127.0.0.2", "127.255.255.255", "127.0.0.3"
USUAL = DummyOptions(prepare_duration=1.0, execute_duration=2.0, seed=1)


def usual_robot(loop, options=USUAL, **settings):
    """The dummy robot of this package."""
    values = {"team": TEAM, "password": PASSWORD, "behaviour": DummyRobot(options), "robot": NAME,
              "rsbb_host": BROADCAST, "bind_host": ROBOT, "clock": loop.utc, **settings}
    return RobotClient(**values)


class Checked:
    """A check that has ended."""

    def __init__(self, monkeypatch, make_robot=usual_robot, level=Depth.BASIC, names=None, benchmarks=("HGTKMH",),
                 during=None, **options):
        """`make_robot(loop)` returns an object with a coroutine `run`, or None. `during(play)`: a coroutine beside."""
        self.loop = SimulatedLoop()
        self.air = MemoryAir()
        monkeypatch.setattr(channels, "Peer", self.air.peer)
        values = {"team": TEAM, "password": PASSWORD, "rsbb_host": BROADCAST, "bind_host": BOX, "patience": 20.0,
                  "second_host": SECOND, "benchmarks": benchmarks, **options}
        self.shown = []
        try:
            self.loop.run_until_complete(
                self._run(make_robot, Options(**values), scenarios_of(level, benchmarks, names), during))
        finally:
            self.loop.close()

    async def _run(self, make_robot, options, scenarios, during):
        self.play = Play(self.loop, options, self.loop.utc, self.air.peer)
        robot = make_robot(self.loop)
        tasks = [self.loop.create_task(robot.run())] if robot is not None else []
        if during is not None:
            tasks.append(self.loop.create_task(during(self.play)))
        self.engine = Engine(self.play, scenarios, on_end=self.shown.append)
        self.play.open()
        try:
            await self.engine.run()
        finally:
            self.seconds = self.play.now
            self.play.close()
            for task in tasks:
                task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.gather(*tasks, return_exceptions=True)

    @property
    def findings(self):
        return [finding for result in self.engine.results for finding in result.findings]

    def causes(self, verdict):
        """The causes of the findings with this verdict."""
        return {finding.cause for finding in self.findings if finding.verdict is verdict}
