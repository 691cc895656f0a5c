"""What is to be held: which team does which benchmark in which zone, and when."""

import datetime
from typing import Dict, Iterator, List, NamedTuple, Sequence, Set, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, KINDS, Kind
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.tools.competition.moments import VenueClock


class Run(NamedTuple):
    """One run of the schedule."""

    code: str
    team: str  # ALL_TEAMS where all robots run at once
    round: int
    run: int
    begins: datetime.datetime  # UTC


class PlannedZone(NamedTuple):
    """A zone and its runs, in order of time."""

    name: str
    runs: Tuple[Run, ...]


class Plan(NamedTuple):
    """A whole competition."""

    teams: Tuple[str, ...]
    zones: Tuple[PlannedZone, ...]

    @property
    def codes(self) -> Tuple[str, ...]:
        """The benchmarks that are held, in the order in which the box knows them."""
        held = {run.code for zone in self.zones for run in zone.runs}
        return tuple(code for code in KINDS if code in held)


class Day(NamedTuple):
    """When runs begin: the first one, the time from one to the next, and when the last one must be over."""

    day: datetime.date
    first: datetime.time
    last: datetime.time
    every: datetime.timedelta


def for_all(code: str) -> bool:
    """Whether all robots do this benchmark at once."""
    return KINDS[code] is Kind.REFEREE_ONLY


def timetable(
    report: Report, teams: Sequence[str], zones: Dict[str, Sequence[str]], days: Sequence[Day], clock: VenueClock,
) -> Plan:
    """Every team does every benchmark once a day; the day's number is the round.

    `zones` has the benchmarks of each zone. In a zone one benchmark follows the other, as each needs its own things
    set up. No team is in two zones at once, and the order of teams moves on with each benchmark and day, so that
    none always begins. A day that is too short is an error in the report.
    """
    runs: Dict[str, List[Run]] = {name: [] for name in zones}
    for number, day in enumerate(days, 1):
        waiting = {name: list(_in_turn(teams, codes, number)) for name, codes in zones.items()}
        begins = clock.utc(day.day, day.first)
        ends = clock.utc(day.day, day.last)
        while any(waiting.values()):
            for name, (code, team) in _same_time(waiting):
                runs[name].append(Run(code, team, number, 1, begins))
            begins += day.every
        if begins > ends:
            at = clock.wall(begins)
            next_day = " the next day" if at.date() > day.day else ""
            report.error(
                Place("--days", 0, 0), f"runs on {day.day} until {at:%H:%M}{next_day}",
                f"that they are over by {day.last:%H:%M}: begin earlier (--begin), have them follow each other "
                "sooner (--every), choose more zones or fewer benchmarks, or end later (--end)")
    return Plan(tuple(teams), tuple(PlannedZone(name, tuple(found)) for name, found in runs.items()))


def _in_turn(teams: Sequence[str], codes: Sequence[str], day: int) -> Iterator[Tuple[str, str]]:
    """The runs of a zone on a day, in their order: those of all robots at once come last, when all are free."""
    for number, code in enumerate(sorted(codes, key=for_all)):
        if for_all(code):
            yield code, ALL_TEAMS
        else:
            first = (number + day - 1) % len(teams)
            yield from ((code, team) for team in (*teams[first:], *teams[:first]))


def _same_time(waiting: Dict[str, List[Tuple[str, str]]]) -> Iterator[Tuple[str, Tuple[str, str]]]:
    """Take out of what waits in each zone a run that can be at the same time as the others'.

    A zone does not go on to the next benchmark while a team of the present one is busy elsewhere: it waits.
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
