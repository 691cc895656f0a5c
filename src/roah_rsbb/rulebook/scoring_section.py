"""Reads the key `scoring` of files before 2026-12 as the key `sheet` (docs/organiser.md, "Points").

Sheets were groups of items, with limits of each group and of the whole sheet, and a bonus for the time left. Here they
only get another shape: `sheet_file` reads the values, and reports errors in them at their places in the file.
"""

from typing import Dict, List, Optional, Tuple

from roah_rsbb.model.rules import Measure
from roah_rsbb.model.scoring import MAX_DECIMALS, TIME_LEFT, WHOLE_SHEET, Key, ScoreKind, earlier_id
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.yaml_fields import describe, fields, one_of, sequence, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable

_ITEMS_SHAPE = "items '- {type: bool, desc: ...}'"
_GROUPS_SHAPE = "groups '- Achievements: [...]', or no key 'scoring'"
_SHEET = {"groups": "[...]"}
_SHEET_OPTIONAL = {"min": "0", "max": "1000", "time_left": "{points: 1, seconds: 10}"}
_GROUP = {"items": "[...]"}
_GROUP_OPTIONAL = {"min": "0", "max": "100"}
_TIME_LEFT = {"points": "1"}
_TIME_LEFT_OPTIONAL = {"seconds": "10", "max": "60", "needs": "Completes the task"}
_ITEM = {"type": "bool", "desc": "The robot finds the door"}
_ITEM_OPTIONAL = {
    "points": "10", "needs": "The robot starts", "min": "0", "max": "5", "choices": "{fully: 20, partly: 10}",
    "judges": "3", "jury": "mean",
}
_KINDS = {kind.word: kind for kind in ScoreKind}
# What each type is now, and its keys besides type, desc and needs, with the names that they have now.
_KEYS = {
    ScoreKind.BOOL: (Measure.YES, {"points": "points"}),
    ScoreKind.UINT: (Measure.COUNT, {"points": "points", "max": "times"}),
    ScoreKind.INT: (Measure.WHOLE, {"points": "points", "min": "from", "max": "to"}),
    ScoreKind.DECIMAL: (Measure.NUMBER, {"points": "points", "min": "from", "max": "to"}),
    ScoreKind.CHOICE: (Measure.CHOICE, {"choices": "choices"}),
    ScoreKind.RATING: (Measure.RATING, {
        "points": "points", "min": "from", "max": "to", "judges": "judges", "jury": "jury"}),
}
_Pairs = List[Tuple[str, Node]]


def as_sheet(report: Report, node: Node) -> Node:
    """Return the value of a key `scoring` as that of a key `sheet`."""
    return _Scoring(report, node).sheet


class _Scoring:
    def __init__(self, report: Report, node: Node) -> None:
        self._report = report
        self._keys: Dict[Key, Node] = {}  # of the items -> their descs
        got: Dict[str, Node] = {"groups": node}
        if isinstance(node, Mapping):
            got = fields(report, node, "scoring", _SHEET, _SHEET_OPTIONAL) or {}
        groups = self._groups(got.get("groups"))
        rows: List[Node] = [
            self._row(value.place, [("section", key), ("id", self._text(f"{name}:", key.place)), *self._limits(value), (
                "items", Sequence(value.place, tuple(self._with_needs(item, name) for item in items)))])
            for name, (key, value, items) in groups.items() if items]
        if "time_left" in got:
            rows += self._time_left(got["time_left"], groups)
        if {"min", "max"} & got.keys():
            place = node.place
            rows = [self._row(place, [
                ("section", self._text(WHOLE_SHEET, place)), ("id", self._text(f"{WHOLE_SHEET}.", place)),
                *((key, got[key]) for key in ("min", "max") if key in got), ("items", Sequence(place, tuple(rows)))])]
        self.sheet: Node = Sequence(node.place, tuple(rows)) if rows else Unusable(node.place)

    def _groups(self, node: Optional[Node]) -> Dict[str, Tuple[Scalar, Node, List[Node]]]:
        """Return each group with its name, what it has, and its items; those of the same name are one."""
        report = self._report
        found: Dict[str, Tuple[Scalar, Node, List[Node]]] = {}
        places: Dict[str, Place] = {}
        for group in sequence(report, node, "scoring", _GROUPS_SHAPE) or ():
            if not isinstance(group, Mapping):
                if not isinstance(group, Unusable):
                    report.error(group.place, f"{describe(group)} in scoring", _GROUPS_SHAPE)
                continue
            for key, value in group.pairs:
                name, items = text(report, key, "name of a scoring group"), value
                what = f"the scoring group {quote(key.text)}"
                if isinstance(value, Mapping):
                    got = fields(report, value, what, _GROUP, _GROUP_OPTIONAL) or {}
                    items = got.get("items", Unusable(key.place))
                    if self._limits(value):
                        report.once(places, key.text, value.place, f"limits of {what} a second time",
                                    "limits of each group once")
                read = [self._item(item, key.text)
                        for item in sequence(report, items, f"items of {what}", _ITEMS_SHAPE) or ()]
                if name is not None:
                    before = found.setdefault(name, (key, value, []))
                    found[name] = key, value if self._limits(value) else before[1], [*before[2], *read]
        return found

    def _item(self, node: Node, group: str) -> Node:
        report = self._report
        got = fields(report, node, "a scoring item", _ITEM, _ITEM_OPTIONAL) or {}
        kind = one_of(report, got.get("type"), "type", _KINDS, "a scoring type")
        if kind is None or "desc" not in got:
            return Unusable(node.place)
        amount, keys = _KEYS[kind]
        for key in got:
            if key not in (*_ITEM, "needs", *keys):
                expected = f"one of {listing(map(quote, (*keys, 'needs')))}"
                if key == "points" and kind is ScoreKind.CHOICE:
                    expected = "the points of each choice, such as 'choices: {fully: 20, partly: 10}'"
                report.error(got[key].place, f"the key {quote(key)} in an item of type {kind.word}", expected)
        if kind is ScoreKind.RATING and "max" not in got:
            return report.error(node.place, "an item of type rating without max", "something like 'max: 5'") or (
                Unusable(node.place))
        desc, place = got["desc"], node.place
        pairs: _Pairs = [("item", desc), ("amount", self._text(amount.value, place))]
        pairs += [(keys[key], value) for key, value in got.items() if key in keys]
        pairs += [("needs", got["needs"])] if "needs" in got else []
        if kind is ScoreKind.UINT and "max" not in got:
            pairs.append(("times", self._text("unlimited", place)))
        if "points" in got and kind is not ScoreKind.CHOICE:
            pairs.append(("decimals", self._text(str(MAX_DECIMALS), place)))
        if isinstance(desc, Scalar):
            pairs.append(("id", self._text(earlier_id((group, desc.text)), desc.place)))
            self._keys.setdefault((group, desc.text), desc)
        return self._row(place, pairs, isinstance(node, Mapping) and node.whole)

    def _time_left(self, node: Node, groups: Dict[str, Tuple[Scalar, Node, List[Node]]]) -> List[Node]:
        """Return the row of the bonus for the time left."""
        got = fields(self._report, node, "time_left", _TIME_LEFT, _TIME_LEFT_OPTIONAL)
        if TIME_LEFT in groups:
            self._report.error(
                node.place, f"time_left, and a scoring group '{TIME_LEFT}' in line {groups[TIME_LEFT][0].place.line}",
                "another name of the group: the sheet lists the points for the time left under this name")
        if got is None:
            return []
        name = self._text(TIME_LEFT, node.place)
        row = self._row(node.place, [("item", name), ("amount", self._text("clock", node.place)), *got.items()])
        return [self._with_needs(row, "")]

    def _with_needs(self, item: Node, group: str) -> Node:
        """Return an item whose `needs` are ids. They name an item of its group, else of the whole sheet."""
        if not isinstance(item, Mapping):
            return item
        own = next((value.text for key, value in item.pairs if key.text == "id" and isinstance(value, Scalar)), "")

        def named(node: Node) -> Node:
            if isinstance(node, Sequence):
                return Sequence(node.place, tuple(map(named, node.items)))
            if not isinstance(node, Scalar):
                return node
            keys = [key for key in self._keys if key[1] == node.text and earlier_id(key) != own]
            keys = [key for key in keys if key[0] == group] or keys
            return self._text(earlier_id(keys[0]), node.place) if len(keys) == 1 else node

        pairs = tuple((key, named(value) if key.text == "needs" else value) for key, value in item.pairs)
        return Mapping(item.place, pairs, item.whole)

    @staticmethod
    def _limits(value: Node) -> _Pairs:
        pairs = value.pairs if isinstance(value, Mapping) else ()
        return [(key.text, limit) for key, limit in pairs if key.text in _GROUP_OPTIONAL]

    @staticmethod
    def _text(words: str, place: Place) -> Scalar:
        return Scalar(place, words, quoted=False, secret=False)

    def _row(self, place: Place, pairs: _Pairs, whole: bool = True) -> Mapping:
        return Mapping(place, tuple((self._text(key, value.place), value) for key, value in pairs), whole)
