"""`rosrun roah_rsbb rulebook` and `roah-rsbb rulebook`: what the rules of a folder leave to people, whether they do
what somebody computed by hand, and what a league's own rule book says (docs/rules.md)."""

import glob
import os
import sys
from typing import Callable, Dict, List, Optional

from roah_rsbb.ground.arguments import Parser, called
from roah_rsbb.ground.durable import write_file
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.model.rules import Sheet
from roah_rsbb.results.cases import CaseRules, answer, differences, read_cases, read_folder
from roah_rsbb.results.runs import NotPossible
from roah_rsbb.rulebook.config import BenchmarksFile
from roah_rsbb.rulebook.decisions import Decided, decided_in
from roah_rsbb.rulebook.errors import ConfigErrors, Report, quote
from roah_rsbb.rulebook.league_import import (
    ANSWERS,
    Lines,
    lines_of_league,
    lines_of_sheets,
    other_points,
    questions,
    questions_text,
    read_answers,
    reworded,
    rulebook_text,
)
from roah_rsbb.rulebook.league_import import differences as changed_rows
from roah_rsbb.rulebook.league_sheets import LEAGUES, LeagueBook, LeagueError, read_league_book
from roah_rsbb.rulebook.sheet_check import findings
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.earlier import sheet_of
from roah_rsbb.tools.competition.check import counted
from roah_rsbb.tools.competition.rulebooks import BENCHMARKS, STANDINGS, folder_of

PROGRAM = called("rulebook")
_DESCRIPTION = """\
Shows and checks the rules in a folder: benchmarks.yaml, standings.yaml, decisions.yaml, and cases in cases*.json.
"""
_EPILOG = f"""\
Examples:
  {PROGRAM} decisions athome2026     what the rules leave to people, and what is chosen
  {PROGRAM} check athome2026         the cases; rows, conditions and incidents in vain; totals
  {PROGRAM} import athome RuleBook comp    the words of RoboCup@Home's rule book for the rows of the folder comp
  {PROGRAM} diff RuleBook2025 RuleBook     what changed

FOLDER is a folder, or the name of an included rulebook. The exit status is 0 on success, 1 if the check found something
or the rules have errors, 2 for wrong usage.
"""

_IMPORT = f"""\
Reads the score sheets in RoboCup@Home's rule book (a checkout of its repository, of any year since 2017). Where FOLDER
has a benchmarks.yaml, its rows get the league's words, and what differs from the printed points is listed. Where it has
none, it is made of the sheets; {ANSWERS} in FOLDER says what they do not say, and is made as a list of questions first.
"""
_DIFF = "Lists in words which rows were added, removed, reworded, or changed their points."


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, what in (("decisions", "list what the rules leave to people"), ("check", "check the rules")):
        own = commands.add_parser(name, help=what, description=f"{what.capitalize()}.")
        own.add_argument("folder", metavar="FOLDER", help="a folder, or the name of an included rulebook")
    taken = commands.add_parser("import", help="read a league's own rule book", description=_IMPORT)
    taken.add_argument("league", choices=["athome"], metavar="LEAGUE", help="athome: RoboCup@Home")
    taken.add_argument("directory", metavar="DIRECTORY", help="a checkout of the repository RoboCupAtHome/RuleBook")
    taken.add_argument("folder", metavar="FOLDER", help="the folder of a competition or a rulebook, or a new one")
    diff = commands.add_parser("diff", help="what differs between two rule books", description=_DIFF)
    diff.add_argument("before", metavar="OLD", help="a folder with rules, an included rulebook, or a RuleBook")
    diff.add_argument("after", metavar="NEW", help="another one")
    for own in (taken, diff):
        own.add_argument("--robots", choices=LEAGUES, default=LEAGUES[0],
                         help="whose rows are taken where the rule book differs (default: %(default)s)")
    options = parser.parse_args(sys.argv[1:] if arguments is None else arguments)
    included = str(shipped_folder())
    work: Dict[str, Callable[[], int]] = {
        "decisions": lambda: _decisions(folder_of(included, options.folder)),
        "check": lambda: _check(folder_of(included, options.folder), included),
        "import": lambda: _import(options.directory, options.folder, options.robots),
        "diff": lambda: _diff(*(_lines(each, included, options.robots) for each in (options.before, options.after))),
    }
    try:
        status = work[options.command]()
    except (NotPossible, LeagueError) as error:
        print(error, file=sys.stderr)
        status = 1
    except ConfigErrors as error:
        print(f"the rules have errors:\n{error}", file=sys.stderr)
        status = 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has closed the pipe
        status = 1
    sys.exit(status)


def _decisions(folder: str) -> int:
    """List what the rules leave to people."""
    report = Report()
    found: Dict[str, List[Decided]] = {}
    for name in (BENCHMARKS, STANDINGS):
        for each in decided_in(report, os.path.join(folder, name)):
            found.setdefault(each.decision.name, []).append(each)
    report.raise_errors()
    if not found:
        print("The rules leave nothing to people.")
    for name, places in found.items():
        decision = places[0].decision
        default = "" if decision.chosen == decision.readings[0] else f"; the default is {quote(decision.readings[0])}"
        print(f"{name}: {quote(decision.chosen)}{default}")
        for place in places:
            print(f"  {', '.join(place.where)} ({os.path.basename(place.place.file)}:{place.place.line})")
            for reading, value in zip(decision.readings, place.values):
                print(f"    {'*' if reading == decision.chosen else ' '} {reading}: {value}")
    return 0


def _check(folder: str, included: str) -> int:
    """Check the rules; return 1 if something was found."""
    report = Report()
    benchmarks = BenchmarksFile(os.path.join(folder, BENCHMARKS), report).by_code
    report.raise_errors()
    if os.path.exists(os.path.join(folder, STANDINGS)):
        read_rules(os.path.join(folder, STANDINGS), list(benchmarks))
    found = [f"{code}: {text}" for code, benchmark in benchmarks.items() for text in findings(sheet_of(benchmark.form))]
    cases = _cases(folder, included)
    wrong = [text for texts in cases for text in texts]
    for text in (*found, *wrong, *report.warnings):
        print(text)
    rows = sum(len(sheet_of(benchmark.form).items) for benchmark in benchmarks.values())
    what = ", ".join((counted(len(benchmarks), "benchmark"), counted(rows, "row"), counted(len(cases), "case")))
    print(f"{what}: {len(found) + len(wrong) or 'nothing'} found")
    return 1 if found or wrong else 0


def _cases(folder: str, included: str) -> List[List[str]]:
    """Return of each case of the folder what differs from what it expects."""
    rules: Dict[str, CaseRules] = {}  # by the decisions of a case
    found: List[List[str]] = []
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "cases*.json"))):
        for number, case in enumerate(read_cases(path), 1):
            name = f"{os.path.basename(path)}, case {case.get('id', number)}"
            key = repr(case.get("decisions"))
            try:
                if key not in rules:
                    rules[key] = read_folder(folder, included, case.get("decisions", {}))
                wrong = differences(case, answer(case, rules[key]))
                wrong += [] if "expected" in case else ["nothing is expected: give 'expected' (docs/results.md)"]
            except NotPossible as error:
                wrong = [str(error)]
            found.append([f"{name}: {text}" for text in wrong])
    return found


def _sheets(folder: str) -> Dict[str, Sheet]:
    """Return the sheets of a folder by the titles of the tests."""
    report = Report()
    benchmarks = BenchmarksFile(os.path.join(folder, BENCHMARKS), report).by_code
    report.raise_errors()
    return {benchmark.desc: sheet_of(benchmark.form) for benchmark in benchmarks.values()}


def _lines(path: str, included: str, robots: str) -> Lines:
    if os.path.isdir(os.path.join(path, "scoresheets")):
        return lines_of_league(read_league_book(path, robots))
    return lines_of_sheets(_sheets(folder_of(included, path)))


def _diff(before: Lines, after: Lines) -> int:
    found = changed_rows(before, after)
    print("\n".join(found) if found else "No row differs.")
    return 0


def _import(directory: str, folder: str, robots: str) -> int:
    """Give a folder the league's words, or make a rulebook of its sheets."""
    book = read_league_book(directory, robots)
    for note in book.notes:
        print(note)
    path = os.path.join(folder, BENCHMARKS)
    return _reword(book, folder, path) if os.path.exists(path) else _make(book, folder, path)


def _write(path: str, content: str) -> None:
    try:
        write_file(path, content.encode("utf-8"), 0o644)
    except OSError as error:
        raise NotPossible(f"{path} cannot be written: {error.strerror}") from None


def _reword(book: LeagueBook, folder: str, path: str) -> int:
    _sheets(folder)  # its errors are said before anything is written
    with open(path, encoding="utf-8") as file:
        before = file.read()
    content, number = reworded(before, book)
    if not number:
        print(f"{path} has no row of these sheets: 'desc' of a test is the title of its sheet, and 'id' of a row its "
              "number", file=sys.stderr)
        return 1
    _write(f"{path}~", before)
    _write(path, content)
    print(f"{path}: {counted(number, 'row')} in the words of the league; before: {path}~")
    for text in other_points(_sheets(folder), book):
        print(f"  {text}")
    return 0


def _make(book: LeagueBook, folder: str, path: str) -> int:
    answers = os.path.join(folder, ANSWERS)
    os.makedirs(folder, exist_ok=True)
    if not os.path.exists(answers):
        _write(answers, questions_text(book))
        print(f"{answers} asks what the sheets do not say: answer there, and give the command again")
        return 1
    report = Report()
    found = read_answers(report, answers)
    report.raise_errors()
    missing = questions(book, found)
    if missing:
        print("\n".join([f"{answers} does not answer:", *(f"  {each}" for each in missing)]), file=sys.stderr)
        return 1
    _write(path, rulebook_text(book, found))
    print(f"{path}: {counted(len(_sheets(folder)), 'test')}")
    return 0
