"""`rosrun roah_rsbb results`: shows and exports what remains of a competition's runs (docs/results.md)."""

import argparse
import glob
import json
import os
import re
import sys
import time
from typing import Any, Callable, Dict, List, NoReturn, Optional, TextIO

from roah_rsbb.arguments import Parser
from roah_rsbb.core import run_log
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.recover import recover
from roah_rsbb.results import json_export, standing_texts, tables, text_sheet
from roah_rsbb.results.html_sheet import sheet_page
from roah_rsbb.results.run_result import NoSuchRun, RobotPart, RunResult, find, records, run_result
from roah_rsbb.results.standing import Choice, Standing, standings
from roah_rsbb.results.standing_rules import OfRuns, Rules, read_rules
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.wording import result_texts

LOG_DIR = "~/.ros/roah_rsbb"
RULES_FILE = "standings.yaml"

_DESCRIPTION = """\
Shows and exports the results of a competition from its journal: while the box runs, and of past competitions.
"""
_EPILOG = """\
Examples:
  results list                                   all runs
  results show 3                                 the whole score sheet of the third one
  results export --html results                  a printable sheet for each run, and a page that leads to them
  results export --csv results.csv --json -      for spreadsheets, and for programs (- is the standard output)
  results standings HGTKMH --signed-off          who is first
  results --journal /media/usb/roah_rsbb_journal.sqlite3 list

Times are local ones with their offset; --utc shows UTC. Nothing is ever changed in a journal.
The exit status is 0 if all is well, 1 if something cannot be read or written, 2 for wrong usage.
"""
_EXPORT = """\
Exports all runs, or those that are named by their number or identity.
"""
_STANDINGS = """\
Ranks the teams of each benchmark, or of those that are named. Counted are runs that were started and are over; of
an event that was run again only the last one.
"""
_BAG = """\
Writes a bag with all that belongs into a run's log, where that was lost. It needs ROS's Python, but no ROS master.
"""
_RULES = """\
How teams are ranked is in a YAML file (docs/results.md, "Standings"); a benchmark that is not in it is ranked by the
sum of the score sheet.
"""


class _NoBag(Exception):
    """The bag cannot be written; the text names the remedy."""


class _Usage(Exception):
    """What is asked for cannot be; the text names the remedy."""


def main(config_dir: str, arguments: Optional[List[str]] = None) -> NoReturn:
    """Run the program; `config_dir` has the shipped rules of the standings."""
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    options.config_dir = config_dir
    sys.stdout.reconfigure(errors="backslashreplace")  # whatever this terminal cannot show
    try:
        status = options.do(options)
    except (JournalError, _NoBag, NoSuchRun, _Usage) as error:
        status = _fail(str(error))
    except ConfigErrors as error:
        status = _fail(f"the rules of the standings cannot be used:\n{error}")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nobody reads on
        status = 0
    except OSError as error:
        status = _fail(f"{error.filename}: {error.strerror}: name another place, or make room there")
    sys.exit(status)


def _parser() -> argparse.ArgumentParser:
    parser = Parser("results", _DESCRIPTION, _EPILOG)
    parser.set_defaults(journal=None, log_dir=LOG_DIR, utc=False)
    _add_source(parser)
    commands = parser.add_subparsers(metavar="COMMAND", required=True, parser_class=_sub_parser)
    _add_views(commands)
    _add_mending(commands)
    return parser


def _add_views(commands: Any) -> None:
    """What shows or exports results."""
    listed = commands.add_parser("list", help="all runs, one a line")
    listed.set_defaults(do=_list)
    show = commands.add_parser("show", help="the whole score sheet of a run")
    show.add_argument("run", metavar="RUN", help="number in the list, or identity, or the beginning of that")
    show.set_defaults(do=_show)
    export = commands.add_parser("export", help="write files", description=_EXPORT, epilog=_RULES)
    export.add_argument("runs", metavar="RUN", nargs="*", help="only these runs")
    export.add_argument("--csv", metavar="FILE", help="a row for each scoring item and module's value")
    export.add_argument("--json", metavar="FILE", help="all that there is")
    export.add_argument("--html", metavar="DIR", help="a printable score sheet for each run, and index.html")
    _add_choice(export)
    export.set_defaults(do=_export)
    ranks = commands.add_parser("standings", help="who is first", description=_STANDINGS, epilog=_RULES)
    ranks.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    ranks.add_argument("--csv", metavar="FILE")
    ranks.add_argument("--json", metavar="FILE")
    ranks.add_argument("--html", metavar="FILE", help="a page that can be printed")
    _add_choice(ranks)
    ranks.set_defaults(do=_standings)


def _add_mending(commands: Any) -> None:
    """What helps where something was lost."""
    bag = commands.add_parser("bag", help="write a run's log (rosbag) from the journal", description=_BAG)
    bag.add_argument("run", metavar="RUN")
    bag.add_argument("bag", metavar="FILE")
    bag.add_argument("--port", type=int, help="the robot's, where several were in the run")
    bag.set_defaults(do=_bag)
    journals = commands.add_parser("journals", help="the journals in the log_dir, also those that were put aside")
    journals.set_defaults(do=_journals)
    recovery = commands.add_parser("recover", help="take what can be read of a damaged journal into a new one")
    recovery.add_argument("damaged", metavar="FILE")
    recovery.add_argument("new", metavar="NEW_FILE")
    recovery.set_defaults(do=_recover)


def _add_source(parser: argparse.ArgumentParser) -> None:
    """What may stand before and after the command."""
    parser.add_argument("--journal", metavar="FILE", default=argparse.SUPPRESS,
                        help=f"the journal; default: {FILE_NAME} in the log_dir")
    parser.add_argument("--log-dir", metavar="DIR", default=argparse.SUPPRESS,
                        help=f"the box's log_dir; default: {LOG_DIR}")
    parser.add_argument("--utc", action="store_true", default=argparse.SUPPRESS, help="show times in UTC")


def _sub_parser(**options: str) -> Parser:
    parser = Parser(options["prog"], options.get("description", ""), options.get("epilog", ""))
    _add_source(parser)
    return parser


def _add_choice(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rules", metavar="YAML", help=f"how teams are ranked; default: the shipped {RULES_FILE}")
    parser.add_argument("--runs", choices=[of.value for of in OfRuns], dest="of_runs", default=None,
                        help="which of a team's runs counts in a standing, instead of what the rules say")
    parser.add_argument("--signed-off", action="store_true", help="only runs that are signed off count in standings")
    parser.add_argument("--without", metavar="RUN", action="append", default=[],
                        help="a run that does not count in standings; may be given several times")


# -- commands ---------------------------------------------------------------------------------------


def _list(options: argparse.Namespace) -> int:
    with _open(options) as reader:
        known = records(reader, _warn)
    if not known:
        print("There are no runs yet.")
        return 0
    for text in text_sheet.list_lines(known, options.utc):
        print(text)
    return 0


def _show(options: argparse.Namespace) -> int:
    with _open(options) as reader:
        known = records(reader, _warn)
        place = find(known, options.run)
        result = run_result(reader, place + 1, known[place], _warn)
    strike = sys.stdout.isatty()
    for text in text_sheet.sheet_lines(result, options.utc, strike):
        print(text)
    return 0


def _export(options: argparse.Namespace) -> int:
    if not (options.csv or options.json or options.html):
        raise _Usage("say what to write: --csv FILE, --json FILE or --html DIR (several are possible)")
    now = time.time()
    with _open(options) as reader:
        known = records(reader, _warn)
        places = sorted({find(known, word) for word in options.runs}) if options.runs else range(len(known))
        chosen = [(place + 1, known[place]) for place in places]
        ranked = _ranked(options, known)
        if options.csv:
            _write(options.csv, lambda file: tables.write_table(
                file, tables.RESULT_COLUMNS, tables.result_rows((r for _, r in chosen), options.utc)), "utf-8-sig")
        results = (run_result(reader, number, record, _warn) for number, record in chosen)
        if options.json:
            value = json_export.exported(list(results), ranked, reader.path, now)
            _write(options.json, lambda file: _dump(value, file))
            results = (run_result(reader, number, record, _warn) for number, record in chosen)
        if options.html:
            _write_pages(options, results, chosen, ranked, now)
    return 0


def _write_pages(options, results, chosen, ranked: List[Standing], now: float) -> None:
    sheets: Dict[str, str] = {}
    os.makedirs(options.html, exist_ok=True)
    for result in results:
        sheets[result.record.identity] = name = _file_name(result)
        _write(os.path.join(options.html, name), lambda file, r=result: file.write(sheet_page(r, options.utc)))
    index = standing_texts.index_page(chosen, sheets, ranked, now, options.utc)
    _write(os.path.join(options.html, "index.html"), lambda file: file.write(index))
    print(f"{len(sheets)} score sheets and index.html are in {options.html}")


def _file_name(result: RunResult) -> str:
    record = result.record
    words = (f"{result.number:03d}", record.benchmark, record.team, f"round{record.round}", f"run{record.run}")
    return "_".join(re.sub(r"[^A-Za-z0-9-]", "-", word)[:60] for word in words) + ".html"


def _standings(options: argparse.Namespace) -> int:
    with _open(options) as reader:
        ranked = _ranked(options, records(reader, _warn))
        path = reader.path
    codes = [standing.benchmark for standing in ranked]
    unknown = [code for code in options.benchmarks if code not in codes]
    if unknown:
        raise _Usage(f"there are no runs of {', '.join(unknown)}; there are some of {', '.join(codes) or 'none'}")
    if options.benchmarks:
        ranked = [standing for standing in ranked if standing.benchmark in options.benchmarks]
    now = time.time()
    if options.csv:
        _write(options.csv, lambda file: tables.write_table(
            file, tables.STANDING_COLUMNS, tables.standing_rows(ranked)), "utf-8-sig")
    if options.json:
        _write(options.json, lambda file: _dump(json_export.exported_standings(ranked, path, now), file))
    if options.html:
        _write(options.html, lambda file: file.write(standing_texts.standings_page(ranked, now, options.utc)))
    if not (options.csv or options.json or options.html):
        for standing in ranked:
            for text in standing_texts.standing_lines(standing):
                print(text)
        if not ranked:
            print("There is no run yet that was started.")
    return 0


def _bag(options: argparse.Namespace) -> int:
    with _open(options) as reader:
        known = records(reader, _warn)
        place = find(known, options.run)
        count = _write_bag(run_result(reader, place + 1, known[place], _warn), options.port, options.bag)
    print(f"{options.bag}: {count} messages")
    return 0


def _write_bag(result: RunResult, port: Optional[int], path: str) -> int:
    """Write a new bag with all that belongs into the run log of a robot; returns the number of messages.

    `port`: of the robot; None: the run has only one. Raises `_NoBag`.
    """
    try:
        from roah_rsbb.run_logs.bag_file import WRITE_ERRORS, write_whole
    except ImportError as error:
        raise _NoBag(
            f"a bag cannot be written here ({error}): do it on a computer with ROS, from a copy of the journal"
        ) from None
    if os.path.exists(path):
        raise _NoBag(f"{path}: there is such a file already: name another one")
    robot = _robot_of(result, port)
    entries = [(e.kind, e.value, e.utc) for e in result.entries if e.port == robot.port and e.kind in run_log.KINDS]
    try:
        write_whole(path, entries)
    except WRITE_ERRORS as error:
        raise _NoBag(f"{path}: {error}: name another place, or make room there") from None
    return len(entries)


def _robot_of(result: RunResult, port: Optional[int]) -> RobotPart:
    robots: List[RobotPart] = [robot for robot in result.robots if port in (None, robot.port)]
    if len(robots) == 1:
        return robots[0]
    known = ", ".join(f"{robot.port} ({robot.robot} of team {robot.team})" for robot in result.robots)
    raise _NoBag(f"say which robot's log it shall be, with --port: {known or 'this run has none'}")


def _journals(options: argparse.Namespace) -> int:
    log_dir = os.path.expanduser(options.log_dir)
    base, suffix = os.path.splitext(FILE_NAME)
    paths = sorted(glob.glob(os.path.join(glob.escape(log_dir), f"{base}*{suffix}")))
    if not paths:
        raise _Usage(f"there are no journals in {log_dir}: name the box's log_dir with --log-dir DIR")
    for path in paths:
        try:
            with JournalReader(path) as reader:
                known, sessions = records(reader, lambda _: None), reader.sessions()
        except JournalError as error:
            print(error)
            continue
        begun = f"begun {result_texts.moment(sessions[0].utc, options.utc)}" if sessions else "empty"
        last = f", last connected {result_texts.moment(known[-1].opened_utc, options.utc)}" if known else ""
        print(f"{path}: {begun}, {len(known)} runs{last}")
    return 0


def _recover(options: argparse.Namespace) -> int:
    counts = recover(options.damaged, options.new)
    found = ", ".join(f"{count} of {name}" for name, count in counts.items())
    print(f"{options.new}: {found}. Read it with --journal {options.new}")
    return 0


# -- shared -----------------------------------------------------------------------------------------


def _open(options: argparse.Namespace) -> JournalReader:
    return JournalReader(options.journal or os.path.join(os.path.expanduser(options.log_dir), FILE_NAME))


def _ranked(options: argparse.Namespace, known: List[RunRecord]) -> List[Standing]:
    rules: Dict[str, Rules] = read_rules(options.rules or os.path.join(options.config_dir, RULES_FILE))
    without = tuple(known[find(known, word)].identity for word in options.without)
    of_runs = OfRuns(options.of_runs) if options.of_runs else None
    return standings(known, rules, Choice(options.signed_off, without, of_runs))


def _write(path: str, write: Callable[[TextIO], object], encoding: str = "utf-8") -> None:
    """Write a file whole, or leave what is there; `-` is the standard output."""
    if path == "-":
        write(sys.stdout)
        return
    draft = f"{path}.draft"
    try:
        with open(draft, "w", encoding=encoding, errors="backslashreplace", newline="") as file:
            write(file)
        os.replace(draft, path)
    except BaseException:
        if os.path.exists(draft):
            os.remove(draft)
        raise


def _dump(value: object, file: TextIO) -> None:
    json.dump(value, file, ensure_ascii=False, indent=1)
    file.write("\n")


def _warn(text: str) -> None:
    print(f"results: {text}", file=sys.stderr)


def _fail(text: str) -> int:
    _warn(text)
    return 1
