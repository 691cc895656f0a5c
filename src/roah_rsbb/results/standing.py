"""The standing of a benchmark: its teams in their order, and the runs that they owe it to."""

import json
import math
import statistics
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.scoring.records import RunRecord, ScoreValue
from roah_rsbb.results.standing_rules import DEFAULT, Criterion, OfRuns, Rules, Term
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, KINDS

# Sums of weighted values that differ by less are the same.
DIGITS = 9

# A number for each criterion; None: there is none, which is worse than any.
Numbers = Tuple[Optional[float], ...]


class Choice(NamedTuple):
    """Which runs count."""

    signed_off: bool = False  # only those whose sheet is signed off
    without: Tuple[str, ...] = ()  # identities of runs that do not
    of_runs: Optional[OfRuns] = None  # instead of what the rules say


class RunLine(NamedTuple):
    """A run in a standing."""

    record: RunRecord
    disqualified: bool
    numbers: Numbers


class TeamLine(NamedTuple):
    """A team in a standing."""

    rank: int
    tied: bool  # another team has the same rank
    team: str
    numbers: Numbers
    disqualified: bool  # all that counts is disqualified
    runs: Tuple[RunLine, ...]  # that count, in their order
    best: Optional[int]  # the place in `runs` of the best one; None: not the best one counts


class Standing(NamedTuple):
    """The standing of a benchmark."""

    benchmark: str  # code
    of_runs: OfRuns
    criteria: Tuple[Criterion, ...]
    lines: Tuple[TeamLine, ...]
    remarks: Tuple[str, ...]  # what whoever reads it should know


def standings(records: Sequence[RunRecord], rules: Dict[str, Rules], choice: Choice) -> List[Standing]:
    """The standings of all benchmarks that have a run that counts, in the order of the benchmarks."""
    codes = {record.benchmark for record in records}
    found = [standing(code, records, rules.get(code, DEFAULT), choice) for code in KINDS if code in codes]
    return [s for s in found if s.lines or s.remarks]


def standing(code: str, records: Sequence[RunRecord], rules: Rules, choice: Choice) -> Standing:
    """The standing of one benchmark."""
    of_runs = choice.of_runs or rules.of_runs
    remarks: List[str] = []
    records = [record for record in records if record.benchmark == code]
    if any(record.team == ALL_TEAMS and record.started_utc for record in records):
        remarks.append("all robots run at once: the box has no score of each team")
    by_team: Dict[str, List[RunLine]] = {}
    for record in _counting([record for record in records if record.team != ALL_TEAMS], choice, remarks):
        by_team.setdefault(record.team, []).append(_run_line(record, rules, remarks))
    lines = [_team_line(team, runs, of_runs, rules.criteria) for team, runs in by_team.items()]
    return Standing(code, of_runs, rules.criteria, _ranked(lines, rules.criteria), tuple(dict.fromkeys(remarks)))


def _counting(records: List[RunRecord], choice: Choice, remarks: List[str]) -> List[RunRecord]:
    """Runs that were started and are over; of an event that was run again only the last one."""
    newest: Dict[Tuple[object, ...], RunRecord] = {}
    for record in sorted(records, key=lambda r: r.opened_utc):
        if not record.started_utc or record.identity in choice.without:
            continue
        if not record.end_reason:
            remarks.append(f"run {record.identity} goes on: it counts when it is over")
            continue
        if choice.signed_off and record.sign_off is None:
            remarks.append(f"run {record.identity} of team {record.team} is not signed off: it does not count")
            continue
        event = (record.zone, record.team, record.round, record.run, record.scheduled)
        if event in newest:
            again = newest[event].identity
            remarks.append(f"run {again} of team {record.team} was run again: only the last one counts")
        newest[event] = record
    remarks += [
        f"run {record.identity} of team {record.team} is not signed off: it may still change"
        for record in newest.values() if record.sign_off is None
    ]
    return list(newest.values())


# -- the numbers of a run ---------------------------------------------------------------------------


def _run_line(record: RunRecord, rules: Rules, remarks: List[str]) -> RunLine:
    disqualified = any(item.value and item.group in rules.disqualified_by for item in record.items)
    missing: Dict[str, None] = {}
    numbers = tuple(_number(record, criterion, missing) for criterion in rules.criteria)
    if missing:
        names = ", ".join(f"'{name}'" for name in missing)
        remarks.append(f"run {record.identity} of team {record.team} has no {names}")
    return RunLine(record, disqualified, numbers)


def _number(record: RunRecord, criterion: Criterion, missing: Dict[str, None]) -> Optional[float]:
    parts = [_term(record, term, missing) for term in criterion.terms]
    return None if None in parts else round(sum(parts), DIGITS) + 0.0


def _term(record: RunRecord, term: Term, missing: Dict[str, None]) -> Optional[float]:
    """`missing` takes the names of what the run has nothing of: items count as 0 then, values as none."""
    if term.score:
        value = next((s for s in record.module_scores if not s.group and s.name == term.score), None)
        if value is None:
            missing[term.score] = None
            return None
        number = _module_number(value)
        return None if number is None else term.weight * number
    items = [i for i in record.items if term.group in ("", i.group) and term.item in ("", i.desc)]
    if not items and (term.group or term.item):
        missing[term.item or term.group] = None
    return term.weight * sum(item.value for item in items)


def _module_number(score: ScoreValue) -> Optional[float]:
    """A module's value as a number; None: it has none, or it is a text."""
    try:
        value = json.loads(score.value)
    except ValueError:
        return None
    if not isinstance(value, (bool, int, float)) or not math.isfinite(value):
        return None
    return float(value)


# -- the numbers of a team --------------------------------------------------------------------------


def _key(numbers: Numbers, disqualified: bool, criteria: Sequence[Criterion]) -> Tuple[float, ...]:
    """The smaller, the better."""
    worth = [
        math.inf if number is None else -number if criterion.more_is_better else number
        for number, criterion in zip(numbers, criteria)
    ]
    return (1.0, *[0.0 for _ in worth]) if disqualified else (0.0, *worth)


def _team_line(team: str, runs: List[RunLine], of_runs: OfRuns, criteria: Sequence[Criterion]) -> TeamLine:
    disqualified = all(run.disqualified for run in runs)
    if of_runs is OfRuns.BEST:
        best = min(range(len(runs)), key=lambda i: _key(runs[i].numbers, runs[i].disqualified, criteria))
        return TeamLine(0, False, team, runs[best].numbers, disqualified, tuple(runs), best)
    together = statistics.mean if of_runs is OfRuns.MEAN else statistics.median
    numbers = tuple(_together(together, [_of_run(run, i, c) for run in runs]) for i, c in enumerate(criteria))
    return TeamLine(0, False, team, numbers, disqualified, tuple(runs), None)


def _of_run(run: RunLine, place: int, criterion: Criterion) -> Optional[float]:
    """What a run brings into the mean: one that is disqualified has nothing of what is good."""
    if run.disqualified:
        return 0.0 if criterion.more_is_better else None
    return run.numbers[place]


def _together(of: Callable[[List[float]], float], numbers: List[Optional[float]]) -> Optional[float]:
    known = [number for number in numbers if number is not None]
    return round(of(known), DIGITS) + 0.0 if known else None


def _ranked(lines: List[TeamLine], criteria: Sequence[Criterion]) -> Tuple[TeamLine, ...]:
    keys = {line.team: _key(line.numbers, line.disqualified, criteria) for line in lines}
    ordered = sorted(lines, key=lambda line: (keys[line.team], line.team))
    all_keys = [keys[line.team] for line in ordered]
    return tuple(
        line._replace(rank=all_keys.index(keys[line.team]) + 1, tied=all_keys.count(keys[line.team]) > 1)
        for line in ordered
    )
