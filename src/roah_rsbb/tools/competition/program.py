"""`rosrun roah_rsbb new_competition DIR`: creates a competition's folder, or checks one (docs/organiser.md)."""

import argparse
import os
import shlex
import sys
from typing import Callable, Dict, List, Optional

from roah_rsbb.arguments import Parser
from roah_rsbb.rulebook.config import BenchmarksFile, PasswordsFile
from roah_rsbb.rulebook.errors import ConfigErrors, Place, Report
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.tools.competition import answers, files
from roah_rsbb.tools.competition.answers import QUESTIONS, Missing, known_answers
from roah_rsbb.tools.competition.check import check
from roah_rsbb.tools.competition.files import CannotWriteFiles, Hosts
from roah_rsbb.tools.competition.plan import Plan, PlannedDay, read_clock, timetable
from roah_rsbb.tools.competition.sheet import OPTIONAL, REQUIRED, Known, read_sheet
from roah_rsbb.tools.interfaces import interfaces

_DESCRIPTION = """\
Create the folder of a competition: benchmarks, passwords (randomly generated), schedule, parameters of the
benchmarking modules, and a launch file for all of it. At a terminal, the program asks for missing options.
"""
_EPILOG = f"""\
The sheet is a CSV file from a spreadsheet program. Its first row names the columns, in any order:
  {', '.join(REQUIRED)}   and optionally {', '.join(OPTIONAL)}
Each further row is a run, such as
  Home,HGTKMH,BrassButlers,2026-11-28,09:00
where the time is the venue's local time. All robots do HSUF at once: its team is ALL, or empty. Without the column
'round', the round is the number of the day. Without the column 'run', the runs of a team are numbered.

Examples:
  new_competition erl2026
  new_competition erl2026 --teams 'BrassButlers, CopperKettle' --benchmarks HGTKMH,HNF --days 2026-11-28,2026-11-29
  new_competition erl2026 --sheet plan.csv
  new_competition erl2026 --sheet plan.csv --schedule-only
  new_competition --check erl2026

The exit status is 0 on success (possibly with warnings), 1 for errors, 2 for wrong usage.
"""


def main(config_dir: str, arguments: Optional[List[str]] = None) -> None:
    """Run the program; `config_dir` contains the default configuration files."""
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    ask = input if sys.stdin is not None and sys.stdin.isatty() else None
    try:
        sys.exit(_run(options, config_dir, ask))
    except (EOFError, KeyboardInterrupt):
        print("\nnew_competition: cancelled; nothing was written", file=sys.stderr)
        sys.exit(1)


def _parser() -> argparse.ArgumentParser:
    parser = Parser("new_competition", _DESCRIPTION, _EPILOG)
    parser.add_argument("directory", metavar="DIR", help="the competition's folder")
    parser.add_argument("--check", action="store_true", help="check the folder without changing it")
    parser.add_argument("--sheet", metavar="CSV", help="create the schedule from this sheet (see below)")
    parser.add_argument("--schedule-only", action="store_true",
                        help="with --sheet: replace only the schedule of an existing competition")
    for question in QUESTIONS:
        parser.add_argument("--" + question.option, metavar=question.example.strip("'"), help=question.help)
    return parser


def _run(options: argparse.Namespace, config_dir: str, ask: Optional[Callable[[str], str]]) -> int:
    """Run the command; returns the exit status."""
    if options.check:
        return _checked(options.directory)
    report = Report()
    try:
        if options.schedule_only:
            return _schedule_only(report, options, config_dir)
        found = known_answers(options, report, ask, print, {"benchmarks": _benchmarks(config_dir)})
        report.raise_errors()
        plan = _plan(report, options, found)
        report.raise_errors()
        _new(options, config_dir, plan, found)
    except ConfigErrors as errors:
        return _failed(errors)
    except CannotWriteFiles as error:
        return _failed(error)
    except Missing as error:
        _failed(error)
        return 2
    for warning in report.warnings:
        print(f"warning: {warning}")
    return _checked(options.directory) or _next_steps(options, found)


def _benchmarks(config_dir: str) -> str:
    """Describe all benchmarks."""
    shipped = BenchmarksFile(os.path.join(config_dir, files.BENCHMARKS), Report()).by_code
    return "\n".join(f"  {code:7} {benchmark.desc}" for code, benchmark in shipped.items())


def _plan(report: Report, options: argparse.Namespace, found: Dict[str, object]) -> Optional[Plan]:
    """Make the plan from the sheet or from the answers."""
    if options.sheet:
        teams = found["teams"]
        known = None if teams is None else Known(teams, "the teams in --teams")
        plan = read_sheet(options.sheet, report, found["time-zone"], known)
        return plan if plan is None or teams is None else plan._replace(teams=teams)
    zones = answers.usual_zones(found["benchmarks"]) if found["zones"] is None else answers.share(
        report, Place("--zones", 0, 0), found["zones"], found["benchmarks"])
    report.raise_errors()
    days = [PlannedDay(day, found["begin"], found["end"], found["every"]) for day in found["days"]]
    return timetable(report, found["teams"], zones, days, found["time-zone"])


def _new(options: argparse.Namespace, config_dir: str, plan: Plan, found: Dict[str, object]) -> None:
    interface = next((i.name for i in interfaces() if i.broadcast == found["rsbb-host"]), None)
    hosts = Hosts(found["rsbb-host"], found["smartif-host"], interface)
    written = files.new_files(config_dir, plan, found["time-zone"], hosts)
    files.write_new(options.directory, written)
    print(f"Written to {options.directory}: {', '.join(written)}")


def _schedule_only(report: Report, options: argparse.Namespace, config_dir: str) -> int:
    """Replace the schedule of an existing competition from a sheet; its teams and benchmarks stay."""
    if not options.sheet:
        raise Missing("not given: --sheet, which --schedule-only needs")
    for question in QUESTIONS:
        if question.option != "time-zone" and getattr(options, question.option.replace("-", "_")) is not None:
            report.error(Place("--" + question.option, 0, 0), "this option together with --schedule-only",
                         "only --sheet and --time-zone")
    clock = read_clock(report, Place("--time-zone", 0, 0), options.time_zone or "local")
    benchmarks, passwords = (os.path.join(options.directory, name) for name in (files.BENCHMARKS, files.PASSWORDS))
    teams = PasswordsFile(passwords, report).by_team
    known = BenchmarksFile(benchmarks, report).by_code
    report.raise_errors()
    plan = read_sheet(options.sheet, report, clock, Known(list(teams), f"the teams of {passwords}"),
                      Known(list(known), f"the benchmarks of {benchmarks}"),
                      lambda code: code in known and known[code].kind is BenchmarkKind.ALL_ROBOTS)
    report.raise_errors()
    before = files.write_schedule(options.directory, config_dir, plan, clock)
    print(f"Written: {files.SCHEDULE} in {options.directory}" + (f"; the old one is {before}" if before else ""))
    for warning in report.warnings:
        print(f"warning: {warning}")
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
        print(f"new_competition: {line}", file=sys.stderr)
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
    print(f"Check the set-up: rosrun roah_rsbb preflight --rsbb-host {example} --competition "
          f"{shlex.quote(directory)}")
    print(f"Start the box: roslaunch {path}" + ("" if host else f" rsbb_host:={example}"))
    return 0
