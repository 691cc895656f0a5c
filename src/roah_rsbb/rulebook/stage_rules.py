"""Reads the stages of a competition: how teams are ranked by several tests, and who advances (docs/results.md).

They are in the file with the rules of the standings. `overall` is how files had them before there were stages.
"""

from decimal import Decimal
from typing import Dict, List, Optional, Sequence, Tuple, Type, TypeVar

from roah_rsbb.model.rules import (
    Adjusted,
    Adjustment,
    Advance,
    Attempts,
    AttemptsRule,
    Disqualified,
    Others,
    Scale,
    Stage,
    StageColumn,
)
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.registry import CODE, PROFILES
from roah_rsbb.rulebook.yaml_fields import (
    YES_NO,
    all_of,
    choice,
    describe,
    exact,
    fields,
    integer,
    one_of,
    sequence,
    text,
    utc_time,
)
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Unusable
from roah_rsbb.wording.texts import nearest
from roah_rsbb.wording.times import formatted

MAX_WEIGHT = 1_000_000
MAX_NUMBER = 2**32 - 1

E = TypeVar("E", Scale, Others, Disqualified)

_STAGE = {"name": "Tasks", "of": "[{test: HGTKMH}]"}
_STAGE_OPTIONAL = {
    "teams": "Tasks", "normalised": "best", "adjustments": "{No referee provided: -250}", "advance": "{0: 3, 10: 4}",
    "others": "below", "ties": "[HGTKMH]", "asks": "yes", "min": "0",
    "given": "[{team: Alpha, adjustment: No referee provided}]", "chosen": "[Alpha]",
}
_COLUMN = {
    "test": "HGTKMH", "stage": "Tasks", "weight": "1", "attempts": "best", "normalised": "best", "maximum": "500",
    "rounds": "[1, 2]", "events": "[day-1-a]",
}
_ADJUSTMENT = {"points": "-250", "from": "-50", "to": "0", "times": "1", "disqualified": "last"}
_OVERALL = {"name": "Overall", "of": "[{benchmark: HGTKMH}]"}
_OVERALL_OPTIONAL = {"normalised": "best", "ties": "[HGTKMH]"}
_PART = {"benchmark": "HGTKMH"}
_PART_OPTIONAL = {"weight": "1", "day": "2026-11-28", "maximum": "500"}

_SEVERAL = (Attempts.SUM, Attempts.MEAN, Attempts.MEDIAN)
_OF_BEST = " of the best "


def attempts_rule(report: Report, node: Optional[Node], what: str) -> Optional[AttemptsRule]:
    """Read which of a team's runs count: best, mean, or the mean of the best 2."""
    word = node.text if isinstance(node, Scalar) else ""
    how, of_best, number = word.partition(_OF_BEST)
    if of_best and how in [each.value for each in _SEVERAL] and number.isdecimal() and 0 < int(number) < 1000:
        return AttemptsRule(Attempts(how), int(number))
    words = {each.value: AttemptsRule(each) for each in Attempts}
    return one_of(report, node, what, words, "which runs count, also such as 'mean of the best 2'")


def benchmark_code(report: Report, key: Scalar, codes: Sequence[str] = ()) -> Optional[str]:
    """Read a code: one of `codes`, or of the registry, or another that a competition may define; None after an error.
    """
    is_new = key.text in codes or (CODE.fullmatch(key.text) and nearest(key.text, PROFILES) is None)
    return key.text if is_new else choice(report, key, "a benchmark", tuple(PROFILES), "a benchmark code")


class StageReader:
    """Reads stages, and what teams were given outside any run."""

    def __init__(
        self, report: Report, less: Sequence[str], codes: Optional[Sequence[str]], teams: Optional[Sequence[str]]
    ) -> None:
        """Prepare. `less`: codes of benchmarks in whose first criterion less is better. `codes`, `teams`: what can be
        named; None: not known."""
        self.found: List[Stage] = []
        self.adjusted: List[Adjusted] = []
        self._report = report
        self._less = less
        self._codes = codes
        self._known_teams = teams
        self._is_old = False
        self._places: Dict[str, Place] = {}  # of the stages by name, also of those with errors

    def read(self, node: Optional[Node]) -> None:
        """Read the stages, in their order."""
        all_of(self._report, node, "stages", "stages, '- {name: Tasks, of: [...]}'", self._stage)

    def read_overall(self, node: Optional[Node]) -> None:
        """Read the overall standings of files without stages: stages with fewer keys, which know no other stage."""
        self._is_old, self._codes = True, None
        all_of(self._report, node, "overall", "overall standings, '- {name: ..., of: [...]}'", self._stage)

    # -- a stage ------------------------------------------------------------------------------------

    def _stage(self, node: Node) -> None:
        """Read a stage. Later ones may name it."""
        report, errors = self._report, len(self._report.errors)
        got = (fields(report, node, "an overall standing", _OVERALL, _OVERALL_OPTIONAL) if self._is_old else
               fields(report, node, "a stage", _STAGE, _STAGE_OPTIONAL))
        if got is None:
            return
        name = text(report, got.get("name"), "name") or ""
        teams = self._earlier(got.get("teams"), "teams")
        normalised = self._word(got, "normalised", Scale, "how numbers become comparable") or (
            Scale.BEST if self._is_old else Scale.NO)
        others = self._word(got, "others", Others, "where teams are ranked that did not advance") or Others.BELOW
        columns = self._columns(got.get("of"), normalised)
        before = len(report.errors)
        adjustments = self._adjustments(got.get("adjustments"))
        given = self._given(name, got.get("given"), adjustments) if len(report.errors) == before else []
        advance = self._advance(got.get("advance"))
        ties = self._ties(got.get("ties"), columns)
        asks = one_of(report, got.get("asks"), "asks", YES_NO, "yes or no") or False
        least = self._number(got, "min")
        chosen = all_of(report, got.get("chosen"), "chosen", "teams", self._team)
        if name and not self._is_old:
            report.once(self._places, name, node.place, f"the stage {quote(name)} again", "each stage once")
        if "others" in got and "teams" not in got:
            report.error(got["others"].place, "'others' in a stage of all teams", "also 'teams: NAME OF A STAGE'")
        if len(report.errors) == errors and all(key in got for key in _STAGE):
            self.adjusted += given
            self.found.append(Stage(name, tuple(columns), teams, normalised, adjustments, advance, others, ties, asks,
                                    least, chosen))

    def _columns(self, node: Optional[Node], normalised: Scale) -> List[StageColumn]:
        shape = "benchmarks, '- {benchmark: " if self._is_old else "tests and earlier stages, '- {test: "
        nodes = sequence(self._report, node, "of", shape + "HGTKMH, weight: 2}'") or ()
        found: List[StageColumn] = []
        places: Dict[str, Place] = {}
        for each in nodes:
            column = self._column(each, normalised)
            if column is not None:
                self._report.once(places, column.name, each.place, f"{quote(column.name)} again",
                                  "each test and each stage once, or different rounds or events of it")
                found.append(column)
        scales = {column.normalised or normalised for column in found}
        for column, each in zip(found, nodes):
            before = next((stage for stage in self.found if stage.name == column.stage), None)
            if before is not None and before.places_count and scales != {Scale.RANK}:
                self._report.error(each.place, f"{quote(column.stage)}, which adds up places, beside other numbers",
                                   "'normalised: rank'")
        return found

    def _column(self, node: Node, normalised: Scale) -> Optional[StageColumn]:
        report, errors = self._report, len(self._report.errors)
        key = "benchmark" if self._is_old else "test"
        got = (fields(report, node, "a benchmark of an overall standing", _PART, _PART_OPTIONAL) if self._is_old else
               fields(report, node, "a column of a stage", {}, _COLUMN))
        if got is None:
            return None
        if not self._is_old and ("test" in got) == ("stage" in got):
            return report.error(node.place, "a column of a stage with 'test' and 'stage', or with neither",
                                "one of them")
        test = self._test(got[key]) if key in got else ""
        stage = self._earlier(got.get("stage"), "stage")
        for key in ("attempts", "rounds", "events"):
            if key in got and "stage" in got:
                report.error(got[key].place, f"{quote(key)} of a stage", f"{quote(key)} only beside 'test'")
        weight = exact(report, got.get("weight"), "weight", 0, MAX_WEIGHT)
        attempts = attempts_rule(report, got.get("attempts"), "attempts")
        own = self._word(got, "normalised", Scale, "how its numbers become comparable")
        maximum = exact(report, got.get("maximum"), "maximum", Decimal("0.001"), MAX_WEIGHT)
        if (own or normalised) is Scale.MAXIMUM and "maximum" not in got:
            report.error(node.place, "a column without maximum, normalised to the maximum",
                         "something like 'maximum: 500'")
        rounds = all_of(report, got.get("rounds"), "rounds", "numbers of rounds, such as [1, 2]",
                        lambda each: integer(report, each, "a round", 1, MAX_NUMBER))
        events = all_of(report, got.get("events"), "events", "ids of events",
                        lambda each: text(report, each, "an event"))
        seconds = utc_time(report, got.get("day"), "day")
        day = "" if seconds is None else formatted(seconds, "%Y-%m-%d", in_utc=True)  # as it is written
        return None if len(report.errors) > errors else StageColumn(
            test or "", stage, Decimal(1) if weight is None else weight, attempts, own, maximum, rounds, events, day)

    def _test(self, node: Node) -> Optional[str]:
        if not isinstance(node, Scalar):
            return text(self._report, node, "test")
        code = benchmark_code(self._report, node) if self._codes is None else choice(
            self._report, node, "a test", tuple(self._codes), "the code of a benchmark of this competition")
        if code in self._less:
            self._report.error(node.place, f"{code}, in whose first criterion less is better, in a stage",
                               "a first criterion where more is better")
        return code

    def _earlier(self, node: Optional[Node], what: str) -> str:
        return choice(self._report, node, what, tuple(self._places), "an earlier stage") or ""

    def _ties(self, node: Optional[Node], columns: Sequence[StageColumn]) -> Tuple[str, ...]:
        names = tuple(dict.fromkeys([*(column.subject for column in columns), *self._places]))
        may_be_other = self._codes is None and not self._is_old

        def read(each: Node) -> Optional[str]:
            is_other = isinstance(each, Scalar) and each.text not in names and nearest(each.text, names) is None
            if isinstance(each, Scalar) and is_other and may_be_other:
                return benchmark_code(self._report, each)
            known = tuple(dict.fromkeys((*names, *(self._codes or ()))))
            return choice(self._report, each, "ties", known, "a test, or an earlier stage")

        return all_of(self._report, node, "ties", "tests or earlier stages", read)

    def _advance(self, node: Optional[Node]) -> Tuple[Advance, ...]:
        if isinstance(node, Scalar):
            number = integer(self._report, node, "advance", 1, MAX_NUMBER)
            return () if number is None else (Advance(0, number),)
        found = []
        for key, value in self._pairs(node, "advance", "{0: 3, 10: 4}: from 10 teams on, 4 advance"):
            least = integer(self._report, key, "the number of teams", 0, MAX_NUMBER)
            most = integer(self._report, value, "how many advance", 1, MAX_NUMBER)
            if least is not None and most is not None:
                found.append(Advance(least, most))
        if node is not None and found and min(found)[0] > 1:
            self._report.error(node.place, f"nothing for fewer than {min(found)[0]} teams", "also '0: 3'")
        return tuple(sorted(found))

    # -- what a team gets outside any run ----------------------------------------------------------

    def _adjustments(self, node: Optional[Node]) -> Tuple[Adjustment, ...]:
        found = []
        for key, value in self._pairs(node, "adjustments", "{No referee provided: -250}"):
            name = text(self._report, key, "the name of an adjustment")
            if isinstance(value, Mapping):
                adjustment = self._adjustment(name or "", value)
            else:
                points = exact(self._report, value, f"points of {quote(key.text)}", -MAX_WEIGHT, MAX_WEIGHT)
                adjustment = Adjustment(name or "", points)
            found.append(adjustment)
        return tuple(found)

    def _adjustment(self, name: str, node: Mapping) -> Adjustment:
        got = fields(self._report, node, "an adjustment", {}, _ADJUSTMENT) or {}
        low, high = self._number(got, "from"), self._number(got, "to")
        times = integer(self._report, got.get("times"), "times", 1, MAX_NUMBER)
        out = self._word(got, "disqualified", Disqualified, "where a disqualified team is ranked")
        if "disqualified" in got and len(got) > 1:
            self._report.error(node.place, "points of a disqualification", "only 'disqualified'")
        if low is not None and high is not None and low > high:
            self._report.error(node.place, f"'from' {low} above 'to' {high}", "'from' at most 'to'")
        return Adjustment(name, self._number(got, "points"), low, high, times, out)

    def _given(self, stage: str, node: Optional[Node], adjustments: Sequence[Adjustment]) -> List[Adjusted]:
        report, found = self._report, []
        shape = "what teams were given, '- {team: Alpha, adjustment: No referee provided, reason: ...}'"
        for each in sequence(report, node, "given", shape) or ():
            got = fields(report, each, "what a team was given", {"team": "Alpha", "adjustment": "No referee provided"},
                         {"points": "-30", "reason": "day 2, 10:00"})
            if got is None or not {"team", "adjustment"} <= got.keys():
                continue
            team = self._team(got["team"])
            name = choice(report, got["adjustment"], "adjustment", tuple(one.name for one in adjustments),
                          "an adjustment of this stage")
            reason = text(report, got.get("reason"), "reason") or ""
            if team is not None and name is not None:
                points = self._points_given(each, got, next(one for one in adjustments if one.name == name))
                found.append(Adjusted(team, stage, name, points or Decimal(0), reason))
        return found

    def _points_given(self, node: Node, got: Dict[str, Node], rule: Adjustment) -> Optional[Decimal]:
        if rule.disqualified is not None or rule.points is not None:
            if "points" in got:
                return self._report.error(got["points"].place, f"points of {quote(rule.name)}",
                                          "none: the rules give them")
            return rule.points or Decimal(0)
        if "points" not in got:
            return self._report.error(node.place, f"{quote(rule.name)} without points", "something like 'points: -30'")
        return exact(self._report, got["points"], "points", -MAX_WEIGHT if rule.low is None else rule.low,
                     MAX_WEIGHT if rule.high is None else rule.high)

    def _team(self, node: Node) -> Optional[str]:
        if self._known_teams is None:
            return text(self._report, node, "team")
        return choice(self._report, node, "team", tuple(self._known_teams), "a team of the schedule")

    # -- values -------------------------------------------------------------------------------------

    def _word(self, got: Dict[str, Node], key: str, kind: Type[E], expected: str) -> Optional[E]:
        return one_of(self._report, got.get(key), key, {each.value: each for each in kind}, expected)

    def _number(self, got: Dict[str, Node], key: str) -> Optional[Decimal]:
        return exact(self._report, got.get(key), key, -MAX_WEIGHT, MAX_WEIGHT)

    def _pairs(self, node: Optional[Node], what: str, shape: str) -> Sequence[Tuple[Scalar, Node]]:
        if node is None or isinstance(node, Unusable):
            return ()
        if not isinstance(node, Mapping):
            self._report.error(node.place, f"{describe(node)} as {what}", f"a map such as {shape}")
            return ()
        return node.pairs
