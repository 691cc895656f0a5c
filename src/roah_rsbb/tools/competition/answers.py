"""The organiser's decisions: options, questions at a terminal, and reading the answers."""

import argparse
import datetime
import ipaddress
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.config import MAX_TEAM_BYTES
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind
from roah_rsbb.rulebook.yaml_fields import choice, text
from roah_rsbb.rulebook.yaml_lines import Scalar
from roah_rsbb.tools.competition.plan import read_clock, read_day, read_time

# Two zones are what a competition usually has (docs/organiser.md, "A first competition").
_TASKS, _OTHERS = "Task Benchmarks", "Functionality Benchmarks"
_MAX_MINUTES = 24 * 60

ZoneWish = Tuple[str, Tuple[str, ...]]  # a zone's name, and its benchmarks if given


def split(given: str) -> List[str]:
    """Split at commas and strip spaces."""
    return [part.strip() for part in given.split(",")]


def team_name(report: Report, place: Place, name: str, what: str = "a team's name") -> Optional[str]:
    """Check a team's name; None after an error."""
    if ":" in name:
        return report.error(place, f"{quote(name)} as {what}", "a name without a colon")
    if name == ALL_TEAMS:
        return report.error(place, f"{ALL_TEAMS} as {what}",
                            f"another name: in the schedule, {ALL_TEAMS} means all robots")
    return text(report, Scalar(place, name, True, False), what, MAX_TEAM_BYTES)


def benchmark_code(
    report: Report, place: Place, code: str, what: str = "benchmark", codes: Sequence[str] = tuple(PROFILES)
) -> Optional[str]:
    """Check a benchmark's code in upper or lower case; None after an error."""
    same = next((known for known in codes if known.upper() == code.upper()), code.upper())
    return choice(report, Scalar(place, same, False, False), what, tuple(codes), "a benchmark code")


def each_once(report: Report, place: Place, names: Sequence[str], what: str) -> Tuple[str, ...]:
    """Return the names; duplicates are errors."""
    for name in dict.fromkeys(name for name in names if names.count(name) > 1):
        report.error(place, f"{what} {quote(name)} twice", "each once")
    return tuple(dict.fromkeys(names))


def read_teams(report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Read names of teams, separated by commas."""
    names = [team_name(report, place, part) for part in split(given)]
    return each_once(report, place, [name for name in names if name is not None], "team")


def read_benchmarks(report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Read codes, separated by commas; or ``tasks``, ``all``."""
    words = {"tasks": tuple(filter(_is_task, PROFILES)), "all": tuple(PROFILES)}
    if given.strip().casefold() in words:
        return words[given.strip().casefold()]
    codes = [benchmark_code(report, place, part) for part in split(given)]
    return each_once(report, place, [code for code in codes if code is not None], "benchmark")


def read_zones(report: Report, place: Place, given: str) -> Tuple[ZoneWish, ...]:
    """Read zones, separated by commas, each a name or ``name: CODE CODE`` with its benchmarks."""
    zones: List[ZoneWish] = []
    for part in split(given):
        name, _, codes = part.partition(":")
        name = text(report, Scalar(place, name.strip(), True, False), "a zone's name")
        found = tuple(benchmark_code(report, place, code) for code in codes.split())
        if name is not None:
            zones.append((name, tuple(code for code in found if code is not None)))
    each_once(report, place, [name for name, _ in zones], "zone")
    return tuple(zones)


def _is_task(code: str) -> bool:
    return PROFILES[code].kind is BenchmarkKind.TASK


def usual_zones(codes: Sequence[str]) -> Dict[str, Sequence[str]]:
    """Return one zone for task benchmarks and one for the others, omitting empty zones."""
    tasks = [code for code in codes if _is_task(code)]
    others = [code for code in codes if not _is_task(code)]
    return {name: found for name, found in ((_TASKS, tasks), (_OTHERS, others)) if found}


def share(
    report: Report, place: Place, zones: Sequence[ZoneWish], codes: Sequence[str]
) -> Dict[str, Sequence[str]]:
    """Return the benchmarks of each zone. Zones without benchmarks share the remaining ones."""
    named = [code for _, own in zones for code in own]
    for code in dict.fromkeys(code for code in named if named.count(code) > 1):
        report.error(place, f"benchmark {code} in two zones",
                     "each benchmark in one zone; use a sheet (--sheet) for other plans")
    for code in dict.fromkeys(code for code in named if code not in codes):
        report.error(place, f"benchmark {code} in a zone", f"one of the competition's benchmarks: {listing(codes)}")
    left = [code for code in codes if code not in named]
    plain = [name for name, own in zones if not own]
    if left and not plain:
        report.error(place, f"no zone for {listing(left)}", "each benchmark in a zone, or a zone without benchmarks")
    if len(plain) > len(left):
        report.error(place, f"no benchmark left for zone {quote(plain[len(left)])}", "at most one zone per benchmark")
    shared = {name: left[number::len(plain)] for number, name in enumerate(plain)}
    return {name: own or shared[name] for name, own in zones}


def read_days(report: Report, place: Place, given: str) -> Tuple[datetime.date, ...]:
    """Read dates, separated by commas."""
    days = [read_day(report, place, part, "a day") for part in split(given)]
    found = sorted(day for day in days if day is not None)
    each_once(report, place, [str(day) for day in found], "day")
    return tuple(found)


def read_minutes(report: Report, place: Place, given: str) -> Optional[datetime.timedelta]:
    """Read whole minutes."""
    if given.isascii() and given.isdigit() and 0 < int(given[:9]) <= _MAX_MINUTES:
        return datetime.timedelta(minutes=int(given))
    return report.error(place, f"{quote(given)} as minutes", f"a whole number from 1 to {_MAX_MINUTES}")


def read_address(report: Report, place: Place, given: str) -> Optional[str]:
    """Read an IPv4 address."""
    try:
        return str(ipaddress.IPv4Address(given))
    except ValueError:
        return report.error(place, f"{quote(given)} as address", "an IPv4 address such as 192.168.1.255")


Reader = Callable[[Report, Place, str], object]


# -- questions --------------------------------------------------------------------------------------

class Question(NamedTuple):
    """A decision of the organiser. `default` None: required; "": optional."""

    option: str
    reader: Reader
    example: str
    help: str
    asks: str  # the question at a terminal; empty: not asked
    default: Optional[str] = None
    of_sheet: bool = False  # a sheet contains it


def _time(report: Report, place: Place, given: str) -> Optional[datetime.time]:
    return read_time(report, place, given, "time")


QUESTIONS = (
    Question("teams", read_teams, "'BrassButlers, CopperKettle'",
             "names of the teams, exactly as their robots send them",
             "Teams, separated by commas, exactly as their robots send them"),
    Question("benchmarks", read_benchmarks, "HGTKMH,HWV,HNF",
             f"codes of the benchmarks ({' '.join(PROFILES)}), or 'tasks', or 'all'",
             "Benchmarks: codes separated by commas, or 'tasks' (the first three), or 'all'", of_sheet=True),
    Question("zones", read_zones, "'Home: HGTKMH HWV, Arena: HNF'",
             "zones, which run in parallel, each with its own referee; with the benchmarks of each, or without, then "
             "the "
             "benchmarks are distributed (default: a zone for task benchmarks, one for the others)",
             "Zones, such as 'Home, Arena' or 'Home: HGTKMH HWV, Arena: HNF' (press Enter for one with task benchmarks "
             "and one with the others)", "", True),
    Question("days", read_days, "2026-11-28,2026-11-29", "days of the competition",
             "Days, such as 2026-11-28, 2026-11-29", of_sheet=True),
    Question("begin", _time, "09:00", "start of the first run of a day (default: 09:00)",
             "Start of the first run of a day (press Enter for 09:00)", "09:00", True),
    Question("end", _time, "18:00", "latest end of the last run of a day (default: 18:00)", "", "18:00", True),
    Question("every", read_minutes, "15", "minutes from the start of one run to the next (default: 15)", "",
             "15", True),
    Question("time-zone", read_clock, "+01:00",
             "time zone of the venue: local (this computer's, the default), UTC, or its offset, such as +01:00", "",
             "local"),
    Question("rsbb-host", read_address, "192.168.1.255",
             "broadcast address of the network with the robots, for the launch file",
             "Broadcast address of the network with the robots ('ip address' shows it as brd; press Enter to give "
             "it later)", ""),
    Question("smartif-host", read_address, "192.168.1.56",
             "address of the home devices' controller, for the launch file", "", ""),
)


class Missing(Exception):
    """Required options are missing, and there is no terminal to ask. The text names them."""


def known_answers(
    given: argparse.Namespace, report: Report, ask: Optional[Callable[[str], str]], say: Callable[[str], None],
    hints: Dict[str, str],
) -> Dict[str, object]:
    """Return the answer to each question by option (None: open), from options, the terminal (`ask`), or defaults.

    Errors in options are added to the report. At the terminal, a question is repeated after an error; `hints` by option
    are printed first. `ask` is None without a terminal. With a sheet, the questions that it answers are skipped.
    """
    found: Dict[str, object] = {}
    missing: List[Question] = []
    for question in QUESTIONS:
        text = getattr(given, question.option.replace("-", "_"))
        place = Place("--" + question.option, 0, 0)
        if given.sheet and question.of_sheet:
            if text is not None:
                report.error(place, "this option together with --sheet", "only one of them: the sheet contains it")
            continue
        optional = question.default is not None or (given.sheet and question.option == "teams")
        if text is None and ask is not None and question.asks and not given.sheet:
            if question.option in hints:
                say(hints[question.option])
            found[question.option] = _asked(question, place, ask, say)
            continue
        if text is None and not optional:
            missing.append(question)
            continue
        text = text if text is not None else question.default
        found[question.option] = question.reader(report, place, text.strip()) if text else None
    if missing:
        wanted = " ".join(f"--{question.option} {question.example}" for question in missing)
        raise Missing(f"not given: {', '.join('--' + q.option for q in missing)}; for example: {wanted}\n"
                      "(or --sheet SHEET.csv; at a terminal, the program asks)")
    return found


def _asked(question: Question, place: Place, ask: Callable[[str], str], say: Callable[[str], None]) -> object:
    """Ask until the answer is valid."""
    while True:
        text = ask(f"{question.asks}: ").strip() or question.default
        if text == "":
            return None
        report = Report()
        if text is None:
            report.error(place, "nothing", question.example)
        answer = None if text is None else question.reader(report, place, text)
        if not report.errors:
            return answer
        for error in report.errors:
            say(f"  found {error.found}; expected {error.expected}")
