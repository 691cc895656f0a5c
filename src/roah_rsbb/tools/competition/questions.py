"""What must be known of a new competition: options, and questions where a terminal is there to answer them."""

import argparse
import datetime
from typing import Callable, Dict, List, NamedTuple, Optional

from roah_rsbb.rulebook.benchmarks import KINDS
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.tools.competition import answers, moments
from roah_rsbb.tools.competition.answers import Reader


class Question(NamedTuple):
    """One thing to know. `default` None: it must be given; "": it may be left open."""

    option: str
    reader: Reader
    example: str
    help: str
    asks: str  # what is asked at a terminal; empty: only the option sets it
    default: Optional[str] = None
    of_sheet: bool = False  # a sheet says it


def _time(report: Report, place: Place, given: str) -> Optional[datetime.time]:
    return moments.read_time(report, place, given, "time")


QUESTIONS = (
    Question("teams", answers.read_teams, "'BrassButlers, CopperKettle'",
             "names of the teams, exactly as their robots announce them",
             "Teams, with commas between them, exactly as their robots announce them"),
    Question("benchmarks", answers.read_benchmarks, "HGTKMH,HWV,HNF",
             f"codes of the benchmarks to be held ({' '.join(KINDS)}), or 'tasks', or 'all'",
             "Benchmarks: codes with commas between them, or 'tasks' (the first three), or 'all'", of_sheet=True),
    Question("zones", answers.read_zones, "'Home: HGTKMH HWV, Arena: HNF'",
             "zones, which run side by side, each with a referee of its own; with the benchmarks of each, or without: "
             "then they are shared out (default: a zone for task benchmarks, one for the others)",
             "Zones, such as 'Home, Arena' or 'Home: HGTKMH HWV, Arena: HNF' (Enter: one for task benchmarks, one for "
             "the others)", "", True),
    Question("days", answers.read_days, "2026-11-28,2026-11-29", "days of the competition",
             "Days, such as 2026-11-28, 2026-11-29", of_sheet=True),
    Question("begin", _time, "09:00", "when the first run of a day begins (default: 09:00)",
             "First run of a day begins at (Enter: 09:00)", "09:00", True),
    Question("end", _time, "18:00", "when the last run of a day must be over (default: 18:00)", "", "18:00", True),
    Question("every", answers.read_minutes, "15", "minutes from the beginning of one run to the next (default: 15)", "",
             "15", True),
    Question("time-zone", moments.read_clock, "+01:00",
             "the venue's: local (this computer's, the default), UTC, or how far it is ahead of UTC, as +01:00", "",
             "local"),
    Question("rsbb-host", answers.read_address, "192.168.1.255",
             "broadcast address of the network with the robots, for the launch file",
             "Broadcast address of the network with the robots ('ip address' shows it as brd; Enter: give it at the "
             "start)", ""),
    Question("smartif-host", answers.read_address, "192.168.1.56",
             "address of the home devices' controller, for the launch file", "", ""),
)


class Missing(Exception):
    """Something is missing, and nobody is there to be asked; str() names the options."""


def known_answers(
    given: argparse.Namespace, report: Report, ask: Optional[Callable[[str], str]], say: Callable[[str], None],
    hints: Dict[str, str],
) -> Dict[str, object]:
    """The answer to each question by its option (None: left open), from options, a person (`ask`), or the defaults.

    What is wrong with options goes into the report. A person is asked again; `hints`, by option, are said before.
    `ask` None: nobody is there. With a sheet only what it does not say is looked for.
    """
    found: Dict[str, object] = {}
    missing: List[Question] = []
    for question in QUESTIONS:
        text = getattr(given, question.option.replace("-", "_"))
        place = Place("--" + question.option, 0, 0)
        if given.sheet and question.of_sheet:
            if text is not None:
                report.error(place, "this option beside --sheet", "one of both: the sheet says it")
            continue
        optional = question.default is not None or (given.sheet and question.option == "teams")
        if text is None and ask is not None and question.asks and not given.sheet:
            if question.option in hints:
                say(hints[question.option])
            found[question.option] = _asked(question, place, ask, say)
            continue
        if text is None and not optional:
            missing.append(question)
            continue
        text = text if text is not None else question.default
        found[question.option] = question.reader(report, place, text.strip()) if text else None
    if missing:
        wanted = " ".join(f"--{question.option} {question.example}" for question in missing)
        raise Missing(f"not given: {', '.join('--' + q.option for q in missing)}; for example: {wanted}\n"
                      "(or --sheet SHEET.csv; at a terminal it asks)")
    return found


def _asked(question: Question, place: Place, ask: Callable[[str], str], say: Callable[[str], None]) -> object:
    """Ask until the answer is right."""
    while True:
        text = ask(f"{question.asks}: ").strip() or question.default
        if text == "":
            return None
        report = Report()
        if text is None:
            report.error(place, "nothing", question.example)
        answer = None if text is None else question.reader(report, place, text)
        if not report.errors:
            return answer
        for error in report.errors:
            say(f"  found {error.found}; expected {error.expected}")
