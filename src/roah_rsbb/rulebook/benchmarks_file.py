"""The benchmarks file: what each benchmark is called, how long it takes, what the referee scores."""

from typing import Dict, List, Optional, Set, Tuple

from roah_rsbb.rulebook.benchmarks import KINDS, Benchmark, ScoreKind, ScoringItem
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.yaml_fields import choice, describe, fields, number, sequence, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Unusable, read_yaml

# A run of more than a day is a typing error.
MAX_TIMEOUT_S = 86400

_REQUIRED = {
    "name": "Task Benchmark 1",
    "desc": "Getting to know my home",
    "code": "HGTKMH",
    "timeout": "600",
}
_OPTIONAL = {"total_timeout": "600", "scoring": "[...]"}
_ITEM = {"type": "bool", "desc": "The robot finds the door"}
_SHAPE = "benchmarks, '- name: ...' and so on"
_ITEMS_SHAPE = "items '- {type: bool, desc: ...}'"
_GROUPS_SHAPE = "groups '- Achievements: [...]', or no key 'scoring'"
_SCORE_KINDS = {"bool": ScoreKind.BOOL, "uint": ScoreKind.UINT}


class BenchmarksFile:
    """The file's benchmarks by code, and the codes that it means to describe.

    `codes` includes those of entries with errors; None: they cannot be known, the file or the code of
    an entry being unreadable.
    """

    def __init__(self, path: str, report: Report) -> None:
        self.path = path
        self.by_code: Dict[str, Benchmark] = {}
        self.codes: Optional[Set[str]] = None
        self._report = report
        self._places: Dict[str, Place] = {}
        what = "the benchmarks file (parameter benchmarks_file)"
        root = read_yaml(path, report, what, f"a sequence of {_SHAPE}")
        entries = sequence(report, root, "the file's content", _SHAPE)
        if entries is None:
            return
        found = [self._entry(entry) for entry in entries]
        # A code or a key twice, or none: another code may be meant.
        doubtful = None in found or len(set(found)) < len(found)
        self.codes = None if doubtful else {code for code in found if code}

    def _entry(self, node: Node) -> Optional[str]:
        """Read one benchmark; return its code if that is sure, also if something else is wrong."""
        report = self._report
        got = fields(report, node, "a benchmark", _REQUIRED, _OPTIONAL)
        if got is None:
            return None
        code = choice(report, got.get("code"), "code", tuple(KINDS), "a benchmark code")
        name = text(report, got.get("name"), "name")
        desc = text(report, got.get("desc"), "desc")
        timeout = _timeout(report, got, "timeout")
        total = _timeout(report, got, "total_timeout") if "total_timeout" in got else timeout
        scoring = self._scoring(got.get("scoring"))
        if code is None:
            return None
        found = f"a second benchmark with code {quote(code)}"
        report.once(self._places, code, got["code"].place, found, "each code once")
        if timeout is not None and total is not None:
            if total < timeout:
                report.warn(
                    got["total_timeout"].place,
                    f"total_timeout {total:g} of {code} is less than its timeout {timeout:g}: "
                    "it ends the run before the first goal's time is over",
                )
            if name is not None and desc is not None:
                self.by_code[code] = Benchmark(code, name, desc, timeout, total, scoring)
        return code if isinstance(node, Mapping) and node.whole else None

    def _scoring(self, node: Optional[Node]) -> Tuple[ScoringItem, ...]:
        """Read the scoring items; those with errors are left out."""
        items: List[ScoringItem] = []
        places: Dict[Tuple[str, str], Place] = {}
        for group in sequence(self._report, node, "scoring", _GROUPS_SHAPE) or ():
            if not isinstance(group, Mapping):
                if not isinstance(group, Unusable):
                    self._report.error(group.place, f"{describe(group)} in scoring", _GROUPS_SHAPE)
                continue
            for key, value in group.pairs:
                name = text(self._report, key, "name of a scoring group")
                what = f"items of the scoring group {quote(key.text)}"
                for entry in sequence(self._report, value, what, _ITEMS_SHAPE) or ():
                    item = self._item(entry, name, places)
                    items += [item] if item else []
        return tuple(items)

    def _item(
        self, node: Node, group: Optional[str], places: Dict[Tuple[str, str], Place]
    ) -> Optional[ScoringItem]:
        got = fields(self._report, node, "a scoring item", _ITEM, {})
        if got is None:
            return None
        kind = choice(self._report, got.get("type"), "type", tuple(_SCORE_KINDS), "a scoring type")
        desc = text(self._report, got.get("desc"), "desc of a scoring item")
        if group is None or desc is None:
            return None
        found = f"the scoring item {quote(desc)} a second time in group {quote(group)}"
        self._report.once(places, (group, desc), got["desc"].place, found, "each desc of a group once")
        return None if kind is None else ScoringItem(group, desc, _SCORE_KINDS[kind])


def _timeout(report: Report, got: Dict[str, Node], key: str) -> Optional[float]:
    return number(report, got.get(key), key, unit="seconds", above=0, most=MAX_TIMEOUT_S)
