"""The standing of a benchmark: its teams, ranked, with the runs that count; as data, as text and as pages."""

import json
import math
import statistics
from decimal import ROUND_HALF_UP, Decimal
from typing import Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.scoring.records import NOT_RUN, ItemRecord, RunRecord, ScoreValue
from roah_rsbb.results.page import NO_COMPETITION, Child, Competition, Markup, joined, page, table, tag
from roah_rsbb.results.runs import run_state_text, signature_of
from roah_rsbb.results.standing_rules import (
    BY_POINTS,
    DEFAULT,
    TOTAL,
    Criterion,
    Normalised,
    OfRuns,
    Overall,
    Part,
    Rules,
    StandingRules,
    Term,
    day_of,
)
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, NO_RULES, CountingAttempt, EventRules, NoShow
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.wording import sheets
from roah_rsbb.wording.sheets import NOT_SIGNED_OFF, end_reason, turn
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING, date_time

# Sums of weighted values are rounded to this many decimals, so that rounding errors do not decide.
DIGITS = 9
# Numbers of overall standings are rounded to this, so that the shown numbers add up.
_THOUSANDTH = Decimal("0.001")
WITHOUT_RULES = (
    "no rules rank this benchmark: all items of its sheet are added up, and penalties raise the sum. Give its items "
    "points (docs/organiser.md), or write its criteria into the file with the standings' rules (docs/results.md)"
)

NO_TITLES: Mapping[str, str] = {}
NO_EVENT_RULES: Mapping[str, EventRules] = {}

# The names of the ends of runs whose team did not appear or withdrew.
_NOT_RUN = frozenset(reason.name.lower() for reason in NOT_RUN)

# A number for each criterion; None (missing) is worse than any number.
Numbers = Tuple[Optional[float], ...]


class Choice(NamedTuple):
    """Which runs count."""

    signed_off: bool = False  # only those whose sheet is signed off
    without: Tuple[str, ...] = ()  # identities of excluded runs
    of_runs: Optional[OfRuns] = None  # overrides the rules
    events: Mapping[str, EventRules] = NO_EVENT_RULES  # which attempts at an event count, by the benchmarks' codes


class RankedRun(NamedTuple):
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
    disqualified: bool  # all its runs are disqualified
    runs: Tuple[RankedRun, ...]  # those that count, in order
    best: Optional[int]  # index in `runs` of the best run; None: mean or median counts


class Standing(NamedTuple):
    """The standing of a benchmark."""

    benchmark: str  # code
    of_runs: OfRuns
    criteria: Tuple[Criterion, ...]
    lines: Tuple[TeamLine, ...]
    remarks: Tuple[str, ...]  # notes for the reader
    units: Tuple[str, ...]  # of each criterion; empty: a plain number
    title: str = ""  # what the benchmark is called; empty: not known
    counting: str = ""  # of an overall standing, what counts; empty: that of `of_runs`


def standings(
    records: Sequence[RunRecord], rules: Dict[str, Rules], choice: Choice, titles: Mapping[str, str] = NO_TITLES
) -> List[Standing]:
    """Return the standings of all benchmarks with runs: in the order of the benchmarks, unknown ones last. Overall
    standings come first.

    `titles`: what the benchmarks are called, by their codes.
    """
    codes = {record.benchmark for record in records}
    ordered = [code for code in PROFILES if code in codes] + sorted(codes.difference(PROFILES))
    found = [
        standing(code, records, rules.get(code), choice)._replace(title=titles.get(code, ""))
        for code in ordered
    ]
    overall = rules.overall if isinstance(rules, StandingRules) else ()
    found = [*(overall_standing(each, records, rules, choice) for each in overall), *found]
    return [s for s in found if s.lines or s.remarks]


def rules_for(records: Sequence[RunRecord], rules: Optional[Rules]) -> Rules:
    """Return the rules of a benchmark. None: points count if its sheets give any, else the sum of the sheet."""
    if rules is not None:
        return rules
    return BY_POINTS if any(record.points is not None for record in records) else DEFAULT


def standing(code: str, records: Sequence[RunRecord], rules: Optional[Rules], choice: Choice) -> Standing:
    """Return the standing of one benchmark. `rules`: None if the rules' file does not name it."""
    remarks: List[str] = []
    records = [record for record in records if record.benchmark == code]
    rules = rules_for(records, rules)
    of_runs = choice.of_runs or rules.of_runs
    if any(record.team == ALL_TEAMS and record.started_utc for record in records):
        remarks.append("all robots run at once: there is no score for each team")
    by_team: Dict[str, List[RankedRun]] = {}
    event_rules = choice.events.get(code, NO_RULES)
    for attempts in _attempts([record for record in records if record.team != ALL_TEAMS], choice, remarks):
        lines = _counting([_run_line(record, rules, remarks) for record in attempts], event_rules, rules, remarks)
        if lines:
            by_team.setdefault(attempts[0].team, []).extend(lines)
    lines = [_team_line(team, runs, of_runs, rules.criteria) for team, runs in by_team.items()]
    if rules is DEFAULT and any(run.record.items for runs in by_team.values() for run in runs):
        remarks.append(WITHOUT_RULES)
    units = tuple(_unit(criterion, records) for criterion in rules.criteria)
    return Standing(
        code, of_runs, rules.criteria, _ranked(lines, rules.criteria), tuple(dict.fromkeys(remarks)), units
    )


def standing_of_run(record: RunRecord, rules: Optional[Rules]) -> Standing:
    """Return a standing of one run only, with its numbers."""
    rules = rules_for([record], rules)
    line = _team_line(record.team, [_run_line(record, rules, [])], OfRuns.BEST, rules.criteria)
    units = tuple(_unit(criterion, [record]) for criterion in rules.criteria)
    return Standing(record.benchmark, OfRuns.BEST, rules.criteria, (line,), (), units)


def _unit(criterion: Criterion, records: Sequence[RunRecord]) -> str:
    """The unit of a criterion that is one value of the module; empty: a sum, a count, or not known."""
    if len(criterion.terms) != 1 or abs(criterion.terms[0].weight) != 1.0:
        return ""
    name = criterion.terms[0].score
    units = {s.unit for r in records for s in r.module_scores if name and not s.group and s.name == name}
    return units.pop() if len(units) == 1 else ""


def _attempts(records: List[RunRecord], choice: Choice, remarks: List[str]) -> List[List[RunRecord]]:
    """Return the attempts at each event that may count, the oldest first."""
    by_event: Dict[Tuple[object, ...], List[RunRecord]] = {}
    for record in sorted(records, key=lambda r: r.opened_utc):
        if not (record.started_utc or record.end_reason in _NOT_RUN) or record.identity in choice.without:
            continue
        if not record.end_reason:
            remarks.append(f"run {record.identity} is still running: it does not count yet")
            continue
        if choice.signed_off and record.sign_off is None:
            remarks.append(f"run {record.identity} of team {record.team} is not signed off and does not count")
            continue
        event = (record.zone, record.team, record.round, record.run, record.scheduled)
        by_event.setdefault(event, []).append(record)
    return list(by_event.values())


def _counting(attempts: List[RankedRun], event: EventRules, rules: Rules, remarks: List[str]) -> List[RankedRun]:
    """Return the attempts at an event that count. A no-show or withdrawal only counts if nothing else was run."""
    found = [run for run in attempts if run.record.end_reason not in _NOT_RUN]
    if not found:
        zero = RankedRun(attempts[-1].record, False, tuple(0.0 for _ in rules.criteria))
        found = [zero] if event.no_show is NoShow.ZERO else []
        last = attempts[-1].record
        scored = "counts as 0" if found else "no score"
        remarks.append(f"team {last.team}, {turn(last.round, last.run)}: {end_reason(last.end_reason)}, {scored}")
    if len(found) > 1 and event.counting is not CountingAttempt.ALL:
        kept = len(found) - 1
        if event.counting is CountingAttempt.BEST:
            keys = [_key(run.numbers, run.disqualified, rules.criteria) for run in found]
            kept = keys.index(min(keys))
        remarks += [
            f"run {run.record.identity} of team {run.record.team} was repeated: only the {event.counting.value} run "
            "counts" for i, run in enumerate(found) if i != kept
        ]
        found = found[kept:kept + 1]
    remarks += [
        f"run {run.record.identity} of team {run.record.team} is not signed off and may still change"
        for run in found if run.record.sign_off is None
    ]
    return found


# -- overall standings ------------------------------------------------------------------------------


COUNTING = {
    Normalised.BEST: "weighted sum of the benchmarks, each relative to its best team",
    Normalised.MAXIMUM: "weighted sum of the benchmarks, each relative to its maximum",
    Normalised.NO: "weighted sum of the benchmarks",
}


def overall_standing(
    overall: Overall, records: Sequence[RunRecord], rules: Mapping[str, Rules], choice: Choice
) -> Standing:
    """Return an overall standing. A team that has no run in a benchmark, or is disqualified, gets 0 there."""
    remarks: List[str] = []
    columns = [_column(part, overall.normalised, records, rules, choice, remarks) for part in overall.parts]
    teams = sorted({team for column in columns for team in column})
    lines: List[TeamLine] = []
    keys: Dict[str, Tuple[Decimal, ...]] = {}
    for team in teams:
        numbers = [column.get(team, Decimal(0)) for column in columns]
        total = sum(numbers, Decimal(0))
        ties = [
            sum((n for n, part in zip(numbers, overall.parts) if part.benchmark == code), Decimal(0))
            for code in overall.ties
        ]
        keys[team] = (-total, *(-number for number in ties))
        lines.append(TeamLine(0, False, team, tuple(map(float, (total, *numbers))), False, (), None))
    order = sorted(keys.values())
    lines = [
        line._replace(rank=order.index(keys[line.team]) + 1, tied=order.count(keys[line.team]) > 1) for line in lines
    ]
    criteria = (Criterion("Total", True, ()), *(Criterion(part.name, True, ()) for part in overall.parts))
    counting = COUNTING[overall.normalised]
    if overall.ties:
        counting += f"; in a tie {', then '.join(overall.ties)}"
    return Standing(
        "", OfRuns.BEST, criteria, tuple(sorted(lines, key=lambda line: (line.rank, line.team))), tuple(remarks),
        tuple("" for _ in criteria), overall.name, counting,
    )


def _column(
    part: Part, normalised: Normalised, records: Sequence[RunRecord], rules: Mapping[str, Rules], choice: Choice,
    remarks: List[str],
) -> Dict[str, Decimal]:
    """Return what each team gets for one benchmark."""
    records = [record for record in records if not part.day or day_of(record.scheduled) == part.day]
    found = standing(part.benchmark, records, rules.get(part.benchmark), choice)
    numbers = {
        line.team: Decimal(0) if line.disqualified or line.numbers[0] is None else Decimal(repr(line.numbers[0]))
        for line in found.lines
    }
    if not numbers:
        remarks.append(f"{part.name} has no runs yet")
        return {}
    reference = Decimal(1)
    if normalised is Normalised.MAXIMUM:
        reference = part.maximum
    elif normalised is Normalised.BEST:
        reference = max(numbers.values())
        if reference <= 0:
            remarks.append(f"{part.name} counts 0: no team has more than 0")
            return dict.fromkeys(numbers, Decimal(0))
    return {
        team: (part.weight * number / reference).quantize(_THOUSANDTH, ROUND_HALF_UP)
        for team, number in numbers.items()
    }


# -- the numbers of a run ---------------------------------------------------------------------------


def _run_line(record: RunRecord, rules: Rules, remarks: List[str]) -> RankedRun:
    disqualified = any(
        sheets.is_marked(item.value, item.text) and item.group in rules.disqualified_by for item in record.items)
    missing: Dict[str, None] = {}
    numbers = tuple(_number(record, criterion, missing) for criterion in rules.criteria)
    if missing and record.end_reason not in _NOT_RUN:
        names = ", ".join(f"'{name}'" for name in missing)
        remarks.append(f"run {record.identity} of team {record.team} has no {names}")
    return RankedRun(record, disqualified, numbers)


def _number(record: RunRecord, criterion: Criterion, missing: Dict[str, None]) -> Optional[float]:
    parts = [_term(record, term, missing) for term in criterion.terms]
    return None if None in parts else round(sum(parts), DIGITS) + 0.0


def _term(record: RunRecord, term: Term, missing: Dict[str, None]) -> Optional[float]:
    """Evaluate a term. Names that the run lacks go to `missing`: items count as 0, values as None."""
    if term.score:
        value = next((s for s in record.module_scores if not s.group and s.name == term.score), None)
        if value is None:
            missing[term.score] = None
            return None
        number = _module_number(value)
        return None if number is None else term.weight * number
    if term.points:
        points = points_of(record, term.points)
        if points is None:
            missing[term.points] = None
        return term.weight * float(points or 0)
    items = [item for item in record.items if term.counts(item)]
    if not items and (term.group or term.item):
        missing[term.item or term.group] = None
    return term.weight * float(sum(amount_of(item) for item in items))


def points_of(record: RunRecord, name: str) -> Optional[Decimal]:
    """Return the points of a group of the sheet, or `TOTAL`; None if it gives none."""
    if record.points is None:
        return None
    groups = {TOTAL: record.points.total, **dict(record.points.groups)}
    return Decimal(groups[name]) if name in groups else None


def amount_of(item: ItemRecord) -> Decimal:
    """Return the value of an item as a number. A choice counts as 0: it has points, but no number."""
    return Decimal(item.text) if item.text and item.kind in ("decimal", "rating") else \
        Decimal(0 if item.kind == "choice" else item.value)


def _module_number(score: ScoreValue) -> Optional[float]:
    """A module's value as a number; None if it is missing or not a number."""
    try:
        value = json.loads(score.value)
    except ValueError:
        return None
    if not isinstance(value, (bool, int, float)) or not math.isfinite(value):
        return None
    return float(value)


# -- the numbers of a team --------------------------------------------------------------------------


def _key(numbers: Numbers, disqualified: bool, criteria: Sequence[Criterion]) -> Tuple[float, ...]:
    """A sort key: smaller is better."""
    worth = [
        math.inf if number is None else -number if criterion.more_is_better else number
        for number, criterion in zip(numbers, criteria)
    ]
    return (1.0, *[0.0 for _ in worth]) if disqualified else (0.0, *worth)


def _team_line(team: str, runs: List[RankedRun], of_runs: OfRuns, criteria: Sequence[Criterion]) -> TeamLine:
    disqualified = all(run.disqualified for run in runs)
    if of_runs is OfRuns.BEST:
        best = min(range(len(runs)), key=lambda i: _key(runs[i].numbers, runs[i].disqualified, criteria))
        return TeamLine(0, False, team, runs[best].numbers, disqualified, tuple(runs), best)
    together = statistics.mean if of_runs is OfRuns.MEAN else statistics.median
    numbers = tuple(_together(together, [_of_run(run, i, c) for run in runs]) for i, c in enumerate(criteria))
    return TeamLine(0, False, team, numbers, disqualified, tuple(runs), None)


def _of_run(run: RankedRun, place: int, criterion: Criterion) -> Optional[float]:
    """What a run contributes to the mean. A disqualified run scores 0 where more is better, else it is left out."""
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


# -- as text and pages ------------------------------------------------------------------------------


DISQUALIFIED = "disqualified"
OF_RUNS = {
    OfRuns.BEST: "the best run of each team counts", OfRuns.MEAN: "the mean of each team's runs counts",
    OfRuns.MEDIAN: "the median of each team's runs counts",
}


def number_text(number: Optional[float]) -> str:
    """A number with at most three decimals."""
    return NOTHING if number is None else f"{number:.3f}".rstrip("0").rstrip(".")


def number_with_unit(number: Optional[float], unit: str) -> str:
    """A number with its unit; a missing number has none."""
    return f"{number_text(number)} {unit}" if unit and number is not None else number_text(number)


def title_of(standing: Standing) -> str:
    """The benchmark's title with its code, or the code alone."""
    if not standing.benchmark:
        return standing.title
    return f"{standing.title} ({standing.benchmark})" if standing.title else standing.benchmark


def counting_of(standing: Standing) -> str:
    """What counts in the standing."""
    return standing.counting or OF_RUNS[standing.of_runs]


def rank_text(team: TeamLine) -> str:
    """A rank; "=" marks ties."""
    return f"{team.rank}{'=' if team.tied else ''}"


def criteria_of(standing: Standing) -> List[str]:
    """The names of the criteria in the order of comparison."""
    return [c.name if c.more_is_better else f"{c.name} (less is better)" for c in standing.criteria]


def number_cells(standing: Standing, team: TeamLine) -> List[str]:
    """A team's numbers with their units."""
    if team.disqualified:
        return [DISQUALIFIED, *("" for _ in standing.criteria[1:])]
    return [number_with_unit(number, unit) for number, unit in zip(team.numbers, standing.units)]


def run_text(run: RankedRun) -> str:
    """Name a run and its state."""
    mark = f", {DISQUALIFIED}" if run.disqualified else ""
    open_mark = "" if run.record.sign_off else f", {NOT_SIGNED_OFF}"
    return f"{turn(run.record.round, run.record.run)}{mark}{open_mark}"


def standing_lines(standing: Standing) -> Iterator[str]:
    """Return the lines for the terminal."""
    yield f"{one_line(title_of(standing))}: {counting_of(standing)}"
    rows = [("Rank", "Team", *criteria_of(standing), "Runs")]
    rows += [
        (rank_text(team), one_line(team.team), *map(one_line, number_cells(standing, team)), str(len(team.runs)))
        for team in standing.lines
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
    for remark in standing.remarks:
        yield f"  * {one_line(remark)}"


def standing_markup(standing: Standing, sheets: Mapping[str, str]) -> Markup:
    """Build the section of a page; `sheets` has the files of the runs' sheets by identity."""
    names = criteria_of(standing)
    parts: List[Child] = [
        tag("h2", title_of(standing)),
        tag("p", f"Ranked by {'; then '.join(names[:1] if standing.counting else names)}; {counting_of(standing)}."),
        table(("Rank", "Team", *names, "Runs"), [
            (rank_text(team), team.team, *number_cells(standing, team), _runs(standing, team, sheets))
            for team in standing.lines
        ], ("number", "team", *("number" for _ in names), "")),
    ]
    parts += [tag("p", remark, class_="small") for remark in standing.remarks]
    return joined(parts)


def _runs(standing: Standing, team: TeamLine, sheets: Mapping[str, str]) -> Markup:
    parts: List[Child] = []
    for i, run in enumerate(team.runs):
        numbers = ", ".join(map(number_with_unit, run.numbers, standing.units))
        text = f"{run_text(run)}: {numbers}"
        link = linked(text, run.record.identity, sheets)
        parts += [tag("br")] if i else []
        parts.append(tag("b", link) if i == team.best else link)
    return joined(parts)


def linked(text: str, identity: str, sheets: Mapping[str, str]) -> Child:
    """Link a text to the run's sheet if there is one."""
    return tag("a", text, href=sheets[identity]) if identity in sheets else text


def standings_page(
    standings: Sequence[Standing], as_of_utc: float, in_utc: bool, competition: Competition = NO_COMPETITION
) -> str:
    """Build a page of standings only."""
    return page(
        "Standings", competition.markup(), tag("h1", "Standings"),
        tag("p", f"As of {date_time(as_of_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, {}) for standing in standings),
    )


def index_page(
    numbered: Sequence[Tuple[int, RunRecord]], sheets: Dict[str, str], standings: Sequence[Standing],
    as_of_utc: float, in_utc: bool, competition: Competition = NO_COMPETITION,
) -> str:
    """Build the page with the standings and links to all sheets."""
    rows = [
        (str(number), date_time(r.opened_utc, in_utc), r.zone, linked(r.benchmark, r.identity, sheets), r.team,
         f"{r.round} / {r.run}", run_state_text(r), signature_of(r, in_utc))
        for number, r in numbered
    ]
    return page(
        "Results", competition.markup(), tag("h1", "Results"),
        tag("p", f"As of {date_time(as_of_utc, in_utc)}", class_="small"),
        *(standing_markup(standing, sheets) for standing in standings),
        tag("h2", "Runs"),
        table(("No.", "Connected", "Zone", "Benchmark", "Team", "Round / run", "State", "Sheet"), rows,
              ("number", "when", "", "", "team", "", "", "who")),
    )
