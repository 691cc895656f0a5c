"""Builds the messages for public displays, the original's and ours."""

import time
from typing import Iterable, List, Optional

from roah_rsbb.core.box import Box
from roah_rsbb.core.scoring.book import FinishedResult
from roah_rsbb.core.views import views
from roah_rsbb.core.views.explained import Explanation
from roah_rsbb.core.views.public import PublicRun, PublicView
from roah_rsbb.model.clock import Now
from roah_rsbb.msg import (
    CoreToPublic,
    PublicDetails,
    PublicEvent,
    PublicExplained,
    PublicExplanation,
    PublicResult,
    PublicSaid,
    ScheduleInfo,
)
from roah_rsbb.msg import PublicRun as PublicRunMsg
from roah_rsbb.nodes.core.score_convert import items_message, points_message, score_message
from roah_rsbb.ros.times import ros_duration, ros_limit, ros_time
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, ScheduledEvent

# Instead of the time. The original's public display shows it.
NOT_LIVE = "not live"


class PublicSchedule:
    """Builds the message for the original's public display, with local times."""

    def __init__(self, box: Box) -> None:
        self._box = box
        self._revision: Optional[int] = None  # of the box, to which the lines belong
        self._lines: List[ScheduleInfo] = []

    def to_public(self, now: Now) -> CoreToPublic:
        """Return the message of this moment. A box that is superseded has no schedule."""
        if self._box.is_superseded:
            return CoreToPublic(clock=NOT_LIVE)
        if self._revision != self._box.revision:
            self._revision = self._box.revision
            self._lines = [
                ScheduleInfo(
                    line.event.team, line.event.benchmark.desc, line.event.round, line.event.run,
                    _local(line.event.scheduled), line.running,
                )
                for line in views.coming_events(self._box)
            ]
        return CoreToPublic(clock=_local(now.utc), schedule=self._lines)


def public_details(view: PublicView, now: Now, box_uuid: str) -> PublicDetails:
    """The data for which CoreToPublic has no fields; `view` was made at `now`."""
    return PublicDetails(
        clock=ros_time(now.utc),
        box_uuid=box_uuid,
        results=view.results.value,
        runs=[_run(run, now) for run in view.runs],
        following=[_event(line.zone, line.event) for line in view.following],
        finished=[result_message(run) for run in view.finished],
    )


def public_explained(runs: Iterable[Explanation], box_uuid: str) -> PublicExplained:
    """The runs explained."""
    return PublicExplained(box_uuid, [
        PublicExplanation(
            zone=run.zone,
            languages=[language for language, _ in run.about],
            about=[text for _, text in run.about],
            kind=run.kind.value, doing=run.doing.value,
            phases=list(run.phases), phase=run.phase,
            waypoints=run.are_waypoints,
            goals=run.goals, goals_ended=run.goals_ended, goals_completed=run.goals_completed or 0,
            said=[PublicSaid(one.robot, one.said.kind, one.said.text, ros_time(one.said.utc)) for one in run.said],
        )
        for run in runs
    ])


def _event(zone: str, event: ScheduledEvent) -> PublicEvent:
    benchmark = event.benchmark
    return PublicEvent(
        zone, benchmark.desc or benchmark.name, event.team, event.round, event.run, ros_time(event.scheduled)
    )


def _run(run: PublicRun, now: Now) -> PublicRunMsg:
    return PublicRunMsg(
        event=_event(run.zone, run.event),
        teams=list(run.teams),
        phase=run.phase.value,
        end_reason="" if run.end_reason is None else run.end_reason.name.lower(),
        counting=run.counting,
        ends=ros_time(now.utc + run.left if run.counting and run.left != NO_LIMIT else 0.0),
        left=ros_limit(run.left),
        unlimited=run.left == NO_LIMIT,
        elapsed=ros_duration(run.elapsed if run.left == NO_LIMIT else 0.0),
        activity=run.activity,
    )


def result_message(run: FinishedResult) -> PublicResult:
    """Return the message of a run that is over."""
    scoring = items_message(run.items)
    return PublicResult(
        event=_event(run.zone, run.event),
        end_reason=run.end_reason,
        disconnected=ros_time(run.disconnected_utc),
        scoring=scoring,
        not_attempted=[
            sum(item.not_attempted for item in run.items if item.group == group.group_name) for group in scoring
        ],
        module_scores=[score_message(score) for score in run.module_scores if not score.group],
        points=points_message(run.points),
    )


def _local(utc: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(utc))
