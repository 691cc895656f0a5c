"""Adds a team to a competition that exists: a password, and its runs at the end of each day (docs/organiser.md,
"A late team").
"""

import datetime
from typing import Dict, List, Optional, Sequence, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, ScheduledEvent, ZonePlan
from roah_rsbb.tools.competition.plan import UTC, PlannedRun, PlannedZone, VenueClock, planned_s

# Set-up time of a run, in addition to the longest benchmark, if the intervals of the schedule are shorter than that.
_SET_UP = datetime.timedelta(minutes=5)


def planned(zones: Sequence[ZonePlan]) -> List[PlannedZone]:
    """The zones of a schedule as a plan."""
    return [PlannedZone(zone.name, tuple(map(_planned, zone.events))) for zone in zones]


def _planned(event: ScheduledEvent) -> PlannedRun:
    begins = datetime.datetime.fromtimestamp(event.scheduled, UTC)
    return PlannedRun(event.benchmark.code, event.team, event.round, event.run, begins, event.id)


def late_runs(
    zones: Sequence[ZonePlan], team: str, clock: VenueClock, days: Optional[Sequence[datetime.date]] = None
) -> Dict[str, List[PlannedRun]]:
    """Return the runs of a late team by zone: each benchmark and round that other teams do, once.

    A run comes at the end of the day, in the zone and on the day where other teams do this round of the benchmark last.
    `days`: consider only these.
    """
    lasts = _last_places(zones, clock, days)
    interval = {zone.name: _interval(zone.events) for zone in zones}
    ends: Dict[Tuple[str, datetime.date], datetime.datetime] = {}
    free: Dict[datetime.date, datetime.datetime] = {}  # for the late team
    for zone in zones:
        for run in map(_planned, zone.events):
            day, end = clock.local(run.begins).date(), run.begins + interval[zone.name]
            ends[zone.name, day] = end
            if run.team == ALL_TEAMS:
                free[day] = max(end, free.get(day, end))
    found: Dict[str, List[PlannedRun]] = {zone.name: [] for zone in zones}
    for (code, number), place in sorted(lasts.items(), key=lambda item: ends[item[1]]):
        zone, day = place
        begins = max(ends[place], free.get(day, ends[place]))
        ends[place] = free[day] = begins + interval[zone]
        found[zone].append(PlannedRun(code, team, number, 1, begins))
    return {zone: runs for zone, runs in found.items() if runs}


def _last_places(
    zones: Sequence[ZonePlan], clock: VenueClock, days: Optional[Sequence[datetime.date]]
) -> Dict[Tuple[str, int], Tuple[str, datetime.date]]:
    """The zone and the day of the last run, for each benchmark and round that teams do one by one."""
    runs = [(run, zone.name) for zone in zones for run in map(_planned, zone.events) if run.team != ALL_TEAMS]
    found: Dict[Tuple[str, int], Tuple[str, datetime.date]] = {}
    for run, zone in sorted(runs, key=lambda entry: entry[0].begins):
        day = clock.local(run.begins).date()
        if days is None or day in days:
            found[run.code, run.round] = (zone, day)
    return found


def _interval(events: Sequence[ScheduledEvent]) -> datetime.timedelta:
    """The shortest interval between two runs of a zone, or a longer one that its longest benchmark needs."""
    longest = datetime.timedelta(seconds=max(planned_s(event.benchmark) for event in events))
    gaps = [after.scheduled - before.scheduled for before, after in zip(events, events[1:])]
    gap = datetime.timedelta(seconds=min((gap for gap in gaps if gap > 0), default=0))
    return gap if gap >= longest else longest + _SET_UP
