"""What the public may see of the box: only what the organisers allow. Everything else stays in the core.

Nothing here shows the content of a goal or of a manual operation: other teams could learn from it what their robots
will meet.
"""

import enum
from typing import Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.reported import MAX_SAID
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import (
    Public,
    PublicEvent,
    PublicGroup,
    PublicItem,
    PublicResult,
    PublicRun,
    PublicStanding,
    RobotText,
)
from roah_rsbb.model.modules import OutcomeKind, RequestKind
from roah_rsbb.model.records import ItemRecord, Phase, RunRecord, grouped
from roah_rsbb.model.results import EventSeen
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.protocol import BoxState
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.registry import GoalForm
from roah_rsbb.rulebook.standing_rules import StandingRules
from roah_rsbb.scoring.book import FinishedRun
from roah_rsbb.scoring.counting import RunChoice

# No screen has space for more.
MAX_FOLLOWING = 40
MAX_FINISHED = 40
# How the public sees the items of a score sheet. Others do not appear.
_KINDS = {"bool": "bool", "uint": "count", "int": "count", "decimal": "count"}
_NOT_SHOWN = frozenset(("choice", "rating"))

Ranked = Callable[[Sequence[RunRecord], StandingRules, RunChoice, Mapping[str, str]], Tuple[PublicStanding, ...]]


class PublicResults(enum.Enum):
    """What the organisers show the public of ended runs."""

    NONE = "none"
    OUTCOMES = "outcomes"  # how each run ended
    SCORES = "scores"  # also its scores


class Publicity(NamedTuple):
    """What the organisers allow the public to see."""

    results: PublicResults = PublicResults.NONE
    provisional: bool = False  # also results that are not signed off
    robot_texts: bool = False  # what robots say
    ranked: Ranked = lambda records, rules, choice, titles: ()  # makes standings (`results.standings`)


NOTHING_ALLOWED = Publicity()


class PublicViews:
    """What the public may see of one box. What is costly to make is kept until it changes."""

    def __init__(self, box: Box, publicity: Publicity) -> None:
        self._box, self._publicity = box, publicity
        self._results: Dict[str, Tuple[RunRecord, PublicResult]] = {}  # by identity
        self._ranked: Tuple[object, ...] = ()  # of what the standings were made
        self._standings: Tuple[PublicStanding, ...] = ()

    def runs(self, zones: Mapping[str, ZoneSeen]) -> Dict[str, PublicRun]:
        """Return all runs by their zones. `zones`: as the referees see them now."""
        found = {}
        for zone in self._box.zones.values():
            if zone.run is not None:
                found[zone.name] = _run(zone.name, zone.run, zones[zone.name], self._publicity)
        return found

    def results(self, now: Now) -> Dict[str, PublicResult]:
        """Return the newest results by the identities of the runs: those that count, or of an event without any the
        last one."""
        if self._publicity.results is PublicResults.NONE:
            return {}
        box, before = self._box, self._results
        shown = {ruling.record.identity for result in box.scores.event_results(now) for ruling in result.runs}
        runs = [run for run in box.finished.newest_runs() if run.record.identity in shown]
        signed = [run for run in runs if run.record.sign_off is not None][:MAX_FINISHED]
        others = [run for run in runs if run.record.sign_off is None][:MAX_FINISHED]
        self._results = {}
        for run in signed + (others if self._publicity.provisional else []):
            record, known = run.record, before.get(run.record.identity)
            if known is None or known[0] is not record:
                known = record, _result(run, self._publicity.results is PublicResults.SCORES)
            self._results[record.identity] = known
        return {identity: result for identity, (_, result) in self._results.items()}

    def others(self, now: Now, schedule: Iterable[EventSeen]) -> Public:
        """Return what the public may see besides. `schedule`: as the referees see it now."""
        return Public(self._publicity.results.value, self._following(schedule), self._ranking(now),
                      self._box.reload.time_zone)

    def _following(self, schedule: Iterable[EventSeen]) -> Tuple[PublicEvent, ...]:
        """Return the coming events. Events whose run is connected or was completed, or whose team withdrew or did not
        appear, are not among them."""
        over = self._box.scores.events_over()
        begins = {(seen.zone, seen.team, seen.round, seen.run, seen.scheduled_utc_s): seen.begins_utc_s
                  for seen in schedule}
        lines = [(zone.name, event) for zone in self._box.zones.values()
                 for place, event in enumerate(zone.events[_first(zone):], _first(zone))
                 if (zone.name, place) not in over]
        found = [_event(zone, event.benchmark, *which)._replace(begins_utc_s=begins.get((zone, *which), 0.0))
                 for zone, event in lines for which in [(event.team, event.round, event.run, event.scheduled)]]
        return tuple(sorted(found, key=lambda one: max(one.scheduled_utc_s, one.begins_utc_s))[:MAX_FOLLOWING])

    def _ranking(self, now: Now) -> Tuple[PublicStanding, ...]:
        """Return the standings of the runs that are signed off. Such a run never changes; whether it counts may."""
        if self._publicity.results is not PublicResults.SCORES:
            return ()
        finished = self._box.finished
        ruled = self._box.scores.rulings(now)
        runs = tuple((r.record.identity, r.why, r.record.end_reason, r.record.sign_off is None) for r in ruled)
        made_of = runs, finished.ranking, finished.benchmarks, self._box.reload.time_zone
        if self._ranked != made_of:
            self._ranked = made_of
            self._standings = self._publicity.ranked(
                [ruling.record for ruling in ruled], finished.ranking,
                RunChoice(signed_off=True, events=finished.event_rules()), finished.titles())
        return self._standings


def _first(zone: Zone) -> int:
    """The index of the zone's first event that has not begun."""
    return zone.index + (zone.run is not None)


def _event(zone: str, benchmark: Benchmark, team: str, round_number: int, run: int, utc_s: float) -> PublicEvent:
    return PublicEvent(zone, benchmark.title, team, round_number, run, utc_s)


def _result(run: FinishedRun, with_scores: bool) -> PublicResult:
    record = run.record
    result = PublicResult(
        _event(record.zone, run.benchmark, record.team, record.round, record.run, record.scheduled),
        record.end_reason, record.closed_utc, record.sign_off is not None)
    return result if not with_scores else result._replace(
        groups=tuple(_group(name, items) for name, items in grouped(record.items).items()),
        module_scores=tuple(score for score in record.module_scores if not score.group),
        points=record.points)


def _group(name: str, items: Sequence[ItemRecord]) -> PublicGroup:
    return PublicGroup(
        name,
        tuple(PublicItem(item.desc, _KINDS.get(item.kind, "count"), max(0, item.value)) for item in items
              if item.kind not in _NOT_SHOWN),
        sum(item.not_attempted for item in items))


def _run(zone: str, run: ZoneRun, shown: ZoneSeen, publicity: Publicity) -> PublicRun:
    event, benchmark = run.event, run.event.benchmark
    goals, has_outcomes = _outcomes(run), publicity.results is not PublicResults.NONE
    return PublicRun(
        _event(zone, benchmark, event.team, event.round, event.run, event.scheduled),
        teams=tuple(dict.fromkeys(member.robot.team for member in run.members())) or (event.team,),
        phase=shown.phase,
        kind=benchmark.kind.value,
        doing=_doing(run),
        end_reason=shown.end_reason if has_outcomes else "",
        limit=shown.clock.limit,
        elapsed=shown.clock.elapsed,
        activity=run.times.phase_name(),
        about=dict(benchmark.about),
        phases=tuple(phase.name for phase in benchmark.rules.phases),
        phase_number=run.times.state.phase,
        are_waypoints=benchmark.profile.goal is GoalForm.WAYPOINT,
        goals=len(goals),
        goals_ended=sum(outcome is not None for outcome in goals),
        goals_completed=goals.count(OutcomeKind.DONE) if has_outcomes else None,
        said=_said(run) if publicity.robot_texts else (),
    )


def _outcomes(run: ZoneRun) -> List[Optional[OutcomeKind]]:
    """Return how each goal ended; None: it has not ended."""
    steps = run.steps if isinstance(run, FunctionalityRun) else ()
    return [None if step.outcome is None else step.outcome.kind
            for step in steps if step.request.kind is RequestKind.GOAL]


def _doing(run: ZoneRun) -> str:
    """Return what happens in a run now, as `wording.public` knows it: `referee`, while the referee prepares the
    next goal or notes what the robot did; `between`, until the next goal follows; `by_hand`, without a robot."""
    if run.phase is not Phase.RUNNING:
        return "ended" if run.phase is Phase.ENDED else "waiting"
    if isinstance(run, FunctionalityRun):
        if run.asked is not None:
            return "referee"
        if run.of_module.goal is None:
            return "between"
    states = [member.message.state for member in run.members() if member.phase is Phase.RUNNING]
    if not states:
        return "by_hand"
    return "executing" if BoxState.WAITING_RESULT in states else "preparing"


def _said(run: ZoneRun) -> Tuple[RobotText, ...]:
    members = run.members()
    found = [RobotText(str(member.robot) if len(members) > 1 else "", said.kind, said.text, said.utc)
             for member in members for said in member.state.said]
    return tuple(sorted(found, key=lambda one: one.utc_s)[-MAX_SAID:])
