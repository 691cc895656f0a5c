"""Cases: what rules give for marks and incidents that somebody wrote down, without a box (docs/results.md, "Cases").

A case names a sheet by its title or its code, and has marks, incidents with their times, or several attempts. It may
choose readings of the choices that its rules leave to people. Another kind of case has the points of teams, and asks
for the standings.
"""

import json
import os
from decimal import Decimal
from fractions import Fraction
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.rules import Adjusted, AttemptsRule, Item, Measure, Sheet, Stage
from roah_rsbb.results.runs import NotPossible
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.decisions import beside
from roah_rsbb.rulebook.errors import ConfigErrors, known
from roah_rsbb.rulebook.standing_rules import StandingRules, read_rules
from roah_rsbb.scoring.points import number_of as decimal_of
from roah_rsbb.scoring.stages import Result, StageRanking, number_of, rank
from roah_rsbb.scoring.tree import ONE, Course, Happened, SheetMark, Worth, count, number_text
from roah_rsbb.wording.texts import did_you_mean

_DIGITS = 10  # of a number of a case
BENCHMARKS, STANDINGS = "benchmarks.yaml", "standings.yaml"
FREE = "other"  # id of the row that takes points with a reason
# What incidents are called where the event has another name; others have blanks for underscores.
_INCIDENTS = {
    "restart_request": "restart", "inactive_from": "inactive", "extension_request": "longer time",
    "timer_pause": "pause", "timer_resume": "resume",
}



class CaseRules(NamedTuple):
    """The rules of a folder."""

    benchmarks: Mapping[str, Benchmark]  # by code
    ranking: StandingRules


class CaseAnswer(NamedTuple):
    """What a case gives: points, or standings."""

    points: Fraction
    steps: Tuple[str, ...]
    standings: Optional[Mapping[str, Any]] = None  # totals, finalists and ranking

    def as_json(self) -> Dict[str, Any]:
        """Return it as other programs read it."""
        own = {"points": plain(self.points)} if self.standings is None else self.standings
        return {**own, "steps": list(self.steps)}


def read_folder(folder: str, included: str, decisions: Mapping[str, str]) -> CaseRules:
    """Read the rules of a folder, with these readings of choices instead of those of its file of decisions. The folder
    `included` has the files that it lacks."""
    benchmarks, standings = (
        next(filter(os.path.exists, (os.path.join(each, name) for each in (folder, included))), "")
        for name in (BENCHMARKS, STANDINGS))
    texts: Dict[str, str] = {}
    if decisions:
        for path in filter(None, (benchmarks, standings)):
            with open(path, encoding="utf-8") as file:
                texts[path] = file.read()
        texts[beside(benchmarks)] = json.dumps(_as(dict, decisions, "decisions"), ensure_ascii=False)
    try:
        with known(texts):
            found = load_benchmarks(benchmarks)
            ranking = read_rules(standings, list(found)) if standings else StandingRules()
    except ConfigErrors as errors:
        own = [error for error in errors.errors if decisions and error.file == beside(benchmarks)]
        if not own:
            raise
        raise NotPossible("'decisions' of the case: " + "; ".join(
            f"found {error.found}; expected {error.expected}" for error in own)) from None
    return CaseRules(found, ranking)


def answer(case: Mapping[str, Any], rules: CaseRules) -> CaseAnswer:
    """Return what the rules give for a case. Raises `NotPossible` if they do not fit together."""
    if case.get("kind") == "standings":
        return _standings(case, rules)
    benchmark = _benchmark(str(case.get("sheet", "")), rules)
    attempts = [_as(dict, each, "attempt") for each in _as(list, case.get("attempts") or [], "attempts")] or [case]
    worths = [_worth(attempt, benchmark) for attempt in attempts]
    if len(worths) == 1:
        found, steps = worths[0]
        return CaseAnswer(found.total + found.charged, steps)
    return _together(worths, benchmark, rules)


def differences(case: Mapping[str, Any], found: CaseAnswer) -> List[str]:
    """Return where an answer differs from the one that the case expects, in words."""
    if "expected" not in case:
        return []
    got = found.as_json()
    expected = case["expected"] if found.standings is not None else {"points": case["expected"]}
    return [f"{key} {got[key]}, expected {wanted}" for key, wanted in expected.items()
            if key in got and not _is_same(got[key], wanted)]


def plain(number: Fraction) -> Any:
    """Return a number for JSON: a whole one without decimals."""
    return int(number) if number.denominator == 1 else float(number)


def _is_same(got: Any, wanted: Any) -> bool:
    if isinstance(got, (int, float)) and isinstance(wanted, (int, float)):
        return abs(got - wanted) < 0.0005
    if isinstance(got, dict) and isinstance(wanted, dict):
        return got.keys() == wanted.keys() and all(_is_same(got[key], wanted[key]) for key in wanted)
    return bool(got == wanted)


# -- a sheet ----------------------------------------------------------------------------------------


def _benchmark(title: str, rules: CaseRules) -> Benchmark:
    names = {name.casefold(): each for each in rules.benchmarks.values() for name in (each.code, each.name, each.desc)}
    found = names.get(title.casefold())
    if found is None:
        titles = [each.desc for each in rules.benchmarks.values()]
        raise NotPossible(f"no sheet {title!r}{did_you_mean(title, titles)}")
    return found


def _worth(attempt: Mapping[str, Any], benchmark: Benchmark) -> Tuple[Worth, Tuple[str, ...]]:
    """Return what an attempt is worth, and the steps."""
    sheet = benchmark.sheet
    marks = [mark for entry in _as(list, attempt.get("marks") or [], "marks") for mark in _marks(entry, sheet)]
    events = _as(list, attempt.get("events") or [], "events")
    happened = [_happened(event)._replace(order=order) for order, event in enumerate(events)]
    names = {incident.name for incident in sheet.incidents}
    unknown = [f"{each.incident}: no rule about it" for each in happened if each.incident not in names]
    limit = Fraction(sheet.limit_s or 0)
    course = Course(tuple(marks), tuple(happened), ended=True, completed=bool(attempt.get("completed")),
                    elapsed_s=_seconds(attempt["elapsed"]) or limit if "elapsed" in attempt else limit)
    found = count(sheet, course)
    return found, (*found.steps, *unknown)


def _together(worths: Sequence[Tuple[Worth, Tuple[str, ...]]], benchmark: Benchmark, rules: CaseRules) -> CaseAnswer:
    """Return what several attempts give."""
    rule = rules.ranking[benchmark.code].attempts if benchmark.code in rules.ranking else AttemptsRule()
    steps: List[str] = []
    for number, (found, own) in enumerate(worths, start=1):
        steps += [f"Attempt {number}: {step}" for step in own]
        if found.replaces:
            steps.append(f"Attempt {number}: the attempts before it do not count")
    results = [Result(found.total, charged=found.charged, replaces=found.replaces) for found, _ in worths]
    points = number_of(rule, results)
    charged = sum((found.charged for found, _ in worths), Fraction(0))
    numbers = ", ".join(number_text(found.total) for found, _ in worths)
    steps.append(f"{rule} of {numbers}: {number_text(points - charged)}")
    return CaseAnswer(points, tuple(steps))


def _marks(entry: Sequence[Any], sheet: Sheet) -> List[SheetMark]:
    """Return a mark; several if it takes more points than one time of its row has."""
    if not isinstance(entry, list) or len(entry) < 2:
        raise NotPossible(f"{entry!r} is not a mark: write [name of the row, how often, {{options}}]")
    text, number, options = entry[0], entry[1], _as(dict, (*entry, {})[2] or {}, "options of a mark")
    item = _row(str(text), options, sheet)
    if item.amount is Measure.CLOCK:
        raise NotPossible(f"a mark of {item.name!r}, the time that was left: nobody marks it. Give 'elapsed', and "
                          "'completed' if the robot completed the run")
    mark = SheetMark(
        item.id, _number(number), text=str(options.get("choice", "")), at_s=_seconds(options.get("t")),
        refused=str(options.get("refused", "")), name=str(options.get("label", "")))
    amount = options.get("points", options.get("amount"))
    if amount is not None:
        return _of_amount(mark, _number(amount), item, sheet)
    if "percent" in options:
        share = _number(options["percent"]) / 100
        if not 0 <= share <= 1:
            raise NotPossible(f"{options['percent']!r} as 'percent' of a mark: write a number from 0 to 100")
        mark = mark._replace(share=share)
    return [mark]


def _row(text: str, options: Mapping[str, Any], sheet: Sheet) -> Item:
    """Return the row of a mark: by its number on the sheet, else by its name; points with a reason have their own."""
    rows = {item.id: item for item in sheet.items}
    found = rows.get(str(options["i"])) if "i" in options else rows.get(text) or next(
        (item for item in sheet.items if item.name == text), None) or ("label" in options and rows.get(FREE)) or None
    if found is None:
        names = (item.id if item.id == item.name else f"{item.id} ({item.name})" for item in sheet.items)
        raise NotPossible(f"no row {options.get('i', text)!r} on the sheet: its rows are {', '.join(names)}")
    return found


def _of_amount(mark: SheetMark, amount: Fraction, item: Item, sheet: Sheet) -> List[SheetMark]:
    """Return marks that are worth these points each."""
    if item.amount in (Measure.NUMBER, Measure.WHOLE):
        return [mark._replace(number=mark.number * amount)]
    if item.amount is Measure.POINTS:
        return [mark._replace(number=mark.number * amount / Fraction(item.points or 1))]
    base = item.points
    if item.percent is not None:  # of what the row above it is worth
        base = next((each.points for each in sheet.items if each.id == item.under), None)
    if not base:
        return [mark]
    times = abs(amount / Fraction(base))
    if item.amount is Measure.YES:
        return [mark._replace(share=min(ONE, times))]
    whole, rest = divmod(times, 1)
    shares = [(Fraction(whole), ONE), (ONE, rest)]
    return [mark._replace(number=mark.number * number, share=share) for number, share in shares if number and share]


def _happened(event: Any) -> Happened:
    event = _as(dict, event, "event")
    kind = str(event.get("type", ""))
    facts = {key.replace("_", " "): _fact(key, value) for key, value in event.items() if key not in ("t", "type")}
    return Happened(_INCIDENTS.get(kind, kind.replace("_", " ")), _seconds(event.get("t")), facts)


def _fact(key: str, value: Any) -> object:
    """Return a fact about an event: a number also where it is written as a text."""
    if value is None or isinstance(value, bool):
        return value
    if not isinstance(value, (str, int, float)):
        raise NotPossible(f"{value!r} as {key!r} of an event: write a number, a text, true or false")
    return _number(value) if not isinstance(value, str) or decimal_of(value) is not None else value


def _as(kind: type, value: Any, what: str) -> Any:
    """Return a value that has this kind."""
    if not isinstance(value, kind):
        expected = "a list [...]" if kind is list else "a map {...}"
        raise NotPossible(f"{value!r} as {what} of a case: write {expected} (docs/results.md)")
    return value


def _number(value: Any) -> Fraction:
    number = decimal_of(str(value))
    if number is None:
        raise NotPossible(f"{value!r} is not a number")
    if number and not -100 < number.adjusted() < _DIGITS:
        raise NotPossible(f"{value!r} is no number of a case: write one with less than {_DIGITS} digits")
    return Fraction(number)


def _seconds(time: Any) -> Optional[Fraction]:
    """Return a time of a run, such as 3:05, in seconds."""
    if time is None:
        return None
    seconds = Fraction(0)
    for part in str(time).split(":"):
        seconds = seconds * 60 + _number(part)
    return seconds


# -- standings --------------------------------------------------------------------------------------


def _standings(case: Mapping[str, Any], rules: CaseRules) -> CaseAnswer:
    """Return the standings of teams whose points are known."""
    stages = rules.ranking.stages
    if not stages:
        raise NotPossible("the rules have no stages: see 'stages' in standings.yaml (docs/results.md)")
    results: Dict[str, Dict[str, List[Result]]] = {}
    adjusted: List[Adjusted] = []
    teams = _as(dict, case.get("teams") or {}, "teams")
    for team, own in teams.items():
        own = _as(dict, own, f"the team {team}")
        for test, attempts in _as(dict, own.get("attempts") or {}, f"attempts of {team}").items():
            code = _benchmark(test, rules).code
            results.setdefault(code, {})[team] = _results(_as(list, attempts, f"attempts of {team} at {test}"))
        adjusted += [_adjusted(team, stages[0], given) for given in
                     _as(list, own.get("team_adjustments") or [], f"team_adjustments of {team}")]
    for team, points in _as(dict, case.get("final") or {}, "final").items():
        results.setdefault(_last_test(stages), {})[team] = _results([points])
    attempts_by_test = {code: own.attempts for code, own in rules.ranking.items()}
    ranked = rank(stages, results, attempts_by_test, adjusted, list(teams))
    return CaseAnswer(Fraction(0), tuple(text for each in ranked for text in (*each.notes, *each.steps)), {
        "totals": {line.team: plain(line.total) for line in ranked[0].lines if line.total is not None},
        "finalists": list(next((each.advance for each in ranked if each.stage.advance), ())),
        "ranking": _places(ranked[-1]),
    })


def _results(attempts: Sequence[Any]) -> List[Result]:
    """Return the attempts of a team: null is none."""
    return [Result(_number(points)) for points in attempts if points is not None]


def _adjusted(team: str, stage: Stage, given: Any) -> Adjusted:
    """Return what a team was given: by its name, or the adjustment that has these points."""
    if not isinstance(given, list) or not 1 <= len(given) <= 2:
        raise NotPossible(f"{given!r} as an adjustment of {team}: write [reason, points]")
    reason, number = str(given[0]), _number((*given, 0)[1] or 0)
    points = Decimal(number.numerator) / number.denominator
    names = [each.name for each in stage.adjustments if reason == each.name] or [
        each.name for each in stage.adjustments if each.points == points]
    return Adjusted(team, stage.name, names[0] if names else reason, points, reason)


def _last_test(stages: Sequence[Stage]) -> str:
    """Return the test that only those who advanced run."""
    tests = [column.test for stage in stages if stage.teams for column in stage.of if column.test]
    return tests[-1] if tests else ""


def _places(ranking: StageRanking) -> List[List[str]]:
    places: Dict[int, List[str]] = {}
    for line in ranking.lines:
        places.setdefault(line.place, []).append(line.team)
    return list(places.values())


# -- a file of cases --------------------------------------------------------------------------------


def read_cases(path: str) -> List[Mapping[str, Any]]:
    """Read the cases of a file: one, a list, or lists in a map."""
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
    except OSError as error:
        raise NotPossible(f"{path} cannot be read ({error.strerror}): give a file of cases") from None
    except ValueError as error:
        raise NotPossible(f"{path} is not JSON: {error}") from None
    if isinstance(found, dict):
        lists = [value for value in found.values() if isinstance(value, list) and "sheet" not in found]
        found = [each for part in lists for each in part] if "cases" in found or "standings" in found else [found]
    return [each for each in found if isinstance(each, dict)]
