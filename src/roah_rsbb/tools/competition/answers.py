"""What an organiser answers, or gives as options: each text read, and whatever is wrong with it told."""

import datetime
import ipaddress
from typing import Callable, Dict, List, Optional, Sequence, Tuple

from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, KINDS, Kind
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.passwords_file import MAX_TEAM_BYTES
from roah_rsbb.rulebook.yaml_fields import choice, text
from roah_rsbb.rulebook.yaml_lines import Scalar
from roah_rsbb.tools.competition.moments import read_day

# Two zones are what a competition usually has (docs/organiser.md, "A first competition").
_TASKS, _OTHERS = "Task Benchmarks", "Functionality Benchmarks"
_MAX_MINUTES = 24 * 60

ZoneWish = Tuple[str, Tuple[str, ...]]  # a zone's name, and its benchmarks if they were named


def split(given: str) -> List[str]:
    """The parts between commas, without blanks around them."""
    return [part.strip() for part in given.split(",")]


def team_name(report: Report, place: Place, name: str, what: str = "a team's name") -> Optional[str]:
    """A name that a team can have in passwords and schedule; None after an error."""
    if ":" in name:
        return report.error(place, f"{quote(name)} as {what}", "a name without a colon")
    if name == ALL_TEAMS:
        return report.error(place, f"{ALL_TEAMS} as {what}",
                            f"another name: {ALL_TEAMS} in the schedule is every robot")
    return text(report, Scalar(place, name, True, False), what, MAX_TEAM_BYTES)


def benchmark_code(report: Report, place: Place, code: str, what: str = "benchmark") -> Optional[str]:
    """A benchmark's code, in upper or lower case; None after an error."""
    return choice(report, Scalar(place, code.upper(), False, False), what, tuple(KINDS), "a benchmark code")


def each_once(report: Report, place: Place, names: Sequence[str], what: str) -> Tuple[str, ...]:
    """The names; one that stands there twice is an error."""
    for name in dict.fromkeys(name for name in names if names.count(name) > 1):
        report.error(place, f"{what} {quote(name)} twice", "each once")
    return tuple(dict.fromkeys(names))


def read_teams(report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Names of teams, with commas between them."""
    names = [team_name(report, place, part) for part in split(given)]
    return each_once(report, place, [name for name in names if name is not None], "team")


def read_benchmarks(report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Codes, with commas between them; or ``tasks``, ``all``."""
    words = {"tasks": tuple(code for code, kind in KINDS.items() if kind is Kind.TASK), "all": tuple(KINDS)}
    if given.strip().casefold() in words:
        return words[given.strip().casefold()]
    codes = [benchmark_code(report, place, part) for part in split(given)]
    return each_once(report, place, [code for code in codes if code is not None], "benchmark")


def read_zones(report: Report, place: Place, given: str) -> Tuple[ZoneWish, ...]:
    """Zones with commas between them, each a name, or ``name: CODE CODE`` with its benchmarks."""
    zones: List[ZoneWish] = []
    for part in split(given):
        name, _, codes = part.partition(":")
        name = text(report, Scalar(place, name.strip(), True, False), "a zone's name")
        found = tuple(benchmark_code(report, place, code) for code in codes.split())
        if name is not None:
            zones.append((name, tuple(code for code in found if code is not None)))
    each_once(report, place, [name for name, _ in zones], "zone")
    return tuple(zones)


def usual_zones(codes: Sequence[str]) -> Dict[str, Sequence[str]]:
    """One zone for task benchmarks and one for the others, if there are any."""
    tasks = [code for code in codes if KINDS[code] is Kind.TASK]
    others = [code for code in codes if KINDS[code] is not Kind.TASK]
    return {name: found for name, found in ((_TASKS, tasks), (_OTHERS, others)) if found}


def share(
    report: Report, place: Place, zones: Sequence[ZoneWish], codes: Sequence[str]
) -> Dict[str, Sequence[str]]:
    """The benchmarks of each zone: those it names; zones that name none share what is left, in turns."""
    named = [code for _, own in zones for code in own]
    for code in dict.fromkeys(code for code in named if named.count(code) > 1):
        report.error(place, f"benchmark {code} in two zones",
                     "each in one, where every team does it; a sheet (--sheet) may do it otherwise")
    for code in dict.fromkeys(code for code in named if code not in codes):
        report.error(place, f"benchmark {code} in a zone", f"one of those that are held: {listing(codes)}")
    left = [code for code in codes if code not in named]
    plain = [name for name, own in zones if not own]
    if left and not plain:
        report.error(place, f"no zone for {listing(left)}", "each benchmark in a zone, or a zone that names none")
    if len(plain) > len(left):
        report.error(place, f"nothing to do in zone {quote(plain[len(left)])}", "at most one zone a benchmark")
    shared = {name: left[number::len(plain)] for number, name in enumerate(plain)}
    return {name: own or shared[name] for name, own in zones}


def read_days(report: Report, place: Place, given: str) -> Tuple[datetime.date, ...]:
    """Days, with commas between them."""
    days = [read_day(report, place, part, "a day") for part in split(given)]
    found = sorted(day for day in days if day is not None)
    each_once(report, place, [str(day) for day in found], "day")
    return tuple(found)


def read_minutes(report: Report, place: Place, given: str) -> Optional[datetime.timedelta]:
    """Whole minutes."""
    if given.isascii() and given.isdigit() and 0 < int(given[:9]) <= _MAX_MINUTES:
        return datetime.timedelta(minutes=int(given))
    return report.error(place, f"{quote(given)} as minutes", f"a whole number from 1 to {_MAX_MINUTES}")


def read_address(report: Report, place: Place, given: str) -> Optional[str]:
    """An IPv4 address."""
    try:
        return str(ipaddress.IPv4Address(given))
    except ValueError:
        return report.error(place, f"{quote(given)} as address", "an IPv4 address such as 192.168.1.255")


Reader = Callable[[Report, Place, str], object]
