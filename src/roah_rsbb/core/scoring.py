"""The score sheet of a run: what the referee marks, item by item.

Items, their types and groups come from the benchmarks file (benchmarks, Scoring items of the TBMs).
"""

from typing import Dict, List, NamedTuple, Tuple

from roah_rsbb.core.benchmarks import ScoreKind, ScoringItem
from roah_rsbb.core.refused import Refused, did_you_mean

# `int32` on the ROS interface.
MAX_VALUE = 2**31 - 1


def score_text(group: str, desc: str, old: int, value: int) -> str:
    """An item's change for the referee's eyes."""
    return f"Score: {group}: {desc} {old} -> {value}"


class ScoreGroup(NamedTuple):
    """A group as the panels show it: items and their values, in the file's order."""

    name: str
    items: Tuple[Tuple[ScoringItem, int], ...]


class ScoreSheet:
    """Values of all scoring items of one run; all begin at 0."""

    def __init__(self, items: Tuple[ScoringItem, ...]) -> None:
        self._items: Dict[Tuple[str, str], ScoringItem] = {(i.group, i.desc): i for i in items}
        self._values: Dict[Tuple[str, str], int] = dict.fromkeys(self._items, 0)

    def check(self, group: str, desc: str, value: int) -> None:
        """Raise `Refused` with the remedy if the item does not exist or cannot have this value."""
        item = self._items.get((group, desc))
        if item is None:
            raise Refused([self._unknown(group, desc)])
        if item.kind is ScoreKind.BOOL and value not in (0, 1):
            raise Refused([f"'{desc}' is yes or no: its value is 0 or 1, not {value}"])
        if not 0 <= value <= MAX_VALUE:
            raise Refused([f"'{desc}' counts: its value is 0 or more, not {value}"])

    def set(self, group: str, desc: str, value: int) -> int:
        """Set an item and return its old value; raises as `check` does."""
        self.check(group, desc, value)
        old = self._values[(group, desc)]
        self._values[(group, desc)] = value
        return old

    def groups(self) -> List[ScoreGroup]:
        """All items with their values, group by group, in the file's order."""
        grouped: Dict[str, List[Tuple[ScoringItem, int]]] = {}
        for key, item in self._items.items():
            grouped.setdefault(item.group, []).append((item, self._values[key]))
        return [ScoreGroup(name, tuple(items)) for name, items in grouped.items()]

    def _unknown(self, group: str, desc: str) -> str:
        if not self._items:
            return "this benchmark has no scoring items for the referee"
        groups = list(dict.fromkeys(i.group for i in self._items.values()))
        if group not in groups:
            return f"no scoring group '{group}'{did_you_mean(group, groups)}"
        descs = [i.desc for i in self._items.values() if i.group == group]
        return f"no scoring item '{desc}' in group '{group}'{did_you_mean(desc, descs)}"
