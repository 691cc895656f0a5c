"""Checks a competition's folder: errors that the box would reject, and probable mistakes."""

import functools
import os
from typing import Callable, Dict, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import file_in, load_tried, modules, own_files, zone_folders
from roah_rsbb.bmbox.host import ground_truth_of_frames
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, Config, Durable, ScheduledEvent, teams_of
from roah_rsbb.rulebook.day import clashes, planned_s
from roah_rsbb.rulebook.errors import ConfigErrors, Place, Report, arguments, elements, listing, quote
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.rulebook.sheet_check import findings
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.tools.competition import files
from roah_rsbb.tools.competition.plan import local_zone
from roah_rsbb.tools.competition.rulebooks import STANDINGS
from roah_rsbb.wording import times
from roah_rsbb.wording.texts import did_you_mean

# Arguments of the launch file that name files of the folder.
_NAMED_FILES = {
    "benchmarks_file": files.BENCHMARKS, "schedule_file": files.SCHEDULE, "passwords_file": files.PASSWORDS,
    "standings_file": STANDINGS, "modules_dir": files.MODULES,
}
_BESIDE = "$(dirname)/"
# At most this many overlaps of a zone or team are listed.
_SHOWN = 3


class Checked(NamedTuple):
    """The result: lines for the organiser."""

    errors: List[str]
    warnings: List[str]
    summary: str  # counts; "" if the configuration cannot be read


def check(directory: str) -> Checked:
    """Check all files of a competition's folder and report all errors at once."""
    if not os.path.isdir(directory):
        return Checked([f"{directory}: found no such folder; expected one that new_competition created"],
                       [], "")
    report = Report()
    errors: List[str] = []
    loaded: Optional[Config] = None
    paths = [os.path.join(directory, name) for name in (files.BENCHMARKS, files.SCHEDULE, files.PASSWORDS)]
    try:
        loaded, report.warnings = config.load(*paths)
    except ConfigErrors as found:
        errors += str(found).splitlines()
    try:
        _check_launch(report, os.path.join(directory, files.LAUNCH))
        report.raise_errors()
    except ConfigErrors as found:
        errors += str(found).splitlines()
    standings = os.path.join(directory, STANDINGS)
    try:
        if os.path.lexists(standings):
            read_rules(standings, *(() if loaded is None else (tuple(loaded.benchmarks), teams_of(loaded))))
    except ConfigErrors as found:
        errors += str(found).splitlines()
    if loaded is not None:
        for code, benchmark in loaded.benchmarks.items():
            for text in findings(benchmark.sheet):
                report.warn(Place(paths[0], 0, 0), f"{code}: {text}")
        report.warnings += warnings_of_days(paths[1], loaded)
        _check_times(report, paths[1], loaded)
        _check_teams(report, paths[2], loaded)
        _check_standby(report, os.path.join(directory, files.LAUNCH), loaded)
        errors += _check_modules(report, directory, loaded)
    return Checked(list(dict.fromkeys(errors)), report.warnings, "" if loaded is None else _summary(loaded))


def _summary(loaded: Config) -> str:
    events = _events(loaded)
    teams = {event.team for _, event in events if event.team != ALL_TEAMS}
    codes = {event.benchmark.code for _, event in events}
    return (f"{counted(len(teams), 'team')}, {counted(len(loaded.zones), 'zone')}, "
            f"{counted(len(codes), 'benchmark')}, {counted(len(events), 'run')}")


def counted(number: int, what: str) -> str:
    """A number of things."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _events(loaded: Config) -> List[Tuple[str, ScheduledEvent]]:
    """All events with their zones, ordered by time."""
    events = [(zone.name, event) for zone in loaded.zones for event in zone.events]
    return sorted(events, key=lambda entry: entry[1].scheduled)


def _check_times(report: Report, path: str, loaded: Config) -> None:
    """Warn of runs that begin before an earlier one of the same zone or team has ended."""
    whole = Place(path, 0, 0)
    by_zone: Dict[str, List[str]] = {}
    by_team: Dict[str, List[str]] = {}
    for clash in clashes(loaded.zones):
        (other, busy), (zone, event) = clash.first, clash.second
        if clash.zone:
            by_zone.setdefault(zone, []).append(f"{_name(event)} before the end of {_name(busy)}")
        else:
            by_team.setdefault(clash.team, []).append(
                f"{_name(event)} in zone {quote(zone)} and {_name(busy)} in zone {quote(other)}")
    for zone, found in by_zone.items():
        report.warn(whole, f"zone {quote(zone)}: too little time between runs: {_few(found)}")
    for team, found in by_team.items():
        report.warn(whole, f"team {quote(team)} is in two zones at once: {_few(found)}")


def warnings_of_days(path: str, loaded: Config) -> List[str]:
    """Warn where it is not clear on which day a run is. `path`: of the schedule."""
    report, whole = Report(), Place(path, 0, 0)
    if not loaded.time_zone:
        here = local_zone()
        report.warn(whole, "no time zone, so each computer shows days and times in its own"
                    f"{f', here {here}' if here else ''}. Add the venue's as a line '- time_zone: "
                    f"{here or 'Asia/Tokyo'}'")
    times.use_zone(loaded.time_zone)
    late = [f"{_name(event)}, from {times.date_time(event.scheduled)}" for _, event in _events(loaded)
            if times.day_of(event.scheduled) != times.day_of(event.scheduled + planned_s(event.benchmark) - 1)]
    if late:
        report.warn(whole, f"past midnight, and counted on the day on which it begins: {_few(late)}")
    return report.warnings


def _name(event: ScheduledEvent) -> str:
    return f"{event.benchmark.code} of {event.team} (round {event.round}, run {event.run})"


def _few(found: List[str]) -> str:
    more = len(found) - _SHOWN
    return "; ".join(found[:_SHOWN]) + (f"; and {more} more" if more > 0 else "")


def _check_teams(report: Report, path: str, loaded: Config) -> None:
    scheduled = {event.team for _, event in _events(loaded)}
    idle = [team for team in loaded.passwords if team not in scheduled]
    if idle:
        report.warn(Place(path, 0, 0), f"no runs in the schedule for {listing(map(quote, idle))}: is that intended?")


def _check_standby(report: Report, launch: str, loaded: Config) -> None:
    """Warn of a box that only starts if its command line has a `standby_port`."""
    port = arguments(Report(), launch).get("standby_port")
    if loaded.durable is Durable.TWO and loaded.durable_at is not None and (port is None or port.default in ("", "0")):
        report.warn(loaded.durable_at, "'durable: two' needs a standby, and the launch file has no port for one: start "
                    "the box with standby_port:=8083, or it does not start")


def _check_modules(report: Report, directory: str, loaded: Config) -> List[str]:
    """Check the parameters of the scheduled benchmarking modules."""
    needed = scheduled_modules(loaded)
    folder = os.path.join(directory, files.MODULES)
    if not needed:
        return []
    if not os.path.isdir(folder):
        report.warn(Place(folder, 0, 0), f"not found, so the default parameters of {listing(needed)} apply, which fit "
                    "no real venue. Copy config/modules of roah_rsbb to this place")
        return []
    _check_zone_folders(report, folder, loaded)
    return module_errors(folder, loaded)


def _check_zone_folders(report: Report, folder: str, loaded: Config) -> None:
    """Warn of files that no zone reads."""
    zones = [zone.name for zone in loaded.zones]
    for name in zone_folders(folder):
        path = os.path.join(folder, name)
        if name not in zones:
            guess = did_you_mean(name, zones)
            report.warn(Place(path, 0, 0), f"not used: no zone of the schedule has this name{guess}")
        for own in own_files(path).values():
            report.warn(Place(own, 0, 0), f"not used: rules are the same in all zones, so put them into {folder}")


def scheduled_modules(loaded: Config) -> List[str]:
    """The codes of the scheduled benchmarks with a benchmarking module."""
    benchmarks = {event.benchmark for zone in loaded.zones for event in zone.events}
    return sorted(b.code for b in benchmarks if b.kind is BenchmarkKind.FUNCTIONALITY)


def module_errors(folder: str, loaded: Config) -> List[str]:
    """Return all errors in the files that the scheduled benchmarking modules read in `folder`."""
    known, own = modules(), own_files(folder)
    errors: List[str] = []
    read: Set[str] = set()  # paths
    for code in scheduled_modules(loaded):
        zones = [zone.name for zone in loaded.zones if any(event.benchmark.code == code for event in zone.events)]
        if code not in own and code not in known:
            errors.append(f"{os.path.join(folder, code)}.py: found no rules for the functionality benchmark {code}; "
                          "expected a file as in docs/write_a_benchmark.md")
            continue
        try:
            kind = load_tried(own[code]) if code in own else known[code]
        except ConfigErrors as found:
            errors += str(found).splitlines()
            continue
        for zone in zones:
            parameters, truth = file_in(folder, zone, f"{code}.yaml"), file_in(folder, zone, files.GROUND_TRUTH)
            checks = {
                parameters: functools.partial(read_parameters, parameters, code, kind.PARAMETERS),
                truth: functools.partial(ground_truth_of_frames.load, truth),
            }
            for path in (path for path in checks if path not in read):
                errors += _errors_in(checks[path])
            read |= checks.keys()
    return errors


def _errors_in(read: Callable[[], object]) -> List[str]:
    try:
        read()
    except ConfigErrors as found:
        return str(found).splitlines()
    return []


def _check_launch(report: Report, path: str) -> None:
    """Check that the launch file is valid and starts the box with the files of this folder."""
    if not os.path.lexists(path):
        report.warn(Place(path, 0, 0), "not found: start with 'roslaunch roah_rsbb roah_rsbb.launch' and pass the "
                                       "files "
                    "as arguments")
        return
    found = elements(report, path)
    starts = [at for name, given, at in found if name == "include" and "roah_rsbb.launch" in given.get("file", "")]
    if not report.errors and not starts:
        report.error(Place(path, 0, 0), "nothing that starts the box",
                     '<include file="$(find roah_rsbb)/launch/roah_rsbb.launch" pass_all_args="true"/>')
    for name, given, line in found:
        own = _NAMED_FILES.get(given.get("name", "")) if name == "arg" else None
        named = given.get("default", given.get("value"))
        if own is not None and named is not None and named != _BESIDE + own:
            report.warn(Place(path, line, 0), f"{given['name']} is {quote(named)}, but the checked file is "
                        f"{_BESIDE + own}")
