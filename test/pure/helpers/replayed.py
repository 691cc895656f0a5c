"""A competition that is played with a journal, and what its box showed at many moments, for tests of replays."""

from decimal import Decimal
from random import Random
from typing import NamedTuple, Tuple

from helpers.competition import BUMPS, DOOR, OBJECTS, competition, event
from helpers.journaled import NO_LISTENING, JournaledDriver
from helpers.module_player import FakeModules, does_goal
from helpers.results_of import EVIL
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import PublicRun
from roah_rsbb.model.modules import RequestKind, ScoreValue
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.model.zone import NOTHING, ZoneSeen
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.benchmarks import EventRules, PhaseRule

RULES = EventRules(setup_time=20.0, pause=True, phases=(PhaseRule("kitchen", 30.0), PhaseRule("bed room")))
SHEET = (DOOR, ScoringItem(OBJECTS.group, "objects <b>brought</b>", ScoreKind.UINT, Decimal("2.5")), BUMPS)
LOOK_S = 0.002  # after an event


def clock_at(clock, now):
    """The times of a run's clock (`model.zone.RunClock`) at a moment, by the names that the journal has."""
    mono = now.mono
    return {
        "elapsed": clock.spent(mono), "goal_elapsed": clock.goal_spent(mono),
        "setup_elapsed": clock.setup_elapsed.at(mono), "phase_elapsed": clock.phase_elapsed.at(mono),
        "after_stop": clock.after_stop(mono), "timer": clock.timer(mono),
    }


def untimed(runs):
    """Public runs without their clocks."""
    return tuple(run._replace(elapsed=NOTHING) for run in runs)


class Look(NamedTuple):
    """What the box showed at a moment."""

    now: Now
    view: ZoneSeen
    desc: str
    explained: Tuple[PublicRun, ...]  # without what the robots say


class ReplayedCompetition(JournaledDriver):
    """Conducts a task benchmark and a functionality benchmark with everything that a replay shows."""

    def __init__(self, log_dir, seed=1):
        self.seed, self.random = seed, Random(seed)
        self.looks = {}  # by identity
        self.core_journal = None
        self._looked_second = None
        config = competition(tbm=[event("HCFGAC", timeout=600.0, scoring=SHEET, rules=RULES)],
                             fbm=[event("HNF", team="Beta", timeout=60.0, total_timeout=300.0)])
        super().__init__(log_dir, config, NO_LISTENING)

    def event(self, method, *arguments):
        """See `BoxDriver.event`. Looks at the box soon after; once a second, the link is recorded."""
        try:
            return super().event(method, *arguments)
        finally:
            if self.core_journal is not None and int(self.now.mono) != self._looked_second:
                self._looked_second = int(self.now.mono)
                self.core_journal.each_second(self.now, {})

    def look(self):
        """Note what the box shows now."""
        self.jump(LOOK_S)
        document = Documents(self.box, "", "").look(self.now)
        for view in document.zones.values():
            if view.identity:
                look = Look(self.now, view, self.run_in(view.zone).desc, untimed(document.runs_shown()))
                self.looks.setdefault(view.identity, []).append(look)
        self.jump(LOOK_S)

    def passes(self, *robots):
        """Let some time pass, in which the robots repeat their reports."""
        for _ in range(self.random.randint(1, 4)):
            for robot in robots:
                robot.says(after=self.random.uniform(0.1, 0.9))
            self.look()

    def play(self):
        """Conduct both runs; returns the path of the journal."""
        modules = FakeModules(self, "HNF")
        modules.beat()
        alpha = self.connected("tbm")
        beta = self.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
        self.passes(alpha)
        for zone in ("tbm", "fbm"):
            modules.beat()
            self.command("start", zone)
        self.look()
        alpha.executes()
        self._play_task(alpha, modules)
        self._play_goals(beta, modules, alpha)
        alpha.completes()
        beta.says(RobotState.STOP)
        self.look()
        self.score(BUMPS.group, BUMPS.desc, 2, "tbm")
        self.passes(alpha, beta)
        for zone in ("tbm", "fbm"):
            self.command("disconnect", zone)
        self.journal.close()
        return self.journal.path

    def _play_task(self, robot, modules):
        actions = [
            lambda: robot.says(notifications=(f"at {self.random.random()} {EVIL}",)),
            lambda: robot.says(visitor=("Dr. Kimble </script><!--\u2028",)),
            lambda: robot.says(activation_event=("tablet",)),
            lambda: robot.says(dimmer=self.random.randint(0, 100)),
            lambda: self.score(DOOR.group, DOOR.desc, self.random.randint(0, 1), "tbm"),
            lambda: self.score(SHEET[1].group, SHEET[1].desc, self.random.randint(0, 9), "tbm"),
            lambda: self.command("pause" if not self.off("pause") else "resume", "tbm"),
            lambda: self.off("next_phase") or self.command("next_phase", "tbm"),
        ]
        for action in self.random.choices(actions, k=20) + actions:
            action()
            self.look()
            modules.beat()
            self.passes(robot)
        if not self.off("resume"):
            self.command("resume", "tbm")
            self.look()

    def _play_goals(self, robot, modules, other):
        for number in (1, 2):
            modules.asks(RequestKind.REFEREE, "fbm", text=f"Place the robot {EVIL}")
            self.passes(other)
            self.event(self.box.act, Target("fbm"), "operation")
            self.look()
            modules.asks(RequestKind.GOAL, "fbm", timeout=60.0, goal=f"[{number}.0, 2.0, 0.5]")
            self.look()
            modules.beat()
            does_goal(robot, generic_result="[1.0, 2.0]")
            modules.says("fbm", scores=(ScoreValue("waypoint 1", "distance", f"{number}.25", "m"),))
            self.look()
        modules.says("fbm", finished=True, request=modules.run("fbm").steps[-1].request)
        self.look()


class SetClock(ReplayedCompetition):
    """Somebody sets the box's clock during both runs."""

    def __init__(self, log_dir, seconds):
        self._seconds = seconds
        super().__init__(log_dir)

    def _play_goals(self, *arguments):
        self.set_clock(self._seconds)
        super()._play_goals(*arguments)
