"""`rosrun roah_rsbb new_competition DIR`: creates a competition's folder, or checks one (docs/organiser.md)."""

import argparse
import datetime
import functools
import math
import os
import shlex
import sys
from typing import Callable, Dict, List, Optional, Sequence, Set, Tuple

from roah_rsbb.ground.arguments import Parser, called, is_without_ros
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.journal.reader import JournalError, JournalReader, journal_in
from roah_rsbb.model.reason import Refused
from roah_rsbb.results.runs import records
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import ZonePlan
from roah_rsbb.rulebook.config import BenchmarksFile, PasswordsFile
from roah_rsbb.rulebook.day import EventChange, late_team, planned_s
from roah_rsbb.rulebook.errors import ConfigErrors, Place, Report, listing, quote
from roah_rsbb.rulebook.event_ids import new_id, written
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.rulebook.schedule_text import changed
from roah_rsbb.rulebook.team_passwords import with_team
from roah_rsbb.scoring.counting import with_events
from roah_rsbb.tools.competition import answers, certificate, files, rulebooks
from roah_rsbb.tools.competition.answers import Missing, known_answers, questions
from roah_rsbb.tools.competition.check import check, counted
from roah_rsbb.tools.competition.files import CannotWriteFiles, Hosts
from roah_rsbb.tools.competition.plan import (
    Plan,
    PlannedDay,
    VenueClock,
    days_of,
    local_zone,
    planned,
    read_clock,
    timetable,
    with_other_days,
)
from roah_rsbb.tools.competition.rulebooks import Rulebook, read_rulebook
from roah_rsbb.tools.competition.sheet import OPTIONAL, REQUIRED, Known, read_sheet
from roah_rsbb.tools.ports import interfaces
from roah_rsbb.wording import times

_DESCRIPTION = """\
Create the folder of a competition: benchmarks, passwords (randomly generated), schedule, parameters of the
benchmarking modules, and a launch file for all of it. At a terminal, the program asks for missing options.
"""
PROGRAM = called("new_competition", "new")
_EPILOG = f"""\
The sheet is a CSV file from a spreadsheet program. Its first row names the columns, in any order:
  {', '.join(REQUIRED)}   and optionally {', '.join(OPTIONAL)}
Each further row is a run, such as
  Home,HGTKMH,BrassButlers,2026-11-28,09:00
where the time is the venue's local time. All robots do HSUF at once: its team is ALL, or empty. Without the column
'round', the round is the number of the day. Without the column 'run', the runs of a team are numbered.

Examples:
  {PROGRAM} erl2026
  {PROGRAM} erl2026 --teams 'BrassButlers, CopperKettle' --benchmarks HGTKMH,HNF --days 2026-11-28,2026-11-29
  {PROGRAM} athome --rulebook athome2026 --teams 'BrassButlers, CopperKettle' --days 2026-11-28,2026-11-29
  {PROGRAM} erl2026 --sheet plan.csv
  {PROGRAM} erl2026 --sheet plan.csv --schedule-only
  {PROGRAM} erl2026 --add-team HomeAlone
  {PROGRAM} --check erl2026
  {PROGRAM} --certificate erl2026

The exit status is 0 on success (possibly with warnings), 1 for errors, 2 for wrong usage.
"""


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    config_dir = str(shipped_folder())
    options = _parser(config_dir).parse_args(sys.argv[1:] if arguments is None else arguments)
    ask = input if sys.stdin is not None and sys.stdin.isatty() else None
    sys.stdout.reconfigure(errors="backslashreplace")  # escape characters that this terminal cannot show
    try:
        status = _run(options, config_dir, ask)
    except (EOFError, KeyboardInterrupt):
        print(f"\n{PROGRAM}: cancelled; nothing was written", file=sys.stderr)
        status = 1
    except UnicodeDecodeError:
        print(f"\n{PROGRAM}: found an answer that is not UTF-8; nothing was written", file=sys.stderr)
        status = 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has closed the pipe
        status = 1
    sys.exit(status)


def _parser(config_dir: str) -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    parser.add_argument("directory", metavar="DIR", help="the competition's folder")
    parser.add_argument("--check", action="store_true", help="check the folder without changing it")
    parser.add_argument("--rulebook", metavar="NAME",
                        help=f"the kind of competition: {', '.join(rulebooks.names(config_dir))}, or a folder with a "
                        "rulebook of your own (default: all included benchmarks)")
    parser.add_argument("--sheet", metavar="CSV", help="create the schedule from this sheet (see below)")
    parser.add_argument("--schedule-only", action="store_true",
                        help="with --sheet: replace only the schedule of an existing competition")
    parser.add_argument("--add-team", metavar="TEAM",
                        help="add a team to an existing competition: a password, and its runs after those of the "
                        "others (--days: only on these days)")
    parser.add_argument("--certificate", action="store_true",
                        help="make a certificate for the web pages of an existing competition, and print how phones "
                        "trust it")
    parser.add_argument("--names", metavar="NAMES",
                        help="with --certificate: names and addresses of the box (default: those of this computer)")
    for question in questions({}):
        parser.add_argument("--" + question.option, metavar=question.example.strip("'"), help=question.help)
    return parser


def _run(options: argparse.Namespace, config_dir: str, ask: Optional[Callable[[str], str]]) -> int:
    """Run the command; returns the exit status."""
    if options.check:
        return _checked(options.directory)
    report = Report()
    try:
        if options.certificate:
            return _certificate(report, options)
        book = read_rulebook(report, config_dir, options.rulebook)
        report.raise_errors()
        if options.schedule_only:
            return _schedule_only(report, options, book, ask)
        if options.add_team is not None:
            return _add_team(report, options)
        hints = {"benchmarks": _described(book), "decisions": _left_to_people(book)}
        found = known_answers(options, report, ask, print, hints, book.benchmarks, book.answers, book.decisions())
        report.raise_errors()
        plan = _plan(report, options, book, found)
        report.raise_errors()
        _new(options, book, plan, found)
    except (ConfigErrors, CannotWriteFiles, Refused) as error:
        return _failed(error)
    except Missing as error:
        _failed(error)
        return 2
    for warning in report.warnings:
        print(f"warning: {warning}")
    return _checked(options.directory) or _next_steps(options, found)


def _described(book: Rulebook) -> str:
    """Describe all benchmarks."""
    return "\n".join(f"  {code:7} {benchmark.desc}" for code, benchmark in book.benchmarks.items())


def _left_to_people(book: Rulebook) -> str:
    """Describe the choices that the rulebook names, with their readings."""
    names = [part.strip() for part in book.answers["decisions"].text.split(";")] if "decisions" in book.answers else []
    return "\n".join(f"  {decision.name}: {', or '.join(decision.readings)}" for decision in book.decisions()
                     if decision.name in names)


def _plan(
    report: Report, options: argparse.Namespace, book: Rulebook, found: Dict[str, object]
) -> Optional[Plan]:
    """Make the plan from the sheet or from the answers."""
    if options.sheet:
        teams = found["teams"]
        known = None if teams is None else Known(teams, "the teams in --teams")
        codes = Known(list(book.benchmarks), f"the benchmarks of {book.path(files.BENCHMARKS)}")
        plan = read_sheet(options.sheet, report, found["time-zone"], known, codes, book.for_all)
        return plan if plan is None or teams is None else plan._replace(teams=teams)
    zones = _zones(report, options, book, found)
    days = _days(report, options, book, found)
    report.raise_errors()
    rounds = _rounds(report, book, found)
    return timetable(report, found["teams"], zones, days, found["time-zone"], rounds, book.for_all)


def _rounds(report: Report, book: Rulebook, found: Dict[str, object]) -> Dict[str, int]:
    """How often each benchmark is done. Those that the rulebook names stay, unless they are named."""
    usual = book.answers.get("rounds")
    own = {} if usual is None else answers.read_rounds(book.benchmarks, report, *usual) or {}
    return {**{code: count for code, count in own.items() if code}, **(found["rounds"] or {})}


def _zones(
    report: Report, options: argparse.Namespace, book: Rulebook, found: Dict[str, object]
) -> Dict[str, Sequence[str]]:
    """The benchmarks of each zone."""
    codes, wishes = found["benchmarks"], found["zones"]
    if options.arenas is not None and not any("*" in name for name, _ in wishes or ()):
        report.error(Place("--arenas", 0, 0), "no zone with '*' in its name", "such a zone, which there is so often")
    if wishes is None:
        return answers.usual_zones(book.benchmarks, codes)
    place, of_rulebook = _place(options, book, "zones")
    if found["arenas"] is not None:
        wishes = [(name.replace("*", "" if found["arenas"] == 1 else str(number)).strip(), own) for name, own in wishes
                  for number in range(1, 1 + (found["arenas"] if "*" in name else 1))]
    chosen = [(name, _chosen(own, codes, book, of_rulebook)) for name, own in wishes]
    wishes = [(name, new) for (name, new), (_, own) in zip(chosen, wishes) if new or not own]
    return answers.share(report, place, wishes, codes)


def _place(options: argparse.Namespace, book: Rulebook, option: str) -> Tuple[Place, bool]:
    """Where an answer stands, and whether it comes from the rulebook."""
    of_rulebook = getattr(options, option) is None and option in book.answers
    return (book.answers[option].place if of_rulebook else Place("--" + option, 0, 0)), of_rulebook


def _chosen(own: Sequence[str], codes: Sequence[str], book: Rulebook, of_rulebook: bool) -> Tuple[str, ...]:
    """The benchmarks of a zone or day. The rulebook's answers and 'all' may contain some that were not chosen."""
    if of_rulebook or own in answers.words_for_several(book.benchmarks).values():
        return tuple(code for code in own if code in codes)
    return tuple(own)


def _days(
    report: Report, options: argparse.Namespace, book: Rulebook, found: Dict[str, object]
) -> List[PlannedDay]:
    """The days with their benchmarks, times and breaks."""
    codes, daily = found["benchmarks"], found["daily"]
    if daily is not None:
        place, of_rulebook = _place(options, book, "daily")
        daily = [_chosen(day, codes, book, of_rulebook) for day in daily]
        if of_rulebook:
            daily = _stretched(daily, len(found["days"]))
        _check_daily(report, place, daily, codes, len(found["days"]))
    every = found["every"] or _every([planned_s(book.benchmarks[code]) for code in codes])
    return [PlannedDay(day, found["begin"], found["end"], every, found["breaks"] or (),
                       None if daily is None else daily[min(number, len(daily) - 1)])
            for number, day in enumerate(found["days"])]


def _stretched(daily: List[Tuple[str, ...]], days: int) -> List[Tuple[str, ...]]:
    """The plan of a rulebook for another number of days: the day before the last one is repeated, or the last days are
    one."""
    if len(daily) == 1:
        return daily
    if days >= len(daily):
        return [*daily[:-2], *[daily[-2]] * (days - len(daily) + 1), daily[-1]]
    return [*daily[:days - 1], tuple(dict.fromkeys(code for day in daily[days - 1:] for code in day))]


def _check_daily(
    report: Report, place: Place, daily: Sequence[Sequence[str]], codes: Sequence[str], days: int
) -> None:
    """Check that there are benchmarks for each day, and a day for each benchmark. One entry is for all days."""
    if len(daily) not in (1, days):
        report.error(place, f"benchmarks for {counted(len(daily), 'day')}",
                     f"those of {counted(days, 'day')}, or --daily all")
    named = [code for day in daily for code in day]
    for code in dict.fromkeys(code for code in named if code not in codes):
        report.error(place, f"benchmark {code} on a day", f"one of the competition's benchmarks: {listing(codes)}")
    left = [code for code in codes if code not in named]
    if left:
        report.error(place, f"no day for {listing(left)}", "a day for each benchmark of the competition")


def _every(seconds: Sequence[float]) -> datetime.timedelta:
    """The usual interval between runs of these lengths: enough for the longest one, in steps of five minutes."""
    return datetime.timedelta(minutes=max(15, 5 * math.ceil(max(seconds) / 300)))


def _new(options: argparse.Namespace, book: Rulebook, plan: Plan, found: Dict[str, object]) -> None:
    interface = next((i.name for i in interfaces() if i.broadcast == found["rsbb-host"]), None)
    hosts = Hosts(found["rsbb-host"], found["smartif-host"], interface)
    written = files.new_files(book, plan, found["time-zone"], hosts, found["decisions"] or {})
    files.write_new(options.directory, written)
    print(f"Written to {options.directory}: {', '.join(written)}")
    if options.time_zone is None:
        _say_zone(found["time-zone"])
    codes = sorted({run.code for zone in plan.zones for run in zone.runs})
    if hosts.smartif is None and files.needs_devices(book.benchmarks[code] for code in codes):
        print("The home devices are off, because the address of their controller is not known. To use them, start the "
              f"box with devices:=true smartif_host:=ADDRESS, or write both into {files.LAUNCH}")


def _say_zone(clock: Optional[VenueClock]) -> None:
    """Say that the schedule gets this computer's time zone, because nobody named another one."""
    if clock is not None and clock.name == local_zone():
        print(f"Time zone: {clock.name} (this computer's; another: --time-zone)")


def _only(report: Report, options: argparse.Namespace, command: str, *allowed: str) -> None:
    """Report the options that a command does not take."""
    for option in (*(question.option for question in questions({})), "rulebook", "sheet"):
        if option not in allowed and getattr(options, option.replace("-", "_")) is not None:
            words = " and ".join(f"--{word}" for word in allowed)
            report.error(Place("--" + option, 0, 0), f"this option together with {command}", f"only {words}")


def _schedule_only(
    report: Report, options: argparse.Namespace, book: Rulebook, ask: Optional[Callable[[str], str]]
) -> int:
    """Replace the schedule of an existing competition from a sheet; its teams and benchmarks stay."""
    if not options.sheet:
        raise Missing("not given: --sheet, which --schedule-only needs")
    _only(report, options, "--schedule-only", "sheet", "time-zone")
    clock = _clock(report, options)
    benchmarks, passwords = (os.path.join(options.directory, name) for name in (files.BENCHMARKS, files.PASSWORDS))
    teams = PasswordsFile(passwords, report).by_team
    known = BenchmarksFile(benchmarks, report).by_code
    report.raise_errors()
    zones = _zones_before(options.directory)
    old = planned(zones)
    plan = read_sheet(options.sheet, report, clock, Known(list(teams), f"the teams of {passwords}"),
                      Known(list(known), f"the benchmarks of {benchmarks}"),
                      lambda code: code in known and known[code].kind is BenchmarkKind.ALL_ROBOTS, days_of(old, clock))
    report.raise_errors()
    merged = with_other_days(old, plan, clock, _ran(options.directory, zones), functools.partial(_which, ask))
    before = files.write_schedule(options.directory, book, merged.zones, clock)
    print(f"Written: {files.SCHEDULE} in {options.directory}" + (f"; the old one is {before}" if before else ""))
    if merged.kept:
        print(f"The runs of other days stay: {', '.join(f'{count} on {day}' for day, count in merged.kept.items())}")
    for warning in (*merged.ran, *report.warnings):
        print(f"warning: {warning}")
    return _checked(options.directory)


def _ran(directory: str, zones: Sequence[ZonePlan]) -> Set[str]:
    """The ids of the events that have results. Raises `CannotWriteFiles` if the journal cannot be read."""
    path = journal_in(os.path.join(directory, files.LOG))
    if not os.path.exists(path):
        return set()
    try:
        return {record.event for record in with_events(records(JournalReader(path, checks_all=False), print), zones)}
    except JournalError as error:
        raise CannotWriteFiles(f"{error}. Which events have results is not known, so the schedule was left as it is") \
            from None


def _which(ask: Optional[Callable[[str], str]], event: str, choices: Sequence[str]) -> Optional[int]:
    """Ask which of these times an event has now; None: none of them."""
    words = ", ".join(f"{number} for {time}" for number, time in enumerate(choices, 1))
    if ask is None:
        raise Missing(f"{event} has results, and is not in the sheet at that time. Is it the event of "
                      f"{' or '.join(choices)} now? Keep its row, or start this command at a terminal, where it asks")
    while True:
        answer = ask(f"{event} has results, and is not in the sheet at that time. Which event is it now? {words}, or "
                     "press Enter for none of them: ").strip()
        if not answer:
            return None
        if answer in map(str, range(1, len(choices) + 1)):
            return int(answer) - 1


def _zones_before(directory: str) -> Sequence[ZonePlan]:
    """The zones of the schedule that is replaced; none if it does not exist. Raises `ConfigErrors`."""
    names = [os.path.join(directory, name) for name in (files.BENCHMARKS, files.SCHEDULE)]
    return config.load_schedule(*names)[1] if os.path.lexists(names[1]) else ()


def _clock(report: Report, options: argparse.Namespace) -> Optional[VenueClock]:
    """The time zone of the competition, or else the option's, or else this computer's."""
    known = config.settings_in(os.path.join(options.directory, files.SCHEDULE)).time_zone
    clock = read_clock(report, Place("--time-zone", 0, 0), options.time_zone or known or "local")
    if not (options.time_zone or known):
        _say_zone(clock)
    if known and clock is not None and clock.name != known:
        report.error(Place("--time-zone", 0, 0), f"{clock.name}, and {known} as time zone of the competition",
                     f"no other one. To change it, change time_zone in {files.SCHEDULE}")
    return clock


def _certificate(report: Report, options: argparse.Namespace) -> int:
    """Make a certificate for the web pages, and replace an old one."""
    _only(report, options, "--certificate", "names")
    names = certificate.own_names() if options.names is None else answers.split(options.names)
    certificate.check_names(report, Place("--names", 0, 0), names)
    report.raise_errors()
    directory = os.path.abspath(options.directory)
    made = certificate.make(names, datetime.datetime.utcnow())
    with files.writing(directory):
        certificate.write(directory, made)
    cert, key, authority = (os.path.join(directory, name) for name in (
        certificate.CERTIFICATE, certificate.KEY, certificate.AUTHORITY))
    start = f"roah-rsbb run {shlex.quote(directory)}" if is_without_ros() else \
        f"roslaunch {shlex.quote(os.path.join(directory, files.LAUNCH))}"
    print(f"""\
Written to {directory}: {certificate.CERTIFICATE}, {certificate.KEY} (secret), {certificate.AUTHORITY}
It is valid for {certificate.VALID_DAYS} days, and for {', '.join(names)}.
Start the box with it: {start} web_cert:={shlex.quote(cert)} web_key:={shlex.quote(key)}
Pair phones again: pairings without encryption do not count on encrypted pages.

Phones warn of the page until they trust this competition. Send {certificate.AUTHORITY} to each phone in a way that
nobody can change (cable, AirDrop, Bluetooth), not by a web page in the network of the competition. Then:
  Android: Settings, search for "CA certificate", Install anyway, choose the file.
  iPhone, iPad: open the file, then Settings, General, VPN & Device Management, install the profile; then General,
    About, Certificate Trust Settings, switch it on.
  Laptop: import it as an authority for websites in the browser's settings, "certificates".
Compare the SHA-256 fingerprint that the phone shows:
  {made.fingerprint}
After the competition, remove it from the phones. {authority} is not secret.""")
    return 0


def _add_team(report: Report, options: argparse.Namespace) -> int:
    """Add a team to an existing competition."""
    _only(report, options, "--add-team", "days", "time-zone")
    place = Place("--add-team", 0, 0)
    team = answers.team_name(report, place, options.add_team)
    clock = _clock(report, options)
    days = None if options.days is None else answers.read_days(report, Place("--days", 0, 0), options.days)
    report.raise_errors()
    names = (files.BENCHMARKS, files.SCHEDULE, files.PASSWORDS)
    loaded, _ = config.load(*(os.path.join(options.directory, name) for name in names))
    if team in loaded.passwords:
        report.error(place, f"team {quote(team)}, which the competition has already", "another name")
    report.raise_errors()
    times.use_zone(clock.name)
    added = late_team(loaded.zones, team, None if days is None else list(map(str, days)))
    passwords, schedule = (os.path.join(options.directory, name) for name in (files.PASSWORDS, files.SCHEDULE))
    files.replace(options.directory, files.PASSWORDS, with_team(passwords, team), 0)
    print(f"Written: a password for {quote(team)} in {passwords}")
    if added:
        ids = {event.id for zone in loaded.zones for event in zone.events}
        with open(schedule, encoding="utf-8", newline="") as file:
            text = written(file.read(), loaded.zones)
        before = files.replace(options.directory, files.SCHEDULE, changed(
            text, [EventChange(new_id(ids), None, slot) for slot in added]))
        print(f"Written: {files.SCHEDULE} in {options.directory}; the old one is {before}")
        for slot in sorted(added, key=lambda slot: slot.scheduled):
            print(f"  {times.formatted(slot.scheduled, '%Y-%m-%d %H:%M', False)}  zone {quote(slot.zone)}: "
                  f"{slot.benchmark}, round {slot.round}")
    return _checked(options.directory)


def _checked(directory: str) -> int:
    """Check a folder and print the result."""
    found = check(directory)
    for error in found.errors:
        print(f"error: {error}")
    for warning in found.warnings:
        print(f"warning: {warning}")
    if found.errors:
        count = len(found.errors)
        print("1 error: correct it before you start the box" if count == 1 else
              f"{count} errors: correct them before you start the box")
        return 1
    print(f"No errors: {found.summary}")
    return 0


def _failed(error: Exception) -> int:
    for line in str(error).splitlines():
        print(f"{PROGRAM}: {line}", file=sys.stderr)
    return 1


def _next_steps(options: argparse.Namespace, found: Dict[str, object]) -> int:
    directory = os.path.abspath(options.directory)
    path = shlex.quote(os.path.join(directory, files.LAUNCH))
    host = found["rsbb-host"]
    if os.path.isdir(os.path.join(directory, files.MODULES)):
        print(f"Now set the waypoints, objects and people of your venue in {files.MODULES}/, and ", end="")
    else:
        print("Now ", end="")
    print(f"give each team its password from {files.PASSWORDS}.")
    example = host or "192.168.1.255"
    print(f"Close the robots' network: check the interface in {files.FIREWALL}, then: sudo nft -f "
          f"{shlex.quote(os.path.join(directory, files.FIREWALL))}")
    setting = "" if host else f" rsbb_host:={example}"
    if is_without_ros():
        print(f"Check the set-up: roah-rsbb preflight {shlex.quote(directory)}{setting}")
        print(f"Start the box: roah-rsbb run {shlex.quote(directory)}{setting}")
    else:
        print(f"Check the set-up: rosrun roah_rsbb preflight --rsbb-host {example} --competition "
              f"{shlex.quote(directory)}")
        print(f"Start the box: roslaunch {path}{setting}")
    return 0
