"""The runs explained for spectators: what each is about, its steps, and what the robot does now.

It contains only what the organisers allow. Nothing here shows the content of a goal or of a manual operation: other
teams could learn from it what their robots will meet.
"""

import enum
from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.online_data import MAX_SAID, Said
from roah_rsbb.core.runs.run import Run, ZoneRun
from roah_rsbb.core.views.public import PublicResults
from roah_rsbb.model.modules import OutcomeKind, RequestKind
from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import BoxState
from roah_rsbb.rulebook.registry import BenchmarkKind, GoalForm


class Doing(enum.Enum):
    """What happens in a run now."""

    WAITING = "waiting"  # for the start
    PREPARING = "preparing"
    EXECUTING = "executing"
    REFEREE = "referee"  # the referee prepares the next goal, or notes what the robot did
    BETWEEN = "between"  # the next goal follows
    BY_HAND = "by_hand"  # a run without a robot
    ENDED = "ended"


class RobotSaid(NamedTuple):
    """What a robot said."""

    robot: str  # empty: there is only one
    said: Said


class Explanation(NamedTuple):
    """The run in a zone, explained."""

    zone: str
    about: Tuple[Tuple[str, str], ...]  # languages and texts
    kind: BenchmarkKind
    doing: Doing
    phases: Tuple[str, ...]  # of the task
    phase: int  # number of the current one; 0: none
    are_waypoints: bool  # the goals
    goals: int  # that have begun
    goals_ended: int
    goals_completed: Optional[int]  # None: the public may not see this
    said: Tuple[RobotSaid, ...]  # the newest last; empty unless the organisers allow it


def explanations(box: Box, results: PublicResults, with_texts: bool) -> Tuple[Explanation, ...]:
    """Return the explanations of all runs. `with_texts`: also what the robots say."""
    return tuple(
        _explanation(zone.name, zone.run, results, with_texts) for zone in box.zones.values() if zone.run is not None)


def _explanation(zone: str, run: ZoneRun, results: PublicResults, with_texts: bool) -> Explanation:
    benchmark = run.event.benchmark
    goals = _outcomes(run)
    return Explanation(
        zone, benchmark.about, benchmark.kind, _doing(run),
        phases=tuple(phase.name for phase in benchmark.rules.phases),
        phase=run.times.state.phase,
        are_waypoints=benchmark.profile.goal is GoalForm.WAYPOINT,
        goals=len(goals),
        goals_ended=sum(outcome is not None for outcome in goals),
        goals_completed=None if results is PublicResults.NONE else goals.count(OutcomeKind.DONE),
        said=_said(run) if with_texts else (),
    )


def _outcomes(run: ZoneRun) -> List[Optional[OutcomeKind]]:
    """Return how each goal ended; None: it has not ended."""
    steps = run.steps if isinstance(run, FunctionalityRun) else ()
    return [None if step.outcome is None else step.outcome.kind
            for step in steps if step.request.kind is RequestKind.GOAL]


def _doing(run: ZoneRun) -> Doing:
    if run.phase is not Phase.RUNNING:
        return Doing.ENDED if run.phase is Phase.ENDED else Doing.WAITING
    if isinstance(run, FunctionalityRun):
        if run.asked is not None:
            return Doing.REFEREE
        if run.of_module.goal is None:
            return Doing.BETWEEN
    states = [member.message.state for member in run.members() if member.phase is Phase.RUNNING]
    if not states:
        return Doing.BY_HAND
    return Doing.EXECUTING if BoxState.WAITING_RESULT in states else Doing.PREPARING


def _said(run: ZoneRun) -> Tuple[RobotSaid, ...]:
    members = run.members()
    found = [RobotSaid(_name(member) if len(members) > 1 else "", said)
             for member in members for said in member.state.said]
    return tuple(sorted(found, key=lambda one: one.said.utc)[-MAX_SAID:])


def _name(member: Run) -> str:
    return str(member.robot)
