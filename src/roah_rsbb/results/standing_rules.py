"""The rules by which runs are ranked, read from a YAML file (docs/results.md, "Standings").

A benchmark has criteria. The first one decides; in a tie the next one does, and so on. Each criterion is a weighted
sum of items of the referee's sheet and of values of the benchmarking module.
"""

import enum
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.scoring.records import ItemRecord
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.registry import CODE, PROFILES
from roah_rsbb.rulebook.yaml_fields import choice, fields, number, sequence, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Unusable, read_yaml
from roah_rsbb.wording.suggestions import nearest

_SHAPE = "a map 'CODE: {runs: best, criteria: [...]}' of benchmarks"
_CRITERION = {"name": "Achievements", "of": "[{group: Achievements}]"}
_CRITERION_OPTIONAL = {"better": "more"}
_TERM_OPTIONAL = {"group": "Achievements", "item": "Detects a changed object", "score": "reached", "weight": "1"}


class OfRuns(enum.Enum):
    """Which of a team's runs counts."""

    BEST = "best"
    MEAN = "mean"
    MEDIAN = "median"


class Term(NamedTuple):
    """Part of a criterion: items of the sheet, or a value of the module (`score`), multiplied by `weight`."""

    group: str = ""  # of the sheet; empty: any group
    item: str = ""  # of the sheet; empty: all items of the group
    score: str = ""  # the name of a value of the whole run
    weight: float = 1.0

    def counts(self, item: ItemRecord) -> bool:
        """Returns whether an item of the sheet is added up."""
        return not self.score and self.group in ("", item.group) and self.item in ("", item.desc)


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


# Applies to benchmarks that the file does not name.
DEFAULT = Rules(OfRuns.BEST, (), (Criterion("Sum of the sheet", True, (Term(),)),))


def read_rules(path: str) -> Dict[str, Rules]:
    """Read the rules by benchmark code; raises `ConfigErrors` with all errors of the file."""
    report = Report()
    rules: Dict[str, Rules] = {}
    root = read_yaml(path, report, "the file with the standings' rules (--rules)", _SHAPE)
    if isinstance(root, Mapping):
        for key, node in root.pairs:
            code = _code(report, key)
            found = _rules(report, node)
            if code is not None and found is not None:
                rules[code] = found
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
    if of_runs is None or None in groups or None in criteria:
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
    words = {key: text(report, got[key], key) for key in ("group", "item", "score") if key in got}
    weight = number(report, got["weight"], "weight") if "weight" in got else 1.0
    if "score" in words and len(words) > 1:
        report.error(node.place, "a term with 'score' and 'group' or 'item'",
                     "either a value of the benchmarking module (score), or items of the referee's sheet")
        return None
    if not words:
        report.error(node.place, "an empty term", "'group', 'item' or 'score'")
        return None
    if weight is None or None in words.values():
        return None
    return Term(weight=weight, **{key: word for key, word in words.items() if word is not None})
