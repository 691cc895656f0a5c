"""Reads the key `scoring` of a benchmark: items by group, and the rules by which they give points.

docs/organiser.md, "Points", describes the keys.
"""

from dataclasses import replace
from decimal import Decimal
from typing import Dict, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.model.rules import JuryResult
from roah_rsbb.model.scoring import (
    MAX_NUMBER,
    MAX_VALUE,
    TIME_LEFT,
    GroupLimits,
    Key,
    ScoreKind,
    ScoringItem,
    SheetRules,
    TimeLeft,
)
from roah_rsbb.rulebook.errors import Place, Report, listing, quote
from roah_rsbb.rulebook.sheet_file import choices_of, ends, judges_of
from roah_rsbb.rulebook.yaml_fields import choice, describe, exact, fields, integer, sequence, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable
from roah_rsbb.wording.texts import did_you_mean

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
# The keys of each type besides type, desc and needs.
_KEYS = {
    ScoreKind.BOOL: ("points",),
    ScoreKind.UINT: ("points", "max"),
    ScoreKind.INT: ("points", "min", "max"),
    ScoreKind.DECIMAL: ("points", "min", "max"),
    ScoreKind.CHOICE: ("choices",),
    ScoreKind.RATING: ("points", "min", "max", "judges", "jury"),
}
_NEEDED_KEYS = {ScoreKind.CHOICE: ("choices",), ScoreKind.RATING: ("judges", "max")}
_JURY = tuple(result.value for result in JuryResult)


class _Needs(NamedTuple):
    """A reference to other items, before all items are known."""

    group: Optional[str]  # of the item that has it
    node: Node


class ScoringSection:
    """The items and rules of one benchmark. Those with errors are left out."""

    def __init__(self, report: Report, node: Optional[Node], sheets: int = 0) -> None:
        """`sheets`: the number of judges who have a sheet of their own; 0: the referee scores."""
        self._report = report
        self._sheets = sheets
        self._items: Dict[Key, ScoringItem] = {}
        self._places: Dict[Key, Place] = {}
        self._needs: Dict[Key, _Needs] = {}
        self._limits: List[Tuple[GroupLimits, Place]] = []
        self._group_places: Dict[str, Place] = {}
        self._whole = True  # no item was left out
        got: Dict[str, Node] = {}
        if isinstance(node, Mapping):
            got = fields(report, node, "scoring", _SHEET, _SHEET_OPTIONAL) or {}
            self._groups(got.get("groups"))
        else:
            self._groups(node)
        self._resolve_needs()
        least, most = ends(report, got, "the sheet")
        time_left = self._time_left(got["time_left"]) if "time_left" in got else None
        self.items = tuple(self._items.values())
        self.rules = SheetRules(tuple(limits for limits, _ in self._limits), least, most, time_left)
        self._check_points(got)

    # -- groups and items ---------------------------------------------------------------------------

    def _groups(self, node: Optional[Node]) -> None:
        for group in sequence(self._report, node, "scoring", _GROUPS_SHAPE) or ():
            if not isinstance(group, Mapping):
                if not isinstance(group, Unusable):
                    self._report.error(group.place, f"{describe(group)} in scoring", _GROUPS_SHAPE)
                continue
            for key, value in group.pairs:
                self._group(key, value)

    def _group(self, key: Scalar, node: Optional[Node]) -> None:
        """Read a group: a sequence of items, or a map with limits."""
        name = text(self._report, key, "name of a scoring group")
        what = f"items of the scoring group {quote(key.text)}"
        if isinstance(node, Mapping):
            got = fields(self._report, node, f"the scoring group {quote(key.text)}", _GROUP, _GROUP_OPTIONAL) or {}
            least, most = ends(self._report, got, f"the scoring group {quote(key.text)}")
            if name is not None and (least is not None or most is not None):
                found = f"limits of the scoring group {quote(name)} a second time"
                self._report.once(self._group_places, name, node.place, found, "limits of each group once")
                self._limits.append((GroupLimits(name, least, most), node.place))
            node = got.get("items")
        for entry in sequence(self._report, node, what, _ITEMS_SHAPE) or ():
            self._item(entry, name)

    def _item(self, node: Node, group: Optional[str]) -> None:
        report = self._report
        got = fields(report, node, "a scoring item", _ITEM, _ITEM_OPTIONAL)
        if got is None:
            self._whole = False
            return
        word = choice(report, got.get("type"), "type", tuple(_KINDS), "a scoring type")
        kind = None if word is None else _KINDS[word]
        desc = text(report, got.get("desc"), "desc of a scoring item")
        if kind is not None:
            self._check_keys(node, got, kind)
        item = self._values(got, ScoreKind.INT if kind is None else kind)
        if group is None or desc is None:
            self._whole = False
            return
        found = f"the scoring item {quote(desc)} a second time in group {quote(group)}"
        report.once(self._places, (group, desc), got["desc"].place, found, "each desc of a group once")
        if "needs" in got:
            self._needs.setdefault((group, desc), _Needs(group, got["needs"]))
        self._items.setdefault((group, desc), replace(item, group=group, desc=desc))

    def _check_keys(self, node: Node, got: Dict[str, Node], kind: ScoreKind) -> None:
        """Check that an item has the keys of its type, and no others."""
        for key in got:
            if key in _ITEM_OPTIONAL and key != "needs" and key not in _KEYS[kind]:
                expected = f"one of {listing(map(quote, (*_KEYS[kind], 'needs')))}"
                if key == "points" and kind is ScoreKind.CHOICE:
                    expected = "the points of each choice, such as 'choices: {fully: 20, partly: 10}'"
                self._report.error(got[key].place, f"the key {quote(key)} in an item of type {kind.word}", expected)
        given = {*got, "judges"} if self._sheets else got.keys()
        missing = [key for key in _NEEDED_KEYS.get(kind, ()) if key not in given]
        if missing and isinstance(node, Mapping) and node.whole:
            examples = listing(f"'{key}: {_ITEM_OPTIONAL[key]}'" for key in missing)
            self._report.error(node.place, f"an item of type {kind.word} without {listing(missing)}",
                               f"something like {examples}")

    def _values(self, got: Dict[str, Node], kind: ScoreKind) -> ScoringItem:
        """Read what an item takes, and its points."""
        report = self._report
        is_whole = kind in (ScoreKind.UINT, ScoreKind.INT)
        least, most = self._whole_range(got, 1 if kind is ScoreKind.UINT else -MAX_VALUE) if is_whole else \
            ends(report, got, "the item")
        if kind is ScoreKind.RATING and least is None:
            least = Decimal(0)
            if most is not None and most <= 0 and "min" not in got:
                found = f"{describe(got['max'])} as max of a rating"
                report.error(got["max"].place, found, "a number above 0, or a min")
        jury = JuryResult.MEAN
        if "jury" in got:
            jury = JuryResult(choice(report, got["jury"], "jury", _JURY, "how ratings become one") or "mean")
        return ScoringItem(
            "", "", kind, exact(report, got.get("points"), "points", -MAX_NUMBER, MAX_NUMBER), least, most,
            choices_of(report, got["choices"]) if "choices" in got else (),
            judges_of(report, got, kind is ScoreKind.RATING, self._sheets), jury,
        )

    def _whole_range(self, got: Dict[str, Node], least: int) -> Tuple[Optional[Decimal], Optional[Decimal]]:
        """Read the keys min and max of an item whose values are whole numbers."""
        numbers = [integer(self._report, got.get(key), key, least, MAX_VALUE) for key in ("min", "max")]
        low, high = (None if number is None else Decimal(number) for number in numbers)
        if low is not None and high is not None and low >= high:
            self._report.error(got["max"].place, f"max {high} of the item, whose min is {low}", "a max above the min")
        return low, high

    # -- references to other items ------------------------------------------------------------------

    def _resolve_needs(self) -> None:
        for key, needs in self._needs.items():
            self._items[key] = replace(self._items[key], needs=self._named(needs, key))
        for key in self._needs:
            path = self._circle(key)
            if path:
                names = " needs ".join(quote(desc) for _, desc in path)
                self._report.error(self._needs[key].node.place, f"items that need each other: {names}",
                                   "one of them without 'needs'")
                return

    def _named(self, needs: _Needs, own: Optional[Key] = None) -> Tuple[Key, ...]:
        """Return the items that a key `needs` names."""
        nodes = needs.node.items if isinstance(needs.node, Sequence) else (needs.node,)
        if not nodes:
            self._report.error(needs.node.place, "an empty sequence as needs", "the desc of one or more items")
        found = [self._one(node, needs.group, own) for node in nodes]
        return tuple(dict.fromkeys(key for key in found if key is not None))

    def _one(self, node: Node, group: Optional[str], own: Optional[Key]) -> Optional[Key]:
        """Return the item that a node names: in the same group, else in the whole sheet."""
        report = self._report
        desc = text(report, node, "needs")
        if desc is None:
            return None
        if group is not None and (group, desc) in self._places and (group, desc) != own:
            return group, desc
        keys = [key for key in self._places if key[1] == desc and key != own]
        if len(keys) == 1:
            return keys[0]
        if keys:
            groups = listing(quote(name) for name, _ in keys)
            return report.error(node.place, f"{quote(desc)} as needs, which is in the groups {groups}",
                                "an item whose desc is in one group only")
        if own is not None and desc == own[1]:
            return report.error(node.place, f"{quote(desc)} as needs of itself", "another item")
        if not self._whole:
            return None  # it may be one that has an error
        others = [name for _, name in self._places if (_, name) != own]
        return report.error(node.place, f"{quote(desc)} as needs",
                            "the desc of another item" + (did_you_mean(desc, others) if others else ""))

    def _circle(self, start: Key) -> Tuple[Key, ...]:
        """Return a path of needs from an item to itself; empty: there is none."""
        paths: List[Tuple[Key, ...]] = [(start,)]
        seen: Set[Key] = set()
        while paths:
            path = paths.pop()
            for key in self._items[path[-1]].needs if path[-1] in self._items else ():
                if key == start:
                    return (*path, start)
                if key not in seen:
                    seen.add(key)
                    paths.append((*path, key))
        return ()

    # -- the whole sheet ----------------------------------------------------------------------------

    def _time_left(self, node: Node) -> Optional[TimeLeft]:
        report = self._report
        got = fields(report, node, "time_left", _TIME_LEFT, _TIME_LEFT_OPTIONAL)
        if got is None:
            return None
        points = exact(report, got.get("points"), "points of time_left", 0, MAX_NUMBER)
        seconds = exact(report, got["seconds"], "seconds of time_left", Decimal("0.001"), 86400) \
            if "seconds" in got else Decimal(1)
        most = exact(report, got.get("max"), "max of time_left", 0, MAX_NUMBER)
        needs = self._named(_Needs(None, got["needs"])) if "needs" in got else ()
        places = [place for (group, _), place in self._places.items() if group == TIME_LEFT]
        if places:
            report.error(node.place, f"time_left, and a scoring group '{TIME_LEFT}' in line {places[0].line}",
                         "another name of the group: the sheet lists the points for the time left under this name")
        return None if points is None or seconds is None else TimeLeft(points, seconds, most, needs)

    def _check_points(self, got: Dict[str, Node]) -> None:
        """Check that limits limit something."""
        if not self._whole:
            return
        with_points = {item.group for item in self.items if item.has_points}
        for limits, place in self._limits:
            if limits.name not in with_points:
                self._report.error(place, f"limits of the group {quote(limits.name)}, whose items give no points",
                                   "the key 'points' in an item, or 'choices' with points")
        if not with_points and "time_left" not in got:
            for key in ("min", "max"):
                if key in got:
                    self._report.error(got[key].place, f"{key} of a sheet that gives no points",
                                       "the key 'points' in an item, or no limits")
