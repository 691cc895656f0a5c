"""`rosrun roah_rsbb results`: shows and exports the runs of a competition (docs/results.md)."""

import argparse
import glob
import json
import os
import sys
from typing import Any, Callable, Dict, Iterable, Iterator, List, NoReturn, Optional, TextIO

from roah_rsbb.arguments import Parser
from roah_rsbb.core import run_log
from roah_rsbb.core.scoring.records import RunRecord
from roah_rsbb.journal.damage import text_of
from roah_rsbb.journal.file import FILE_NAME
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.recover import recover
from roah_rsbb.results import dataset
from roah_rsbb.results.anonymous import names_of
from roah_rsbb.results.bags import bag_lines
from roah_rsbb.results.checklist import check_lines, checklist
from roah_rsbb.results.dataset import write_dataset
from roah_rsbb.results.events import sections
from roah_rsbb.results.export import (
    RESULT_COLUMNS,
    STANDING_COLUMNS,
    exported,
    exported_standings,
    result_rows,
    standing_rows,
    write_table,
)
from roah_rsbb.results.page import Competition, page, picture_address
from roah_rsbb.results.paper import blank_front, front_markup
from roah_rsbb.results.printing import CannotPrint, Printer, browser, print_pdf
from roah_rsbb.results.replay_page import page_parts, replay_name, replay_of
from roah_rsbb.results.report.facts import facts_of
from roah_rsbb.results.report.pages import Compared, Site, all_pages, comparison
from roah_rsbb.results.report.plots import Assets, assets
from roah_rsbb.results.runs import (
    NoSuchRun,
    RobotPart,
    RunResult,
    file_name,
    find,
    find_record,
    heads,
    records,
    run_result,
)
from roah_rsbb.results.sheet import list_lines, sheet_lines, sheet_page
from roah_rsbb.results.standing_rules import OfRuns, Rules, read_rules
from roah_rsbb.results.standings import Choice, Standing, index_page, standing_lines, standings, standings_page
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.wording.times import date_time

LOG_DIR = "~/.ros/roah_rsbb"
RULES_FILE = "standings.yaml"
BENCHMARKS_FILE, SCHEDULE_FILE = "benchmarks.yaml", "schedule.yaml"

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
  results --journal /media/usb/roah_rsbb_journal.sqlite3 list

Times are local times with their UTC offset; --utc shows UTC. The journal is never changed.
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
repeated, only the last run counts.
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
Writes a run's log (rosbag) again from the journal, for example after it was lost. This needs ROS's Python modules,
but no ROS master.
"""
_RULES = """\
A YAML file defines how teams are ranked (docs/results.md, "Standings"). Benchmarks that it does not name are ranked by
the sum of the score sheet.
"""


class _NoBag(Exception):
    """The bag cannot be written. The text names the remedy."""


class _Usage(Exception):
    """The request cannot be fulfilled. The text names the remedy."""


def main(config_dir: str, arguments: Optional[List[str]] = None) -> NoReturn:
    """Run the program; `config_dir` contains the default rules of the standings."""
    if arguments is None:  # the process's own output, too
        sys.stdout.reconfigure(errors="backslashreplace")  # escape characters that this terminal cannot show
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    options.config_dir = config_dir
    try:
        status = options.do(options)
    except (JournalError, _NoBag, NoSuchRun, _Usage, CannotPrint) as error:
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
    parser = Parser("results", _DESCRIPTION, _EPILOG)
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
    export.add_argument("--json", metavar="FILE", help="everything that is recorded")
    export.add_argument("--html", metavar="DIR", help="a printable score sheet for each run, and index.html")
    export.add_argument("--pdf", metavar="DIR", help="the same, printed by Chromium if it is installed")
    export.add_argument("--dataset", metavar="DIR", help="CSV tables with their description, for publication")
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
    replay.set_defaults(do=_replay)
    _add_choice(export)
    export.set_defaults(do=_export)
    report = commands.add_parser("report", help="write a site of pages about a competition, or several",
                                 description=_REPORT, epilog=_RULES)
    report.add_argument("competitions", metavar="COMPETITION", nargs="*",
                        help="folder of a competition, log_dir, or journal; default: the journal in the log_dir")
    report.add_argument("--html", metavar="DIR", default="report", help="folder of the pages; default: report")
    report.add_argument("--no-replays", action="store_true", help="without a page for each run that plays it again")
    _add_competition(report)
    _add_choice(report)
    report.set_defaults(do=_report)
    ranks = commands.add_parser("standings", help="rank the teams", description=_STANDINGS, epilog=_RULES)
    ranks.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    ranks.add_argument("--csv", metavar="FILE")
    ranks.add_argument("--json", metavar="FILE")
    ranks.add_argument("--html", metavar="FILE", help="a page that can be printed")
    ranks.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    _add_competition(ranks)
    _add_choice(ranks)
    ranks.set_defaults(do=_standings)
    blank = commands.add_parser("blank", help="write empty score sheets, to be filled in by hand", description=_BLANK)
    blank.add_argument("benchmarks", metavar="CODE", nargs="*", help="only these benchmarks, such as HGTKMH")
    blank.add_argument("--html", metavar="FILE", help="a page that can be printed")
    blank.add_argument("--pdf", metavar="FILE", help="the same, printed by Chromium if it is installed")
    _add_competition(blank)
    _add_files(blank)
    blank.set_defaults(do=_blank)
    check = commands.add_parser("checklist", help="list what is signed off and what is missing", description=_CHECKLIST)
    check.add_argument("--missing", action="store_true", help="only events without a signed-off result")
    _add_files(check)
    check.set_defaults(do=_checklist)


def _add_recovery(commands: Any) -> None:
    """Commands that recover lost data."""
    bag = commands.add_parser("bag", help="write a run's log (rosbag) from the journal", description=_BAG)
    bag.add_argument("run", metavar="RUN")
    bag.add_argument("bag", metavar="FILE")
    bag.add_argument("--port", type=int, help="port of the robot, if the run had several")
    bag.set_defaults(do=_bag)
    bags = commands.add_parser("bags", help="list the run logs (rosbags) of all runs, and what is missing")
    bags.set_defaults(do=_bags)
    journals = commands.add_parser("journals", help="list the journals in the log_dir, including old ones")
    journals.set_defaults(do=_journals)
    recovery = commands.add_parser("recover", help="copy the readable part of a damaged journal into a new one")
    recovery.add_argument("damaged", metavar="FILE")
    recovery.add_argument("new", metavar="NEW_FILE")
    recovery.set_defaults(do=_recover)


def _add_source(parser: argparse.ArgumentParser) -> None:
    """Options that are allowed before and after the command."""
    parser.add_argument("--journal", metavar="FILE", default=argparse.SUPPRESS,
                        help=f"the journal; default: {FILE_NAME} in the log_dir")
    parser.add_argument("--log-dir", metavar="DIR", default=argparse.SUPPRESS,
                        help=f"the box's log_dir; default: {LOG_DIR}")
    parser.add_argument("--utc", action="store_true", default=argparse.SUPPRESS, help="show times in UTC")


def _sub_parser(**options: str) -> Parser:
    parser = Parser(options["prog"], options.get("description", ""), options.get("epilog", ""))
    _add_source(parser)
    return parser


def _add_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--benchmarks-file", metavar="YAML", help=f"default: {BENCHMARKS_FILE} beside the log_dir")
    parser.add_argument("--schedule-file", metavar="YAML", help=f"default: {SCHEDULE_FILE} beside the log_dir")


def _add_competition(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--title", metavar="TEXT", default="", help="competition, at the top of each sheet")
    parser.add_argument("--logo", metavar="FILE", default="", help="its logo beside the title: a PNG, JPEG or SVG file")


def _add_choice(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rules", metavar="YAML",
                        help=f"rules of the ranking; default: {RULES_FILE} beside the log_dir, or the included one")
    parser.add_argument("--benchmarks-file", metavar="YAML",
                        help=f"titles of the benchmarks; default: {BENCHMARKS_FILE} beside the log_dir")
    parser.add_argument("--runs", choices=[of.value for of in OfRuns], dest="of_runs", default=None,
                        help="which of a team's runs counts; overrides the rules")
    parser.add_argument("--signed-off", action="store_true", help="count only signed-off runs in standings")
    parser.add_argument("--without", metavar="RUN", action="append", default=[],
                        help="exclude a run from standings; may be repeated")


# -- commands ---------------------------------------------------------------------------------------


def _list(options: argparse.Namespace) -> int:
    with _open(options, checks_all=False) as reader:
        known = heads(reader, _warn)
    if not known:
        print("There are no runs yet.")
        return 0
    for text in list_lines(known, options.utc):
        print(text)
    return 0


def _show(options: argparse.Namespace) -> int:
    with _open(options, checks_all=False) as reader:
        result = _one_run(reader, options.run)
    strike = sys.stdout.isatty()
    for text in sheet_lines(result, options.utc, strike):
        print(text)
    return 0


def _export(options: argparse.Namespace) -> int:
    if not (options.csv or options.json or options.html or options.pdf or options.dataset):
        raise _Usage("choose what to write: --csv FILE, --json FILE, --html DIR, --pdf DIR, --dataset DIR, or several "
                     "of them")
    if (options.anonymous or options.licence) and not options.dataset:
        raise _Usage("--anonymous and --licence are for a data set: name its folder with --dataset DIR")
    if options.pdf:
        browser()  # before anything is written
    _competition(options)
    with _open(options) as reader:
        as_of = reader.as_of()
        known = records(reader, _warn)
        identities = [record.identity for record in known]
        places = sorted({find(identities, word) for word in options.runs}) if options.runs else range(len(known))
        chosen = [(place + 1, known[place]) for place in places]
        ranked = _ranked(options, known)
        if options.csv:
            _write(options.csv, lambda file: write_table(
                file, RESULT_COLUMNS, result_rows((r for _, r in chosen), options.utc)), "utf-8-sig")

        def results() -> Iterator[RunResult]:
            return (run_result(reader, number, record, _warn) for number, record in chosen)

        if options.json:
            value = exported(list(results()), ranked, reader.path, as_of)
            _write(options.json, lambda file: _dump(value, file))
        if options.dataset:
            os.makedirs(options.dataset, exist_ok=True)
            names = names_of(reader) if options.anonymous else None
            write_dataset(options.dataset, results(), dataset.Options(names, options.licence, options.title))
            print(f"the data set of {len(chosen)} runs is in {options.dataset}")
        if options.html:
            _write_pages(options, options.html, "html", _write_html, results(), chosen, ranked, as_of)
        if options.pdf:
            with Printer() as printer:
                _write_pages(options, options.pdf, "pdf", printer.print, results(), chosen, ranked, as_of)
    return 0


def _write_pages(
    options, folder: str, suffix: str, write: Callable[[str, str], None], results: Iterable[RunResult], chosen,
    ranked: List[Standing], as_of: float,
) -> None:
    rules, titles, competition = _rules(options), _titles(options), _competition(options)
    sheets: Dict[str, str] = {}
    os.makedirs(folder, exist_ok=True)
    for result in results:
        record = result.record
        sheets[record.identity] = name = f"{file_name(result.number, record)}.{suffix}"
        text = sheet_page(result, options.utc, rules.get(record.benchmark), titles.get(record.benchmark, ""),
                          not options.no_appendix, competition)
        write(text, os.path.join(folder, name))
    index = f"index.{suffix}"
    write(index_page(chosen, sheets, ranked, as_of, options.utc, competition), os.path.join(folder, index))
    print(f"{len(sheets)} score sheets and {index} are in {folder}")


def _replay(options: argparse.Namespace) -> int:
    if options.video and len(options.runs) != 1:
        raise _Usage("--video needs exactly one RUN, because each run has its own video")
    parts = page_parts(_resource(options, "replay"))
    os.makedirs(options.html, exist_ok=True)
    with _open(options) as reader:
        for identity in options.runs or reader.identities():
            result = run_result(reader, *find_record(reader, identity, _warn), _warn)
            path = os.path.join(options.html, replay_name(result.number, result.record))
            _write_html(replay_of(reader, result, parts, options.utc, _warn, options.video), path)
            print(path)
    return 0


def _report(options: argparse.Namespace) -> int:
    shared = assets(_resource(options, "report"))
    sources = [_journal_in(source) for source in options.competitions] or [options.journal]
    if len(sources) == 1:
        count = len(_write_site(options, sources[0], options.html, shared).runs)
        print(f"the report of {count} runs is in {os.path.join(options.html, 'index.html')}")
        return 0
    compared = []
    for number, (source, given) in enumerate(zip(sources, options.competitions), 1):
        name = os.path.basename(os.path.abspath(given))
        sub_folder = f"competition{number}"
        site = _write_site(options, source, os.path.join(options.html, sub_folder), shared, "../index.html")
        compared.append(Compared(f"{number}. {name}", f"{sub_folder}/index.html", site))
    _write_html(comparison(compared, shared), os.path.join(options.html, "index.html"))
    print(f"the reports of {len(sources)} competitions are in {os.path.join(options.html, 'index.html')}")
    return 0


def _resource(options: argparse.Namespace, name: str) -> str:
    """Return a folder in the package's folder resource."""
    return os.path.join(os.path.dirname(os.path.abspath(options.config_dir)), "resource", name)


def _journal_in(source: str) -> str:
    """Return the journal of a competition's folder, of a log_dir, or the journal itself."""
    places = (source, os.path.join(source, FILE_NAME), os.path.join(source, "log", FILE_NAME))
    found = next((path for path in places if os.path.isfile(path)), None)
    if found is None:
        raise _Usage(f"{source}: there is no journal: name the folder of a competition, a log_dir, or a journal")
    return found


def _write_site(
    options: argparse.Namespace, journal: Optional[str], folder: str, shared: Assets, home: str = ""
) -> Site:
    """Write the pages of a competition."""
    options = argparse.Namespace(**{**vars(options), "journal": journal})
    rules, titles, competition = _rules(options), _titles(options), _competition(options)
    parts = None if options.no_replays else page_parts(_resource(options, "replay"))
    os.makedirs(os.path.join(folder, "runs"), exist_ok=True)
    sheets: Dict[str, str] = {}
    replays: Dict[str, str] = {}
    runs = []
    with _open(options) as reader:
        known = records(reader, _warn)
        ranked = _ranked(options, known)
        for number, record in enumerate(known, 1):
            result = run_result(reader, number, record, _warn)
            shown = sections(result)
            runs.append(facts_of(result, sum(event.bad for section in shown for event in section.events)))
            sheets[record.identity] = name = f"runs/{file_name(number, record)}.html"
            _write_html(sheet_page(result, options.utc, rules.get(record.benchmark), titles.get(record.benchmark, ""),
                                   competition=competition, shown=shown), os.path.join(folder, name))
            if parts is not None:
                replays[record.identity] = name = f"runs/{replay_name(number, record)}"
                _write_html(replay_of(reader, result, parts, options.utc, _warn), os.path.join(folder, name))
        as_of = reader.as_of()
    site = Site(runs, ranked, sheets, replays, titles, as_of, options.utc, shared, competition, home)
    for name, text in all_pages(site).items():
        _write_html(text, os.path.join(folder, name))
    return site


def _write_html(text: str, path: str) -> None:
    _write(path, lambda file: file.write(text))


def _standings(options: argparse.Namespace) -> int:
    with _open(options, checks_all=False) as reader:
        ranked = _ranked(options, records(reader, _warn))
        path, as_of = reader.path, reader.as_of()
    codes = [standing.benchmark for standing in ranked]
    unknown = [code for code in options.benchmarks if code not in codes]
    if unknown:
        raise _Usage(f"there are no runs of {', '.join(unknown)}; there are some of {', '.join(codes) or 'none'}")
    if options.benchmarks:
        ranked = [standing for standing in ranked if standing.benchmark in options.benchmarks]
    if options.csv:
        _write(options.csv, lambda file: write_table(
            file, STANDING_COLUMNS, standing_rows(ranked)), "utf-8-sig")
    if options.json:
        _write(options.json, lambda file: _dump(exported_standings(ranked, path, as_of), file))
    _write_page(options, standings_page(ranked, as_of, options.utc, _competition(options)))
    if not (options.csv or options.json or options.html or options.pdf):
        for standing in ranked:
            for text in standing_lines(standing):
                print(text)
        if not ranked:
            print("No run has started yet.")
    return 0


def _blank(options: argparse.Namespace) -> int:
    if not (options.html or options.pdf):
        raise _Usage("choose what to write: --html FILE, --pdf FILE, or both")
    benchmarks, plans = config.load_schedule(_file(options, BENCHMARKS_FILE), _file(options, SCHEDULE_FILE))
    unknown = [code for code in options.benchmarks if code not in benchmarks]
    if unknown:
        raise _Usage(f"there is no benchmark {', '.join(unknown)}; there are {', '.join(benchmarks)}")
    events = [(plan.name, event) for plan in plans for event in plan.events]
    events.sort(key=lambda line: line[1].scheduled)
    with_event = {event.benchmark.code for _, event in events}
    sheets = [blank_front(event.benchmark, zone, event, options.utc) for zone, event in events
              if not options.benchmarks or event.benchmark.code in options.benchmarks]
    sheets += [blank_front(benchmark) for code, benchmark in benchmarks.items()
               if (code in options.benchmarks or not options.benchmarks) and code not in with_event]
    competition = _competition(options)
    _write_page(options, page("Score sheets", *(
        front_markup(front._replace(competition=competition)) for front in sheets)))
    print(f"{len(sheets)} empty score sheets are in {' and '.join(filter(None, (options.html, options.pdf)))}")
    return 0


def _checklist(options: argparse.Namespace) -> int:
    _, plans = config.load_schedule(_file(options, BENCHMARKS_FILE), _file(options, SCHEDULE_FILE))
    with _open(options) as reader:
        lines = checklist(plans, records(reader, _warn), options.utc)
    shown = [line for line in lines if not (options.missing and line.is_final)]
    for text in check_lines(shown, options.utc):
        print(text)
    return 0 if all(line.is_final for line in lines) else 1


def _bag(options: argparse.Namespace) -> int:
    with _open(options, checks_all=False) as reader:
        count = _write_bag(_one_run(reader, options.run), options.port, options.bag)
    print(f"{options.bag}: {count} messages")
    return 0


def _bags(options: argparse.Namespace) -> int:
    with _open(options, checks_all=False) as reader:
        lines = list(bag_lines(reader))
    for text in lines:
        print(text)
    return 0


def _write_bag(result: RunResult, port: Optional[int], path: str) -> int:
    """Write the run log of a robot to a new bag; returns the number of messages. Raises `_NoBag`.

    `port`: private port of the robot; None if the run has only one robot.
    """
    try:
        from roah_rsbb.run_logs.bag_file import WRITE_ERRORS, write_whole
    except ImportError as error:
        raise _NoBag(
            f"a bag cannot be written here ({error}): use a computer with ROS and a copy of the journal"
        ) from None
    if os.path.exists(path):
        raise _NoBag(f"{path}: this file already exists: choose another name")
    robot = _robot_of(result, port)
    entries = [(e.kind, e.value, e.utc) for e in result.entries if e.port == robot.port and e.kind in run_log.KINDS]
    try:
        write_whole(path, entries)
    except WRITE_ERRORS as error:
        raise _NoBag(f"{path}: {error}: choose another place or free some space") from None
    return len(entries)


def _robot_of(result: RunResult, port: Optional[int]) -> RobotPart:
    robots: List[RobotPart] = [robot for robot in result.robots if port in (None, robot.port)]
    if len(robots) == 1:
        return robots[0]
    known = ", ".join(f"{robot.port} ({robot.robot} of team {robot.team})" for robot in result.robots)
    raise _NoBag(f"choose a robot with --port: {known or 'this run has none'}")


def _journals(options: argparse.Namespace) -> int:
    log_dir = os.path.expanduser(options.log_dir)
    base, suffix = os.path.splitext(FILE_NAME)
    paths = sorted(glob.glob(os.path.join(glob.escape(log_dir), f"{base}*{suffix}")))
    if not paths:
        raise _Usage(f"there are no journals in {log_dir}: give the box's log_dir with --log-dir DIR")
    for path in paths:
        try:
            with JournalReader(path) as reader:
                known, sessions = records(reader, lambda _: None), reader.sessions()
        except JournalError as error:
            print(error)
            continue
        begun = f"started {date_time(sessions[0].utc, options.utc)}" if sessions else "empty"
        last = f", last connected {date_time(known[-1].opened_utc, options.utc)}" if known else ""
        print(f"{path}: {begun}, {len(known)} runs{last}")
    return 0


def _recover(options: argparse.Namespace) -> int:
    counts, damage = recover(options.damaged, options.new)
    for missing in damage:
        _warn(f"not recovered: {text_of(missing)}")
    found = ", ".join(f"{count} of {name}" for name, count in counts.items())
    print(f"{options.new}: {found}. Read it with --journal {options.new}")
    return 0


# -- shared -----------------------------------------------------------------------------------------


def _open(options: argparse.Namespace, checks_all: bool = True) -> JournalReader:
    """Open the journal. `checks_all`: check all of a large one for damage, which takes seconds."""
    reader = JournalReader(options.journal or os.path.join(os.path.expanduser(options.log_dir), FILE_NAME), checks_all)
    try:
        _warn_of_damage(reader, reader.damage)
    except JournalError:
        reader.close()
        raise
    return reader


def _one_run(reader: JournalReader, word: str) -> RunResult:
    """Read the run with this number, identity or beginning of the identity."""
    number, record = find_record(reader, word, _warn)
    _warn_of_damage(reader, reader.damage_of(record.identity))
    return run_result(reader, number, record, _warn)


def _warn_of_damage(reader: JournalReader, damage: List[str]) -> None:
    for text in damage:
        _warn(f"{reader.path} is damaged: {text}. More may be recovered with: rosrun roah_rsbb results recover "
              f"'{reader.path}' NEW_FILE")


def _rules(options: argparse.Namespace) -> Dict[str, Rules]:
    return read_rules(options.rules or _beside(options, RULES_FILE) or os.path.join(options.config_dir, RULES_FILE))


def _file(options: argparse.Namespace, name: str) -> str:
    """The path of a file of the competition: the option's, or the one beside the log_dir, else the included one."""
    given = getattr(options, name.replace(".yaml", "_file"))
    return given or _beside(options, name) or os.path.join(options.config_dir, name)


def _beside(options: argparse.Namespace, name: str) -> Optional[str]:
    """The path of a file of the competition beside the log_dir; None if it does not exist."""
    log_dir = os.path.dirname(options.journal) if options.journal else os.path.expanduser(options.log_dir)
    beside = os.path.join(os.path.dirname(os.path.abspath(log_dir)), name)
    return beside if os.path.exists(beside) else None


def _titles(options: argparse.Namespace) -> Dict[str, str]:
    return {code: benchmark.desc or benchmark.name for code, benchmark in _benchmarks(options).items()}


def _benchmarks(options: argparse.Namespace) -> Dict[str, Benchmark]:
    return config.load_benchmarks(_file(options, BENCHMARKS_FILE))


def _competition(options: argparse.Namespace) -> Competition:
    try:
        return Competition(options.title, picture_address(options.logo) if options.logo else "")
    except ValueError as error:
        raise _Usage(str(error)) from None
    except OSError as error:
        raise _Usage(f"{options.logo}: {error.strerror}: choose another picture with --logo") from None


def _write_page(options: argparse.Namespace, text: str) -> None:
    """Write a page as the options say."""
    if options.html:
        _write_html(text, options.html)
    if options.pdf:
        print_pdf(text, options.pdf)


def _ranked(options: argparse.Namespace, known: List[RunRecord]) -> List[Standing]:
    identities = [record.identity for record in known]
    without = tuple(identities[find(identities, word)] for word in options.without)
    of_runs = OfRuns(options.of_runs) if options.of_runs else None
    events = {code: benchmark.rules for code, benchmark in _benchmarks(options).items()}
    return standings(known, _rules(options), Choice(options.signed_off, without, of_runs, events), _titles(options))


def _write(path: str, write: Callable[[TextIO], object], encoding: str = "utf-8") -> None:
    """Write a complete file, or leave the old one unchanged; `-` is standard output."""
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
