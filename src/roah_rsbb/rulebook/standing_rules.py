"""The rules by which runs are ranked, read from a YAML file (docs/results.md, "Standings").

A benchmark has criteria. The first one decides; in a tie the next one does, and so on. Each criterion is a weighted
sum of items of the referee's sheet, of its points, and of values of the benchmarking module. An overall standing is a
weighted sum of the first criteria of several benchmarks.
"""

import enum
from decimal import Decimal
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.registry import CODE, PROFILES
from roah_rsbb.rulebook.yaml_fields import choice, exact, fields, number, sequence, text, utc_time
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Unusable, read_yaml
from roah_rsbb.wording.texts import nearest
from roah_rsbb.wording.times import formatted

_SHAPE = "a map 'CODE: {runs: best, criteria: [...]}' of benchmarks"
_CRITERION = {"name": "Achievements", "of": "[{group: Achievements}]"}
_CRITERION_OPTIONAL = {"better": "more"}
_TERM_OPTIONAL = {
    "group": "Achievements", "item": "Detects a changed object", "score": "reached", "points": "total", "weight": "1",
}
# The key of the overall standings, and of a term the points of the whole sheet.
OVERALL, TOTAL = "overall", "total"
_OVERALL = {"name": "Overall", "of": "[{benchmark: HGTKMH}]"}
_OVERALL_OPTIONAL = {"normalised": "best", "ties": "[HGTKMH]"}
_PART = {"benchmark": "HGTKMH"}
_PART_OPTIONAL = {"weight": "1", "day": "2026-11-28", "maximum": "500"}
MAX_WEIGHT = 1_000_000


class OfRuns(enum.Enum):
    """Which of a team's runs counts."""

    BEST = "best"
    MEAN = "mean"
    MEDIAN = "median"


class Term(NamedTuple):
    """Part of a criterion, multiplied by `weight`: items of the sheet, points, or a value of the module (`score`)."""

    group: str = ""  # of the sheet; empty: any group
    item: str = ""  # of the sheet; empty: all items of the group
    score: str = ""  # the name of a value of the whole run
    weight: float = 1.0
    points: str = ""  # of this group of the sheet, or `TOTAL`

    def counts(self, group: str, item: str) -> bool:
        """Return whether an item of the sheet is added up."""
        return not self.score and not self.points and self.group in ("", group) and self.item in ("", item)


class Criterion(NamedTuple):
    """A number by which runs are compared."""

    name: str
    more_is_better: bool
    terms: Tuple[Term, ...]


class Rules(NamedTuple):
    """How a benchmark is ranked."""

    of_runs: OfRuns
    disqualified_by: Tuple[str, ...]  # groups of the sheet: an entry in one of them disqualifies the run
    criteria: Tuple[Criterion, ...]


# Apply to benchmarks that the file does not name: those whose sheet gives points, and the others.
BY_POINTS = Rules(OfRuns.BEST, (), (Criterion("Points", True, (Term(points=TOTAL),)),))
DEFAULT = Rules(OfRuns.BEST, (), (Criterion("Sum of the sheet", True, (Term(),)),))


class Normalised(enum.Enum):
    """How the numbers of several benchmarks become comparable."""

    BEST = "best"  # divided by that of the best team
    MAXIMUM = "maximum"  # divided by a fixed maximum
    NO = "no"


class StandingPart(NamedTuple):
    """A benchmark in an overall standing."""

    benchmark: str  # code
    weight: Decimal = Decimal(1)
    day: str = ""  # only runs that are scheduled on this day of the venue; empty: all
    maximum: Decimal = Decimal(0)  # of the number, for `Normalised.MAXIMUM`

    @property
    def name(self) -> str:
        """What the standing calls it."""
        return f"{self.benchmark} {self.day}".rstrip()


class Overall(NamedTuple):
    """The rules of an overall standing."""

    name: str
    parts: Tuple[StandingPart, ...]
    normalised: Normalised = Normalised.BEST
    ties: Tuple[str, ...] = ()  # codes: where teams tie, the first of these benchmarks decides, then the next


class StandingRules(Dict[str, Rules]):
    """The rules of all benchmarks by their codes, and the overall standings."""

    overall: Tuple[Overall, ...] = ()

    def __eq__(self, other: object) -> bool:
        return dict.__eq__(self, other) is True and self.overall == getattr(other, "overall", ())

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None


def read_rules(path: str) -> StandingRules:
    """Read the rules; raises `ConfigErrors` with all errors of the file."""
    report = Report()
    rules = StandingRules()
    root = read_yaml(path, report, "the file with the standings' rules (--rules)", _SHAPE)
    if isinstance(root, Mapping):
        for key, node in root.pairs:
            if key.text == OVERALL:
                continue
            code = _code(report, key)
            found = _rules(report, node)
            if code is not None and found is not None:
                rules[code] = found
        # A part may name any benchmark of the file, also one after the overall standings.
        overall = next((node for key, node in root.pairs if key.text == OVERALL), None)
        nodes = sequence(report, overall, OVERALL, "overall standings, '- {name: ..., of: [...]}'")
        rules.overall = tuple(filter(None, [_overall(report, node, rules) for node in nodes or ()]))
    elif root is not None and not isinstance(root, Unusable):
        report.error(root.place, "unexpected content", _SHAPE)
    report.raise_errors()
    return rules


def _code(report: Report, key: Scalar) -> Optional[str]:
    """Read a code, also one that a competition defines; None after an error."""
    is_new = CODE.fullmatch(key.text) and nearest(key.text, PROFILES) is None
    return key.text if is_new else choice(report, key, "a benchmark", tuple(PROFILES), "a benchmark code")


def _rules(report: Report, node: Node) -> Optional[Rules]:
    got = fields(report, node, "a benchmark's rules", {"criteria": "[...]"},
                 {"runs": "best", "disqualified_by": "[Disqualifying Behaviors]"})
    if got is None:
        return None
    words = tuple(of.value for of in OfRuns)
    of_runs = choice(report, got["runs"], "runs", words, "which runs count") if "runs" in got else OfRuns.BEST.value
    groups: List[Optional[str]] = []
    if "disqualified_by" in got:
        nodes = sequence(report, got["disqualified_by"], "disqualified_by", "groups of the score sheet")
        groups = [text(report, group, "group") for group in nodes or ()]
    nodes = sequence(report, got.get("criteria"), "criteria", "criteria, '- {name: ..., of: [...]}'")
    criteria = [_criterion(report, criterion) for criterion in nodes or ()]
    if of_runs is None or None in groups or None in criteria or not criteria:
        return None
    return Rules(OfRuns(of_runs), tuple(filter(None, groups)), tuple(c for c in criteria if c is not None))


def _criterion(report: Report, node: Node) -> Optional[Criterion]:
    got = fields(report, node, "a criterion", _CRITERION, _CRITERION_OPTIONAL)
    if got is None:
        return None
    name = text(report, got.get("name"), "name")
    better = "more"
    if "better" in got:
        better = choice(report, got["better"], "better", ("more", "less"), "whether more or less is better") or ""
    nodes = sequence(report, got.get("of"), "of", "terms, '- {group: Achievements}' or '- {score: reached}'")
    terms = [_term(report, term) for term in nodes or ()]
    if name is None or not better or None in terms:
        return None
    return Criterion(name, better == "more", tuple(term for term in terms if term is not None))


def _term(report: Report, node: Node) -> Optional[Term]:
    got = fields(report, node, "a term", {}, _TERM_OPTIONAL)
    if got is None:
        return None
    words = {key: text(report, got[key], key) for key in ("group", "item", "score", "points") if key in got}
    weight = number(report, got["weight"], "weight") if "weight" in got else 1.0
    if len(words) > 1 and ("score" in words or "points" in words):
        alone = "score" if "score" in words else "points"
        others = " or ".join(f"'{key}'" for key in words if key != alone)
        report.error(node.place, f"a term with '{alone}' and {others}",
                     "either a value of the benchmarking module (score), points, or items of the referee's sheet")
        return None
    if not words:
        report.error(node.place, "an empty term", "'group', 'item', 'points' or 'score'")
        return None
    if weight is None or None in words.values():
        return None
    return Term(weight=weight, **{key: word for key, word in words.items() if word is not None})


# -- overall standings ------------------------------------------------------------------------------


def _overall(report: Report, node: Node, rules: Dict[str, Rules]) -> Optional[Overall]:
    got = fields(report, node, "an overall standing", _OVERALL, _OVERALL_OPTIONAL)
    if got is None:
        return None
    name = text(report, got.get("name"), "name")
    normalised: Optional[str] = Normalised.BEST.value
    if "normalised" in got:
        words = tuple(each.value for each in Normalised)
        normalised = choice(report, got["normalised"], "normalised", words, "how numbers become comparable")
    nodes = sequence(report, got.get("of"), "of", "benchmarks, '- {benchmark: HGTKMH, weight: 2}'")
    parts = [_part(report, part, normalised, rules) for part in nodes or ()]
    places: Dict[str, Place] = {}
    for part, each in zip(parts, nodes or ()):
        if part is not None:
            report.once(places, part.name, each.place, f"{quote(part.name)} again", "each benchmark (of a day) once")
    codes = tuple(part.benchmark for part in parts if part is not None)
    ties: List[Optional[str]] = []
    if "ties" in got:
        named = sequence(report, got["ties"], "ties", "benchmarks of this standing") or ()
        expected = "a benchmark of this standing"
        ties = [choice(report, word, "ties", codes, expected) for word in named] if None not in parts else []
    if name is None or normalised is None or not parts or None in parts or None in ties:
        return None
    return Overall(name, tuple(filter(None, parts)), Normalised(normalised), tuple(filter(None, ties)))


def _part(report: Report, node: Node, normalised: Optional[str], rules: Dict[str, Rules]) -> Optional[StandingPart]:
    got = fields(report, node, "a benchmark of an overall standing", _PART, _PART_OPTIONAL)
    if got is None:
        return None
    named = got.get("benchmark")
    code = _code(report, named) if isinstance(named, Scalar) else text(report, named, "benchmark")
    if code in rules and not rules[code].criteria[0].more_is_better:
        found = f"{code}, in whose first criterion less is better,"
        report.error(node.place, f"{found} in an overall standing", "a first criterion where more is better")
        return None
    weight = exact(report, got["weight"], "weight", 0, MAX_WEIGHT) if "weight" in got else Decimal(1)
    day = _day(report, got["day"]) if "day" in got else ""
    maximum: Optional[Decimal] = Decimal(0)
    if "maximum" in got:
        maximum = exact(report, got["maximum"], "maximum", Decimal("0.001"), MAX_WEIGHT)
    elif normalised == Normalised.MAXIMUM.value:
        report.error(node.place, "a benchmark without maximum, normalised to the maximum",
                     "something like 'maximum: 500'")
        return None
    if code is None or weight is None or day is None or maximum is None:
        return None
    return StandingPart(code, weight, day, maximum)


def _day(report: Report, node: Node) -> Optional[str]:
    """Read a day; None after an error."""
    seconds = utc_time(report, node, "day")
    return None if seconds is None else formatted(seconds, "%Y-%m-%d", in_utc=True)  # as it is written
