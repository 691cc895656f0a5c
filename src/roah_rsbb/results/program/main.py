"""`rosrun roah_rsbb results` and `roah-rsbb results`: shows and exports the runs of a competition (docs/results.md)."""

import argparse
import importlib
import os
import sys
from typing import Any, Callable, List, NoReturn, Optional

from roah_rsbb.ground.arguments import Parser, called
from roah_rsbb.ground.installed import NotShipped, shipped_folder
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.processes import ProcessEnded
from roah_rsbb.journal.reader import JournalError
from roah_rsbb.model import run_log
from roah_rsbb.results.bags import bag_lines, making_bags, missing_bags
from roah_rsbb.results.mcap_file import NoMcap
from roah_rsbb.results.printing import CannotPrint
from roah_rsbb.results.program.journal import (
    BENCHMARKS_FILE,
    RULES_FILE,
    SCHEDULE_FILE,
    Usage,
    files_of,
    one_run,
    open_journal,
    warn,
)
from roah_rsbb.results.run_list import list_lines
from roah_rsbb.results.runs import NoSuchRun, RobotPart, RunResult, heads
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.run_logs.bag_file import write_bag, write_bags

LOG_DIR = "~/.ros/roah_rsbb"
OF_RUNS = ("best", "mean", "median")  # `OfRuns`, without loading what reads its rules

_DESCRIPTION = """\
Shows and exports the results of a competition from its journal, during the competition and afterwards.
"""
_EPILOG = """\
Examples:
  results list                                   all runs
  results show 3                                 the complete score sheet of run 3
  results export --html results                  a printable sheet for each run, and an index
  results export --pdf results --no-appendix     the same as PDF, one A4 page for each run
  results export --csv results.csv --json -      for spreadsheets and programs (- is standard output)
  results replay 3                               a page that plays run 3 again
  results blank --pdf blank.pdf                  empty score sheets of all events, to be filled in by hand
  results checklist                              which events have a signed-off result, and what is missing
  results report --html report                   a site of pages about the competition
  results standings HGTKMH --signed-off          ranking of the teams
  results --journal /media/usb/roah_rsbb_journal list
  results verify                                 whether the journal is whole

Times are those of the venue (time_zone in schedule.yaml) with their UTC offset; --utc shows UTC.
The journal is never changed.
The exit status is 0 on success, 1 if something cannot be read or written, 2 for wrong usage.
"""
_EXPORT = """\
Exports all runs, or the runs with these numbers or identities.
"""
_REPLAY = """\
Writes a page for each run (default: all runs), which plays it again in any browser, without a network: states, goals,
scores as they grew, strings of the robot, warnings and the link, with a video beside them.
"""
_REPORT = """\
Writes pages about a competition: standings, runs with their score sheets, teams, how often each item was achieved,
ends, delays, times of phases and goals, link quality, and missing signatures. With several competitions, it also
compares them.
"""
_STANDINGS = """\
Ranks the teams of all benchmarks, or of the given ones. Runs count if they started and ended. Of an event that was
repeated, the attempt counts that benchmarks.yaml says (attempt_counts; default: the last).
"""
_BLANK = """\
Writes a page for each event of the schedule, and one for each benchmark without an event: with the items of the score
sheet, and lines for times, remarks and signatures.
"""
_CHECKLIST = """\
Lists all events of the schedule: signed off (final, and public if the organisers publish results), not signed off, or
without a run. The exit status is 0 only if every event has a signed-off result, so scripts can wait for it.
"""
_BAG = """\
Writes a run's log (rosbag) from the journal, also that of a run that is not over. This needs no ROS.
"""
_RULES = """\
A YAML file defines how teams are ranked (docs/results.md, "Standings"). Benchmarks that it does not name are ranked by
the sum of the score sheet.
"""


class _NoBag(Exception):
    """The bag cannot be written. The text names the remedy."""


def main(arguments: Optional[List[str]] = None) -> NoReturn:
    """Run the program with its arguments (default: those of the process)."""
    if arguments is None:  # the process's own output, too
        sys.stdout.reconfigure(errors="backslashreplace")  # escape characters that this terminal cannot show
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    try:
        options.config_dir = str(shipped_folder())
        with files_of(options):
            status = options.do(options)
    except (JournalError, ProcessEnded, _NoBag, NoSuchRun, NoMcap, Usage, CannotPrint, NotShipped) as error:
        status = _fail(str(error))
    except ConfigErrors as error:
        status = _fail(f"a file of the competition is invalid:\n{error}")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has closed the pipe
        status = 0
    except OSError as error:
        status = _fail(f"{error.filename}: {error.strerror}: choose another place or free some space")
    sys.exit(status)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(called("results"), _DESCRIPTION, _EPILOG)
    parser.set_defaults(journal=None, log_dir=LOG_DIR, utc=False)
    _add_source(parser)
    commands = parser.add_subparsers(metavar="COMMAND", required=True, parser_class=_sub_parser)
    _add_views(commands)
    _add_recovery(commands)
    return parser


def _add_views(commands: Any) -> None:
    """Commands that show or export results."""
    listed = commands.add_parser("list", help="list all runs")
    listed.set_defaults(do=_list)
    show = commands.add_parser("show", help="show the complete score sheet of a run")
    show.add_argument("run", metavar="RUN", help="number in the list, identity, or beginning of the identity")
    show.set_defaults(do=_show)
    export = commands.add_parser("export", help="write files", description=_EXPORT, epilog=_RULES)
    export.add_argument("runs", metavar="RUN", nargs="*", help="only these runs")
    export.add_argument("--csv", metavar="FILE", help="one row for each scoring item and each value of a module")
    _add_decimal_comma(export)
    export.add_argument("--json", metavar="FILE", help="everything that is recorded")
    export.add_argument("--html", metavar="DIR", help="a printable score sheet for each run, and index.html")
    export.add_argument("--pdf", metavar="DIR", help="the same, printed by Chromium if it is installed")
    export.add_argument("--dataset", metavar="DIR", help="CSV tables with their description, for publication")
    export.add_argument("--mcap", metavar="DIR", help="the run logs with types of ROS 2, for Foxglove and ros2 bag")
    export.add_argument("--anonymous", action="store_true",
                        help="pseudonyms instead of names, addresses and free texts in the data set")
    export.add_argument("--licence", metavar="TEXT", default="", help="licence of the data set, such as CC-BY-4.0")
    export.add_argument("--no-appendix", action="store_true",
                        help="only the page that is signed, without the history and the link")
    _add_competition(export)
    replay = commands.add_parser("replay", help="write pages that play runs again", description=_REPLAY)
    replay.add_argument("runs", metavar="RUN", nargs="*", help="only these runs")
    replay.add_argument("--html", metavar="DIR", default=".", help="folder of the pages; default: the current one")
    replay.add_argument("--video", metavar="ADDRESS", default="",
                        help="show this video: a web address, or a path from the page's folder; only with one run")
    replay.set_defaults(do=_writing("replay"))
    _add_choice(export)
    export.set_defaults(do=_writing("export"))
    report = commands.add_parser("report", help="write a site of pages about a competition, or several",
                                 description=_REPORT, epilog=_RULES)
    report.add_argument("competitions", metavar="COMPETITION", nargs="*",
                        help="folder of a competition, log_dir, or journal; default: the journal in the log_dir")
    report.add_argument("--html", metavar="DIR", default="report", help="folder of the pages; default: report")
    report.add_argument("--no-replays", action="store_true", help="without a page for each run that plays it again")
    _add_competition(report)
    _add_choice(report)
    report.set_defaults(do=_writing("report"))
    ranks = commands.add_parser("standings", help="rank the teams", description=_STANDINGS, epilog=_RULES)
    ranks.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    ranks.add_argument("--csv", metavar="FILE")
    _add_decimal_comma(ranks)
    ranks.add_argument("--json", metavar="FILE")
    ranks.add_argument("--html", metavar="FILE", help="a page that can be printed")
    ranks.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    _add_competition(ranks)
    _add_choice(ranks)
    ranks.set_defaults(do=_writing("standings"))
    blank = commands.add_parser("blank", help="write empty score sheets, to be filled in by hand", description=_BLANK)
    blank.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    blank.add_argument("--html", metavar="FILE", help="a page that can be printed")
    blank.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    _add_competition(blank)
    _add_files(blank)
    blank.set_defaults(do=_writing("blank"))
    check = commands.add_parser("checklist", help="list what is signed off and what is missing", description=_CHECKLIST)
    check.add_argument("--missing", action="store_true", help="only events without a signed-off result")
    _add_files(check)
    check.set_defaults(do=_writing("checklist"))


def _add_recovery(commands: Any) -> None:
    """Commands that recover lost data, and look into the journal."""
    bag = commands.add_parser("bag", help="write a run's log (rosbag) from the journal", description=_BAG)
    bag.add_argument("run", metavar="RUN")
    bag.add_argument("bag", metavar="FILE")
    bag.add_argument("--port", type=int, help="port of the robot, if the run had several")
    bag.set_defaults(do=_bag)
    bags = commands.add_parser("bags", help="list the run logs (rosbags) of all runs, and what is missing")
    bags.add_argument("--make", action="store_true", help="make those that are missing of runs that are over")
    bags.set_defaults(do=_bags)
    journals = commands.add_parser("journals", help="list the journals in the log_dir, including old ones")
    journals.set_defaults(do=_writing("journals", "segments"))
    verify = commands.add_parser("verify", help="read all of the journal, and list what is damaged or missing")
    verify.set_defaults(do=_writing("verify", "segments"))
    dump = commands.add_parser("dump", help="print all records of the journal as text, or those of a run")
    dump.add_argument("run", metavar="RUN", nargs="?")
    dump.set_defaults(do=_writing("dump", "segments"))


def _add_source(parser: argparse.ArgumentParser) -> None:
    """Options that are allowed before and after the command."""
    parser.add_argument("--journal", metavar="FOLDER", default=argparse.SUPPRESS,
                        help=f"the journal; default: {JOURNAL} in the log_dir")
    parser.add_argument("--log-dir", metavar="DIR", default=argparse.SUPPRESS,
                        help=f"the box's log_dir; default: {LOG_DIR}")
    parser.add_argument("--utc", action="store_true", default=argparse.SUPPRESS, help="show times in UTC")


def _sub_parser(**options: str) -> Parser:
    parser = Parser(options["prog"], options.get("description", ""), options.get("epilog", ""))
    _add_source(parser)
    return parser


def _add_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--benchmarks-file", metavar="YAML", help=f"default: {BENCHMARKS_FILE} of the competition")
    parser.add_argument("--schedule-file", metavar="YAML", help=f"default: {SCHEDULE_FILE} of the competition")


def _add_decimal_comma(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--decimal-comma", action="store_true",
                        help="write 1,5 and semicolons into CSV, for spreadsheet programs in German, French and others")


def _add_competition(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--title", metavar="TEXT", default="", help="competition, at the top of each sheet")
    parser.add_argument("--logo", metavar="FILE", default="", help="its logo beside the title: a PNG, JPEG or SVG file")


def _add_choice(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rules", metavar="YAML",
                        help=f"rules of the ranking; default: {RULES_FILE} of the competition, or the included one")
    parser.add_argument("--benchmarks-file", metavar="YAML",
                        help=f"the benchmarks; default: {BENCHMARKS_FILE} of the competition")
    parser.add_argument("--runs", choices=OF_RUNS, dest="of_runs", default=None,
                        help="which of a team's runs counts; overrides the rules")
    parser.add_argument("--signed-off", action="store_true", help="count only signed-off runs in standings")
    parser.add_argument("--without", metavar="RUN", action="append", default=[],
                        help="exclude a run from standings; may be repeated")


# -- commands ---------------------------------------------------------------------------------------


def _writing(name: str, module: str = "files") -> Callable[[argparse.Namespace], int]:
    """Return a command of another module of this folder."""
    def do(options: argparse.Namespace) -> int:
        # Imported late: it loads what the list does not need.
        return getattr(importlib.import_module(f"roah_rsbb.results.program.{module}"), name)(options)

    return do


def _list(options: argparse.Namespace) -> int:
    reader = open_journal(options, checks_all=False)
    known = heads(reader, warn)
    if not known:
        print("There are no runs yet.")
        return 0
    from roah_rsbb.results.program.counting import words_of_heads  # imported late: it loads the rules of standings

    counts = words_of_heads(options, reader, known)
    print("\n".join(list_lines(known, options.utc, counts)))
    return 0


def _show(options: argparse.Namespace) -> int:
    reader = open_journal(options, checks_all=False)
    result = one_run(reader, options.run)
    # Imported late: they load the rules of standings.
    from roah_rsbb.results.program.counting import words_of_heads
    from roah_rsbb.results.sheet import sheet_lines

    counts = words_of_heads(options, reader, heads(reader, warn))
    result = result._replace(counts=counts.get(result.record.identity, ""))
    strike = sys.stdout.isatty()
    for text in sheet_lines(result, options.utc, strike):
        print(text)
    return 0


def _bag(options: argparse.Namespace) -> int:
    count = _write_bag(one_run(open_journal(options, checks_all=False), options.run), options.port, options.bag)
    print(f"{options.bag}: {count} messages")
    return 0


def _bags(options: argparse.Namespace) -> int:
    reader = open_journal(options, checks_all=False)
    if options.make:
        with making_bags(reader) as may_make:
            if not may_make:
                raise _NoBag("another program makes the bags just now: try again")
            write_bags(reader, missing_bags(reader))
    lines = list(bag_lines(reader))
    for text in lines:
        print(text)
    return 0


def _write_bag(result: RunResult, port: Optional[int], path: str) -> int:
    """Write the run log of a robot to a new bag; returns the number of messages. Raises `_NoBag`.

    `port`: private port of the robot; None if the run has only one robot.
    """
    if os.path.exists(path):
        raise _NoBag(f"{path}: this file already exists: choose another name")
    robot = _robot_of(result, port)
    entries = [(e.kind, e.value, e.utc) for e in result.entries if e.port == robot.port and e.kind in run_log.KINDS]
    write_bag(path, entries)
    return len(entries)


def _robot_of(result: RunResult, port: Optional[int]) -> RobotPart:
    robots: List[RobotPart] = [robot for robot in result.robots if port in (None, robot.port)]
    if len(robots) == 1:
        return robots[0]
    known = ", ".join(f"{robot.port} ({robot.robot} of team {robot.team})" for robot in result.robots)
    raise _NoBag(f"choose a robot with --port: {known or 'this run has none'}")


# -- shared -----------------------------------------------------------------------------------------


def _fail(text: str) -> int:
    warn(text)
    return 1
