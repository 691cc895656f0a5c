"""Plans a competition: which team does which benchmark, in which zone, at which time.

The runs of a late team come at the end of each day (docs/organiser.md, "A late team").
"""

import datetime
import re
import time
from typing import (
    Callable,
    Container,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

from roah_rsbb.ground import linux
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.config import ZONE_SHAPE
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.registry import BenchmarkKind, profile_of
from roah_rsbb.wording.times import zone_of

UTC = datetime.timezone.utc
_DAY = re.compile(r"([0-9]{4})-([0-9]{1,2})-([0-9]{1,2})")
_TIME = re.compile(r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}))?")
# Rejects two-digit years and typing errors.
_FIRST_YEAR, _LAST_YEAR = 2000, 2100


class VenueClock:
    """Time at the venue. `name`: of its time zone, see `wording.times.zone_of`."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._zone = zone_of(name)

    def utc(self, day: datetime.date, at: datetime.time) -> datetime.datetime:
        """Convert from venue time to UTC. Of a time that exists twice, it is the first one."""
        return datetime.datetime.combine(day, at, self._zone).astimezone(UTC)

    def written(self, moment: datetime.datetime) -> str:
        """Return a time as a schedule file has it, with its offset from UTC if there is one."""
        text = self.local(moment).isoformat(" ", "seconds")
        return text[:19] if text[19:] == "+00:00" else f"{text[:19]} {text[19:]}"

    def check(self, report: Report, place: Place, day: datetime.date, at: datetime.time) -> None:
        """Report a time that does not exist on a day, or exists twice, because the clocks are changed."""
        local = datetime.datetime.combine(day, at, self._zone)
        first, second = (local.replace(fold=fold).astimezone(UTC) for fold in (0, 1))
        if self.local(first).time() != at:
            report.error(place, f"{at:%H:%M} on {day}, which does not exist: the clocks of {self.name} skip it",
                         "another time")
        elif first != second:
            report.warn(place, f"{at:%H:%M} on {day} exists twice, because the clocks of {self.name} are set back: "
                        f"the first one was taken. For the second one, write {self.written(second)} into schedule.yaml "
                        f"instead of {self.written(first)}")

    def local(self, moment: datetime.datetime) -> datetime.datetime:
        """Convert a time to venue time (with its UTC offset)."""
        return moment.astimezone(self._zone)


def read_day(report: Report, place: Place, text: str, what: str) -> Optional[datetime.date]:
    """Read a date; None after an error, which is added to the report."""
    found = _DAY.fullmatch(text)
    if found is None:
        report.error(place, f"{quote(text)} as {what}", "a day as year-month-day, such as 2026-11-28")
        return None
    try:
        day = datetime.date(*map(int, found.groups()))
    except ValueError:
        report.error(place, f"{quote(text)} as {what}", "a day that exists, as year-month-day, such as 2026-11-28")
        return None
    if not _FIRST_YEAR <= day.year <= _LAST_YEAR:
        report.error(place, f"{quote(text)} as {what}", f"a year from {_FIRST_YEAR} to {_LAST_YEAR}")
        return None
    return day


def read_time(report: Report, place: Place, text: str, what: str) -> Optional[datetime.time]:
    """Read a time of day; None after an error, which is added to the report."""
    found = _TIME.fullmatch(text)
    if found is not None:
        hour, minute, second = (int(part or 0) for part in found.groups())
        if hour < 24 and minute < 60 and second < 60:
            return datetime.time(hour, minute, second)
    report.error(place, f"{quote(text)} as {what}", "a time of day from 0:00 to 23:59, such as 09:30")
    return None


def read_clock(report: Report, place: Place, text: str) -> Optional[VenueClock]:
    """Read ``local``, or the name of a time zone; None after an error, which is added to the report."""
    if text.casefold() == "local":
        name = local_zone()
        if not name:
            return report.error(place, "local, whose name this computer does not know", f"the venue's: {ZONE_SHAPE}")
        return VenueClock(name)
    name = "UTC" if text.casefold() == "utc" else text
    if zone_of(name) is None:
        return report.error(place, f"{quote(text)} as time zone", f"local (this computer's), {ZONE_SHAPE}")
    return VenueClock(name)


def local_zone() -> str:
    """Return the name of this computer's time zone, or its offset if it has no other one; empty: not known."""
    name = linux.time_zone()
    if zone_of(name) is not None:
        return name
    sign, minutes = "-" if time.timezone > 0 else "+", abs(time.timezone) // 60
    return "" if time.daylight else f"{sign}{minutes // 60:02d}:{minutes % 60:02d}"


# -- the plan ---------------------------------------------------------------------------------------

class PlannedRun(NamedTuple):
    """A run of the schedule."""

    code: str
    team: str  # ALL_TEAMS if all robots run at once
    round: int
    run: int
    begins: datetime.datetime  # UTC
    id: str = ""  # of its event; empty: it gets one when the schedule is written


class PlannedZone(NamedTuple):
    """A zone and its runs, in order of time."""

    name: str
    runs: Tuple[PlannedRun, ...]


class Plan(NamedTuple):
    """A complete competition."""

    teams: Tuple[str, ...]
    zones: Tuple[PlannedZone, ...]
    automatic: Tuple[str, ...] = ()  # which numbers of its runs, 'round' and 'run', nobody chose

    @property
    def codes(self) -> Tuple[str, ...]:
        """The benchmarks of the plan."""
        return tuple(dict.fromkeys(run.code for zone in self.zones for run in zone.runs))


def days_of(zones: Iterable[PlannedZone], clock: VenueClock) -> Set[datetime.date]:
    """The days of a plan, as the venue's calendar has them."""
    return {clock.local(run.begins).date() for zone in zones for run in zone.runs}


class Merged(NamedTuple):
    """A plan of some days beside what was planned for the others."""

    zones: Tuple[PlannedZone, ...]
    kept: Dict[datetime.date, int]  # runs of days that the new plan does not have
    ran: List[str]  # what becomes of events that have results and are planned otherwise now


# Returns which of these runs is now the event that has results; None: none of them.
Which = Callable[[str, Sequence[str]], Optional[int]]


def with_other_days(
    before: Sequence[PlannedZone], plan: Plan, clock: VenueClock, ran: Container[str], which: Which
) -> Merged:
    """Replace the days that a new plan has, and keep the others. The events of a team in a benchmark keep their ids at
    the same time, or else within their day, whatever their zones, rounds and numbers are. They keep their numbers, too,
    unless the plan gives others.

    `ran`: the ids of the events that have results. `which` is asked where such an event may be another one now.
    """
    after = plan.zones
    days = days_of(after, clock)
    old: Dict[Tuple[str, str], List[PlannedRun]] = {}
    kept: Dict[datetime.date, int] = {}
    zones: Dict[str, List[PlannedRun]] = {}
    for zone in before:
        for run in zone.runs:
            day = clock.local(run.begins).date()
            if day in days:
                old.setdefault(run[:2], []).append(run)
            else:
                zones.setdefault(zone.name, []).append(run)
                kept[day] = kept.get(day, 0) + 1
    new: Dict[Tuple[str, str], List[PlannedRun]] = {}
    for run in sorted((run for zone in after for run in zone.runs), key=lambda run: run.begins):
        new.setdefault(run[:2], []).append(run)
    ids: Dict[PlannedRun, str] = {}
    said: List[str] = []
    for key, runs in old.items():
        ids.update(_ids(sorted(runs, key=lambda run: run.begins), new.get(key, []), clock, ran, which, said))
    had = {run.id: run for runs in old.values() for run in runs}
    placed = [run for runs in zones.values() for run in runs]
    numbered: Dict[PlannedRun, PlannedRun] = {}
    for run in sorted((run for runs in new.values() for run in runs),
                      key=lambda run: (ids.get(run) not in had, run.begins)):
        numbered[run] = _numbered(run._replace(id=ids.get(run, "")), had, placed, plan.automatic, clock)
        placed.append(numbered[run])
    for zone in after:
        zones.setdefault(zone.name, []).extend(numbered[run] for run in zone.runs)
    order = dict.fromkeys(zone.name for zone in (*before, *after) if zone.name in zones)
    return Merged(
        tuple(PlannedZone(name, tuple(sorted(zones[name], key=lambda run: run.begins))) for name in order),
        dict(sorted(kept.items())), said)


def _numbered(
    run: PlannedRun, had: Mapping[str, PlannedRun], placed: Sequence[PlannedRun], automatic: Sequence[str],
    clock: VenueClock,
) -> PlannedRun:
    """Return a new run with numbers that no placed run of the team in the benchmark has, or with those that its event
    `had`. Only `automatic` ones change."""
    if run.id in had:
        run = run._replace(**{name: getattr(had[run.id], name) for name in automatic})
    elif "round" in automatic:
        day = clock.local(run.begins).date()
        others = {other.round: clock.local(other.begins).date() for other in placed if other[:2] == run[:2]}
        today = [number for number, when in others.items() if when == day]
        number = today[0] if today else run.round
        while others.get(number, day) != day:
            number += 1
        run = run._replace(round=number)
    while "run" in automatic and any(other[:4] == run[:4] for other in placed):
        run = run._replace(run=run.run + 1)
    return run


def _ids(
    old: Sequence[PlannedRun], new: Sequence[PlannedRun], clock: VenueClock, ran: Container[str], which: Which,
    said: List[str],
) -> Dict[PlannedRun, str]:
    """Return the ids of the new runs of a team in a benchmark that are events of the old plan. Both are in order."""
    def time(run: PlannedRun) -> str:
        return f"{clock.local(run.begins):%Y-%m-%d %H:%M}"

    def day(run: PlannedRun) -> datetime.date:
        return clock.local(run.begins).date()

    left, found = list(new), {}
    waiting = []
    for run in old:
        same = next((other for other in left if other.begins == run.begins), None)
        if same is None:
            waiting.append(run)
        else:
            left.remove(same)
            found[same] = run.id
    for run in sorted(waiting, key=lambda run: run.id not in ran):  # first those that have results
        today = [other for other in left if day(other) == day(run)]
        choice = 0 if today else None
        if run.id in ran:
            event = f"{run.code} of {run.team} on {time(run)}"
            rivals = [other for other in waiting if other.id in ran and day(other) == day(run)]
            if len(today) != 1 or len(rivals) > 1:
                today = today or left
                choice = which(event, list(map(time, today))) if today else None
            said.append(f"{event} has results and no event any more: they stay in the results" if choice is None else
                        f"{event} has results and is on {time(today[choice])} now: they stay with it")
        if choice is not None:
            left.remove(today[choice])
            found[today[choice]] = run.id
    return found


class Break(NamedTuple):
    """A time of day without runs."""

    begin: datetime.time
    end: datetime.time


class PlannedDay(NamedTuple):
    """A day: when the first run begins, the interval between runs, and when the last one must end."""

    day: datetime.date
    first: datetime.time
    last: datetime.time
    every: datetime.timedelta
    breaks: Tuple[Break, ...] = ()  # sorted
    codes: Optional[Tuple[str, ...]] = None  # the benchmarks of this day; None: all

    def free(self, begins: datetime.datetime, clock: VenueClock) -> datetime.datetime:
        """The earliest time from `begins` on at which a run meets no break."""
        for each in self.breaks:
            if begins < clock.utc(self.day, each.end) and clock.utc(self.day, each.begin) < begins + self.every:
                begins = clock.utc(self.day, each.end)
        return begins


def for_all(code: str) -> bool:
    """Whether all robots do this shipped benchmark at once."""
    return profile_of(code).kind is BenchmarkKind.ALL_ROBOTS


# A team's turn in a benchmark: the team, and the round.
_Turn = Tuple[str, int]


def timetable(
    report: Report, teams: Sequence[str], zones: Dict[str, Sequence[str]], days: Sequence[PlannedDay],
    clock: VenueClock, rounds: Optional[Mapping[str, int]] = None, for_all: Callable[[str], bool] = for_all,
) -> Plan:
    """Plan every benchmark `rounds` times for every team, spread evenly over its days: by code, "" for all others
    (None: once a day).

    `zones` has the benchmarks of each zone. A zone finishes one benchmark before it begins the next, because each needs
    its own set-up. Zones with the same benchmark share its teams. No team is in two zones at once. The order of teams
    rotates with each benchmark and round, so that no team always begins. If a day is too short, an error is added to
    the report. `for_all` says whether all robots do a benchmark at once.
    """
    runs: Dict[str, List[PlannedRun]] = {name: [] for name in zones}
    ordered = {name: sorted(codes, key=for_all) for name, codes in zones.items()}
    for day, waiting in zip(days, _turns(teams, ordered, days, rounds, for_all)):
        clock.check(report, Place("--begin", 0, 0), day.day, day.first)
        begins = ended = clock.utc(day.day, day.first)
        while any(waiting.values()):
            begins = day.free(ended, clock)
            for name, code, (team, number) in _same_time(ordered, waiting):
                runs[name].append(PlannedRun(code, team, number, 1, begins))
            ended = begins + day.every
        if ended > clock.utc(day.day, day.last):
            at = clock.local(ended)
            next_day = " the next day" if at.date() > day.day else ""
            report.error(
                Place("--days", 0, 0), f"runs on {day.day} until {at:%H:%M}{next_day}",
                f"that they end by {day.last:%H:%M}: begin earlier (--begin), reduce "
                "the interval (--every), choose more zones or fewer benchmarks, or end later (--end)")
    for name in [name for name, found in runs.items() if not found]:
        report.warn(Place("--zones", 0, 0), f"zone {quote(name)} has no runs and is left out: others do them all")
    return Plan(tuple(teams), tuple(PlannedZone(name, tuple(found)) for name, found in runs.items() if found))


def _turns(
    teams: Sequence[str], zones: Dict[str, List[str]], days: Sequence[PlannedDay], rounds: Optional[Mapping[str, int]],
    for_all: Callable[[str], bool],
) -> List[Dict[str, List[_Turn]]]:
    """The turns of each day by benchmark. Each benchmark's turns are spread evenly over its days."""
    found: List[Dict[str, List[_Turn]]] = [{} for _ in days]
    numbers = {code: number for codes in reversed(list(zones.values())) for number, code in enumerate(codes)}
    for code, number in numbers.items():
        of_code = [i for i, day in enumerate(days) if day.codes is None or code in day.codes]
        every = {"": len(of_code), **(rounds or {})}
        count = every.get(code, every[""])
        turns: List[_Turn] = []
        for round_ in range(1, count + 1):
            first = (number + round_ - 1) % len(teams)
            turns += [(team, round_) for team in ([ALL_TEAMS] if for_all(code) else (*teams[first:], *teams[:first]))]
        for place, i in enumerate(of_code):
            begin, end = (len(turns) * n // len(of_code) for n in (place, place + 1))
            found[i][code] = turns[begin:end]
    return found


def _same_time(
    zones: Dict[str, List[str]], waiting: Dict[str, List[_Turn]]
) -> Iterator[Tuple[str, str, _Turn]]:
    """Take turns that can take place at the same time, at most one for each zone. Yields zone, benchmark and turn.

    A zone waits while the remaining teams of its present benchmark are busy in other zones.
    """
    busy: Set[str] = set()
    for name, codes in zones.items():
        code = next((code for code in codes if waiting.get(code)), None)
        if code is None or ALL_TEAMS in busy:
            continue
        free = [turn for turn in waiting[code] if turn[0] not in busy and (turn[0] != ALL_TEAMS or not busy)]
        if free:
            waiting[code].remove(free[0])
            busy.add(free[0][0])
            yield name, code, free[0]


def planned(zones: Sequence[ZonePlan]) -> List[PlannedZone]:
    """The zones of a schedule as a plan."""
    return [PlannedZone(zone.name, tuple(map(_planned, zone.events))) for zone in zones]


def _planned(event: ScheduledEvent) -> PlannedRun:
    begins = datetime.datetime.fromtimestamp(event.scheduled, UTC)
    return PlannedRun(event.benchmark.code, event.team, event.round, event.run, begins, event.id)
