"""A journal of many runs, written by the real core in simulated time: for the speed of results, and for large reports.

Each zone has one run after the other. In a run a robot reports each second, a referee marks items, and some runs are
stopped, restarted, never started, corrected or not signed off.
"""

import os
import random

from helpers.commands import given_with
from helpers.config_files import SHIPPED
from roah_rsbb.box import journal as core_journal
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio.radio import beacon_size
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config, ScheduledEvent, ZonePlan

START = Now(1000.0, 1_800_000_000.0)
CODES = ("HGTKMH", "HCFGAC", "HWV")
SLOT_S = 120.0  # from one scheduled event of a zone to the next
_FOLLOWS = {BoxState.STOP: RobotState.STOP, BoxState.PREPARE: RobotState.WAITING_GOAL,
            BoxState.WAITING_RESULT: RobotState.EXECUTING}


def write_journal(log_dir, runs, zones=20, seconds=20):
    """Write a journal with about so many runs, each with so many seconds of execution; returns its path."""
    zones = min(zones, runs)
    return _Competition(str(log_dir), zones, runs // zones, seconds).play()


class _Competition:
    def __init__(self, log_dir, zones, rounds, seconds):
        self._random = random.Random(23)
        self._rounds, self._seconds = rounds, seconds
        benchmarks = config.load_benchmarks(os.path.join(str(SHIPPED), "benchmarks.yaml"))
        self._benchmarks = [benchmarks[code] for code in CODES]
        self._teams = [f"Team {i + 1}" for i in range(zones)]
        plans = tuple(
            ZonePlan(f"zone {i + 1}", tuple(
                ScheduledEvent(self._benchmarks[(i + run) % len(CODES)], self._teams[i], 1 + run // 10, 1 + run % 10,
                               START.utc + SLOT_S * run) for run in range(rounds)))
            for i in range(zones))
        config_ = Config(benchmarks, dict.fromkeys(self._teams, "password"), plans)
        self._now = START
        self._box = Box(config_, Settings(listen_duration=0.0, max_datagram=8000), beacon_size)
        session = CoreSession(START.utc, START.mono, "boot", 1, "uuid", "")
        self._troubles = []
        self._journal = Journal(log_dir, session, core_journal.competition(config_), Resume.ALWAYS,
                                self._troubles.append)
        self._core_journal = core_journal.CoreJournal(self._box, self._journal)

    def play(self):
        """Conduct all runs; returns the journal's path."""
        self._event(self._box.timers.tick)
        for number in range(self._rounds):
            self._round(number)
        path = self._journal.path
        self._journal.close()
        assert not any(self._troubles), self._troubles
        return path

    def _round(self, number):
        """Conduct a run in each zone at the same time."""
        began = self._now
        for i, team in enumerate(self._teams):
            self._event(self._box.arrivals.on_robot_beacon, f"10.0.1.{i + 1}", team, "robot", self._wire_now())
        self._pass_time(1.0)
        scheduled = START.utc + SLOT_S * number  # a zone whose robot completed its task is there already
        self._command("next", [name for name, zone in self._box.zones.items() if zone.event.scheduled < scheduled])
        self._command("connect")
        started = [zone for zone in self._box.zones if self._random.random() < 0.95]
        self._start(started)
        for second in range(self._seconds):
            self._second()
            if second == self._seconds // 2:
                self._mark(started)
                self._command("stop", started[::10])
                self._start(started[::10])
        self._command("stop", started[::2])
        self._end(started[1::2])
        closed = {name: self._box.zones[name].run.identity for name in started}
        self._command("disconnect")
        for zone, identity in closed.items():
            if self._random.random() < 0.9:
                self._event(self._box.act, Target(zone, identity), "sign_off", "Anna")
        self._pass_time(max(1.0, began.mono + SLOT_S + self._random.uniform(-10.0, 30.0) - self._now.mono))

    def _start(self, zones):
        while any(self._box.actions.off(self._now, self._box.zones[name], "start") for name in zones):
            self._second()
        self._command("start", zones)

    def _second(self):
        """Let a second pass, in which each robot follows the box and reports."""
        self._pass_time(1.0)
        for run in self._box.zones.members():
            self._report(run, _FOLLOWS[run.message.state])
        self._core_journal.each_second(self._now, {})

    def _report(self, run, state):
        if self._random.random() < 0.02:
            return  # lost
        host = f"10.0.1.{1 + self._teams.index(run.robot.team)}"
        notifications = (f"at waypoint {self._random.randrange(3)}",) if state is RobotState.EXECUTING else ()
        report = RobotReport(self._wire_now(), messages_saved=1, state=state, notifications=notifications)
        self._event(self._box.arrivals.on_robot_report, run.port, host, report)

    def _mark(self, zones):
        for name in zones:
            run = self._box.zones[name].run
            items = [item for item in run.event.benchmark.scoring if item.kind in (ScoreKind.BOOL, ScoreKind.UINT)]
            for item in self._random.sample(items, min(3, len(items))):
                value = 1 if item.kind is ScoreKind.BOOL else self._random.randrange(1, 4)
                given = {"group": item.group, "desc": item.desc, "value": value}
                self._event(self._box.act, Target(name), "mark", "Anna", given)

    def _end(self, zones):
        """The robots end their task."""
        for name in zones:
            run = self._box.zones[name].run
            if run.message.state is BoxState.WAITING_RESULT:
                self._report(run, RobotState.RESULT_TX)
        self._second()
        self._command("stop", [name for name in zones if not self._box.actions.off(
            self._now, self._box.zones[name], "stop")])

    # -- the box ------------------------------------------------------------------------------------

    def _event(self, method, *arguments):
        method(self._now, *arguments)
        todo = self._box.outbox.take()
        if todo:
            self._core_journal.record(self._now, todo)

    def _command(self, command, zones=None):
        for zone in self._box.zones if zones is None else zones:
            self._event(self._box.act, Target(zone), command, "", given_with(command))

    def _pass_time(self, seconds):
        self._now = self._now.later(seconds)
        self._event(self._box.timers.tick)

    def _wire_now(self):
        return divmod(round(self._now.utc * 1e6) * 1000, 1_000_000_000)
