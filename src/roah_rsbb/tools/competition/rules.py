"""`rosrun roah_rsbb rulebook` and `roah-rsbb rulebook`: what the rules of a folder leave to people, and whether they do
what somebody computed by hand (docs/rules.md)."""

import glob
import os
import sys
from typing import Dict, List, Optional

from roah_rsbb.ground.arguments import Parser, called
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.results.cases import CaseRules, answer, differences, read_cases, read_folder
from roah_rsbb.results.runs import NotPossible
from roah_rsbb.rulebook.config import BenchmarksFile
from roah_rsbb.rulebook.decisions import Decided, decided_in
from roah_rsbb.rulebook.errors import ConfigErrors, Report, quote
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

FOLDER is a folder, or the name of an included rulebook. The exit status is 0 on success, 1 if the check found something
or the rules have errors, 2 for wrong usage.
"""


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, what in (("decisions", "list what the rules leave to people"), ("check", "check the rules")):
        own = commands.add_parser(name, help=what, description=f"{what.capitalize()}.")
        own.add_argument("folder", metavar="FOLDER", help="a folder, or the name of an included rulebook")
    options = parser.parse_args(sys.argv[1:] if arguments is None else arguments)
    included = str(shipped_folder())
    folder = folder_of(included, options.folder)
    try:
        status = _decisions(folder) if options.command == "decisions" else _check(folder, included)
    except NotPossible as error:
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
            except NotPossible as error:
                wrong = [str(error)]
            found.append([f"{name}: {text}" for text in wrong])
    return found
