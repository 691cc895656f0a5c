"""A ranking of teams by their results in several tests: who is where, and who advances (docs/results.md, "Stages").

Theory of operation. The attempts of a team at a test become one number; numbers become comparable, and are added up
with their weights and what a team got outside any run. Sums are compared, then what decides ties. Those who advance are
the first ones, and a later stage may rank only them. All numbers are exact fractions. Every step is said in words.
"""

import statistics
from fractions import Fraction
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

from roah_rsbb.model.reason import say
from roah_rsbb.model.rules import Adjusted, Attempts, AttemptsRule, Disqualified, Others, Scale, Stage, StageColumn
from roah_rsbb.scoring.tree import number_text

ZERO, ONE = Fraction(0), Fraction(1)

OF_ATTEMPTS = say("{team}, {test}: {rule} of {numbers}: {number}")
REPLACED = say("{team}, {test}: the attempts before the extra one do not count")
CHARGED = say("{team}, {test}: {points} for the team, whichever attempt counts")
RELATIVE = say("{team}, {column}: {weight} × {number} / {reference} = {points}")
PLACE = say("{team}, {column}: place {place} of {teams}")
SUM = say("{team}: {sum} = {points}")
AT_LEAST = say("{team}: {sum}, at least {limit}: {points}")
TOO_OFTEN = say("{team}: {name} counts at most {times} times")
IS_OUT = say("{team}: {name}")
ADVANCE = say("{stage}: {number} of {count} advance: {teams}")
TIED = say("{teams} tie for {stage}, place {place}: {by} decides")
ASK = say("{stage}: {teams} tie, and {number} of them can advance: name who does in 'chosen' of the stage "
          "(docs/results.md)")
ALL_ADVANCE = say("{stage}: {teams} tie, so all of them advance")
WAITS_FOR = say("{stage}: who advances from {before} is not decided yet")
DID_NOT_ADVANCE = say("{team} has a result in {test} but did not advance: it does not count in {stage}")
ALL_ZERO = say("{part} counts 0: no team has more than 0")
NO_RUNS = say("{part}: no run counts yet")


class Result(NamedTuple):
    """What a team got in an attempt at a test."""

    points: Optional[Fraction]  # None: there is no number, which is worse than any
    round: int = 0
    event: str = ""  # id
    day: str = ""
    order: Any = None  # sort key, smaller is better; None: by points
    charged: Fraction = ZERO  # points that the team gets whichever attempt counts
    replaces: bool = False  # the attempts before do not count
    counts: bool = True  # else it only says that the team was to take part: that is 0
    run: str = ""  # identity


# Of each test by its code, the results of each team in the order of its attempts. No result counts 0.
Results = Mapping[str, Mapping[str, Sequence[Result]]]

# Disqualified; not in this stage; the sum; what decides ties. Smaller is better.
_Key = Tuple[object, ...]


class StageLine(NamedTuple):
    """A team in the ranking of a stage."""

    place: int
    tied: bool  # another team has the same place
    team: str
    total: Optional[Fraction]  # None: it did not advance to this stage
    numbers: Tuple[Optional[Fraction], ...]  # of each column, as it counts
    adjusted: Fraction = ZERO
    results: Tuple[Result, ...] = ()  # those that gave it its numbers
    disqualified: bool = False


class StageRanking(NamedTuple):
    """The ranking of a stage."""

    stage: Stage
    lines: Tuple[StageLine, ...]
    advance: Tuple[str, ...]  # teams, in order
    undecided: Tuple[str, ...]  # of these teams, which tie, a person must choose who advances
    notes: Tuple[str, ...]  # what everybody should know
    steps: Tuple[str, ...]


# -- attempts ---------------------------------------------------------------------------------------


def counting_attempts(rule: AttemptsRule, orders: Sequence[Any]) -> Tuple[int, ...]:
    """Return which attempts count, by their places in order. `orders`: their sort keys, smaller is better."""
    places = tuple(range(len(orders)))
    if rule.how is Attempts.FIRST:
        return places[:1]
    if rule.how is Attempts.LAST:
        return places[-1:]
    number = 1 if rule.how is Attempts.BEST else rule.of_best
    return places if number is None else tuple(sorted(sorted(places, key=orders.__getitem__)[:number]))


def first_kept(replaces: Iterable[bool]) -> int:
    """Return the place of the first attempt that counts: an extra one replaces those before it."""
    return max((place for place, each in enumerate(replaces) if each), default=0)


def together(rule: AttemptsRule, numbers: Sequence[Optional[Fraction]]) -> Optional[Fraction]:
    """Return one number of those of the attempts that count. None, a number that is missing, is left out."""
    known = [number for number in numbers if number is not None]
    if not known:
        return None
    if rule.how is Attempts.MEAN:
        return statistics.mean(known)
    return statistics.median(known) if rule.how is Attempts.MEDIAN else sum(known, ZERO)


def number_of(rule: AttemptsRule, results: Sequence[Result]) -> Fraction:
    """Return the number of a team's attempts at a test."""
    number = together(rule, [result.points for result in _deciding_results(rule, results)]) or ZERO
    return number + _charged(results)


def _deciding_results(rule: AttemptsRule, results: Sequence[Result]) -> List[Result]:
    kept = _kept(results)
    return [kept[place] for place in counting_attempts(rule, [_order(result) for result in kept])]


def _kept(results: Sequence[Result]) -> List[Result]:
    """Return the results that no extra attempt replaces."""
    results = [result for result in results if result.counts]
    return results[first_kept(result.replaces for result in results):]


def _charged(results: Sequence[Result]) -> Fraction:
    return sum((result.charged for result in results), ZERO)


def _order(result: Result) -> Any:
    if result.order is not None:
        return result.order
    return (ONE, ZERO) if result.points is None else (ZERO, -result.points)


# -- stages -----------------------------------------------------------------------------------------


def rank(
    stages: Sequence[Stage], results: Results, attempts: Mapping[str, AttemptsRule],
    adjusted: Sequence[Adjusted] = (), teams: Sequence[str] = (),
) -> List[StageRanking]:
    """Return the ranking of each stage.

    `attempts`: the rule of each test that has another one than best. `teams`: those that take part, besides those with
    results.
    """
    disqualified = {given.team: (found.disqualified, given.name) for given in adjusted for stage in stages
                    if stage.name == given.stage for found in stage.adjustments
                    if found.name == given.name and found.disqualified is not None}
    done: Dict[str, StageRanking] = {}
    for stage in stages:
        done[stage.name] = _Ranking(stage, done, results, attempts, adjusted, teams, disqualified).found()
    gone = {team for team, (how, _) in disqualified.items() if how is Disqualified.GAP}
    return [each._replace(lines=tuple(line for line in each.lines if line.team not in gone),
                          advance=tuple(team for team in each.advance if team not in gone)) for each in done.values()]


class _Ranking:
    """Ranks the teams of a stage."""

    def __init__(
        self, stage: Stage, before: Mapping[str, StageRanking], results: Results,
        attempts: Mapping[str, AttemptsRule], adjusted: Sequence[Adjusted], teams: Sequence[str],
        disqualified: Mapping[str, Tuple[Optional[Disqualified], str]],
    ) -> None:
        self._stage = stage
        self._before = before
        self._results = results
        self._attempts = attempts
        self._adjusted = [given for given in adjusted if given.stage == stage.name]
        self._disqualified = disqualified
        self._notes: Dict[str, None] = {}
        self._steps: List[str] = []
        self._decisive: Dict[str, List[Result]] = {}  # of each team
        self._teams = self._all_teams(teams)
        self._inside = [team for team in self._teams if self._takes_part(team)]

    def found(self) -> StageRanking:
        """Return the ranking."""
        columns = [self._column(column) for column in self._stage.of]
        lines = [self._line(team, columns) for team in self._teams]
        keys = {line.team: self._key(line, columns) for line in lines}
        order = sorted(keys.values())
        lines = sorted((line._replace(place=order.index(keys[line.team]) + 1, tied=order.count(keys[line.team]) > 1)
                        for line in lines), key=lambda line: (line.place, line.team))
        self._say_ties(lines, keys)
        advance, undecided = self._who_advances(lines)
        return StageRanking(self._stage, tuple(lines), advance, undecided, tuple(self._notes), tuple(self._steps))

    def _line(self, team: str, columns: Sequence[Mapping[str, Fraction]]) -> StageLine:
        is_last = self._how_disqualified(team) is Disqualified.LAST
        if team not in self._inside:
            return StageLine(0, False, team, None, tuple(None for _ in columns), disqualified=is_last)
        numbers, adjusted = tuple(column[team] for column in columns), self._points_outside(team)
        return StageLine(0, False, team, self._total(team, numbers, adjusted), numbers, adjusted,
                         tuple(self._decisive.get(team, ())), is_last)

    def _key(self, line: StageLine, columns: Sequence[Mapping[str, Fraction]]) -> _Key:
        """Return the sort key of a line: smaller is better. After its first three parts it has what decides ties."""
        if line.disqualified:
            return True, False, ZERO, *(ZERO for _ in self._stage.ties)
        if line.total is None:
            place = next(each.place for each in self._before[self._stage.teams].lines if each.team == line.team)
            return False, True, Fraction(place), *(ZERO for _ in self._stage.ties)
        number = line.total if self._stage.places_count else -line.total
        return False, False, number, *(-each for each in self._deciding(line.team, columns))

    # -- teams --------------------------------------------------------------------------------------

    def _all_teams(self, teams: Sequence[str]) -> List[str]:
        """Return all teams of the ranking."""
        if self._stage.teams:
            before = self._before[self._stage.teams]
            if before.undecided:
                self._notes[WAITS_FOR(stage=self._stage.name, before=before.stage.name)] = None
            return self._in_list(line.team for line in before.lines)
        found = {*teams, *(given.team for given in self._adjusted)}
        for column in self._stage.of:
            if column.stage:
                found.update(line.team for line in self._before[column.stage].lines)
            found.update(team for team, results in self._results.get(column.test, {}).items()
                         if not results or any(column.has(each.round, each.event, each.day) for each in results))
        return self._in_list(found)

    def _in_list(self, teams: Any) -> List[str]:
        found = []
        for team in sorted(teams):
            if team in self._disqualified:
                self._steps.append(IS_OUT(team=team, name=self._disqualified[team][1]))
            if self._how_disqualified(team) is not Disqualified.OUT:
                found.append(team)
        return found

    def _how_disqualified(self, team: str) -> Optional[Disqualified]:
        return self._disqualified.get(team, (None, ""))[0]

    def _takes_part(self, team: str) -> bool:
        """Whether a team has a sum in this stage."""
        return self._stage.others is Others.ZERO or self._advanced(team)

    def _advanced(self, team: str) -> bool:
        return not self._stage.teams or team in self._before[self._stage.teams].advance

    # -- numbers ------------------------------------------------------------------------------------

    def _column(self, column: StageColumn) -> Dict[str, Fraction]:
        """Return what each team of the stage gets for a column."""
        numbers = self._raw(column)
        how = column.normalised or self._stage.normalised
        inside = {team: numbers.get(team, ZERO) for team in self._inside}
        if not numbers:
            self._notes[NO_RUNS(part=column.name)] = None
        weight = Fraction(column.weight)
        if how is Scale.RANK:
            return self._ranks(column, weight, inside)
        lowest, reference = ZERO, ONE
        if how is Scale.MAXIMUM:
            reference = Fraction(column.maximum or 1)
        elif how is not Scale.NO:
            values = list((numbers if how is Scale.BEST else inside).values())
            lowest = min(values, default=ZERO) if how is Scale.RANGE else ZERO
            reference = max(values, default=ZERO) - lowest
            if reference <= 0:
                if numbers:
                    self._notes[ALL_ZERO(part=column.name)] = None
                return dict.fromkeys(inside, ZERO)
        found = {team: weight * (number - lowest) / reference for team, number in inside.items()}
        if how is not Scale.NO:
            for team, number in inside.items():
                self._steps.append(RELATIVE(
                    team=team, column=column.name, weight=number_text(weight), number=number_text(number - lowest),
                    reference=number_text(reference), points=number_text(found[team])))
        return found

    def _ranks(self, column: StageColumn, weight: Fraction, inside: Mapping[str, Fraction]) -> Dict[str, Fraction]:
        is_less_better = bool(column.stage) and self._before[column.stage].stage.places_count
        order = sorted(inside.values(), reverse=not is_less_better)
        found = {}
        for team, number in inside.items():
            place = order.index(number) + 1
            self._steps.append(PLACE(team=team, column=column.name, place=place, teams=len(inside)))
            found[team] = weight * (
                place if self._stage.places_count else Fraction(len(inside) - place + 1, len(inside)))
        return found

    def _raw(self, column: StageColumn) -> Dict[str, Fraction]:
        """Return the numbers of the teams that have one."""
        if column.stage:
            return {line.team: line.total for line in self._before[column.stage].lines if line.total is not None}
        found: Dict[str, Fraction] = {}
        rule: AttemptsRule = column.attempts or self._attempts.get(column.test) or AttemptsRule()
        for team, results in self._results.get(column.test, {}).items():
            own = [result for result in results if column.has(result.round, result.event, result.day) and result.counts]
            if not own or team not in self._teams:
                continue
            if not self._advanced(team):
                self._notes[DID_NOT_ADVANCE(team=team, test=column.name, stage=self._stage.name)] = None
                continue
            found[team] = number_of(rule, own)
            self._decisive.setdefault(team, []).extend(_deciding_results(rule, own))
            self._say_attempts(team, column, rule, own, found[team])
        return found

    def _say_attempts(
        self, team: str, column: StageColumn, rule: AttemptsRule, results: Sequence[Result], number: Fraction
    ) -> None:
        kept, charged = _kept(results), _charged(results)
        if len(kept) < len(results):
            self._steps.append(REPLACED(team=team, test=column.name))
        if len(kept) > 1:
            numbers = ", ".join(number_text(result.points or ZERO) for result in kept)
            self._steps.append(OF_ATTEMPTS(team=team, test=column.name, rule=str(rule), numbers=numbers,
                                           number=number_text(number - charged)))
        if charged:
            self._steps.append(CHARGED(team=team, test=column.name, points=number_text(charged)))

    def _points_outside(self, team: str) -> Fraction:
        """Return the sum of what a team got outside any run."""
        limits = {each.name: each.times for each in self._stage.adjustments}
        count: Dict[str, int] = {}
        total = ZERO
        for given in self._adjusted:
            if given.team == team:
                count[given.name] = count.get(given.name, 0) + 1
                limit = limits.get(given.name)
                if limit is not None and count[given.name] > limit:
                    self._steps.append(TOO_OFTEN(team=team, name=given.name, times=limit))
                else:
                    total += Fraction(given.points)
        return total

    def _total(self, team: str, numbers: Sequence[Fraction], adjusted: Fraction) -> Fraction:
        parts = [(column.name, number) for column, number in zip(self._stage.of, numbers)]
        parts += [(", ".join(dict.fromkeys(given.name for given in self._adjusted if given.team == team)), adjusted)
                  ] if adjusted else []
        total = sum((number for _, number in parts), ZERO)
        said = _sum_text([part for part in parts if part[1]])
        if self._stage.least is not None and total < Fraction(self._stage.least):
            total = Fraction(self._stage.least)
            self._steps.append(AT_LEAST(team=team, sum=said, limit=number_text(total), points=number_text(total)))
        else:
            self._steps.append(SUM(team=team, sum=said, points=number_text(total)))
        return total

    # -- ties and who advances ----------------------------------------------------------------------

    def _deciding(self, team: str, columns: Sequence[Mapping[str, Fraction]]) -> List[Fraction]:
        """Return the numbers that decide where a team ties with others; more is better."""
        found = []
        for name in self._stage.ties:
            own = [numbers[team] for column, numbers in zip(self._stage.of, columns) if column.subject == name]
            if own:
                number = sum(own, ZERO)
                sign = -1 if self._stage.places_count else 1
            elif name in self._before:
                number = next((line.total or ZERO for line in self._before[name].lines if line.team == team), ZERO)
                sign = -1 if self._before[name].stage.places_count else 1
            else:
                results = self._results.get(name, {}).get(team, ())
                number = number_of(self._attempts.get(name, AttemptsRule()), results)
                sign = 1
            found.append(sign * number)
        return found

    def _say_ties(self, lines: Sequence[StageLine], keys: Mapping[str, Tuple[Any, ...]]) -> None:
        """Say what decided where teams had equal sums."""
        if not self._stage.ties:
            return
        equal: Dict[Any, List[StageLine]] = {}
        for line in lines:
            if line.total is not None and not line.disqualified:
                equal.setdefault(line.total, []).append(line)
        for group in equal.values():
            apart = [place for place in range(len(self._stage.ties))
                     if len({keys[line.team][3 + place] for line in group}) > 1]
            if apart:
                self._steps.append(TIED(teams=", ".join(line.team for line in group), stage=self._stage.name,
                                        place=group[0].place, by=self._stage.ties[apart[0]]))

    def _who_advances(self, lines: Sequence[StageLine]) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
        """Return who advances, and those of whom it is not decided."""
        stage = self._stage
        taking_part = [line for line in lines if line.total is not None]
        able = [line for line in taking_part if not line.disqualified]
        number = len(able)
        for least, most in sorted(stage.advance):
            number = most if len(taking_part) >= least else number
        number = min(number, len(able))
        before = [line.team for line in able if line.place <= number and
                  sum(other.place <= line.place for other in able) <= number]
        cut = [line.team for line in able if line.place <= number and line.team not in before]
        left = number - len(before)
        chosen: Set[str] = set(stage.chosen)
        undecided: List[str] = []
        if cut and stage.asks:
            if len(chosen.intersection(cut)) < left:
                undecided = [team for team in cut if team not in chosen]
                self._notes[ASK(stage=stage.name, teams=", ".join(cut), number=left)] = None
        elif cut:
            self._notes[ALL_ADVANCE(stage=stage.name, teams=", ".join(cut))] = None
            before += cut
        found = [line.team for line in able if line.team in before or line.team in chosen]
        if stage.advance:
            said = ADVANCE(stage=stage.name, count=len(taking_part), number=number, teams=", ".join(
                team for team in found if team not in self._disqualified))
            self._notes[said] = None
            self._steps.append(said)
        return tuple(found), tuple(undecided)


def _sum_text(parts: Sequence[Tuple[str, Fraction]]) -> str:
    """Return a sum with the names of what is added: HRI 650 + GPSR 500 − No referee provided 250."""
    text = ""
    for name, number in parts:
        sign = "−" if number < 0 else "+"
        text += f"{f' {sign} ' if text else '−' if number < 0 else ''}{name} {number_text(abs(number))}"
    return text or "0"
