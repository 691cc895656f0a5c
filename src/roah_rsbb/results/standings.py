"""The standing of a benchmark: its teams, ranked, with the runs that count; as data, as text and as pages."""

import math
import statistics
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.document import PublicRank, PublicStanding
from roah_rsbb.model.reason import Reason, say
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.scoring import SheetForm
from roah_rsbb.results.lists import aligned
from roah_rsbb.results.page import NO_COMPETITION, Child, Competition, Markup, joined, page, table, tag
from roah_rsbb.results.runs import run_state_text, signature_of
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, NO_RULES, EventRules
from roah_rsbb.rulebook.changes import differences
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.rulebook.standing_rules import (
    DEFAULT,
    Criterion,
    Normalised,
    OfRuns,
    Overall,
    Rules,
    StandingPart,
    StandingRules,
)
from roah_rsbb.scoring.book import form_of
from roah_rsbb.scoring.counting import Numbers, Ruling, RunChoice, Why, attempts_of, exact, rules_for, rulings, sort_key
from roah_rsbb.scoring.points import text_of
from roah_rsbb.wording.sheets import NOT_SIGNED_OFF, end_reason, turn
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import NOTHING, date_time, day_of, has_zone

# Numbers are shown with at most this many decimals.
_DECIMALS = 3
WITHOUT_RULES = (
    "no rules rank this benchmark: all items of its sheet are added up, and penalties raise the sum. Give its items "
    "points (docs/organiser.md), or write its criteria into the file with the standings' rules (docs/results.md)"
)

DAYS_OF_COMPUTER = (
    "the competition has no time zone, so days are those of this computer: set time_zone in schedule.yaml "
    "(docs/organiser.md)"
)
NO_TITLES: Mapping[str, str] = {}


TURN = say("team {team}, {turn}: {what}")
UNSIGNED = say("team {team}, {turn}: not signed off yet, so it does not count")
ABSENT = say("team {team} gets 0 for {part}: none of its runs counts")
NOT_YET = say("team {team} gets 0 for {part}: its run is not signed off yet")
WAITS = say("team {team} has a run of {part} that is not signed off yet: it does not count")
NO_RUNS = say("{part} has no runs yet")
EARLIER = say("scored by an earlier sheet ({changed}): run {runs}")
ALL_ZERO = say("{part} counts 0: no team has more than 0")


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
    remarks: Tuple[str, ...]  # notes for the reader; those made by `say` are for the public, too
    units: Tuple[str, ...]  # of each criterion; empty: a plain number
    title: str = ""  # what the benchmark is called; empty: not known
    counting: str = ""  # of an overall standing, what counts; empty: that of `of_runs`


def standings(
    records: Sequence[RunRecord], rules: Dict[str, Rules], choice: RunChoice, titles: Mapping[str, str] = NO_TITLES
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


def public_standings(
    records: Sequence[RunRecord], rules: Dict[str, Rules], choice: RunChoice, titles: Mapping[str, str]
) -> Tuple[PublicStanding, ...]:
    """Return the standings for the public; see `standings`."""
    return tuple(
        PublicStanding(found.title or found.benchmark, tuple(criteria_of(found)), tuple(
            PublicRank(rank_text(line), line.team, tuple(number_cells(found, line))) for line in found.lines),
            tuple(remark for remark in found.remarks if isinstance(remark, Reason)))
        for found in standings(records, rules, choice, titles) if found.lines)


def standing(code: str, records: Sequence[RunRecord], rules: Optional[Rules], choice: RunChoice) -> Standing:
    """Return the standing of one benchmark. `rules`: None if the rules' file does not name it."""
    remarks: List[str] = []
    records = [record for record in records if record.benchmark == code]
    shown = [record for record in records if _is_shown(record, choice)]
    rules = rules_for(shown, rules)
    of_runs = choice.of_runs or rules.of_runs
    ruled = rulings(records, {code: rules}, choice)
    if any(ruling.why is Why.ALL_ROBOTS for ruling in ruled):
        remarks.append("all robots run at once: there is no score for each team")
    by_team: Dict[str, List[RankedRun]] = {}
    for ruling in _by_attempts(ruled):
        missing: Dict[str, None] = {}
        if ruling.counts:
            run = RankedRun(ruling.record, ruling.disqualified(rules), ruling.numbers(rules, missing))
            by_team.setdefault(ruling.record.team, []).append(run)
        remarks += _remarks(ruling, missing, choice.events.get(code, NO_RULES))
    remarks += _of_other_sheets([each.record for each in ruled if each.counts or each.why is Why.NOT_BEST])
    lines = [_team_line(team, runs, of_runs, rules.criteria) for team, runs in by_team.items()]
    if rules is DEFAULT and any(run.record.items for runs in by_team.values() for run in runs):
        remarks.append(WITHOUT_RULES)
    units = tuple(_unit(criterion, shown) for criterion in rules.criteria)
    return Standing(
        code, of_runs, rules.criteria, _ranked(lines, rules.criteria), tuple(dict.fromkeys(remarks)), units
    )


def _of_other_sheets(records: Sequence[RunRecord]) -> Iterator[str]:
    """Yield a note for each score sheet by which runs that are compared were scored, other than the newest one's."""
    by_form: Dict[SheetForm, List[str]] = {}
    for record in sorted((record for record in records if record.items), key=lambda record: -record.opened_utc):
        by_form.setdefault(replace(form_of(record), objection_time=0.0), []).append(record.identity)
    newest = next(iter(by_form), None)
    for form, runs in by_form.items():
        if form is not newest:
            changed = "; ".join(differences("", form, newest))
            yield EARLIER(changed=changed, runs=", ".join(runs[::-1]))


def _is_shown(record: RunRecord, choice: RunChoice) -> bool:
    """Whether anything of a run may be seen in a standing."""
    return record.sign_off is not None or not choice.signed_off


def standing_of_run(record: RunRecord, rules: Optional[Rules]) -> Standing:
    """Return a standing of one run only, with its numbers."""
    rules = rules_for([record], rules)
    ruling = Ruling(record, Why.COUNTS)
    run = RankedRun(record, ruling.disqualified(rules), ruling.numbers(rules))
    line = _team_line(record.team, [run], OfRuns.BEST, rules.criteria)
    units = tuple(_unit(criterion, [record]) for criterion in rules.criteria)
    return Standing(record.benchmark, OfRuns.BEST, rules.criteria, (line,), (), units)


def _unit(criterion: Criterion, records: Sequence[RunRecord]) -> str:
    """The unit of a criterion that is one value of the module; empty: a sum, a count, or not known."""
    if len(criterion.terms) != 1 or abs(criterion.terms[0].weight) != 1.0:
        return ""
    name = criterion.terms[0].score
    units = {s.unit for r in records for s in r.module_scores if name and not s.group and s.name == name}
    return units.pop() if len(units) == 1 else ""


def _by_attempts(ruled: Sequence[Ruling]) -> Iterator[Ruling]:
    """Yield the rulings with the attempts at an event beside each other."""
    by_identity = {ruling.record.identity: ruling for ruling in ruled}
    for attempts in attempts_of(ruling.record for ruling in ruled).values():
        yield from (by_identity[record.identity] for record in attempts)


def _remarks(ruling: Ruling, missing: Mapping[str, None], event: EventRules) -> Iterator[str]:
    """Yield what the reader of a standing should know about a run."""
    record, why = ruling.record, ruling.why
    run = f"run {record.identity} of team {record.team}"
    if missing:
        names = ", ".join(f"'{name}'" for name in missing)
        yield f"{run} has no {names}"
    if why is Why.NOT_OVER and record.started_utc:
        yield f"run {record.identity} is still running: it does not count yet"
    elif why is Why.NOT_SIGNED_OFF:
        yield UNSIGNED(team=record.team, turn=turn(record.round, record.run))
    elif why in (Why.ZERO, Why.NO_SCORE):
        scored = "counts as 0" if ruling.counts else "no score"
        yield TURN(team=record.team, turn=turn(record.round, record.run),
                   what=f"{end_reason(record.end_reason)}, {scored}")
    elif why in (Why.NOT_LAST, Why.NOT_BEST):
        yield f"{run} was repeated: only the {event.counting.value} run counts"
    elif why is Why.RAN:
        yield f"{run} does not count ({end_reason(record.end_reason)}): the team ran at this event"
    if ruling.counts and record.sign_off is None:
        yield f"{run} is not signed off and may still change"


# -- overall standings ------------------------------------------------------------------------------


COUNTING = {
    Normalised.BEST: "weighted sum of the benchmarks, each relative to its best team",
    Normalised.MAXIMUM: "weighted sum of the benchmarks, each relative to its maximum",
    Normalised.NO: "weighted sum of the benchmarks",
}


def overall_standing(
    overall: Overall, records: Sequence[RunRecord], rules: Mapping[str, Rules], choice: RunChoice
) -> Standing:
    """Return an overall standing. A team that has no run in a benchmark, or is disqualified, gets 0 there."""
    remarks: List[str] = []
    columns = [_column(part, overall.normalised, records, rules, choice, remarks) for part in overall.parts]
    nothing = _TeamsPart(Fraction(0), ())
    lines: List[TeamLine] = []
    keys: Dict[str, Tuple[Fraction, ...]] = {}
    for team in sorted({team for column in columns for team in column}):
        parts = [column.get(team, nothing) for column in columns]
        numbers = [part.number for part in parts]
        total = sum(numbers, Fraction(0))
        ties = [
            sum((n for n, part in zip(numbers, overall.parts) if part.benchmark == code), Fraction(0))
            for code in overall.ties
        ]
        keys[team] = (-total, *(-number for number in ties))
        runs = tuple(run for part in parts for run in part.runs)
        lines.append(TeamLine(0, False, team, (total, *numbers), False, runs, None))
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


class _TeamsPart(NamedTuple):
    """What a team gets for a benchmark, and the runs that count there."""

    number: Fraction
    runs: Tuple[RankedRun, ...]


def _column(
    part: StandingPart, normalised: Normalised, records: Sequence[RunRecord], rules: Mapping[str, Rules],
    choice: RunChoice, remarks: List[str],
) -> Dict[str, _TeamsPart]:
    """Return what each team gets for one benchmark. A team that did not appear or withdrew gets 0."""
    if part.day and not has_zone() and DAYS_OF_COMPUTER not in remarks:
        remarks.append(DAYS_OF_COMPUTER)
    records = [record for record in records if not part.day or day_of(record.scheduled) == part.day]
    found = standing(part.benchmark, records, rules.get(part.benchmark), choice)
    numbers = {line.team: Fraction(0) if line.disqualified else line.numbers[0] or Fraction(0) for line in found.lines}
    over = [record for record in records
            if record.benchmark == part.benchmark and record.end_reason and record.team != ALL_TEAMS]
    absent = {record.team: _TeamsPart(Fraction(0), ()) for record in over if _is_shown(record, choice)}
    remarks += [ABSENT(team=team, part=part.name) for team in absent if team not in numbers]
    waiting = dict.fromkeys(record.team for record in over if not _is_shown(record, choice))
    remarks += [(WAITS if team in numbers or team in absent else NOT_YET)(team=team, part=part.name)
                for team in waiting]
    if not numbers:
        remarks.append(NO_RUNS(part=part.name))
        return absent
    reference = Fraction(1)
    if normalised is Normalised.MAXIMUM:
        reference = exact(part.maximum)
    elif normalised is Normalised.BEST:
        reference = max(numbers.values())
        if reference <= 0:
            remarks.append(ALL_ZERO(part=part.name))
            numbers, reference = dict.fromkeys(numbers, Fraction(0)), Fraction(1)
    return {**absent, **{line.team: _TeamsPart(exact(part.weight) * numbers[line.team] / reference, _deciding(line))
                         for line in found.lines}}


def _deciding(line: TeamLine) -> Tuple[RankedRun, ...]:
    """Return the runs that gave a team its number."""
    return line.runs if line.best is None else (line.runs[line.best],)


# -- the numbers of a team --------------------------------------------------------------------------


def _team_line(team: str, runs: List[RankedRun], of_runs: OfRuns, criteria: Sequence[Criterion]) -> TeamLine:
    disqualified = all(run.disqualified for run in runs)
    if of_runs is OfRuns.BEST:
        best = min(range(len(runs)), key=lambda i: sort_key(runs[i].numbers, runs[i].disqualified, criteria))
        return TeamLine(0, False, team, runs[best].numbers, disqualified, tuple(runs), best)
    together = statistics.mean if of_runs is OfRuns.MEAN else statistics.median
    numbers = tuple(_together(together, [_of_run(run, i, c) for run in runs]) for i, c in enumerate(criteria))
    return TeamLine(0, False, team, numbers, disqualified, tuple(runs), None)


def _of_run(run: RankedRun, place: int, criterion: Criterion) -> Optional[Fraction]:
    """What a run contributes to the mean. A disqualified run scores 0 where more is better, else it is left out."""
    if run.disqualified:
        return Fraction(0) if criterion.more_is_better else None
    return run.numbers[place]


def _together(of: Callable[[List[Fraction]], Fraction], numbers: List[Optional[Fraction]]) -> Optional[Fraction]:
    known = [number for number in numbers if number is not None]
    return of(known) if known else None


def _ranked(lines: List[TeamLine], criteria: Sequence[Criterion]) -> Tuple[TeamLine, ...]:
    keys = {line.team: sort_key(line.numbers, line.disqualified, criteria) for line in lines}
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


def number_text(number: Optional[Fraction]) -> str:
    """A number with at most three decimals. It is rounded half up."""
    if number is None:
        return NOTHING
    shown = math.floor(abs(number) * 10 ** _DECIMALS + Fraction(1, 2))
    return text_of(Decimal(-shown if number < 0 else shown).scaleb(-_DECIMALS))


def number_with_unit(number: Optional[Fraction], unit: str) -> str:
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
    yield from (f"  {line}" for line in aligned(rows))
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
    why: Mapping[str, Why] = MappingProxyType({}),
) -> str:
    """Build the page with the standings and links to all sheets. `why`: whether runs count, by their identities."""
    rows = [
        (str(number), date_time(r.opened_utc, in_utc), r.zone, linked(r.benchmark, r.identity, sheets), r.team,
         f"{r.round} / {r.run}", run_state_text(r, why[r.identity].value if r.identity in why else ""),
         signature_of(r, in_utc))
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
