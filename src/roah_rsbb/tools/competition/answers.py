"""The organiser's decisions: options, questions at a terminal, and reading the answers."""

import argparse
import collections
import datetime
import functools
import ipaddress
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.rules import Decision
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.config import MAX_ROUND, MAX_TEAM_BYTES
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.rulebook.yaml_fields import choice, integer, text
from roah_rsbb.rulebook.yaml_lines import Scalar
from roah_rsbb.tools.competition.plan import Break, local_zone, read_clock, read_day, read_time
from roah_rsbb.tools.competition.rulebooks import Benchmarks, RulebookAnswer

# A competition usually has two zones (docs/organiser.md, "A first competition").
_TASKS, _OTHERS = "Task Benchmarks", "Functionality Benchmarks"
_MAX_MINUTES = 24 * 60
_MAX_ARENAS = 20

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
    report: Report, place: Place, code: str, codes: Sequence[str], what: str = "benchmark"
) -> Optional[str]:
    """Check a benchmark's code in upper or lower case; None after an error."""
    same = next((known for known in codes if known.upper() == code.upper()), code)
    return choice(report, Scalar(place, same, False, False), what, tuple(codes), "a benchmark code")


def each_once(report: Report, place: Place, names: Sequence[str], what: str) -> Tuple[str, ...]:
    """Return the names; duplicates are errors."""
    for name, count in collections.Counter(names).items():
        if count > 1:
            report.error(place, f"{what} {quote(name)} twice", "each once")
    return tuple(dict.fromkeys(names))


def read_teams(report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Read names of teams, separated by commas."""
    names = [team_name(report, place, part) for part in split(given)]
    return each_once(report, place, [name for name in names if name is not None], "team")


def read_benchmarks(benchmarks: Benchmarks, report: Report, place: Place, given: str) -> Tuple[str, ...]:
    """Read codes, separated by commas; or ``tasks``, ``all``."""
    return _codes(benchmarks, report, place, split(given))


def words_for_several(benchmarks: Benchmarks) -> Dict[str, Tuple[str, ...]]:
    """The words that stand for several benchmarks, with their codes."""
    return {"tasks": tuple(filter(are_of(BenchmarkKind.TASK, benchmarks), benchmarks)),
            "all": tuple(benchmarks)}


def _codes(benchmarks: Benchmarks, report: Report, place: Place, words: Sequence[str]) -> Tuple[str, ...]:
    """Read codes, each once; or only ``tasks`` or ``all``."""
    several = words_for_several(benchmarks)
    word = words[0].casefold() if len(words) == 1 else ""
    if several.get(word):
        return several[word]
    codes = [benchmark_code(report, place, part, tuple(benchmarks)) for part in words]
    return each_once(report, place, [code for code in codes if code is not None], "benchmark")


def read_zones(benchmarks: Benchmarks, report: Report, place: Place, given: str) -> Tuple[ZoneWish, ...]:
    """Read zones, separated by commas, each a name or ``name: CODE CODE`` with its benchmarks."""
    zones: List[ZoneWish] = []
    for part in split(given):
        name, _, codes = part.partition(":")
        name = text(report, Scalar(place, name.strip(), True, False), "a zone's name")
        found = _codes(benchmarks, report, place, codes.split())
        if name is not None:
            zones.append((name, found))
    each_once(report, place, [name for name, _ in zones], "zone")
    return tuple(zones)


def read_daily(benchmarks: Benchmarks, report: Report, place: Place, given: str) -> Tuple[Tuple[str, ...], ...]:
    """Read the benchmarks of each day: days separated by commas, codes by spaces."""
    return tuple(_codes(benchmarks, report, place, part.split() or [part]) for part in split(given))


def read_breaks(report: Report, place: Place, given: str) -> Tuple[Break, ...]:
    """Read breaks of each day, separated by commas, such as 12:30-13:30."""
    found: List[Break] = []
    for part in split(given):
        begin, _, end = part.partition("-")
        times = [read_time(report, place, time.strip(), "time of a break") for time in (begin, end)]
        if None in times:
            continue
        if times[0] < times[1]:
            found.append(Break(*times))
        else:
            report.error(place, f"{quote(part)} as break", "a break that ends after its begin, such as 12:30-13:30")
    return tuple(sorted(found))


def read_rounds(benchmarks: Benchmarks, report: Report, place: Place, given: str) -> Optional[Dict[str, int]]:
    """Read how often each team does each benchmark, such as ``2, Restaurant: 1``; by code, "" for all others."""
    found: Dict[str, int] = {}
    for part in split(given):
        name, _, number = part.rpartition(":")
        code = benchmark_code(report, place, name.strip(), tuple(benchmarks)) if name else ""
        count = integer(report, Scalar(place, number.strip(), False, False), "rounds", 1, MAX_ROUND)
        if code is None or count is None:
            return None
        found[code] = count
    return found


def read_arenas(report: Report, place: Place, given: str) -> Optional[int]:
    """Read the number of arenas."""
    return integer(report, Scalar(place, given, False, False), "arenas", 1, _MAX_ARENAS)


def read_decisions(decisions: Sequence[Decision], report: Report, place: Place, given: str) -> Dict[str, str]:
    """Read choices of the rules, such as ``Posters: count; Restarts: two``. One without a reading stays as it is."""
    known = {decision.name: decision.readings for decision in decisions}
    found: Dict[str, str] = {}
    for part in filter(None, (part.strip() for part in given.split(";"))):
        name, _, reading = (word.strip() for word in part.partition(":"))
        own = choice(report, Scalar(place, name, False, False), "choice", tuple(known), "a choice of the rules")
        if own is not None and reading:
            word = choice(report, Scalar(place, reading, True, False), f"reading of {quote(own)}", known[own],
                          "one of its readings")
            found[own] = word or ""
    return found


def are_of(kind: BenchmarkKind, benchmarks: Benchmarks) -> Callable[[str], bool]:
    """Return a function that returns whether a code is of this kind."""
    return lambda code: benchmarks[code].kind is kind


def usual_zones(benchmarks: Benchmarks, codes: Sequence[str]) -> Dict[str, Sequence[str]]:
    """Return one zone for task benchmarks and one for the others, omitting empty zones."""
    is_task = are_of(BenchmarkKind.TASK, benchmarks)
    tasks = [code for code in codes if is_task(code)]
    others = [code for code in codes if not is_task(code)]
    return {name: found for name, found in ((_TASKS, tasks), (_OTHERS, others)) if found}


def share(
    report: Report, place: Place, zones: Sequence[ZoneWish], codes: Sequence[str]
) -> Dict[str, Sequence[str]]:
    """Return the benchmarks of each zone. Zones without benchmarks share the remaining ones."""
    named = [code for _, own in zones for code in own]
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
    """A decision of the organiser. `default` None: required; "": optional. `suggested`: asked only where the rulebook
    has an answer, which is taken where nothing is typed."""

    option: str
    reader: Reader
    example: str
    help: str
    asks: str  # the question at a terminal; empty: not asked
    default: Optional[str] = None
    of_sheet: bool = False  # a sheet contains it
    suggested: bool = False


def _time(report: Report, place: Place, given: str) -> Optional[datetime.time]:
    return read_time(report, place, given, "time")


def questions(benchmarks: Benchmarks, decisions: Sequence[Decision] = ()) -> Tuple[Question, ...]:
    """All questions; codes in the answers are those of `benchmarks`, choices those of `decisions`."""
    of_codes = functools.partial
    return (
        Question("teams", read_teams, "'BrassButlers, CopperKettle'",
                 "names of the teams, exactly as their robots send them",
                 "Teams, separated by commas, exactly as their robots send them"),
        Question("benchmarks", of_codes(read_benchmarks, benchmarks), _codes_example(benchmarks),
                 "codes of the benchmarks, or 'tasks', or 'all'",
                 "Benchmarks: codes separated by commas, or 'tasks', or 'all'", of_sheet=True),
        Question("zones", of_codes(read_zones, benchmarks), "'Home: HGTKMH HWV, Arena: HNF'",
                 "zones, which run in parallel, each with its own referee. Name the benchmarks of each zone, or 'all'; "
                 "zones without any share the remaining ones. Zones with the same benchmark share its teams "
                 "(default: a zone for task benchmarks, one for the others)",
                 "Zones, such as 'Home, Arena' or 'Home: HGTKMH HWV, Arena: HNF' (press Enter for one with task "
                 "benchmarks and one with the others)", "", True),
        Question("days", read_days, "2026-11-28,2026-11-29", "days of the competition",
                 "Days, such as 2026-11-28, 2026-11-29", of_sheet=True),
        Question("daily", of_codes(read_daily, benchmarks), "'HGTKMH HWV, HWV HNF'",
                 "benchmarks of each day: days separated by commas, codes by spaces (default: all of them every day)",
                 "", "", True),
        Question("arenas", read_arenas, "2", "number of arenas: how often there is the zone of the rulebook whose name "
                 "has a '*'", "Number of arenas", "", True, True),
        Question("rounds", of_codes(read_rounds, benchmarks), "'2, HNF: 1'",
                 "how often each team does each benchmark, spread over the benchmark's days, and how often those that "
                 "differ (default: once a day)", "How often each team does each benchmark, and which ones differ",
                 "", True, True),
        Question("decisions", of_codes(read_decisions, decisions), "'Posters: count'",
                 "choices that the rules leave to people, with their readings, separated by ';'",
                 "Which of these are not to have the first reading, such as 'Posters: count', separated by ';' (press "
                 "Enter for none)", "", False, True),
        Question("begin", _time, "09:00", "start of the first run of a day (default: 09:00)",
                 "Start of the first run of a day (press Enter for 09:00)", "09:00", True),
        Question("end", _time, "18:00", "latest end of the last run of a day (default: 18:00)", "", "18:00", True),
        Question("every", read_minutes, "15",
                 "minutes from the start of one run to the next (default: 15, or more if the longest benchmark needs "
                 "more)", "", "", True),
        Question("breaks", read_breaks, "12:30-13:30", "breaks of each day, separated by commas: no run begins or "
                 "continues in them", "", "", True),
        Question("time-zone", read_clock, "Asia/Tokyo",
                 "time zone of the venue: a name such as Asia/Tokyo, UTC, its offset, such as +01:00, or local (this "
                 "computer's, the default)",
                 f"Time zone of the venue, such as Asia/Tokyo (press Enter for {local_zone() or 'none'}, that of this "
                 "computer)", "local"),
        Question("rsbb-host", read_address, "192.168.1.255",
                 "broadcast address of the network with the robots, for the launch file",
                 "Broadcast address of the network with the robots ('ip address' shows it as brd; press Enter to give "
                 "it later)", ""),
        Question("smartif-host", read_address, "192.168.1.56",
                 "address of the home devices' controller, for the launch file", "", ""),
    )


def _codes_example(benchmarks: Benchmarks) -> str:
    usual = ("HGTKMH", "HWV", "HNF")
    return ",".join(usual if not benchmarks or all(code in benchmarks for code in usual) else list(benchmarks)[:3])


class Missing(Exception):
    """Required options are missing, and there is no terminal to ask. The text names them."""


def known_answers(
    given: argparse.Namespace, report: Report, ask: Optional[Callable[[str], str]], say: Callable[[str], None],
    hints: Dict[str, str], benchmarks: Benchmarks, usual: Dict[str, RulebookAnswer],
    decisions: Sequence[Decision] = (),
) -> Dict[str, object]:
    """Return the answer to each question by option (None: open), from options, the terminal (`ask`), or defaults.

    Errors in options are added to the report. At the terminal, a question is repeated after an error; `hints` by option
    are printed first. `ask` is None without a terminal. `usual`: the answers of the rulebook. With a sheet, the
    questions that it answers are skipped. Raises `Missing`.
    """
    found: Dict[str, object] = {}
    missing: List[Question] = []
    for question in questions(benchmarks, decisions):
        option = question.option
        text = getattr(given, option.replace("-", "_"))
        place = Place("--" + option, 0, 0)
        if given.sheet and question.of_sheet:
            if text is not None:
                report.error(place, "this option together with --sheet", "only one of them: the sheet contains it")
            continue
        is_asked = ask is not None and question.asks and not given.sheet and text is None and (
            question.suggested == (option in usual))
        if text is None and option in usual:
            place, text = usual[option]
        optional = question.default is not None or (given.sheet and option == "teams")
        if is_asked and ask is not None:
            if hints.get(option):
                say(hints[option])
            found[option] = _asked(question, place, ask, say, text or "", not hints.get(option))
        elif text is None and not optional:
            missing.append(question)
        elif text is None and question.default is None:
            found[option] = None  # the sheet has the teams
        else:
            found[option] = _read(question, report, place, (text or "").strip())
    if missing:
        wanted = " ".join(f"--{question.option} {question.example}" for question in missing)
        raise Missing(f"not given: {', '.join('--' + q.option for q in missing)}; for example: {wanted}\n"
                      "(or --sheet SHEET.csv; at a terminal, the program asks)")
    return found


def _read(question: Question, report: Report, place: Place, given: str) -> object:
    """Read an answer; None after an error, or if it is optional and empty."""
    text = given or question.default
    if not text:
        return report.error(place, "nothing", question.example) if text is None else None
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return report.error(place, "a character that is not UTF-8", "text in UTF-8")
    return question.reader(report, place, text)


def _asked(
    question: Question, place: Place, ask: Callable[[str], str], say: Callable[[str], None], suggested: str,
    shown: bool,
) -> object:
    """Ask until the answer is valid. `suggested`: the answer if nothing is typed; `shown`: the question names it."""
    asks = f"{question.asks} (press Enter for {suggested})" if suggested and shown else question.asks
    while True:
        report = Report()
        answer = _read(question, report, place, ask(f"{asks}: ").strip() or suggested)
        if not report.errors:
            return answer
        for error in report.errors:
            say(f"  found {error.found}; expected {error.expected}")
