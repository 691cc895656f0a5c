"""The core alone, in simulated time: a whole competition day."""

import array
import gc
import io
import sys
import time
from typing import NamedTuple

from table import quantile

from helpers.commands import given_with
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.nodes.core.to_gui import ToGui
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio.radio import beacon_size
from roah_rsbb.rulebook.benchmarks import Benchmark, Config, ScheduledEvent, ZonePlan

START = Now(1000.0, 1_800_000_000.0)
SCORING = tuple(ScoringItem("Achievements", f"Item {i}", ScoreKind.UINT) for i in range(16))
RUN_S, PAUSE_S, TICK_S = 600.0, 60.0, 1.0
BENCHMARK = Benchmark("HWV", "Task Benchmark", "A task", RUN_S + PAUSE_S, RUN_S + PAUSE_S, SCORING)
SECONDS = int(RUN_S / TICK_S) - 1  # measured seconds of a run
FOLLOWS = {BoxState.STOP: RobotState.STOP, BoxState.PREPARE: RobotState.WAITING_GOAL,
           BoxState.WAITING_RESULT: RobotState.EXECUTING}


class World:
    """A box with the given number of zones and a robot for each."""

    def __init__(self, zones: int, events: int = 1) -> None:
        plans = tuple(
            ZonePlan(f"zone {i}", tuple(
                ScheduledEvent(BENCHMARK, f"Team{i}", 1, run, START.utc) for run in range(events)))
            for i in range(zones))
        self.teams = [f"Team{i}" for i in range(zones)]
        config = Config({"HWV": BENCHMARK}, dict.fromkeys(self.teams, "password"), plans)
        self.now = START
        self.box = Box(config, Settings(listen_duration=0.0, max_datagram=8000), beacon_size)
        self._to_gui = ToGui(self.box)
        self._documents = Documents(self.box, "", "")
        self.box.tick(self.now)

    def wire_now(self):
        return divmod(round(self.now.utc * 1e6) * 1000, 1_000_000_000)

    def beacons(self) -> None:
        """All robots send a beacon."""
        for i, team in enumerate(self.teams):
            self.box.on_robot_beacon(self.now, f"127.0.2.{1 + i}", team, "Robot", self.wire_now())

    def reports(self) -> None:
        """All robots in runs follow the box's state and report it."""
        for i, run in enumerate(self.box.zones.members()):
            report = RobotReport(self.wire_now(), messages_saved=1, state=FOLLOWS[run.message.state],
                                 notifications=(f"at {self.now.utc // 10:.0f}",))
            self.box.on_robot_report(self.now, run.port, f"127.0.2.{1 + i}", report)

    def command(self, command: str) -> None:
        """The referees give the same command to all zones."""
        for zone in self.box.zones:
            self.box.act(self.now, Target(zone), command, "", given_with(command))

    def pass_time(self, seconds: float) -> None:
        self.now = self.now.later(seconds)

    def publish(self) -> None:
        """The messages that the core node makes for panels ten times a second."""
        self.box.tick(self.now)
        self._to_gui.message(self.now, self._documents.look(self.now)).serialize(io.BytesIO())


def _python_bytes() -> int:
    """The size of all Python objects in this process. tracemalloc would make the box twenty times as slow."""
    total, known, found = 0, set(), gc.get_objects()
    while found:
        new = [item for item in {id(item): item for item in found}.values() if id(item) not in known]
        known.update(map(id, new))
        total += sum(map(sys.getsizeof, new))
        found = gc.get_referents(*new)
    return total


class Day(NamedTuple):
    """Results of a competition day."""

    runs: int
    grown_mb: float  # growth from the end of the first run to the end of the last
    slower_percent: float  # last quarter compared with the first one, median of a second
    jitter_ms: float  # 99 % of the time of one second of all robots, in the last quarter


def day(zones: int, hours: float) -> Day:
    """Runs of ten minutes in all zones, with a message of each robot and one for the panels each second."""
    rounds = max(2, int(hours * 3600 / (RUN_S + PAUSE_S)))
    world = World(zones, rounds)
    # Allocate memory for all measurements first: only the core's memory may grow.
    taken = array.array("d", bytes(8 * rounds * SECONDS))
    index = after_first = 0
    for number in range(rounds):
        world.beacons()
        world.pass_time(1.0)
        if number:
            world.command("next")
        world.command("connect")
        world.reports()
        world.command("start")
        for _ in range(SECONDS):
            world.pass_time(TICK_S)
            began = time.perf_counter()
            world.reports()
            world.publish()
            world.box.take_effects()
            taken[index] = (time.perf_counter() - began) * 1e3
            index += 1
        world.pass_time(1.0)
        world.command("stop")
        world.reports()
        world.command("disconnect")
        world.box.take_effects()
        world.pass_time(PAUSE_S - 2.0)
        gc.collect()
        if number == 0:
            after_first = _python_bytes()
    grown = _python_bytes() - after_first
    quarter = max(1, len(taken) // 4)
    first, last = taken[:quarter], taken[-quarter:]
    slower = 100.0 * (quantile(last, 0.5) / quantile(first, 0.5) - 1.0)
    return Day(rounds * zones, grown / 1e6, slower, quantile(last, 0.99))
