"""A day of a competition in simulated time: the real box and rules, robots at the other end of the wire, referees.

A test says how robots and people behave. Each zone has a referee, who conducts the runs of the day one after the other
without waiting for their scheduled times.
"""

import functools
import io
import os
import random
from unittest import mock

import pytest

from helpers.linked_world import FakeLink, RadioRobot, World
from roah_rsbb.bmbox.framework.rehearsal import Poses
from roah_rsbb.bmbox.framework.rule_files import modules, own_files
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.bmbox.host.host import Driven
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.zones import key_of
from roah_rsbb.model.modules import ModuleInfo, ModulesState
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import Phase
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.tools.competition import program

LOOKS_S = 0.25  # how often modules and referees look
LOSS = 0.02


def make_competition(folder, rulebook, *options):
    """Make the folder of a competition with an included rulebook; returns its path."""
    # pytest 4.6 (Ubuntu 20.04) puts a file there that is not a text stream.
    stdout = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    with mock.patch("sys.stdout", stdout), pytest.raises(SystemExit) as end:
        program.main([str(folder), "--rulebook", rulebook, *options, "--time-zone", "UTC"])
    assert end.value.code == 0
    return str(folder)


class Behaviour:
    """How the people and robots of a test behave. A test overrides what it needs."""

    def answer(self, event, asked):
        """The referee's answer to a benchmarking module; "" is the usual one."""
        return ""

    def result(self, event, number, goal):
        """A robot's seconds and result for its goal, which is a text or None; no seconds: it does not end the goal."""
        return 5.0, None

    def marks(self, event):
        """The referee's marks of a run."""
        return ()


class DayRobot(RadioRobot):
    """A robot of the team of an event, which behaves as the test says."""

    def __init__(self, day, event, *of_robot):
        self.day, self.event = day, event
        super().__init__(day.world, *of_robot)

    def _end_of(self, mono, execute):
        text = None if execute.goal is None else execute.goal.text
        seconds, result = self.day.behaviour.result(self.event, self.tasks, text)
        return None if seconds is None else (mono + seconds, lambda: self.session.end_execute(result))


class RealModules:
    """The node of benchmarking modules, without ROS: the competition's rules and parameters."""

    def __init__(self, world, folder, codes):
        known, own = modules(), own_files(folder)
        self.world = world
        self.driven = {code: Driven(code, folder, known.get(code), own.get(code)) for code in codes}
        self.runners = {}  # by identity
        self.due = world.mono
        problems = {code: driven.problems() for code, driven in self.driven.items()}
        assert not any(problems.values()), problems

    def deadline(self):
        return self.due

    def poll(self):
        """Exchange messages with the core until neither side has news."""
        self.due = self.world.mono + LOOKS_S
        box, said = self.world.box, None
        while said is None or said != self._said():
            for run in box.box.modules.runs():
                driven = self.driven[run.benchmark]
                runner = self.runners.setdefault(run.run, ModuleRunner(driven.make, driven.parameters, Poses()))
                runner.on_run(run)
                assert not runner.progress() or not runner.progress().failed, runner.traceback
            said = self._said()
            infos = tuple(map(ModuleInfo, self.driven))
            box.event(box.box.modules.on_modules, ModulesState("node", infos, said))

    def _said(self):
        current = {run.run for run in self.world.box.box.modules.runs()}
        said = [runner.progress() for run, runner in self.runners.items() if run in current]
        return tuple(progress for progress in said if progress is not None)


class Day:
    """The box with the files of a competition's folder, which is for one day."""

    def __init__(self, folder, behaviour):
        self.folder, self.behaviour = folder, behaviour
        files = (os.path.join(folder, f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords"))
        loaded, warnings = config.load(*files)
        assert warnings == []
        self.config = loaded
        # Without jitter many datagrams arrive at the same time, so that there are fewer moments to simulate.
        self.world = World(self.config, FakeLink(random.Random(1), loss=LOSS, jitter=False), Settings())
        codes = sorted({event.benchmark.code for zone in self.config.zones for event in zone.events
                        if event.benchmark.kind is BenchmarkKind.FUNCTIONALITY})
        self.world.companions.append(RealModules(self.world, os.path.join(folder, "modules"), codes))
        self.world.companions.append(self)
        self.busy = set()  # teams
        self.due = self.world.mono
        self._waits = {referee: next(referee) for referee in map(self._conduct, self.config.zones)}

    def play(self, limit_s=3600):
        """Conduct all runs of the day; returns their records."""
        ended = self.world.run_until(lambda: not self._waits, limit_s)
        assert ended, [(zone.name, key_of(zone.event), zone.run) for zone in self.world.box.box.zones.values()]
        return self.world.box.box.finished.records()

    def deadline(self):
        return self.due

    def poll(self):
        """Let each referee do what is possible now."""
        self.due = self.world.mono + LOOKS_S
        for referee in list(self._waits):
            while referee in self._waits and self._waits[referee]():
                try:
                    self._waits[referee] = next(referee)
                except StopIteration:
                    del self._waits[referee]

    # -- a referee ------------------------------------------------------------------------------------

    def _conduct(self, zone):
        """Conduct the runs of a zone. Yields what the referee waits for."""
        for event in zone.events:
            teams = list(self.config.passwords) if event.team == ALL_TEAMS else [event.team]
            yield functools.partial(self.busy.isdisjoint, teams)
            self.busy.update(teams)
            robots = [self._switch_on(event, team) for team in teams]
            yield from self._run(zone.name, event)
            for robot in robots:
                self.world.robots.remove(robot)
            self.busy.difference_update(teams)

    def _switch_on(self, event, team):
        number = list(self.config.passwords).index(team)
        robot = DayRobot(self, event, team, f"robot of {team}", f"10.0.1.{number + 1}", self.world.keys[team])
        self.world.robots.append(robot)
        return robot

    def _run(self, zone, event):
        """Conduct the run of an event, and sign it off."""
        box = self.world.box
        place = box.box.zones[zone]
        assert key_of(place.event) == key_of(event)
        yield from self._press(zone, "connect")
        run = box.run_in(zone)
        yield from self._press(zone, "start")
        for _ in event.benchmark.rules.phases[1:]:
            yield from self._press(zone, "next_phase")
        yield from self._to_the_end(zone, event, run)
        for mark in self.behaviour.marks(event):
            box.mark(RunName(zone), mark, "Anna")
        identity = run.identity
        yield from self._press(zone, "disconnect")
        box.enter("sign_off", RunName(zone, identity), "Anna")
        if key_of(place.event) == key_of(event) and not place.at_last:
            yield from self._press(zone, "next")

    def _to_the_end(self, zone, event, run):
        """Wait for the end of a run, and answer the benchmarking module."""
        box = self.world.box
        while run.phase is not Phase.ENDED:
            yield lambda: run.phase is Phase.ENDED or getattr(run, "asked", None) is not None
            asked = getattr(run, "asked", None)
            if run.phase is not Phase.ENDED and asked is not None:
                answer = self.behaviour.answer(event, asked)
                box.event(box.box.act, Target(zone), "operation", "", {"operation": asked.number, "answer": answer})

    def _press(self, zone, command):
        yield lambda: not self.world.box.off(command, zone)
        self.world.box.command(command, zone)
