"""One simulated competition: its seed decides everything."""

import gc
import logging
import os
import pathlib
import random
import tempfile
from dataclasses import replace
from decimal import Decimal
from typing import NamedTuple

from helpers.competition import benchmark, competition
from roah_rsbb.model.scoring import JudgesRule, ScoreKind, ScoringItem, rows
from roah_rsbb.rulebook.benchmarks import Durable, EventRules, PhaseRule, Restarts, ScheduledEvent

from .air import Air
from .box import Box
from .disk import Storage
from .ledger import Ledger
from .oracles import Oracles
from .referee import Referee
from .robots import Robot
from .scheduler import UTC0, Computer, Scheduler
from .sheets import drawn_sheet
from .shown import Shown
from .standby import PORT, Standby
from .trace import Trace
from .troubles import SHORT_S, Troubles, plan_of
from .witness import Witness

BOX_HOST, STANDBY_HOST = "10.0.0.1", "10.0.0.50"
# Of so many seeds, one runs a second time without the short way of datagrams.
BOTH_WAYS = 4
# From this seed on, an organiser annuls, moves and reopens runs, too.
ORGANISED = 10**9
# Objects between two collections of garbage: a tenth of the time is saved.
GARBAGE = 200_000
# Seconds without troubles and without referees at the end.
CALM_S = 12.0
# The limit of runs of which many time out, and so have late marks.
LATE_S = 4.0
SCORING = (
    ScoringItem("Achievements", "detects the door", ScoreKind.BOOL, Decimal("10")),
    ScoringItem("Achievements", "changed objects", ScoreKind.UINT, Decimal("2.5")),
    ScoringItem("Penalized", "bumps", ScoreKind.UINT, Decimal("-3")),
)
PHASES = (PhaseRule("first", 5.0), PhaseRule("second", 10.0), PhaseRule("third"))


class _Errors(logging.Handler):
    """What programs log as an error is a bug."""

    def __init__(self, scheduler):
        super().__init__(logging.ERROR)
        self._scheduler = scheduler

    def emit(self, record):
        error = record.exc_info[1] if record.exc_info else None
        self._scheduler.bugs.append(error or RuntimeError(record.getMessage()))


class Size(NamedTuple):
    """A larger competition than seeds have: in each zone one team, with a robot."""

    zones: int
    length_s: float


class World:
    """All computers, and the time. `plan`: troubles, in place of those of the seed. `can_wait`: whether datagrams take
    the short way (`roah_rsbb.radio.short_way`), which must make no difference."""

    def __init__(self, seed, folder, plan=None, can_wait=True, size=None):
        self.seed, self.folder, self.can_wait = seed, folder, can_wait
        draw = random.Random(f"{seed} world")
        self._bytes = random.Random(f"{seed} bytes")
        self.scheduler = Scheduler()
        self.trace = Trace(self.scheduler, folder)
        self.air = Air(self.scheduler, random.Random(f"{seed} air"), self.trace)
        self.clocks_were_set = set()  # names of robots
        self.has_organiser = seed >= ORGANISED
        self.config = _competition(draw, 0 if size is None else size.zones, random.Random(f"{seed} sheets"))
        if self.has_organiser:
            self.config = _with_ids(self.config)
        has_standby = draw.random() < 0.4
        if has_standby and draw.random() < 0.6:
            self.config = replace(self.config, durable=Durable.TWO)
        self.length_s = draw.uniform(20.0, 60.0) if size is None else size.length_s
        self.robots = []
        self.is_compared = seed % BOTH_WAYS == 0  # with a second pass
        self.documents = []  # of all boxes, once a second, if they are compared
        self.journal = {}  # of the first box at the end: bytes by path
        computer = Computer(self.scheduler, "box", BOX_HOST, draw.uniform(-5e-5, 5e-5), draw.uniform(-0.03, 0.03))
        self.storage = Storage(os.path.join(folder, "log"), self.scheduler, random.Random(f"{seed} disk"),
                               self.random_bytes)
        self.oracles = Oracles(self)
        self.ledger, self.witness, self.shown = Ledger(self), Witness(self), Shown(self)
        self.standby = None
        self.box = Box(self, computer, self.storage, self.config, PORT if has_standby else 0)
        self.boxes = [self.box]
        if has_standby:
            self._add_standby(draw, os.path.join(folder, "copy"))
        self.referee = Referee(self, self.box, random.Random(f"{seed} referee"))
        for number, team in enumerate(self.config.passwords):
            self._add_robot(draw, number, team)
        self.plan = plan_of(self, random.Random(f"{seed} troubles")) if plan is None else plan
        self.troubles = Troubles(self, random.Random(f"{seed} forger"))

    def _add_standby(self, draw, folder):
        computer = Computer(self.scheduler, "standby", STANDBY_HOST, draw.uniform(-5e-5, 5e-5),
                            draw.uniform(-0.03, 0.03), draw.choice((20.0, 990.0, 90_000.0)))
        self.standby = Standby(self, computer, folder, self.box)
        self.box.copy()

    def taken_over(self, box):
        """Another box begins. Referees turn to it."""
        self.oracles.taken_over()
        self.boxes.append(box)
        self.box = self.referee.box = box
        self.storage = box.storage
        box.start()

    def _add_robot(self, draw, number, team):
        computer = Computer(self.scheduler, f"robot {number}", f"10.0.0.{number + 2}", draw.uniform(-5e-5, 5e-5),
                            draw.uniform(-0.03, 0.03))
        options = {"prepare_duration": draw.uniform(0.0, 3.0), "execute_duration": draw.uniform(0.5, 8.0),
                   "never_end": draw.random() < 0.2}
        robot = Robot(self, computer, team, f"r{number}", self.config.passwords[team], options)
        if draw.random() < 0.3:  # it completes its task just in time
            robot.complete_after(SHORT_S - draw.uniform(0.1, 2.0))
        robot.saves_nothing = draw.random() < 0.15
        self.robots.append(robot)
        self.witness.add(robot)

    def random_bytes(self, count):
        """Stands for os.urandom."""
        return self._bytes.getrandbits(8 * count).to_bytes(count, "big") if count else b""

    def run(self):
        """Play it all. Raises what went wrong."""
        errors = _Errors(self.scheduler)
        logging.getLogger().addHandler(errors)
        try:
            self._play()
        finally:
            logging.getLogger().removeHandler(errors)
            for process in self.scheduler.processes:
                process.end()
            for process in self.scheduler.processes:
                process.bury()
            for box in self.boxes:
                box.storage.killed()

    def _play(self):
        self.oracles.begin()
        self.box.start()
        for robot in self.robots:
            self.scheduler.after(self._bytes.uniform(0.0, 2.0), robot.start)
        self.referee.begin()
        for trouble in self.plan:
            self.scheduler.after(trouble.at, lambda trouble=trouble: self.troubles.begin(trouble))
        self._pass(self.length_s)
        self.referee.is_at_work = False
        self.troubles.end_all()
        self._pass(self.length_s + CALM_S)
        self.oracles.end()
        self._raise_bugs()

    def _pass(self, end):
        bugs = self.scheduler.bugs
        self.scheduler.run(end, lambda: bool(bugs))
        self._raise_bugs()

    def _raise_bugs(self):
        if self.scheduler.bugs:
            raise self.scheduler.bugs[0]


def _competition(draw, large, draw_sheet):
    """`large`: number of zones; 0: as seeds have."""
    has_sheets = draw_sheet.random() < 0.6
    codes = ("HGTKMH", "HCFGAC", "HWV")
    if large:
        teams = tuple(f"T{number}" for number in range(large))
        playing = {f"z{number}": (team,) for number, team in enumerate(teams)}
    else:
        teams = ("Alpha", "Beta")
        playing = dict.fromkeys(("a", "b")[:draw.choice((1, 1, 2))], ("Alpha", "Beta", "ALL"))
    zones = {}
    for name, those in playing.items():
        zones[name] = tuple(
            ScheduledEvent(benchmark("HSUF" if team == "ALL" else draw.choice(codes),
                                     draw.choice((SHORT_S, 30.0, 600.0)), scoring=SCORING, rules=_rules(draw),
                                     judges=JudgesRule(2) if draw.random() < 0.15 else None),
                           team, 1, number, UTC0 + 60.0 * number)
            for number, team in enumerate(draw.choices(those, (2, 2, 1)[:len(those)], k=draw.randint(1, 4)), 1))
        if has_sheets:
            zones[name] = tuple(replace(event, benchmark=_with_sheet(event.benchmark, draw_sheet))
                                for event in zones[name])
    return competition(teams=teams, **zones)


def _with_ids(config):
    return replace(config, zones=tuple(
        replace(zone, events=tuple(replace(event, id=f"{zone.name}{number}")
                                   for number, event in enumerate(zone.events, 1))) for zone in config.zones))


def _with_sheet(benchmark, draw):
    if benchmark.judges is not None or draw.random() < 0.2:
        return benchmark
    limit_s = draw.choice((LATE_S, benchmark.total_timeout))
    sheet = drawn_sheet(draw, limit_s)
    return replace(benchmark, timeout=limit_s, total_timeout=limit_s, sheet=sheet, scoring=rows(sheet))


def _rules(draw):
    return EventRules(
        setup_time=draw.choice((0.0, 0.0, 6.0)), attempts=draw.choice((0, 0, 0, 1, 2)), pause=draw.random() < 0.7,
        restarts=draw.choice((Restarts.CLOCK_RUNS, Restarts.CLOCK_STOPS, Restarts.NOT_ALLOWED)),
        phases=draw.choice(((), PHASES)))


def simulate(seed, plan=None, can_wait=True, size=None):
    """Run a seed; returns its world. Raises what went wrong, with the world as its attribute `world`."""
    thresholds = gc.get_threshold()
    with tempfile.TemporaryDirectory(prefix="simulated_", dir=_memory()) as folder:
        world = World(seed, folder, plan, can_wait, size)
        gc.set_threshold(GARBAGE)
        try:
            world.run()
        except Exception as error:
            error.world = world
            raise
        finally:
            gc.set_threshold(*thresholds)
        journal = pathlib.Path(folder, "log", "roah_rsbb_journal")
        world.journal = {path.name: path.read_bytes() for path in journal.iterdir()}
        return world


def _memory():
    """A folder in memory, if there is one, because the simulated disk has its own slowness."""
    return "/dev/shm" if os.path.isdir("/dev/shm") else None
