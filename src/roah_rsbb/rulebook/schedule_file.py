"""The schedule file: which team does which benchmark when, zone by zone."""

from typing import Dict, List, Optional, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, KINDS, Event, Kind, ZonePlan
from roah_rsbb.rulebook.benchmarks_file import BenchmarksFile
from roah_rsbb.rulebook.errors import Place, Report, line_list, quote
from roah_rsbb.rulebook.passwords_file import PasswordsFile
from roah_rsbb.rulebook.yaml_fields import choice, fields, integer, sequence, text, utc_time
from roah_rsbb.rulebook.yaml_lines import Node, read_yaml
from roah_rsbb.wording.suggestions import nearest

_SHAPE = "zones, '- zone: ...' with 'schedule: ...'"
_ZONE = {"zone": "Task Benchmarks", "schedule": "[...]"}
_EVENT = {
    "benchmark": "HGTKMH",
    "team": "TestingTeam",
    "round": "1",
    "run": "1",
    "scheduled_time": "2015-12-31 14:30:00",
}
# `uint8` on the ROS interface; counted from 1.
_MAX_ROUND = 255

_Run = Tuple[str, str, int, int]


class ScheduleFile:
    """The file's zones, checked against the benchmarks and teams of the two other files."""

    def __init__(
        self, path: str, report: Report, benchmarks: BenchmarksFile, passwords: PasswordsFile
    ) -> None:
        self.zones: Tuple[ZonePlan, ...] = ()
        self._report = report
        self._benchmarks = benchmarks
        self._passwords = passwords
        self._zone_places: Dict[str, Place] = {}
        self._run_places: Dict[_Run, Place] = {}
        self._codes_not_described: Dict[str, List[Place]] = {}
        self._teams_without_password: Dict[str, List[Place]] = {}
        what = "the schedule file (parameter schedule_file)"
        root = read_yaml(path, report, what, f"a sequence of {_SHAPE}")
        zones = [self._zone(node) for node in sequence(report, root, "the file's content", _SHAPE) or ()]
        self._report_unknown()
        self.zones = tuple(zone for zone in zones if zone is not None)

    def _zone(self, node: Node) -> Optional[ZonePlan]:
        got = fields(self._report, node, "a zone", _ZONE, {})
        if got is None:
            return None
        name = text(self._report, got.get("zone"), "zone")
        if name is not None:
            found = f"a second zone {quote(name)}"
            self._report.once(self._zone_places, name, got["zone"].place, found, "each zone once")
        what = "schedule" if name is None else f"schedule of zone {quote(name)}"
        shape = "at least one event, '- {benchmark: ..., team: ..., and so on}'"
        nodes = sequence(self._report, got.get("schedule"), what, shape) or ()
        events = [event for event in map(self._event, nodes) if event is not None]
        return None if name is None else ZonePlan(name, tuple(sorted(events, key=lambda e: e.scheduled)))

    def _event(self, node: Node) -> Optional[Event]:
        """Read one event; None if anything is wrong with it."""
        report = self._report
        got = fields(report, node, "an event", _EVENT, {})
        if got is None:
            return None
        code = choice(report, got.get("benchmark"), "benchmark", tuple(KINDS), "a benchmark code")
        team = text(report, got.get("team"), "team")
        number = integer(report, got.get("round"), "round", 1, _MAX_ROUND)
        run = integer(report, got.get("run"), "run", 1, _MAX_ROUND)
        scheduled = utc_time(report, got.get("scheduled_time"), "scheduled_time")
        if code is not None and self._benchmarks.codes is not None and code not in self._benchmarks.codes:
            self._codes_not_described.setdefault(code, []).append(got["benchmark"].place)
        if team is not None:
            self._check_team(code, team, got["team"].place)
        if code is None or team is None or number is None or run is None:
            return None
        self._warn_of_twin((code, team, number, run), node.place)
        benchmark = self._benchmarks.by_code.get(code)
        if benchmark is None or scheduled is None:
            return None
        return Event(benchmark, team, number, run, scheduled)

    def _check_team(self, code: Optional[str], team: str, place: Place) -> None:
        """ALL with the referee-only benchmark and with no other; other teams with a password."""
        for_all = code is not None and KINDS[code] is Kind.REFEREE_ONLY
        if team == ALL_TEAMS:
            if code is not None and not for_all:
                self._report.error(place, f"team {ALL_TEAMS} in {code}", "the name of one team")
            return
        if for_all:
            found = f"team {quote(team)} in {code}"
            self._report.error(place, found, f"team {ALL_TEAMS}: all robots do it at once")
        elif self._passwords.teams is not None and team not in self._passwords.teams:
            self._teams_without_password.setdefault(team, []).append(place)

    def _warn_of_twin(self, run: _Run, place: Place) -> None:
        first = self._run_places.setdefault(run, place)
        if first is not place:
            code, team, number, run_number = run
            self._report.warn(
                place,
                f"{code}, team {quote(team)}, round {number}, run {run_number} is already in line "
                f"{first.line}: give each run a number of its own, or their logs and results look alike",
            )

    def _report_unknown(self) -> None:
        """One error for each unknown name, however often it is used."""
        file = self._benchmarks.path
        for code, places in self._codes_not_described.items():
            found = f"benchmark {quote(code)}{_also(places)}, which is not in {file}"
            codes = ", ".join(sorted(self._benchmarks.codes or ()))
            self._report.error(places[0], found, f"one that is there ({codes}), or an entry for it there")
        file = self._passwords.path
        for team, places in self._teams_without_password.items():
            # Only what is a team beyond doubt is shown of the passwords file.
            near = nearest(team, self._passwords.by_team)
            guess = f": did you mean {quote(near)}?" if near else ", or a line 'team: password' for it"
            found = f"team {quote(team)}{_also(places)}, which is not in {file}"
            self._report.error(places[0], found, f"a team of that file{guess}")


def _also(places: List[Place]) -> str:
    """The other lines with the same mistake."""
    return f" (also in line {line_list([place.line for place in places[1:]])})" if places[1:] else ""
