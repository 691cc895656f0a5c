"""The standings of a competition: those of its benchmarks, with the runs that count, and those of its stages."""

from dataclasses import replace
from fractions import Fraction
from typing import Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.reason import say
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.rules import Attempts, AttemptsRule, Scale, StageColumn
from roah_rsbb.model.scoring import SheetForm
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, NO_RULES, EventRules
from roah_rsbb.rulebook.changes import differences
from roah_rsbb.rulebook.registry import in_order
from roah_rsbb.rulebook.standing_rules import DEFAULT, TOTAL, Criterion, Rules, StandingRules
from roah_rsbb.scoring.book import form_of
from roah_rsbb.scoring.counting import (
    Numbers,
    Ruling,
    RunChoice,
    Why,
    by_attempts,
    exact,
    replaces,
    rules_for,
    rulings,
    sort_key,
)
from roah_rsbb.scoring.stages import Result, StageRanking, counting_attempts, first_kept, rank, together
from roah_rsbb.wording.sheets import end_reason, turn
from roah_rsbb.wording.times import day_of, has_zone

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
PROTEST = say("team {team}, {turn}: an objection is not answered yet")
UNSIGNED = say("team {team}, {turn}: not signed off yet, so it does not count")
ABSENT = say("team {team} gets 0 for {part}: none of its runs counts")
NOT_YET = say("team {team} gets 0 for {part}: its run is not signed off yet")
WAITS = say("team {team} has a run of {part} that is not signed off yet: it does not count")
DECIDED = say("{name}: {reading}")
EARLIER = say("scored by an earlier sheet ({changed}): run {runs}")


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
    counting: Tuple[int, ...]  # indexes in `runs` of those that gave the team its numbers


class Standing(NamedTuple):
    """The standing of a benchmark."""

    benchmark: str  # code
    attempts: AttemptsRule
    criteria: Tuple[Criterion, ...]
    lines: Tuple[TeamLine, ...]
    remarks: Tuple[str, ...]  # notes for the reader; those made by `say` are for the public, too
    units: Tuple[str, ...]  # of each criterion; empty: a plain number
    title: str = ""  # what the benchmark is called; empty: not known
    counting: str = ""  # of a stage, what counts; empty: that of `attempts`
    steps: Tuple[str, ...] = ()  # of a stage, how its numbers were computed
    advance: Tuple[str, ...] = ()  # of a stage, the teams that advance, in order
    undecided: Tuple[str, ...] = ()  # of these teams, which tie, a person must choose who advances


def standings(
    records: Sequence[RunRecord], rules: Dict[str, Rules], choice: RunChoice, titles: Mapping[str, str] = NO_TITLES
) -> List[Standing]:
    """Return the standings of all benchmarks with runs: in the order of the benchmarks, unknown ones last. Those of the
    stages come first.

    `titles`: what the benchmarks are called, by their codes.
    """
    found = [standing(code, records, rules.get(code), choice)._replace(title=titles.get(code, ""))
             for code in in_order(record.benchmark for record in records)]
    if isinstance(rules, StandingRules):
        found = [*stage_standings(rules, records, choice), *found]
    return [s for s in found if s.lines or s.remarks]


def standing(code: str, records: Sequence[RunRecord], rules: Optional[Rules], choice: RunChoice) -> Standing:
    """Return the standing of one benchmark. `rules`: None if the rules' file does not name it."""
    remarks: List[str] = []
    records = [record for record in records if record.benchmark == code]
    shown = [record for record in records if _is_shown(record, choice)]
    rules = rules_for(shown, rules)
    attempts = choice.attempts or rules.attempts
    ruled = rulings(records, {code: rules}, choice)
    if any(ruling.why is Why.ALL_ROBOTS for ruling in ruled):
        remarks.append("all robots run at once: there is no score for each team")
    by_team: Dict[str, List[RankedRun]] = {}
    for ruling in (each for attempts in by_attempts(ruled) for each in attempts):
        missing: Dict[str, None] = {}
        if ruling.counts:
            run = RankedRun(ruling.record, ruling.disqualified(rules), ruling.numbers(rules, missing))
            by_team.setdefault(ruling.record.team, []).append(run)
        remarks += _remarks(ruling, missing, choice.events.get(code, NO_RULES))
    remarks += _of_other_sheets([each.record for each in ruled if each.counts or each.why is Why.NOT_BEST])
    lines = [_team_line(team, runs, attempts, rules.criteria) for team, runs in by_team.items()]
    if rules.criteria is DEFAULT.criteria and any(run.record.items for runs in by_team.values() for run in runs):
        remarks.append(WITHOUT_RULES)
    units = tuple(_unit(criterion, shown) for criterion in rules.criteria)
    return Standing(
        code, attempts, rules.criteria, _ranked(lines, rules.criteria), tuple(dict.fromkeys(remarks)), units
    )


def _of_other_sheets(records: Sequence[RunRecord]) -> Iterator[str]:
    """Yield a note for each score sheet by which runs that are compared were scored, other than the newest one's."""
    by_form: Dict[SheetForm, List[str]] = {}
    for record in sorted((record for record in records if record.items), key=lambda record: -record.opened_utc):
        by_form.setdefault(replace(form_of(record), objection_time=0.0, protest_time=0.0), []).append(record.identity)
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
    line = _team_line(record.team, [run], AttemptsRule(), rules.criteria)
    units = tuple(_unit(criterion, [record]) for criterion in rules.criteria)
    return Standing(record.benchmark, AttemptsRule(), rules.criteria, (line,), (), units)


def _unit(criterion: Criterion, records: Sequence[RunRecord]) -> str:
    """The unit of a criterion that is one value of the module; empty: a sum, a count, or not known."""
    if len(criterion.terms) != 1 or abs(criterion.terms[0].weight) != 1.0:
        return ""
    name = criterion.terms[0].score
    units = {s.unit for r in records for s in r.module_scores if name and not s.group and s.name == name}
    return units.pop() if len(units) == 1 else ""


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
    if record.open_objections:
        yield PROTEST(team=record.team, turn=turn(record.round, record.run))
    if ruling.counts and record.sign_off is None:
        yield f"{run} is not signed off and may still change"


# -- stages -----------------------------------------------------------------------------------------


COUNTING = {
    Scale.BEST: "weighted sum of the benchmarks, each relative to its best team",
    Scale.FINALIST: "weighted sum of the benchmarks, each relative to the best team of this stage",
    Scale.MAXIMUM: "weighted sum of the benchmarks, each relative to its maximum",
    Scale.RANGE: "weighted sum of the benchmarks, each from 0 for the worst team to 1 for the best",
    Scale.RANK: "weighted sum of the places in the benchmarks",
    Scale.NO: "weighted sum of the benchmarks",
}


SEVERAL_SCALES = "weighted sum, each part in its own way: see the steps"


def stage_standings(rules: StandingRules, records: Sequence[RunRecord], choice: RunChoice) -> List[Standing]:
    """Return the standings of the stages. A team that has no run in a benchmark, or is
    disqualified, gets 0 there."""
    tests = {column.test for stage in rules.stages for column in stage.of} | {
        name for stage in rules.stages for name in stage.ties}
    found = {code: standing(code, records, rules.get(code), choice) for code in sorted(tests) if code}
    runs = {run.record.identity: run for each in found.values() for line in each.lines for run in line.runs}
    results = {code: _results(each, records, choice) for code, each in found.items()}
    attempts = {code: each.attempts for code, each in found.items()}
    ranked = rank(rules.stages, results, attempts, rules.adjusted)
    tables = [_stage_standing(each, records, results, choice, runs) for each in ranked]
    decided = [DECIDED(name=each.name, reading=each.chosen) for each in rules.decisions
               if each.chosen != each.readings[0]]
    return [*tables[:-1], *(each._replace(remarks=(*each.remarks, *decided)) for each in tables[-1:])]


def _results(found: Standing, records: Sequence[RunRecord], choice: RunChoice) -> Dict[str, List[Result]]:
    """Return what each team got in a benchmark. A team that did not appear or withdrew has a result that does not
    count."""
    results: Dict[str, List[Result]] = {}
    for line in found.lines:
        for run in line.runs:
            points = Fraction(0) if run.disqualified else run.numbers[0] or Fraction(0)
            results.setdefault(line.team, []).append(_result(run.record)._replace(
                points=points, order=sort_key(run.numbers, run.disqualified, found.criteria), counts=True,
                charged=_charged(run.record, found.criteria[0]), replaces=replaces(run.record)))
    for record in records:
        if record.benchmark == found.benchmark and _was_to_run(record) and _is_shown(record, choice):
            results.setdefault(record.team, []).append(_result(record))
    return results


def _result(record: RunRecord) -> Result:
    return Result(None, record.round, record.event, day_of(record.scheduled), counts=False, run=record.identity)


def _was_to_run(record: RunRecord) -> bool:
    return bool(record.end_reason) and record.team != ALL_TEAMS


def _stage_standing(
    ranked: StageRanking, records: Sequence[RunRecord], results: Mapping[str, Mapping[str, Sequence[Result]]],
    choice: RunChoice, runs: Mapping[str, RankedRun],
) -> Standing:
    stage = ranked.stage
    remarks: List[str] = []
    for column in stage.of:
        remarks += _about_column(column, records, results.get(column.test, {}), choice)
    names = ["Total", *(column.name for column in stage.of), *(["Adjustments"] if stage.adjustments else [])]
    lines = tuple(
        TeamLine(line.place, line.tied, line.team,
                 (line.total, *line.numbers, *([line.adjusted] if stage.adjustments else [])), line.disqualified,
                 tuple(runs[result.run] for result in line.results), tuple(range(len(line.results))))
        for line in ranked.lines)
    scales = {column.normalised or stage.normalised for column in stage.of}
    counting = COUNTING[scales.pop()] if len(scales) == 1 else SEVERAL_SCALES
    if stage.ties:
        counting += f"; in a tie {', then '.join(stage.ties)}"
    return Standing(
        "", AttemptsRule(), tuple(Criterion(name, True, ()) for name in names), lines,
        tuple(dict.fromkeys([*remarks, *ranked.notes])), tuple("" for _ in names), stage.name, counting,
        ranked.steps, ranked.advance, ranked.undecided)


def _about_column(
    column: StageColumn, records: Sequence[RunRecord], results: Mapping[str, Sequence[Result]], choice: RunChoice
) -> Iterator[str]:
    """Yield what the reader of a stage should know about one of its benchmarks."""
    if column.day and not has_zone():
        yield DAYS_OF_COMPUTER
    own = [record for record in records if record.benchmark == column.test and _was_to_run(record)
           and column.has(record.round, record.event, day_of(record.scheduled))]
    counting = {team for team, found in results.items()
                if any(result.counts and column.has(result.round, result.event, result.day) for result in found)}
    absent = dict.fromkeys(record.team for record in own if _is_shown(record, choice))
    yield from (ABSENT(team=team, part=column.name) for team in absent if team not in counting)
    for team in dict.fromkeys(record.team for record in own if not _is_shown(record, choice)):
        yield (WAITS if team in counting or team in absent else NOT_YET)(team=team, part=column.name)


# -- the numbers of a team --------------------------------------------------------------------------


def _team_line(team: str, runs: List[RankedRun], attempts: AttemptsRule, criteria: Sequence[Criterion]) -> TeamLine:
    first = first_kept(replaces(run.record) for run in runs)
    orders = [sort_key(run.numbers, run.disqualified, criteria) for run in runs[first:]]
    counting = tuple(first + place for place in counting_attempts(attempts, orders))
    own = [runs[place] for place in counting]
    disqualified = all(run.disqualified for run in own)
    if attempts.how in (Attempts.BEST, Attempts.FIRST, Attempts.LAST):
        numbers = own[0].numbers
    else:
        numbers = tuple(together(attempts, [_of_run(run, i, c) for run in own]) for i, c in enumerate(criteria))
    charged = [sum((_charged(run.record, criterion) for run in runs), Fraction(0)) for criterion in criteria]
    numbers = tuple(None if number is None else number + more for number, more in zip(numbers, charged))
    return TeamLine(0, False, team, numbers, disqualified, tuple(runs), counting)


def _charged(record: RunRecord, criterion: Criterion) -> Fraction:
    """Return what a run adds to a number of its team whichever attempt counts."""
    points = Fraction((record.points.for_team if record.points is not None else "") or 0)
    return points * sum((exact(term.weight) for term in criterion.terms if term.points == TOTAL), Fraction(0))


def _of_run(run: RankedRun, place: int, criterion: Criterion) -> Optional[Fraction]:
    """What a run adds to a mean or a sum. A disqualified one adds 0 where more is better, else it is left out."""
    if run.disqualified:
        return Fraction(0) if criterion.more_is_better else None
    return run.numbers[place]


def _ranked(lines: List[TeamLine], criteria: Sequence[Criterion]) -> Tuple[TeamLine, ...]:
    keys = {line.team: sort_key(line.numbers, line.disqualified, criteria) for line in lines}
    ordered = sorted(lines, key=lambda line: (keys[line.team], line.team))
    all_keys = [keys[line.team] for line in ordered]
    return tuple(
        line._replace(rank=all_keys.index(keys[line.team]) + 1, tied=all_keys.count(keys[line.team]) > 1)
        for line in ordered
    )
