"""The rules by which runs are ranked, read from a YAML file (docs/results.md, "Standings").

A benchmark has criteria. The first one decides; in a tie the next one does, and so on. Each criterion is a weighted
sum of items of the referee's sheet, of its points, and of values of the benchmarking module. `stage_rules` reads how
several benchmarks become one ranking.
"""

from typing import Dict, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.rules import Adjusted, AttemptsRule, Decision, Stage
from roah_rsbb.rulebook.decisions import decisions_in, resolved
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.stage_rules import StageReader, attempts_rule, benchmark_code
from roah_rsbb.rulebook.yaml_fields import all_of, fields, number, one_of, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Unusable, read_yaml

_SHAPE = "a map 'CODE: {runs: best, criteria: [...]}' of benchmarks"
_CRITERION = {"name": "Achievements", "of": "[{group: Achievements}]"}
_CRITERION_OPTIONAL = {"better": "more"}
_TERM_OPTIONAL = {
    "group": "Achievements", "item": "Detects a changed object", "score": "reached", "points": "total", "weight": "1",
}
# The keys of the stages, now and before, and of a term the points of the whole sheet.
STAGES, OVERALL, TOTAL = "stages", "overall", "total"


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

    attempts: AttemptsRule  # which of a team's runs count
    disqualified_by: Tuple[str, ...]  # groups of the sheet: an entry in one of them disqualifies the run
    criteria: Tuple[Criterion, ...]  # empty: those of a benchmark without rules


# Apply to benchmarks that the file does not name: those whose sheet gives points, and the others.
BY_POINTS = Rules(AttemptsRule(), (), (Criterion("Points", True, (Term(points=TOTAL),)),))
DEFAULT = Rules(AttemptsRule(), (), (Criterion("Sum of the sheet", True, (Term(),)),))


class StandingRules(Dict[str, Rules]):
    """The rules of all benchmarks by their codes, and the stages."""

    stages: Tuple[Stage, ...] = ()
    adjusted: Tuple[Adjusted, ...] = ()  # what teams were given outside any run
    decisions: Tuple[Decision, ...] = ()  # what they leave to people, or all rules of the competition do

    def __eq__(self, other: object) -> bool:
        return (dict.__eq__(self, other) is True and self.stages == getattr(other, "stages", ())
                and self.adjusted == getattr(other, "adjusted", ()))

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None


def read_rules(
    path: str, codes: Optional[Sequence[str]] = None, teams: Optional[Sequence[str]] = None
) -> StandingRules:
    """Read the rules; raises `ConfigErrors` with all errors of the file.

    `codes`, `teams`: the benchmarks and teams that stages may name; None: they are not known.
    """
    report = Report()
    rules = StandingRules()
    root = read_yaml(path, report, "the file with the standings' rules (--rules)", _SHAPE)
    root, decided = resolved(report, root, path)
    rules.decisions = decisions_in(decided)
    if isinstance(root, Mapping):
        found = {key.text: node for key, node in root.pairs if key.text in (OVERALL, STAGES)}
        for key, node in root.pairs:
            if key.text in found:
                continue
            code = benchmark_code(report, key, codes or ())
            rules[code or key.text] = _rules(report, node)
        # They may name any benchmark of the file, also one after them.
        less = tuple(code for code, own in rules.items() if own.criteria and not own.criteria[0].more_is_better)
        stages = StageReader(report, less, codes, teams)
        stages.read(found.get(STAGES))
        stages.read_overall(found.get(OVERALL))
        rules.stages, rules.adjusted = tuple(stages.found), tuple(stages.adjusted)
    elif root is not None and not isinstance(root, Unusable):
        report.error(root.place, "unexpected content", _SHAPE)
    report.raise_errors()
    return rules


# What has an error is in the report, so nobody uses what is returned for it.


def _rules(report: Report, node: Node) -> Rules:
    got = fields(report, node, "a benchmark's rules", {},
                 {"criteria": "[...]", "runs": "best", "disqualified_by": "[Disqualifying Behaviors]"}) or {}
    return Rules(
        attempts_rule(report, got.get("runs"), "runs") or AttemptsRule(),
        all_of(report, got.get("disqualified_by"), "disqualified_by", "groups of the score sheet",
               lambda group: text(report, group, "group")),
        all_of(report, got.get("criteria"), "criteria", "criteria, '- {name: ..., of: [...]}'",
               lambda criterion: _criterion(report, criterion)))


def _criterion(report: Report, node: Node) -> Criterion:
    got = fields(report, node, "a criterion", _CRITERION, _CRITERION_OPTIONAL) or {}
    return Criterion(
        text(report, got.get("name"), "name") or "",
        one_of(report, got.get("better"), "better", {"more": True, "less": False},
               "whether more or less is better") is not False,
        all_of(report, got.get("of"), "of", "terms, '- {group: Achievements}' or '- {score: reached}'",
               lambda term: _term(report, term)))


def _term(report: Report, node: Node) -> Optional[Term]:
    got = fields(report, node, "a term", {}, _TERM_OPTIONAL)
    if got is None:
        return None
    words = {key: text(report, got[key], key) or "" for key in ("group", "item", "score", "points") if key in got}
    weight = number(report, got.get("weight"), "weight")
    if len(words) > 1 and ("score" in words or "points" in words):
        alone = "score" if "score" in words else "points"
        others = " or ".join(f"'{key}'" for key in words if key != alone)
        return report.error(
            node.place, f"a term with '{alone}' and {others}",
            "either a value of the benchmarking module (score), points, or items of the referee's sheet")
    if not words:
        return report.error(node.place, "an empty term", "'group', 'item', 'points' or 'score'")
    return Term(weight=1.0 if weight is None else weight, **words)
