"""`rosrun roah_rsbb results` and `roah-rsbb results`: shows and exports the runs of a competition (docs/results.md)."""

import argparse
import sys
from typing import Any, List, NoReturn, Optional

from roah_rsbb.ground.arguments import Parser, called
from roah_rsbb.journal.log_dir import JOURNAL

LOG_DIR = "~/.ros/roah_rsbb"
OF_RUNS = ("best", "last", "first", "sum", "mean", "median")  # `Attempts`, without loading what reads its rules

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
  results try case.json                          what the rules give for marks that are written down

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
_TRY = """\
Computes cases without a box: marks and incidents of a run, several attempts, or the points of teams (docs/results.md,
"Cases"). FILE is JSON, a case or a list of cases, or the league's scores.csv: an attempt of a team a row. The exit
status is 1 if a case expects something else.
"""
_BAG = """\
Writes a run's log (rosbag) from the journal, also that of a run that is not over. This needs no ROS.
"""
_RULES = """\
A YAML file defines how teams are ranked (docs/results.md, "Standings"). Benchmarks that it does not name are ranked by
the sum of the score sheet.
"""


def main(arguments: Optional[List[str]] = None) -> NoReturn:
    """Run the program with its arguments (default: those of the process)."""
    if arguments is None:  # the process's own output, too
        sys.stdout.reconfigure(errors="backslashreplace")  # escape characters that this terminal cannot show
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    from roah_rsbb.results.program import commands  # imported late: help and wrong usage are answered at once

    sys.exit(commands.run(options))


def _parser() -> argparse.ArgumentParser:
    parser = Parser(called("results"), _DESCRIPTION, _EPILOG)
    parser.set_defaults(journal=None, log_dir=LOG_DIR, utc=False, module="commands")
    _add_source(parser)
    commands = parser.add_subparsers(metavar="COMMAND", required=True, parser_class=_sub_parser)
    _add_views(commands)
    _add_recovery(commands)
    return parser


def _add_views(commands: Any) -> None:
    """Commands that show or export results."""
    listed = commands.add_parser("list", help="list all runs")
    listed.set_defaults(command="list_runs")
    show = commands.add_parser("show", help="show the complete score sheet of a run")
    show.add_argument("run", metavar="RUN", help="number in the list, identity, or beginning of the identity")
    show.set_defaults(command="show")
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
    replay.set_defaults(command="replay", module="files")
    _add_choice(export)
    export.set_defaults(command="export", module="files")
    report = commands.add_parser("report", help="write a site of pages about a competition, or several",
                                 description=_REPORT, epilog=_RULES)
    report.add_argument("competitions", metavar="COMPETITION", nargs="*",
                        help="folder of a competition, log_dir, or journal; default: the journal in the log_dir")
    report.add_argument("--html", metavar="DIR", default="report", help="folder of the pages; default: report")
    report.add_argument("--no-replays", action="store_true", help="without a page for each run that plays it again")
    _add_competition(report)
    _add_choice(report)
    report.set_defaults(command="report", module="files")
    ranks = commands.add_parser("standings", help="rank the teams", description=_STANDINGS, epilog=_RULES)
    ranks.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    ranks.add_argument("--csv", metavar="FILE")
    _add_decimal_comma(ranks)
    ranks.add_argument("--json", metavar="FILE")
    ranks.add_argument("--html", metavar="FILE", help="a page that can be printed")
    ranks.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    ranks.add_argument("--tables", metavar="DIR", help="scores.csv, scores.md and standings.md, as of RoboCup@Home")
    _add_competition(ranks)
    _add_choice(ranks)
    ranks.set_defaults(command="standings", module="files")
    blank = commands.add_parser("blank", help="write empty score sheets, to be filled in by hand", description=_BLANK)
    blank.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    blank.add_argument("--html", metavar="FILE", help="a page that can be printed")
    blank.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    _add_competition(blank)
    _add_files(blank)
    blank.set_defaults(command="blank", module="files")
    check = commands.add_parser("checklist", help="list what is signed off and what is missing", description=_CHECKLIST)
    check.add_argument("--missing", action="store_true", help="only events without a signed-off result")
    _add_files(check)
    check.set_defaults(command="checklist", module="files")
    tried = commands.add_parser("try", help="compute points of marks that are written down", description=_TRY)
    tried.add_argument("file", metavar="FILE")
    tried.add_argument("--rulebook", metavar="NAME", default="",
                       help="an included rulebook, or the folder of a competition; default: that of the case")
    tried.add_argument("--json", action="store_true", help="points and steps for programs")
    tried.set_defaults(command="try_cases", module="trying")


def _add_recovery(commands: Any) -> None:
    """Commands that recover lost data, and look into the journal."""
    bag = commands.add_parser("bag", help="write a run's log (rosbag) from the journal", description=_BAG)
    bag.add_argument("run", metavar="RUN")
    bag.add_argument("bag", metavar="FILE")
    bag.add_argument("--port", type=int, help="port of the robot, if the run had several")
    bag.set_defaults(command="bag")
    bags = commands.add_parser("bags", help="list the run logs (rosbags) of all runs, and what is missing")
    bags.add_argument("--make", action="store_true", help="make those that are missing of runs that are over")
    bags.set_defaults(command="bags")
    journals = commands.add_parser("journals", help="list the journals in the log_dir, including old ones")
    journals.set_defaults(command="journals")
    verify = commands.add_parser("verify", help="read all of the journal, and list what is damaged or missing")
    verify.set_defaults(command="verify")
    dump = commands.add_parser("dump", help="print all records of the journal as text, or those of a run")
    dump.add_argument("run", metavar="RUN", nargs="?")
    dump.set_defaults(command="dump")


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
    parser.add_argument("--benchmarks-file", metavar="YAML", help="default: benchmarks.yaml of the competition")
    parser.add_argument("--schedule-file", metavar="YAML", help="default: schedule.yaml of the competition")


def _add_decimal_comma(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--decimal-comma", action="store_true",
                        help="write 1,5 and semicolons into CSV, for spreadsheet programs in German, French and others")


def _add_competition(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--title", metavar="TEXT", default="", help="competition, at the top of each sheet")
    parser.add_argument("--logo", metavar="FILE", default="", help="its logo beside the title: a PNG, JPEG or SVG file")


def _add_choice(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rules", metavar="YAML",
                        help="rules of the ranking; default: standings.yaml of the competition, or the included one")
    parser.add_argument("--benchmarks-file", metavar="YAML",
                        help="the benchmarks; default: benchmarks.yaml of the competition")
    parser.add_argument("--runs", choices=OF_RUNS, dest="of_runs", default=None,
                        help="which of a team's runs counts; overrides the rules")
    parser.add_argument("--signed-off", action="store_true", help="count only signed-off runs in standings")
    parser.add_argument("--without", metavar="RUN", action="append", default=[],
                        help="exclude a run from standings; may be repeated")
