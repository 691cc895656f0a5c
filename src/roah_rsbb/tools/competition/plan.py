"""Plans a competition: which team does which benchmark, in which zone, at which time."""

import datetime
import re
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind

UTC = datetime.timezone.utc
_DAY = re.compile(r"([0-9]{4})-([0-9]{1,2})-([0-9]{1,2})")
_TIME = re.compile(r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}))?")
_OFFSET = re.compile(r"([+-])([0-9]{1,2}):([0-9]{2})")
# Rejects two-digit years and typing errors.
_FIRST_YEAR, _LAST_YEAR = 2000, 2100


class VenueClock:
    """Time at the venue: this computer's local time, or a fixed offset from UTC."""

    def __init__(self, offset: Optional[datetime.timedelta] = None) -> None:
        self._zone = None if offset is None else datetime.timezone(offset)

    def utc(self, day: datetime.date, time: datetime.time) -> datetime.datetime:
        """Convert from venue time to UTC."""
        local = datetime.datetime.combine(day, time)
        return (local if self._zone is None else local.replace(tzinfo=self._zone)).astimezone(UTC)

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
    """Read ``local``, ``UTC`` or an offset; None after an error, which is added to the report."""
    if text.casefold() == "local":
        return VenueClock()
    if text.casefold() == "utc":
        return VenueClock(datetime.timedelta(0))
    found = _OFFSET.fullmatch(text)
    if found is not None and int(found.group(2)) <= 14 and int(found.group(3)) < 60:
        offset = datetime.timedelta(hours=int(found.group(2)), minutes=int(found.group(3)))
        return VenueClock(-offset if found.group(1) == "-" else offset)
    report.error(place, f"{quote(text)} as time zone",
                 "local (this computer's), UTC, or the venue's offset from UTC, such as +01:00")
    return None


# -- the plan ---------------------------------------------------------------------------------------

class PlannedRun(NamedTuple):
    """A run of the schedule."""

    code: str
    team: str  # ALL_TEAMS if all robots run at once
    round: int
    run: int
    begins: datetime.datetime  # UTC


class PlannedZone(NamedTuple):
    """A zone and its runs, in order of time."""

    name: str
    runs: Tuple[PlannedRun, ...]


class Plan(NamedTuple):
    """A complete competition."""

    teams: Tuple[str, ...]
    zones: Tuple[PlannedZone, ...]

    @property
    def codes(self) -> Tuple[str, ...]:
        """The benchmarks of the plan: the shipped ones in their order, then others."""
        held = {run.code for zone in self.zones for run in zone.runs}
        return (*(code for code in PROFILES if code in held), *sorted(held.difference(PROFILES)))


class PlannedDay(NamedTuple):
    """A day: when the first run begins, the interval between runs, and when the last one must end."""

    day: datetime.date
    first: datetime.time
    last: datetime.time
    every: datetime.timedelta


def for_all(code: str) -> bool:
    """Whether all robots do this shipped benchmark at once."""
    return PROFILES[code].kind is BenchmarkKind.ALL_ROBOTS


def timetable(
    report: Report, teams: Sequence[str], zones: Dict[str, Sequence[str]], days: Sequence[PlannedDay],
    clock: VenueClock,
) -> Plan:
    """Plan every benchmark for every team once a day. The number of the day is the round.

    `zones` has the benchmarks of each zone. A zone finishes one benchmark before it begins the next, because each needs
    its own set-up. No team is in two zones at once. The order of teams rotates with each benchmark and day, so that no
    team always begins. If a day is too short, an error is added to the report.
    """
    runs: Dict[str, List[PlannedRun]] = {name: [] for name in zones}
    for number, day in enumerate(days, 1):
        waiting = {name: list(_in_turn(teams, codes, number)) for name, codes in zones.items()}
        begins = clock.utc(day.day, day.first)
        ends = clock.utc(day.day, day.last)
        while any(waiting.values()):
            for name, (code, team) in _same_time(waiting):
                runs[name].append(PlannedRun(code, team, number, 1, begins))
            begins += day.every
        if begins > ends:
            at = clock.local(begins)
            next_day = " the next day" if at.date() > day.day else ""
            report.error(
                Place("--days", 0, 0), f"runs on {day.day} until {at:%H:%M}{next_day}",
                f"that they end by {day.last:%H:%M}: begin earlier (--begin), reduce "
                "the interval (--every), choose more zones or fewer benchmarks, or end later (--end)")
    return Plan(tuple(teams), tuple(PlannedZone(name, tuple(found)) for name, found in runs.items()))


def _in_turn(teams: Sequence[str], codes: Sequence[str], day: int) -> Iterator[Tuple[str, str]]:
    """The runs of a zone on a day, in order. Runs of all robots at once come last."""
    for number, code in enumerate(sorted(codes, key=for_all)):
        if for_all(code):
            yield code, ALL_TEAMS
        else:
            first = (number + day - 1) % len(teams)
            yield from ((code, team) for team in (*teams[first:], *teams[:first]))


def _same_time(waiting: Dict[str, List[Tuple[str, str]]]) -> Iterator[Tuple[str, Tuple[str, str]]]:
    """Take from each zone's queue a run that can take place at the same time as the others.

    A zone waits while the remaining teams of its present benchmark are busy in other zones.
    """
    busy: Set[str] = set()
    for name, queue in waiting.items():
        now = [entry for entry in queue if entry[0] == queue[0][0]]
        free = [entry for entry in now if entry[1] not in busy and (entry[1] != ALL_TEAMS or not busy)]
        if ALL_TEAMS in busy or not free:
            continue
        queue.remove(free[0])
        busy.add(free[0][1])
        yield name, free[0]
